//! Findings: what a run found, each in one sentence with its numbers, from the gravest.
//!
//! A finding is a set of rows that do not pass for one reason, or a condition of the run that is not met. Which level it has is decided in
//! [`Severity`] alone. A *new* finding turns the gate red; the others are known.

use std::collections::{BTreeMap, BTreeSet};

use featherbench_results::{Culprit, Expectation, GateKind, Relation, Row, RunInfo, Severity, Verdict};

use crate::labels;
use crate::numbers::{count, grouped, listed, short};
use crate::tally::{Tally, worst_first};

/// Quantities that a sentence names.
const NAMED: usize = 3;
/// Characters of a reason in a sentence.
const LONGEST: usize = 300;

/// The state of a run in one word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// Every judged row is inside its gate, or deviates as is known, and every expectation is met.
    Passed,
    /// A row failed or gave no answer, or an expectation is not met.
    Failed,
    /// No row was judged.
    Empty,
}

/// One finding.
#[derive(Clone, Debug)]
pub struct Found<'a> {
    /// Its level; `None` for a condition that says nothing about an answer: a list that is out of date.
    pub severity: Option<Severity>,
    /// Whether it turns the gate red.
    pub new: bool,
    /// The gate that it turns red, or that its known cause excuses.
    pub gate: GateKind,
    /// Who it is about: of rows, the worst one.
    pub culprit: Culprit,
    /// Its quantities in words, that of the worst row first; one alone with its measure of error.
    pub quantities: Vec<String>,
    /// Number of rows.
    pub rows: usize,
    /// Number of robots.
    pub robots: usize,
    /// The worst row; `None` if it is about no row.
    pub worst: Option<&'a Row>,
    /// The condition that is not met; empty if it is about rows.
    pub what: String,
    /// The cause, if it is known, or the reason as the row or the condition has it.
    pub cause: String,
    /// The command that makes its worst row again; empty if there is none.
    pub again: String,
}

/// What a run found.
#[derive(Clone, Debug)]
pub struct Findings<'a> {
    /// The run as a whole.
    pub status: Status,
    /// Verdicts of all rows.
    pub tally: Tally,
    /// The findings: new ones first, then from the gravest.
    pub found: Vec<Found<'a>>,
}

impl<'a> Findings<'a> {
    /// Collects a run's rows and conditions.
    pub fn of(run: &'a RunInfo, rows: &'a [Row]) -> Self {
        Self::about(run, rows, |_| true)
    }

    /// Collects some of a run's rows, and the conditions about those that they are about.
    pub fn about(run: &'a RunInfo, rows: impl IntoIterator<Item = &'a Row> + Clone, concerned: impl Fn(&Culprit) -> bool) -> Self {
        let tally = Tally::of(rows.clone().into_iter().map(|row| row.verdict));
        let mut found = of_rows(run, rows);
        let conditions = run.expected.iter().filter(|condition| concerned(&condition.culprit));
        found.extend(conditions.filter_map(|condition| of_condition(run, condition, &tally)));
        found.sort_by(|a, b| a.order().cmp(&b.order()).then(b.size().total_cmp(&a.size())));
        let judged = tally.total() - tally.get(Verdict::Info) - tally.get(Verdict::Skip);
        let status = if found.iter().any(|found| found.new) {
            Status::Failed
        } else if judged == 0 {
            Status::Empty
        } else {
            Status::Passed
        };
        Self { status, tally, found }
    }

