//! Section: joint type × engine × quantity: which engine has the joint, and which engines agree on what.
//!
//! The robots are those named `joints-TYPE-BASE…`; each of them has one type of joint. A cell combines their bases, shapes and states, and
//! the engine's methods, into the worst row. So the named method is the one that decides.

use std::collections::{BTreeMap, BTreeSet};

use featherbench_bench::params;
use featherbench_model::JointType;
use featherbench_report::map::{inside, outside};
use featherbench_report::numbers::{decades, larger, listed, short};
use featherbench_report::{Overview, Tally, engine as linked, labels, swatch, worst_first};
use featherbench_results::{Row, Verdict};
use maud::{Markup, html};
use serde::Serialize;

use super::{PAIRWISE, STUDY};
use crate::agreement::Params;

/// The prefix of these robots' names.
const PREFIX: &str = "joints-";
/// The suffix of a row with armature.
const WITH_ARMATURE: &str = " with armature";

/// The table, and the data of its cells for the page's script.
#[derive(Debug, Default, Serialize)]
pub struct JointMatrix<'a> {
    /// One row per joint type, and one more for the type with armature.
    pub rows: Vec<Shown<'a>>,
    /// Columns: engine and quantity, as indices of the overview.
    pub columns: Vec<(usize, usize)>,
    /// The cells by row, engine and quantity.
    pub cells: Vec<Cell<'a>>,
}

/// The joint of a robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct Shown<'a> {
    #[serde(skip)]
    rank: usize,
    /// The joint type.
    pub kind: &'a str,
    /// Whether it has armature.
    pub armature: bool,
}

/// The result of a joint type in an engine's quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum State {
    /// Every answer is inside its gate.
    Agrees,
    /// One is outside, for a known cause.
    Deviates,
    /// One is outside.
    Fails,
    /// One is missing.
    Error,
    /// The engine offers none.
    Unsupported,
}

/// All rows of one joint type, engine and quantity.
#[derive(Debug, Serialize)]
pub struct Cell<'a> {
    /// Row, engine and quantity.
    pub at: [usize; 3],
    /// The whole cell in a word.
    pub state: State,
    /// How many rows have which verdict.
    pub rows: String,
    /// The robots that answered.
    pub robots: usize,
    /// The robots that the engine does not support.
    pub lacking: Vec<&'a str>,
    /// The robot, metric, case, method and reason of the row that decides.
    pub worst: [&'a str; 5],
    /// Its value, bound and margin.
    pub numbers: [Option<f64>; 3],
}

/// A cell while rows are added.
#[derive(Default)]
struct Fold<'a> {
    tally: Tally,
    answered: BTreeSet<&'a str>,
    lacking: BTreeSet<&'a str>,
    worst: Option<&'a Row>,
    refused: Option<&'a Row>,
}

impl<'a> JointMatrix<'a> {
    /// Collects a run's rows; empty if it has no such robots.
    pub fn of(overview: &Overview, quantities: &[&str], rows: &'a [Row]) -> Self {
        let mut folds: BTreeMap<(Shown, usize, usize), Fold> = BTreeMap::new();
        for row in rows.iter().filter(|row| row.study == STUDY && row.metric != PAIRWISE && row.verdict != Verdict::Info) {
            let quantity = quantities.iter().position(|&name| name == row.quantity);
            let (Some(shown), Some(engine), Some(quantity)) = (Shown::of(row), overview.engine(&row.engine), quantity) else { continue };
            // An engine that is compared with itself is left out.
            if row.reference.split(' ').next() != Some(&row.engine) {
                folds.entry((shown, engine, quantity)).or_default().add(row);
            }
        }
        let rows: Vec<Shown> = folds.keys().map(|&(shown, ..)| shown).collect::<BTreeSet<_>>().into_iter().collect();
        let columns = folds.keys().map(|&(_, engine, quantity)| (engine, quantity)).collect::<BTreeSet<_>>().into_iter().collect();
        let cells = folds.into_iter().filter_map(|((shown, engine, quantity), fold)| {
            let row = rows.iter().position(|&other| other == shown)?;
            fold.cell([row, engine, quantity])
        });
        Self { cells: cells.collect(), rows, columns }
    }

    fn cell(&self, row: usize, engine: usize, quantity: usize) -> Option<&Cell<'a>> {
        self.cells.iter().find(|cell| cell.at == [row, engine, quantity])
    }
}

