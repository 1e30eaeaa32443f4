//! Studies: the questions that featherbench asks, one file each.
//!
//! - [`Agreement`]: do the engines agree on one and the same model?
//! - [`Structure`]: are the counts of the sparse algorithms the integers that theory says?
//! - [`Timing`]: how long do the native kernels take?

mod agreement;
mod structure;
mod timing;

pub use agreement::Agreement;
pub use structure::Structure;
pub use timing::Timing;

use harness::{Cell, Problem};
use record::Record;

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
        params: record::canonical_json(&cell.params),
        engine: cell.subject.clone(),
        engine_version: cell.version.clone(),
        method: cell.method.clone(),
        scalar: cell.scalar.clone(),
        quantity: cell.quantity.clone(),
        ..Record::default()
    }
}
