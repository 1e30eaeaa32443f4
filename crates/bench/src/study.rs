//! The trait [`Study`]: a question, asked as cells and answered as records.

use crate::{Cell, Gates, Outcome, Problem, Subject};
use featherbench_results::Record;
use std::collections::BTreeMap;

/// What a study can see: the robots and the subjects.
pub struct Context<'a> {
    /// The robots, in the suite's order.
    pub problems: &'a [Problem],
    /// The subjects, the native one first.
    pub subjects: &'a [Box<dyn Subject>],
    /// Every threshold.
    pub gates: &'a Gates,
    /// The suite's seed.
    pub seed: u64,
}

impl Context<'_> {
    /// The problem of a cell.
    pub fn problem(&self, name: &str) -> Option<&Problem> {
        self.problems.iter().find(|problem| problem.name == name)
    }

    /// The subject of a cell.
    pub fn subject(&self, name: &str) -> Option<&dyn Subject> {
        self.subjects.iter().find(|subject| subject.identity().name == name).map(AsRef::as_ref)
    }
}

/// A finished cell.
pub type Finished = (Cell, Outcome);

/// A question about robots and subjects.
///
/// A study plans its cells, evaluates each by itself (in any order, on any thread, once), and turns the outcomes into records by a pure
/// function: that is what makes a resumed run byte-identical.
pub trait Study: Sync {
    /// The study's name in records.
    fn name(&self) -> &'static str;

    /// Whether its cells run alone on a quiet machine, after all others.
    fn exclusive(&self) -> bool {
        false
    }

    /// The cells, in the order of the report.
    fn plan(&self, context: &Context) -> Vec<Cell>;

    /// Whether a cell belongs to no robot, so that it is asked wherever any cell of the study is.
    fn is_common(&self, _cell: &Cell) -> bool {
        false
    }

    /// Evaluates one cell.
    fn evaluate(&self, context: &Context, cell: &Cell) -> Outcome;

    /// Turns the outcomes of one problem into records.
    fn compare(&self, context: &Context, problem: &Problem, finished: &[Finished]) -> Vec<Record>;

    /// Turns the outcomes into the records that belong to no problem. Most studies have none.
    fn compare_all(&self, _context: &Context, _finished: &[Finished]) -> Vec<Record> {
        Vec::new()
    }

    /// What of the outcomes is worth a file of its own beside the records: its name and its text.
    fn side_file(&self, _: &[Finished]) -> Option<(&'static str, String)> {
        None
    }
}

/// Groups finished cells by problem, in the order of the problems.
pub(crate) fn by_problem(finished: Vec<Finished>) -> BTreeMap<String, Vec<Finished>> {
    let mut groups: BTreeMap<String, Vec<Finished>> = BTreeMap::new();
    for item in finished {
        groups.entry(item.0.problem.clone()).or_default().push(item);
    }
    groups
}
