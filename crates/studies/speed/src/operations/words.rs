//! The words of the study: its names in rows, and what they mean.

use featherbench_study::Words;

pub(crate) const WORDS: Words = Words { quantities: &[], metrics: &[], params: &[] };