    /// Those that turn the gate red, from the gravest.
    pub fn red(&self) -> impl Iterator<Item = &Found<'a>> {
        self.found.iter().filter(|found| found.new)
    }

    /// The verdict in one line: `passed: all 118 deviations found are known, 25 131 rows passed, 0 failed`. It is about the run, and names no engine.
    pub fn verdict(&self) -> String {
        let word = match self.status {
            Status::Passed => "passed",
            Status::Failed => "failed",
            Status::Empty => "nothing judged",
        };
        format!("{word}: {}", self.meaning())
    }

    /// What the verdict means, in numbers. Of a run that failed: what failed.
    pub fn meaning(&self) -> String {
        let rows = |verdict: Verdict| self.tally.get(verdict);
        let passed = format!("{} passed, {} failed", count(rows(Verdict::Pass), "row"), grouped(self.tally.broken()));
        match (self.status, rows(Verdict::Deviation)) {
            (Status::Empty, _) => format!("{}, none with a bound", count(self.tally.total(), "row")),
            (Status::Passed, 0) => format!("no deviations, {passed}"),
            (Status::Passed, 1) => format!("the only deviation found is known, {passed}"),
            (Status::Passed, all) => format!("all {} deviations found are known, {passed}", grouped(all)),
            (Status::Failed, _) => {
                let more = match self.red().count() {
                    0 | 1 => String::new(),
                    all => format!("; and {}", count(all - 1, "more new finding")),
                };
                self.red().next().map_or_else(String::new, Found::first_words) + &more
            }
        }
    }

    /// The gravest finding, of those that turn the gate red if there are any.
    pub fn headline(&self) -> String {
        match (self.status, self.loudest()) {
            (_, Some(found)) => found.short(),
            (Status::Empty, None) => "Nothing was judged in this run".into(),
            (_, None) => "No engine misses a gate".into(),
        }
    }

    /// Whether no engine misses a gate.
    pub fn is_quiet(&self) -> bool {
        self.status != Status::Empty && self.loudest().is_none()
    }

    /// The gravest finding, of those that turn the gate red if there are any; `None` if there is nothing but questions that are not offered.
    pub(crate) fn loudest(&self) -> Option<&Found<'a>> {
        self.red().next().or(self.found.iter().find(|found| found.severity != Some(Severity::NotOffered)))
    }

    /// The second: how many findings of each level there are, and how many are new.
    pub fn levels(&self) -> String {
        let levels = Severity::ALL.iter().map(|&level| Some(level)).chain([None]);
        let parts: Vec<String> = levels
            .map(|level| (level, self.found.iter().filter(|found| found.severity == level).count()))
            .filter(|(_, number)| *number > 0)
            .map(|(level, number)| format!("{} {}", grouped(number), level.map_or("gate not met", Severity::as_str)))
            .collect();
        if parts.is_empty() {
            return "no findings".into();
        }
        let new = self.red().count();
        let known = if new == 0 { "all known".to_owned() } else { format!("{} new", grouped(new)) };
        format!("{}: {}; {known}", count(self.found.len(), "finding"), parts.join(", "))
    }

    /// The third: how many rows the findings are among.
    pub fn extent(&self) -> String {
        format!("{}: {}", count(self.tally.total(), "row"), self.tally.words())
    }

    /// The worst finding of an engine.
    pub fn of_engine(&self, engine: &str) -> Option<&Found<'a>> {
        self.found.iter().find(|found| found.culprit.engine == engine && found.severity != Some(Severity::NotOffered))
    }
}

