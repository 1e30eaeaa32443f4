//! Who agrees with whom on what, in sentences.

use featherbench_bench::OWN;
use std::collections::{BTreeMap, BTreeSet};

use featherbench_report::numbers::{count, larger, listed, short};
use featherbench_report::{Overview, Tally, labels};
use featherbench_results::{Row, Verdict};
use maud::{Markup, html};

use super::is_error_measure;

/// Engines that pass all their gates against a reference, on the same quantities.
pub struct Agreement<'a> {
    /// The engines.
    pub engines: Vec<&'a str>,
    /// The reference.
    pub reference: &'a str,
    /// The quantities, and the largest error of each.
    pub quantities: Vec<(&'a str, f64)>,
    /// The number of robots: the fewest and the most of any quantity.
    pub robots: (usize, usize),
}

/// The agreements of a run.
pub struct WhoAgrees<'a> {
    /// The engines that pass their gates.
    pub agreements: Vec<Agreement<'a>>,
    /// The references of the answers.
    pub references: BTreeSet<&'a str>,
}

impl<'a> WhoAgrees<'a> {
    /// Collects a run's rows.
    pub fn of(overview: &Overview<'a>, rows: &'a [Row]) -> Self {
        let measured = rows.iter().filter(|row| is_error_measure(row));
        Self {
            agreements: agreements(overview, rows),
            references: measured.map(|row| row.reference.as_str()).filter(|name| !name.is_empty()).collect(),
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

    /// `over 31 robots`, its end.
    pub fn extent(&self) -> String {
        match self.robots {
            (fewest, most) if fewest == most => format!("over {}", count(most, "robot")),
            (fewest, most) => format!("over {fewest} to {}", count(most, "robot")),
        }
    }
}

/// The rows of one engine on one quantity against one reference.
struct Account<'a> {
    tally: Tally,
    robots: BTreeSet<&'a str>,
    largest: f64,
}

fn agreements<'a>(overview: &Overview<'a>, rows: &'a [Row]) -> Vec<Agreement<'a>> {
    let mut accounts: BTreeMap<(&str, (usize, &str), usize), Account> = BTreeMap::new();
    for row in rows.iter().filter(|row| is_error_measure(row) && !row.reference.is_empty() && row.reference != row.engine) {
        let Some(engine) = overview.engine(&row.engine) else { continue };
        let account = accounts.entry((&row.reference, labels::quantity_rank(&row.quantity), engine)).or_insert_with(|| Account {
            tally: Tally::default(),
            robots: BTreeSet::new(),
            largest: 0.0,
        });
        account.tally.add(row.verdict);
        if row.verdict == Verdict::Pass {
            account.robots.insert(&row.robot);
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
            entry.2.push(account.robots.len());
        }
    }
    let mut sentences: BTreeMap<(&str, Vec<usize>), Agreement> = BTreeMap::new();
    for ((reference, (_, quantity)), (engines, largest, robots)) in kept {
        let fewest = robots.iter().copied().min().unwrap_or_default();
        let most = robots.iter().copied().max().unwrap_or_default();
        let sentence = sentences.entry((reference, engines.clone())).or_insert_with(|| Agreement {
            engines: engines.iter().map(|&engine| overview.engines[engine]).collect(),
            reference,
            quantities: Vec::new(),
            robots: (fewest, most),
        });
        sentence.quantities.push((quantity, largest));
        sentence.robots = (sentence.robots.0.min(fewest), sentence.robots.1.max(most));
    }
    let mut sentences: Vec<Agreement> = sentences.into_values().collect();
    sentences.sort_by_key(|sentence| std::cmp::Reverse((sentence.engines.len(), sentence.quantities.len())));
    sentences
}

/// What the verdict says of them.
pub fn markup(who: &WhoAgrees) -> Markup {
    html! {
        @if !who.agreements.is_empty() {
            h3 { "Who agrees" }
            ul.findings {
                @for found in &who.agreements {
                    li.pass {
                        b { (found.who()) } " "
                        @for (index, (quantity, largest)) in found.quantities.iter().enumerate() {
                            @if index > 0 { ", " }
                            span.nowrap { (labels::quantity(quantity)) " " span.number { "(" (short(*largest)) ")" } }
                        }
                        " " (found.extent()) "."
                    }
                }
            }
            p.note { "In parentheses the largest error, in each quantity's own measure." }
        }
        @if who.references.contains(OWN) {
            p.note {
                "The reference here is our own f64 code, and not the truth: agreement shows that independent programs compute the same, "
                "disagreement does not show who is wrong. See " a href="#pairs" { "every engine against every other" } "."
            }
        }
    }
}
