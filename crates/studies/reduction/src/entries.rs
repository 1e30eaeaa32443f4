//! The entries of a catalogue: each known deviation of each engine, with the rows that show it, or why none can be reduced.

use super::catalogue::{Line, Status};
use super::finding::{Failure, Fault, OF_SEVERAL, metric};
use featherbench_bench::{Deviation, Gates, Quantity, Reproduction, cause};
use featherbench_results::{Row, Verdict};
use std::collections::{BTreeMap, BTreeSet};

/// Errors of inverse dynamics and M below this are rounding: 45 ε, the gate of the study `accuracy`.
const ROUNDING: f64 = 1e-14;
/// Errors of forward dynamics up to this multiple of the conditioning bound are no finding: ten for each of some ten levels of a tree.
const OVER_FLOOR: f64 = 100.0;
/// Rows of robots up to this size come first: a step of a larger one takes seconds.
const SMALL: u64 = 64;
/// Quantities for which engines have a call of their own: their cases have programs. So their rows come before others.
const CALLED: [Quantity; 9] = [
    Quantity::InverseDynamics,
    Quantity::Bias,
    Quantity::MassMatrix,
    Quantity::ForwardDynamics,
    Quantity::KineticEnergy,
    Quantity::InverseDynamicsDq,
    Quantity::InverseDynamicsDv,
    Quantity::ForwardDynamicsDq,
    Quantity::ForwardDynamicsDv,
];
/// What a reproduction's name is, where there is none.
const NOT_REPRODUCED: &str = "not reproduced";

/// Rows, each with what it says.
type Found<'a> = Vec<(&'a Row, Failure)>;
/// An engine, a quantity and a method.
type Way<'a> = (&'a str, &'a str, &'a str);

/// An entry: a line that says why there is no case yet, and the rows to reduce, the worst first.
#[derive(Debug)]
pub struct Entry<'a> {
    /// The line; its status holds unless a row is reduced.
    pub line: Line,
    /// The rows, each with what it says.
    pub found: Vec<(&'a Row, Failure)>,
}

/// The entries of the rows of one run or several, in this order:
///
/// - one for each known deviation and each reproduction,
/// - one for each engine, quantity and method that fails for no known cause,
/// - one for each other whose error is above rounding in the studies `accuracy` and `sweep`.
///
/// With cells named by the beginnings of their ids, those that have a row of these cells.
pub fn entries<'a>(gates: &Gates, rows: &'a [Row], named: &[String]) -> Vec<Entry<'a>> {
    let asked = |row: &&Row| named.is_empty() || named.iter().any(|cell| row.cell.starts_with(cell.as_str()));
    let rows: Vec<&Row> = rows.iter().filter(asked).collect();
    let mut all: Vec<Entry> = gates.deviations().iter().map(|known| of_deviation(known, &rows)).collect();
    let told: BTreeSet<&str> = gates.deviations().iter().map(|known| known.reproduction.as_str()).collect();
    let alone = gates.reproductions().iter().filter(|reproduction| !told.contains(reproduction.name.as_str()));
    all.extend(alone.map(of_reproduction));
    // One engine's lines follow each other, in the order of its file.
    all.sort_by(|a, b| a.line.engine.cmp(&b.line.engine));
    let failing = by_method(&rows, |row| Failure::of(row).filter(|finding| finding.fault == Fault::Unknown));
    let taken: BTreeSet<(String, String)> = failing.iter().map(|entry| (entry.line.engine.clone(), entry.line.class.clone())).collect();
    all.extend(failing);
    let above = by_method(&rows, |row| above_rounding(row, named.is_empty()));
    all.extend(above.into_iter().filter(|entry| !taken.contains(&(entry.line.engine.clone(), entry.line.class.clone()))));
    all.retain(|entry| named.is_empty() || !entry.found.is_empty());
    all
}

