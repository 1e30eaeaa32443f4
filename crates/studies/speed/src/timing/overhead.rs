//! The overhead of calling an engine whose times are estimates. Its clock measures and subtracts it.

use featherbench_bench::{Evaluation, NoAnswer};

/// Number of calls whose overhead is asked for: one at each of the first states.
const CALLS: usize = 31;

/// Nanoseconds of overhead of each of some calls.
pub(super) fn per_call(prepared: &mut dyn Evaluation) -> Result<Vec<f64>, NoAnswer> {
    let one = |state: usize| {
        prepared.clock(state..state + 1)?;
        let overhead = prepared.overhead().ok_or_else(|| NoAnswer::Failed("its clock tells no overhead".into()))?;
        Ok(overhead.as_nanos() as f64)
    };
    (0..CALLS).map(one).collect()
}