impl<'a> Shown<'a> {
    /// The joint of a row's robot: `joints-TYPE-BASE`, then perhaps `-single` and `-armature`; `None` if that is not a single type.
    fn of(row: &'a Row) -> Option<Self> {
        let mut parts = row.robot.strip_prefix(PREFIX)?.split('-');
        let kind = parts.next()?;
        let armature = parts.any(|part| part == "armature");
        let params: Params = params::of_row(row)?;
        let held = params.joints.iter().any(|joint| joint == kind);
        let rank = JointType::names().iter().position(|&known| known == kind).unwrap_or(usize::MAX);
        held.then_some(Self { rank, kind, armature })
    }
}

impl<'a> Fold<'a> {
    fn add(&mut self, row: &'a Row) {
        // A skip says that the engine has no such joint or armature: it is neither right nor wrong.
        if row.verdict == Verdict::Skip {
            self.lacking.insert(&row.robot);
            self.refused = self.refused.or(Some(row));
            return;
        }
        self.tally.add(row.verdict);
        self.answered.insert(&row.robot);
        if self.worst.is_none_or(|worst| worst_first(row) < worst_first(worst)) {
            self.worst = Some(row);
        }
    }

    fn cell(self, at: [usize; 3]) -> Option<Cell<'a>> {
        let row = self.worst.or(self.refused)?;
        let state = match (self.worst, self.tally.verdict()) {
            (None, _) => State::Unsupported,
            (_, Verdict::Fail) => State::Fails,
            (_, Verdict::Error) => State::Error,
            (_, Verdict::Deviation) => State::Deviates,
            _ => State::Agrees,
        };
        Some(Cell {
            at,
            state,
            rows: self.tally.words(),
            robots: self.answered.len(),
            lacking: self.lacking.into_iter().collect(),
            worst: [&row.robot, &row.metric, &row.states, &row.method, &row.reason],
            numbers: [row.value, row.bound, row.margin],
        })
    }
}

/// Writes the section.
pub fn markup(overview: &Overview, quantities: &[&str], matrix: &JointMatrix) -> Markup {
    html! {
        section #joints {
            h2 { "Joint matrix" }
            p.lead {
                "Each joint type in the middle and at the tips of a branched tree and alone, on fixed and floating bases: the worst row of every "
                "engine and quantity over all its methods, robots and states. Fixed joints are merged before any engine is asked. Click a cell to "
                "see the rows of the robot that decided it."
            }
            ul.findings { @for engine in engines(matrix) { (sentence(overview, quantities, matrix, engine)) } }
            (legend())
            div.heat-frame tabindex="-1" { (table(overview, quantities, matrix)) }
        }
    }
}

fn engines(matrix: &JointMatrix) -> BTreeSet<usize> {
    matrix.columns.iter().map(|&(engine, _)| engine).collect()
}

/// The joints of an engine, and where it does not agree.
fn sentence(overview: &Overview, quantities: &[&str], matrix: &JointMatrix, engine: usize) -> Markup {
    let cells: Vec<&Cell> = matrix.cells.iter().filter(|cell| cell.at[1] == engine).collect();
    let name = |row: usize| matrix.rows[row].words();
    let rows_where = |lack: &dyn Fn(&Cell) -> bool| {
        let rows: BTreeSet<usize> = cells.iter().filter(|cell| lack(cell)).map(|cell| cell.at[0]).collect();
        rows.into_iter().map(name).collect::<Vec<_>>()
    };
    // Each quantity in that state with its largest value, if it has one.
    let quantities_where = |state: State| {
        let mut largest: BTreeMap<usize, Option<f64>> = BTreeMap::new();
        for cell in cells.iter().filter(|cell| cell.state == state) {
            let known = largest.entry(cell.at[2]).or_default();
            *known = [*known, cell.numbers[0]].into_iter().flatten().reduce(larger);
        }
        let words = |(quantity, value): (usize, Option<f64>)| {
            let title = labels::quantity(quantities[quantity]);
            value.map_or(title.to_owned(), |value| format!("{title} ({})", short(value)))
        };
        largest.into_iter().map(words).collect::<Vec<_>>()
    };
    // If the engine answers one quantity of a row and does not support another, the row is offered in part, not lacking.
    let answered: BTreeSet<usize> = cells.iter().filter(|cell| cell.state != State::Unsupported).map(|cell| cell.at[0]).collect();
    let mut lacking = rows_where(&|cell| !answered.contains(&cell.at[0]));
    // Without the joint there is no armature on it either.
    let types = lacking.clone();
    lacking.retain(|row| row.strip_suffix(WITH_ARMATURE).is_none_or(|kind| !types.iter().any(|other| other == kind)));
    let partly = rows_where(&|cell| answered.contains(&cell.at[0]) && !cell.lacking.is_empty());

    let agreeing = cells.iter().filter(|cell| cell.state == State::Agrees);
    let closest = agreeing.filter_map(|cell| Some((cell.numbers[2]?, *cell))).min_by(|(one, _), (other, _)| one.total_cmp(other));
    let mut parts = Vec::new();
    if let Some((margin, cell)) = closest {
        let quantity = labels::quantity(quantities[cell.at[2]]);
        let (decades, method, joint) = (decades(margin), cell.worst[3], name(cell.at[0]));
        parts.push(format!("agrees with at least {decades} decades to the gate ({quantity} by {method} on {joint})"));
    }
    let (deviating, failing, silent) = (quantities_where(State::Deviates), quantities_where(State::Fails), quantities_where(State::Error));
    for (what, list) in [
        ("deviates by known cause in", &deviating),
        ("is outside its gate in", &failing),
        ("gives no answer in", &silent),
        ("does not offer", &lacking),
        ("offers in part", &partly),
    ] {
        if !list.is_empty() {
            parts.push(format!("{what} {}", listed(list)));
        }
    }
    let class = match (failing.is_empty() && silent.is_empty(), deviating.is_empty()) {
        (false, _) => "fail",
        (true, false) => "known",
        (true, true) => "pass",
    };
    html! { li.(class) { b { (linked(overview, overview.engines[engine])) } " " (parts.join("; ")) "." } }
}

