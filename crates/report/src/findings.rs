//! Findings, in sentences: which engines agree on what, which do not, and whether the run passed.

use std::collections::{BTreeMap, BTreeSet};

use featherbench_results::{Row, RunInfo, Verdict};

use crate::figures::is_error_measure;
use crate::labels;
use crate::numbers::{count, larger, listed, short};
use crate::overview::{ACCURACY, Overview, severity};
use crate::tally::Tally;

/// The state of a run in one word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// Every judged row is inside its gate and every expectation is met.
    Passed,
    /// A row failed or gave no answer, or an expectation is not met.
    Failed,
    /// No row was judged.
    Empty,
}

/// Engines that pass all their gates against a reference, on the same quantities.
pub struct Agreement<'a> {
    /// The engines.
    pub engines: Vec<&'a str>,
    /// The reference.
    pub reference: &'a str,
    /// The quantities, and the largest error of each.
    pub quantities: Vec<(&'a str, f64)>,
    /// The number of models: the fewest and the most of any quantity.
    pub models: (usize, usize),
}

/// An engine that failed gates on a quantity.
pub struct Disagreement<'a> {
    /// The engine.
    pub engine: &'a str,
    /// The reference; empty if nothing was compared.
    pub reference: &'a str,
    /// The quantity.
    pub quantity: &'a str,
    /// All its judged rows there.
    pub tally: Tally,
    /// The row that is worst.
    pub worst: &'a Row,
}

/// The contents of the head of the page.
pub struct Findings<'a> {
    /// The run as a whole.
    pub status: Status,
    /// Verdicts of all rows.
    pub tally: Tally,
    /// Expectations that are not met.
    pub unmet: usize,
    /// The engines that pass their gates.
    pub agreements: Vec<Agreement<'a>>,
    /// The engines that fail gates, worst first.
    pub disagreements: Vec<Disagreement<'a>>,
    /// The passing row that is closest to its gate.
    pub closest: Option<&'a Row>,
    /// The references of the answers.
    pub references: BTreeSet<&'a str>,
}

impl<'a> Findings<'a> {
    /// Collects a run's rows.
    pub fn of(run: &RunInfo, overview: &Overview<'a>, records: &'a [Row]) -> Self {
        let tally = Tally::of(records.iter().map(|row| row.verdict));
        let unmet = run
            .expected
            .iter()
            .filter(|condition| !matches!(condition.verdict, Verdict::Pass | Verdict::Deviation | Verdict::Info))
            .count();
        let judged = tally.total() - tally.get(Verdict::Info) - tally.get(Verdict::Skip);
        let status = if tally.broken() + unmet > 0 {
            Status::Failed
        } else if judged == 0 {
            Status::Empty
        } else {
            Status::Passed
        };
        let passing = records.iter().filter(|row| row.verdict == Verdict::Pass && row.margin.is_some());
        Self {
            status,
            tally,
            unmet,
            agreements: agreements(overview, records),
            disagreements: disagreements(records),
            closest: passing.min_by_key(|row| severity(row)),
            references: records
                .iter()
                .filter(|row| is_error_measure(row))
                .map(|row| row.reference.as_str())
                .filter(|name| !name.is_empty())
                .collect(),
        }
    }

    /// The first line of the page.
    pub fn headline(&self) -> String {
        let judged = self.tally.total() - self.tally.get(Verdict::Info) - self.tally.get(Verdict::Skip);
        match self.status {
            Status::Empty => "Nothing was judged in this run".into(),
            Status::Passed => match self.tally.get(Verdict::Deviation) {
                0 if judged == 1 => "The one judged row is inside its gate".into(),
                0 => format!("All {} are inside their gates", count(judged, "judged row")),
                known => {
                    format!("{} are inside their gates, {} by known cause", count(judged - known, "judged row"), count(known, "deviation"))
                }
            },
            Status::Failed => {
                let mut parts = Vec::new();
                match self.tally.get(Verdict::Fail) {
                    0 => {}
                    failed => parts.push(format!("{} of {} outside their gates", count(failed, "row"), crate::numbers::grouped(judged))),
                }
                match self.tally.get(Verdict::Error) {
                    0 => {}
                    errors => parts.push(format!("{} without an answer", crate::numbers::grouped(errors))),
                }
                match self.unmet {
                    0 => {}
                    unmet => parts.push(format!("{} not met", count(unmet, "expectation"))),
                }
                listed(&parts)
            }
        }
    }
}

impl Agreement<'_> {
    /// `drake and mujoco agree with featherbench on`, the start of a sentence.
    pub fn who(&self) -> String {
        let names: Vec<String> = self.engines.iter().map(|&name| name.to_owned()).collect();
        let verb = if names.len() == 1 { "agrees" } else { "agree" };
        format!("{} {verb} with {} on", listed(&names), self.reference)
    }

    /// `over 31 models`, its end.
    pub fn extent(&self) -> String {
        match self.models {
            (fewest, most) if fewest == most => format!("over {}", count(most, "model")),
            (fewest, most) => format!("over {fewest} to {}", count(most, "model")),
        }
    }
}