impl Found<'_> {
    /// The level, in words.
    pub fn level(&self) -> &'static str {
        self.severity.map_or("gate not met", Severity::as_str)
    }

    /// The engine and what it is off by: `pinocchio, kinetic energy: off by 2.4 %`.
    pub fn short(&self) -> String {
        let mut words = self.who();
        words.push_str(": ");
        words.push_str(&self.size_words());
        words
    }

    /// What failed, in one sentence: the same with its extent, or the condition and why it is not met.
    fn first_words(&self) -> String {
        match self.worst {
            None => format!("not met: {}: {}", self.what, clipped(&self.cause)),
            Some(_) => format!("{}, in {}", self.short(), self.extent()),
        }
    }

    /// `pinocchio, kinetic energy`: engine and quantities, as far as they are known.
    pub fn who(&self) -> String {
        let quantities = match self.quantities.len() {
            0 => String::new(),
            number if number > NAMED => format!("{} and {} more", self.quantities[..NAMED].join(", "), number - NAMED),
            _ => listed(&self.quantities),
        };
        match (self.culprit.engine.is_empty(), quantities.is_empty()) {
            (false, false) => format!("{}, {quantities}", self.culprit.engine),
            (false, true) => self.culprit.engine.clone(),
            (true, false) => quantities,
            (true, true) => "the run".to_owned(),
        }
    }

    /// The robot, state and method of its worst row, or as much of them as a condition names.
    pub fn place(&self) -> String {
        joined([&self.culprit.robot, &self.case()])
    }

    /// The state and method of its worst row.
    pub fn case(&self) -> String {
        let (body, states, cache) = self.worst.map_or(("", "", ""), |row| (&row.body, &row.states, &row.cache));
        joined([body, states, cache, &self.culprit.method])
    }

    /// How large it is.
    pub fn size_words(&self) -> String {
        let Some(row) = self.worst else { return self.what.clone() };
        let (Some(value), Some(bound)) = (row.value, row.bound) else {
            let words = match row.verdict {
                Verdict::Skip => "not offered",
                Verdict::Error => "no answer where one is due",
                _ => "no answer",
            };
            return words.into();
        };
        let against = if row.reference.is_empty() { String::new() } else { format!(" against {}", row.reference) };
        let Some((error, rounding)) = row.unit_free_error() else {
            let unit = if row.unit == "1" || row.unit.is_empty() { String::new() } else { format!(" {}", row.unit) };
            let relation = row.relation.map_or("", Relation::phrase);
            return format!("{}{unit} where {relation} {} is due", short(value), short(bound));
        };
        if let Some(excess) = row.param("excess").and_then(|excess| excess.as_f64()) {
            return format!("{}{against}", scaled(excess));
        }
        match self.severity {
            Some(Severity::PhysicsDiffers) => format!("off by {}{against}", part(error)),
            Some(Severity::Rounding) => format!("{} times its gate of {}{against}", short(error / bound), short(bound)),
            _ => format!(
                "{:.1} digits lost beyond rounding{against} ({} where {} is allowed)",
                (error / rounding).log10(),
                short(value),
                short(bound)
            ),
        }
    }

    /// How many rows and robots it has.
    pub fn extent(&self) -> String {
        match (self.rows, self.robots) {
            (0, _) => String::new(),
            (rows, 0) => count(rows, "row"),
            (rows, robots) => format!("{} on {}", count(rows, "row"), count(robots, "robot")),
        }
    }

    /// All of it in one line.
    pub fn sentence(&self) -> String {
        self.told("known: ")
    }

    /// The same behind its level and whether it is new: `physics differs, known: pinocchio, kinetic energy: …`.
    pub fn marked(&self) -> String {
        format!("{}, {}: {}", self.level(), if self.new { "new" } else { "known" }, self.told(""))
    }

    /// All of it in one line; `known` stands before a known cause.
    fn told(&self, known: &str) -> String {
        let place = match self.place() {
            place if place.is_empty() => String::new(),
            place => format!(" ({place})"),
        };
        let extent = match self.extent() {
            extent if extent.is_empty() => String::new(),
            extent => format!("; {extent}"),
        };
        let cause = match (self.new, self.worst) {
            (false, _) => format!("; {known}{}", self.cause),
            (true, Some(row)) if row.value.is_some() && self.cause == refuted(row) => String::new(),
            (true, _) => format!("; {}", clipped(&self.cause)),
        };
        format!("{}{place}{extent}{cause}", self.short())
    }

    /// New before known, then by level; a condition without a level comes last. Of what is missing, an engine comes before its rows, and rows
    /// with their reason before their number.
    fn order(&self) -> (bool, bool, Option<Severity>, u8) {
        let near = match self.gate {
            GateKind::Engine => 0,
            GateKind::Counts | GateKind::Rows => 2,
            _ => 1,
        };
        (!self.new, self.severity.is_none(), self.severity, near)
    }

    /// What orders findings of one level: the error if the physics differs, decades beyond the gate otherwise.
    fn size(&self) -> f64 {
        let Some(row) = self.worst else { return 0.0 };
        match (self.severity, row.unit_free_error()) {
            (Some(Severity::PhysicsDiffers), Some((error, _))) => error,
            _ => -row.margin.unwrap_or(0.0),
        }
    }
}

/// The words that are there, with commas between them.
fn joined<const N: usize>(words: [&str; N]) -> String {
    words.into_iter().filter(|word| !word.is_empty()).collect::<Vec<_>>().join(", ")
}

/// The beginning of a long reason: a condition may list every quantity of an engine.
pub fn clipped(text: &str) -> String {
    let head: String = text.chars().take(LONGEST).collect();
    if head.len() < text.len() { format!("{head} …") } else { head }
}

/// What a constant factor does to all values, in words; `excess` is the factor less one.
fn scaled(excess: f64) -> String {
    let factor = 1.0 + excess;
    match excess.abs() {
        size if size < 0.1 => {
            format!("all values are too {} by one part in {}", if excess > 0.0 { "large" } else { "small" }, short(1.0 / size))
        }
        _ if (factor + 1.0).abs() < 1e-6 => "all values have the other sign".into(),
        _ => format!("all values are multiplied by {factor:.6}"),
    }
}

/// A part of a whole: `78 %`, `0.24 %`, `2.4e-5`, `12 times its size`.
fn part(error: f64) -> String {
    if error >= 10.0 {
        format!("{} times its size", short(error))
    } else if error >= 1e-3 {
        format!("{} %", short(100.0 * error))
    } else {
        short(error)
    }
}