impl Shown<'_> {
    /// In words: `planar with armature`.
    fn words(self) -> String {
        if self.armature { format!("{}{WITH_ARMATURE}", self.kind) } else { self.kind.to_owned() }
    }
}

fn table(overview: &Overview, quantities: &[&str], matrix: &JointMatrix) -> Markup {
    let first = |position: usize| position == 0 || matrix.columns[position - 1].0 != matrix.columns[position].0;
    html! {
        table #joints-table.grid role="grid" aria-label="Agreement by joint type, engine and quantity" {
            thead {
                tr {
                    th.corner rowspan="2" scope="col" { "joint" }
                    @for engine in engines(matrix) {
                        @let width = matrix.columns.iter().filter(|&&(other, _)| other == engine).count();
                        th.engine colspan=(width) scope="colgroup" { (linked(overview, overview.engines[engine])) }
                    }
                }
                tr {
                    @for (position, &(_, quantity)) in matrix.columns.iter().enumerate() {
                        th.quantity.first[first(position)] scope="col" title=(quantities[quantity]) {
                            span { (labels::quantity(quantities[quantity])) }
                        }
                    }
                }
            }
            tbody {
                @for (index, shown) in matrix.rows.iter().enumerate() {
                    tr data-m=(index) {
                        th scope="row" { (shown.kind) @if shown.armature { small { "with armature" } } }
                        @for (position, &(engine, quantity)) in matrix.columns.iter().enumerate() {
                            td.first[first(position)] {
                                @if let Some(cell) = matrix.cell(index, engine, quantity) { (button(cell)) }
                            }
                        }
                    }
                }
            }
        }
    }
}

fn button(cell: &Cell) -> Markup {
    let margin = cell.numbers[2];
    let (class, text) = match cell.state {
        State::Agrees => (margin.map_or("p5", inside), margin.map_or("✓".into(), |margin| format!("{:.0}", margin.floor().max(0.0)))),
        State::Fails => (margin.map_or("f2", outside), labels::glyph(Verdict::Fail).to_owned()),
        State::Deviates => ("deviation", labels::glyph(Verdict::Deviation).to_owned()),
        State::Error => ("error", labels::glyph(Verdict::Error).to_owned()),
        State::Unsupported => ("skip", labels::glyph(Verdict::Skip).to_owned()),
    };
    let partial = cell.state != State::Unsupported && !cell.lacking.is_empty();
    html! { button.(class).part[partial] type="button" tabindex="-1" { (text) } }
}

fn legend() -> Markup {
    html! {
        ul.legend aria-label="Legend of the joint matrix" {
            (swatch("p3", "2", "agrees: whole decades to the gate"))
            (swatch("p3 part", "2", "agrees where it is offered"))
            (swatch("deviation", "≈", "deviates by known cause"))
            (swatch("f1", "✕", "outside its gate"))
            (swatch("skip", "–", "not offered"))
            (swatch("error", "!", "no answer"))
        }
    }
}