impl Disagreement<'_> {
    /// `3 of 124 rows of forward dynamics fail against featherbench`.
    pub fn sentence(&self) -> String {
        let quantity = labels::quantity(self.quantity);
        let total = self.tally.total();
        let mut parts = Vec::new();
        if self.tally.get(Verdict::Fail) > 0 {
            let against = if self.reference.is_empty() { String::new() } else { format!(" against {}", self.reference) };
            parts.push(format!("fails {} of {}{against}", self.tally.get(Verdict::Fail), count(total, "row")));
        }
        if self.tally.get(Verdict::Error) > 0 {
            parts.push(format!("gives no answer in {} of {}", self.tally.get(Verdict::Error), count(total, "row")));
        }
        format!("{quantity}: {}", listed(&parts))
    }

    /// `chain_10, fast, forward 3.0e-9 over 1.0e-12`, or why there is no number.
    pub fn worst_words(&self) -> String {
        let row = self.worst;
        let mut parts: Vec<String> =
            [&row.robot, &row.body, &row.states, &row.cache, &row.method].into_iter().filter(|part| !part.is_empty()).cloned().collect();
        match (row.value, row.bound) {
            (Some(value), Some(bound)) => parts.push(format!("{} {} where {} is allowed", row.metric, short(value), short(bound))),
            _ => parts.push(row.reason.clone()),
        }
        parts.join(", ")
    }
}

/// The rows of one engine on one quantity against one reference.
struct Account<'a> {
    tally: Tally,
    models: BTreeSet<&'a str>,
    largest: f64,
}

fn agreements<'a>(overview: &Overview<'a>, records: &'a [Row]) -> Vec<Agreement<'a>> {
    let mut accounts: BTreeMap<(&str, (usize, &str), usize), Account> = BTreeMap::new();
    for row in records.iter().filter(|row| is_error_measure(row) && !row.reference.is_empty() && row.reference != row.engine) {
        let Some(engine) = overview.engine(&row.engine) else { continue };
        let account = accounts.entry((&row.reference, labels::quantity_rank(&row.quantity), engine)).or_insert_with(|| Account {
            tally: Tally::default(),
            models: BTreeSet::new(),
            largest: 0.0,
        });
        account.tally.add(row.verdict);
        if row.verdict == Verdict::Pass {
            account.models.insert(&row.robot);
            // An error over its conditioning bound is a ratio, not an error: it is judged, but not part of this sentence.
            if row.metric != "error_over_floor" {
                account.largest = larger(account.largest, row.value.unwrap_or_default().abs());
            }
        }
    }

    // Per reference and quantity, the engines that passed every gate; quantities with the same engines share a sentence.
    type Kept<'a> = (Vec<usize>, f64, Vec<usize>);
    let mut kept: BTreeMap<(&str, (usize, &str)), Kept> = BTreeMap::new();
    for ((reference, quantity, engine), account) in &accounts {
        if account.tally.verdict() == Verdict::Pass {
            let entry = kept.entry((reference, *quantity)).or_default();
            entry.0.push(*engine);
            entry.1 = larger(entry.1, account.largest);
            entry.2.push(account.models.len());
        }
    }
    let mut sentences: BTreeMap<(&str, Vec<usize>), Agreement> = BTreeMap::new();
    for ((reference, (_, quantity)), (engines, largest, models)) in kept {
        let fewest = models.iter().copied().min().unwrap_or_default();
        let most = models.iter().copied().max().unwrap_or_default();
        let sentence = sentences.entry((reference, engines.clone())).or_insert_with(|| Agreement {
            engines: engines.iter().map(|&engine| overview.engines[engine]).collect(),
            reference,
            quantities: Vec::new(),
            models: (fewest, most),
        });
        sentence.quantities.push((quantity, largest));
        sentence.models = (sentence.models.0.min(fewest), sentence.models.1.max(most));
    }
    let mut sentences: Vec<Agreement> = sentences.into_values().collect();
    sentences.sort_by_key(|sentence| std::cmp::Reverse((sentence.engines.len(), sentence.quantities.len())));
    sentences
}

fn disagreements(records: &[Row]) -> Vec<Disagreement<'_>> {
    let mut found: BTreeMap<(&str, &str, &str), Disagreement> = BTreeMap::new();
    // Comparisons with the truth have their own sentences, apart from comparisons between engines.
    let told_here = |row: &&Row| row.study != ACCURACY && !matches!(row.verdict, Verdict::Info | Verdict::Skip);
    for row in records.iter().filter(told_here) {
        let group = found.entry((&row.engine, &row.reference, &row.quantity)).or_insert_with(|| Disagreement {
            engine: &row.engine,
            reference: &row.reference,
            quantity: &row.quantity,
            tally: Tally::default(),
            worst: row,
        });
        group.tally.add(row.verdict);
        if severity(row) < severity(group.worst) {
            group.worst = row;
        }
    }
    let mut broken: Vec<Disagreement> = found.into_values().filter(|group| group.tally.broken() > 0).collect();
    broken.sort_by_key(|group| severity(group.worst));
    broken
}