fn of_deviation<'a>(known: &Deviation, rows: &[&'a Row]) -> Entry<'a> {
    let of_engine = || rows.iter().copied().filter(|row| row.engine == known.engine);
    let its: Vec<&Row> = of_engine().filter(|row| cause(row).is_some_and(|id| id == known.id)).collect();
    let mut found: Found = its.iter().filter_map(|row| Some((*row, Failure::of(row)?))).collect();
    sort(&mut found);
    let of_files = known.quantities.as_ref().is_some_and(|quantities| quantities.iter().all(|quantity| quantity == "import"));
    let why = if of_files {
        "it is about reading a file, and about no robot at a state: the file shows it".to_owned()
    } else if of_engine().next().is_none() {
        format!("there is no row of {}", known.engine)
    } else if its.is_empty() {
        "no row shows it".to_owned()
    } else if its.iter().all(|row| OF_SEVERAL.contains(&row.metric.as_str())) {
        let others: BTreeSet<&str> = its.iter().map(|row| row.reference.as_str()).collect();
        format!("only its difference from {} shows it, and not its own error", others.into_iter().collect::<Vec<_>>().join(", "))
    } else {
        let studies: BTreeSet<&str> = its.iter().map(|row| row.study.as_str()).collect();
        let quantities: BTreeSet<&str> = its.iter().map(|row| row.quantity.as_str()).collect();
        let [studies, quantities] = [studies, quantities].map(|words| words.into_iter().collect::<Vec<_>>().join(", "));
        format!("its rows ({quantities} of {studies}) ask for more than a robot at a state")
    };
    let line = Line {
        name: format!("{}-{}", known.engine, known.id),
        engine: known.engine.clone(),
        class: known.id.clone(),
        reason: known.reason.clone(),
        reproduction: (known.reproduction != NOT_REPRODUCED).then(|| known.reproduction.clone()),
        status: Status::None { why },
    };
    Entry { line, found }
}

fn of_reproduction<'a>(known: &Reproduction) -> Entry<'a> {
    let line = Line {
        name: known.name.clone(),
        engine: known.engine.clone(),
        class: known.name.clone(),
        reason: known.condition.clone(),
        reproduction: Some(known.name.clone()),
        status: Status::None { why: "its reproduction shows it; the answers that are judged do not have it".into() },
    };
    Entry { line, found: Vec::new() }
}

/// An entry for each engine, quantity and method with such a finding.
fn by_method<'a>(rows: &[&'a Row], finding: impl Fn(&Row) -> Option<Failure>) -> Vec<Entry<'a>> {
    let mut groups: BTreeMap<Way, Found> = BTreeMap::new();
    for &row in rows {
        let Some(finding) = finding(row) else { continue };
        // The probe of M is of the same method as M.
        let quantity = if finding.quantity == Quantity::MassMatrixProbe { Quantity::MassMatrix } else { finding.quantity };
        groups.entry((&row.engine, quantity.name(), &row.method)).or_default().push((row, finding));
    }
    let entry = |((engine, quantity, method), mut found): (Way, Found<'a>)| {
        sort(&mut found);
        let suffix = found.first().map_or("", |(_, finding)| finding.fault.suffix());
        let reason = found.first().map(|(row, _)| row.reason.clone()).unwrap_or_default();
        let line = Line {
            name: format!("{engine}-{quantity}-{method}{suffix}"),
            engine: engine.to_owned(),
            class: format!("{quantity} by {method}"),
            reason: if reason.is_empty() { "the largest error of the method against the truth".into() } else { reason },
            reproduction: None,
            status: Status::None { why: "it was not reduced".into() },
        };
        Entry { line, found }
    };
    groups.into_iter().map(entry).collect()
}

/// A row of the studies `accuracy` and `sweep` with a number, and one above rounding if `only` these are wanted.
fn above_rounding(row: &Row, only: bool) -> Option<Failure> {
    let least = if row.quantity == Quantity::ForwardDynamics.name() { OVER_FLOOR } else { ROUNDING };
    let severe = row.value.is_some_and(|value| value > least || !only) && row.precision == "f64";
    let judged =
        matches!(row.study.as_str(), "accuracy" | "sweep") && matches!(row.verdict, Verdict::Pass | Verdict::Info | Verdict::Deviation);
    let finding = Failure::with(row, Fault::Above(least)).filter(|_| severe && judged)?;
    (finding.metric == metric(finding.quantity)).then_some(finding)
}

/// The worst first: of small robots, the row with the largest error for its bound; of those without a number, that of the smallest robot.
fn sort(found: &mut [(&Row, Failure)]) {
    let big = |row: &Row| row.bodies.is_none_or(|bodies| bodies > SMALL);
    let share = |row: &Row| row.value.map_or(0.0, |value| value / row.bound.filter(|bound| *bound > 0.0).unwrap_or(1.0));
    let is_called = |finding: &Failure| CALLED.contains(&finding.quantity);
    found.sort_by(|(a, of_a), (b, of_b)| {
        let by_share = share(b).total_cmp(&share(a));
        big(a)
            .cmp(&big(b))
            .then(is_called(of_b).cmp(&is_called(of_a)))
            .then(by_share)
            .then(a.bodies.cmp(&b.bodies))
            .then(a.cell.cmp(&b.cell))
    });
}