/// What a row that misses its gate says of itself.
fn refuted(row: &Row) -> String {
    match (row.value, row.relation, row.bound) {
        (Some(value), Some(relation), Some(bound)) => format!("{value:e} is not {} {bound:e}", relation.phrase()),
        _ => String::new(),
    }
}

/// The cause of a row, without what the row says of itself.
fn cause(row: &Row) -> String {
    let own = format!(" ({})", refuted(row));
    row.reason.strip_suffix(own.as_str()).unwrap_or(&row.reason).to_owned()
}

/// The rows that do not pass. Failures are grouped by engine and quantity, missing answers by their reason, known deviations by their cause,
/// and what an engine does not offer by engine.
fn of_rows<'a>(run: &RunInfo, rows: impl IntoIterator<Item = &'a Row>) -> Vec<Found<'a>> {
    let mut groups: BTreeMap<(&str, Verdict, &str, String), Vec<&Row>> = BTreeMap::new();
    for row in rows.into_iter().filter(|row| !matches!(row.verdict, Verdict::Pass | Verdict::Info)) {
        let (quantity, cause) = match row.verdict {
            Verdict::Deviation => ("", named_cause(row).unwrap_or_else(|| cause(row))),
            Verdict::Skip => ("", String::new()),
            Verdict::Error => ("", row.reason.clone()),
            _ => (row.quantity.as_str(), String::new()),
        };
        groups.entry((&row.engine, row.verdict, quantity, cause)).or_default().push(row);
    }
    groups.into_values().filter_map(|rows| of_group(run, &rows)).collect()
}

fn of_group<'a>(run: &RunInfo, rows: &[&'a Row]) -> Option<Found<'a>> {
    // The gravest level first, then the largest miss.
    let worst = *rows.iter().min_by_key(|row| (Severity::of(row), worst_first(row)))?;
    let mut quantities = vec![labels::quantity(&worst.quantity).to_owned()];
    for row in rows {
        let quantity = labels::quantity(&row.quantity).to_owned();
        if !quantities.contains(&quantity) {
            quantities.push(quantity);
        }
    }
    if quantities.len() == 1 {
        quantities = vec![labels::error(&worst.quantity, &worst.metric)];
    }
    let robots: BTreeSet<&str> = rows.iter().map(|row| row.robot.as_str()).filter(|robot| !robot.is_empty()).collect();
    Some(Found {
        severity: Severity::of(worst),
        new: matches!(worst.verdict, Verdict::Fail | Verdict::Error),
        gate: match worst.verdict {
            Verdict::Error => GateKind::Answer,
            Verdict::Skip => GateKind::Unlisted,
            _ => GateKind::Bound,
        },
        culprit: Culprit::of(worst),
        quantities,
        rows: rows.len(),
        robots: robots.len(),
        worst: Some(worst),
        what: String::new(),
        cause: cause(worst),
        again: run.again(&worst.study, &worst.robot).unwrap_or_default(),
    })
}

/// The id of the known deviation that a row names in its parameters.
fn named_cause(row: &Row) -> Option<String> {
    Some(row.param("deviation")?.as_str()?.to_owned())
}

/// A condition that is not met. Rows that fail or have no answer are findings of their own; so are conditions that count nothing but them.
fn of_condition(run: &RunInfo, condition: &Expectation, tally: &Tally) -> Option<Found<'static>> {
    let told = match condition.kind {
        GateKind::Bound => tally.get(Verdict::Fail) > 0,
        GateKind::Answer => tally.get(Verdict::Error) > 0,
        _ => false,
    };
    if told || matches!(condition.verdict, Verdict::Pass | Verdict::Deviation | Verdict::Info) {
        return None;
    }
    let culprit = condition.culprit.clone();
    let severity = match condition.kind {
        GateKind::Engine | GateKind::Unlisted | GateKind::Counts | GateKind::Rows => Some(Severity::NotOffered),
        GateKind::Import => Some(Severity::PhysicsDiffers),
        _ => None,
    };
    let again = if culprit.study.is_empty() { String::new() } else { run.again(&culprit.study, &culprit.robot).unwrap_or_default() };
    let quantities = if culprit.quantity.is_empty() { Vec::new() } else { vec![labels::quantity(&culprit.quantity).to_owned()] };
    let (what, cause) = (condition.what.clone(), condition.reason.clone());
    Some(Found { severity, new: true, gate: condition.kind, culprit, quantities, rows: 0, robots: 0, worst: None, what, cause, again })
}
