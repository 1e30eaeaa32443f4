//! How much tests draw: by day a fixed share, at night all. The tests of several crates include this file.

/// One of how many is drawn: of `n` by day, and each at night, when `FEATHERBENCH_FULL` is set.
pub fn one_of(n: usize) -> usize {
    if std::env::var_os("FEATHERBENCH_FULL").is_some() { 1 } else { n }
}
