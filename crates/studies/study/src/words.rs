//! The words of a study: its names in rows, and what they mean.

/// The names that a study writes into rows, each with its meaning. A `*` in a name stands for any text.
pub struct Words {
    /// Names in the column `quantity`, beside those of [`Quantity`](featherbench_results::Quantity).
    pub quantities: &'static [(&'static str, &'static str)],
    /// Names in the column `metric`.
    pub metrics: &'static [(&'static str, &'static str)],
    /// Keys in the column `params`, beside those that all studies have.
    pub params: &'static [(&'static str, &'static str)],
}
