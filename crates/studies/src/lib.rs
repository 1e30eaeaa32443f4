//! Studies: the questions that featherbench asks, one file each.
//!
//! - [`Agreement`]: do the engines agree on one and the same model, and how far are we from the truth beside the best of them?
//! - [`Digits`]: how far is each from the truth, and who is right?
//! - [`Conditioning`]: how does κ(M) grow, and does it matter?
//! - [`Reading`]: do they read one and the same file alike, and if not, where and why?
//! - [`Repeatability`]: does the same question have the same answer?
//! - [`Reproductions`]: are the engines' known deviations still there, and as large as they were?
//! - [`StepLimit`]: how does the acceleration of a step approach the true one, and what do steps do to energy?
//! - [`Structure`]: are the counts of the sparse algorithms the integers that theory says?
//! - [`Timing`]: how long does everyone take, in a paired experiment?

mod accuracy;
mod agreement;
mod conditioning;
mod digits;
pub mod reading;
mod repeatability;
mod reproductions;
mod step_limit;
mod structure;
mod timing;

pub use agreement::Agreement;
pub use conditioning::Conditioning;
pub use digits::Digits;
pub use reading::Reading;
pub use repeatability::Repeatability;
pub use reproductions::{Reproduce, Reproductions};
pub use step_limit::StepLimit;
pub use structure::Structure;
pub use timing::Timing;

use featherbench_bench::{Cell, Context, Outcome, Problem, Quantity, Refusal, Subject};
use featherbench_results::Record;

/// A row with everything that its cell and problem say; the study adds case, metric and value.
fn row(cell: &Cell, problem: &Problem) -> Record {
    Record {
        cell: cell.id(),
        study: cell.study.clone(),
        problem: problem.family.clone(),
        model: problem.name.clone(),
        nq: Some(problem.states.nq as u64),
        nv: Some(problem.states.nv as u64),
        bodies: Some(problem.description.bodies.len() as u64),
        depth: Some(problem.depth as u64),
        params: featherbench_results::canonical_json(&cell.params),
        engine: cell.subject.clone(),
        engine_version: cell.version.clone(),
        method: cell.method.clone(),
        scalar: cell.scalar.clone(),
        quantity: cell.quantity.clone(),
        ..Record::default()
    }
}

/// Asks a cell's subject for its quantity at the problem's states.
fn evaluate(context: &Context, cell: &Cell) -> Outcome {
    let lost = |what: &str| Outcome::Refused(Refusal::Failed(format!("there is no {what} of this cell")));
    let Some(problem) = context.problem(&cell.problem) else { return lost("problem") };
    let Some(subject) = context.subject(&cell.subject) else { return lost("subject") };
    let Some(quantity) = Quantity::parse(&cell.quantity) else { return lost("quantity") };
    asked(subject, problem, quantity, &cell.method).into()
}

/// Asks a subject for a quantity at a problem's states.
fn asked(subject: &dyn Subject, problem: &Problem, quantity: Quantity, method: &str) -> Result<Vec<f64>, Refusal> {
    let count = quantity.states(problem.states.count());
    let mut prepared = subject.prepare(problem, quantity, method, &problem.states)?;
    prepared.run(0..count)?;
    let (values, due) = (prepared.read().to_vec(), count * quantity.size(problem));
    // Fewer states would be compared, and nobody would know.
    if values.len() == due { Ok(values) } else { Err(Refusal::Failed(format!("{} numbers came, {due} are due", values.len()))) }
}

/// The value below which a fraction of the sorted samples lies.
fn quantile(sorted: &[f64], fraction: f64) -> f64 {
    let at = fraction * (sorted.len().saturating_sub(1)) as f64;
    let (low, high) = (at.floor() as usize, at.ceil() as usize);
    match (sorted.get(low), sorted.get(high)) {
        (Some(a), Some(b)) => a + (b - a) * at.fract(),
        _ => f64::NAN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_interpolate() {
        let sorted = [1.0, 2.0, 3.0, 4.0, 5.0];
        assert_eq!([0.0, 0.1, 0.5, 1.0].map(|f| quantile(&sorted, f)), [1.0, 1.4, 3.0, 5.0]);
        assert!(quantile(&[], 0.5).is_nan());
    }
}
