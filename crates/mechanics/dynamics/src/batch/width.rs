//! The widths of a batch: which instructions it computes with.

use super::Number;
use super::run::Workers;
use super::samples::Models;
use super::selected::{Avx2, Avx512, Instructions};
use std::fmt;
use thiserror::Error;

/// The instructions that a [`Batch`](crate::Batch) computes with.
///
/// A build knows those of the processor it is compiled for. Wider ones are compiled beside them, for processors that have them. A build with
/// AVX-512 has no others. Every width with fused multiply-add gives the same results to the bit; without it, results differ by roundings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Width {
    /// Those of the build.
    AsBuilt,
    /// AVX2 with fused multiply-add: registers of 32 bytes.
    Avx2,
    /// AVX-512 (F, BW, CD, DQ, VL): registers of 64 bytes.
    Avx512,
}

impl Width {
    /// Every width, the narrowest first.
    const ALL: [Self; 3] = [Self::AsBuilt, Self::Avx2, Self::Avx512];

    /// The widths that this build has on this processor, the narrowest first. The first is [`Width::AsBuilt`].
    ///
    /// ```
    /// use featherbench_dynamics::Width;
    /// assert_eq!(Width::available().next(), Some(Width::AsBuilt));
    /// assert_eq!(Width::available().last(), Some(Width::widest()));
    /// ```
    pub fn available() -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().filter(|width| width.check().is_ok())
    }

    /// The widest of them, which a new batch takes.
    pub fn widest() -> Self {
        Self::available().last().unwrap_or(Self::AsBuilt)
    }

    /// An error unless this build has the width, and this processor has its instructions.
    fn check(self) -> Result<(), NoSuchWidth> {
        match self {
            Self::AsBuilt => Ok(()),
            Self::Avx2 => Avx2::check(self),
            Self::Avx512 => Avx512::check(self),
        }
    }
}

impl fmt::Display for Width {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::AsBuilt => "the width of the build",
            Self::Avx2 => "AVX2",
            Self::Avx512 => "AVX-512",
        })
    }
}

/// A batch cannot compute with these instructions. [`Width::available`] lists those that it can compute with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum NoSuchWidth {
    /// The processor does not have them.
    #[error("this processor does not have {0}; take one of `Width::available()`")]
    Processor(Width),
    /// The build does not select them: its own are as wide, or it is not for x86-64.
    #[error("this build does not select {0}: its own instructions are as wide or wider, or not those of x86-64; take `Width::AsBuilt`")]
    Build(Width),
}

/// The workers of a batch at the width that it has; none for that of the build, whose workers every batch can have.
#[derive(Clone, Debug)]
pub(super) enum Selected<S: Number> {
    AsBuilt,
    Avx2(Workers<S::Register<Avx2>>),
    Avx512(Workers<S::Register<Avx512>>),
}

impl<S: Number> Selected<S> {
    pub(super) fn new(width: Width, models: &impl Models<S>, cores: usize) -> Result<Self, NoSuchWidth> {
        width.check()?;
        Ok(match width {
            Width::AsBuilt => Self::AsBuilt,
            Width::Avx2 => Self::Avx2(Workers::new(models, cores)),
            Width::Avx512 => Self::Avx512(Workers::new(models, cores)),
        })
    }

    pub(super) fn width(&self) -> Width {
        match self {
            Self::AsBuilt => Width::AsBuilt,
            Self::Avx2(_) => Width::Avx2,
            Self::Avx512(_) => Width::Avx512,
        }
    }

    pub(super) fn resize(&mut self, cores: usize) {
        match self {
            Self::AsBuilt => {}
            Self::Avx2(workers) => workers.resize(cores),
            Self::Avx512(workers) => workers.resize(cores),
        }
    }
}
