//! Section: which engine's derivatives are right, on which joint; what the step of finite differences costs; the cost of an entry.

mod cost;
mod drawings;
mod joints;
mod lines;

use super::{NONE, STUDY};
use featherbench_report::numbers::{count, larger, listed, short};
use featherbench_report::{Finding, Overview, Section, labels, opener, worst_first};
use featherbench_results::{Row, RunInfo, Verdict};
use lines::{Line, lines};
use maud::{Markup, html};
use std::collections::{BTreeMap, BTreeSet};

/// Terms that the page explains.
const TERMS: &[(&str, &str)] = &[
    (
        "Derivative by q",
        "On the tangent space of the configurations: column k is the change while q moves as the velocity e_k moves it; a quaternion joint has three columns, in body axes. The numbers in q̇, q̈ and τ stay as they are.",
    ),
    (
        "True derivative",
        "Dual numbers over double-double arithmetic, 32 digits, through our kernels. A test compares them with differences in double-double, which use no dual numbers.",
    ),
];

/// One engine's method for one quantity: the judged row that decides for each robot.
struct Account<'a> {
    engine: &'a str,
    method: &'a str,
    quantity: &'a str,
    decides: BTreeMap<usize, &'a Row>,
}

impl<'a> Account<'a> {
    fn with(&self, verdicts: &[Verdict]) -> Vec<&'a Row> {
        let mut rows: Vec<&Row> = self.decides.values().copied().filter(|row| verdicts.contains(&row.verdict)).collect();
        rows.sort_by_key(|row| worst_first(row));
        rows
    }

    fn largest(&self) -> f64 {
        self.decides.values().filter_map(|row| row.value).fold(0.0, larger)
    }
}

/// Makes the section, if the run has rows of the study.
pub(crate) fn sections<'a>(_: &RunInfo, rows: &'a [Row], overview: &Overview<'a>) -> Vec<Section> {
    let own: Vec<&Row> = rows.iter().filter(|row| row.study == STUDY).collect();
    if own.is_empty() {
        return Vec::new();
    }
    let accounts = accounts(overview, &own);
    let lines = lines(overview, &own);
    let mut robots: Vec<usize> = lines.iter().map(|line| line.robot).collect();
    robots.dedup();
    let opening = robots.iter().copied().max_by_key(|&robot| overview.robots[robot].nv);
    let (drawn, parts) = opening.map(|opening| drawings::drawings(overview, &lines, &robots, opening)).unzip();
    let quantities: BTreeSet<&str> = own.iter().map(|row| row.quantity.as_str()).collect();
    vec![Section {
        parts: parts.unwrap_or_default(),
        finding: Some(Finding { rank: 1, body: answer(overview, &accounts) }),
        quantities: quantities.into_iter().map(str::to_owned).collect(),
        terms: TERMS,
        ..Section::new("derivatives", "Derivatives", body(overview, &own, &accounts, drawn.map(|drawn| (drawn, lines.as_slice())), rows))
    }]
}

fn accounts<'a>(overview: &Overview<'a>, rows: &[&'a Row]) -> Vec<Account<'a>> {
    let mut found: BTreeMap<_, Account> = BTreeMap::new();
    for &row in rows.iter().filter(|row| !matches!(row.verdict, Verdict::Info | Verdict::Skip)) {
        let (Some(robot), Some(engine)) = (overview.robot(&row.robot), overview.engine(&row.engine)) else { continue };
        let (name, method, quantity) = (overview.engines[engine], row.method.as_str(), row.quantity.as_str());
        let account = found.entry((labels::quantity_rank(quantity), engine, method)).or_insert_with(|| Account {
            engine: name,
            method,
            quantity,
            decides: BTreeMap::new(),
        });
        let decides = account.decides.entry(robot).or_insert(row);
        if worst_first(row) < worst_first(decides) {
            *decides = row;
        }
    }
    found.into_values().collect()
}

/// Who is right, in sentences.
fn answer(overview: &Overview, accounts: &[Account]) -> Markup {
    let right: Vec<&Account> = accounts.iter().filter(|account| account.decides.values().all(|row| row.verdict == Verdict::Pass)).collect();
    let mut kept: BTreeMap<(&str, &str), (Vec<String>, f64, usize)> = BTreeMap::new();
    for account in &right {
        let entry = kept.entry((account.engine, account.method)).or_default();
        entry.0.push(labels::quantity(account.quantity).to_owned());
        entry.1 = larger(entry.1, account.largest());
        entry.2 = entry.2.max(account.decides.len());
    }
    html! {
        h3 { "Derivatives against the truth" }
        ul.findings {
            @for ((engine, method), (quantities, largest, robots)) in &kept {
                li.pass {
                    b { (engine) " " (method) } " keeps every gate on " (listed(quantities)) " "
                    span.number { "(" (short(*largest)) ")" } " over " (count(*robots, "robot")) "."
                }
            }
            @for account in accounts {
                (missed(overview, account, &[Verdict::Fail, Verdict::Error], "fail", "fails"))
                (missed(overview, account, &[Verdict::Deviation], "known", "misses by known cause"))
            }
        }
        p.note { "In parentheses the largest judged error. Joint by joint, and the steps of finite differences: " a href="#derivatives" { "derivatives" } "." }
    }
}

fn missed(overview: &Overview, account: &Account, verdicts: &[Verdict], class: &str, verb: &str) -> Markup {
    let rows = account.with(verdicts);
    html! {
        @if let Some(row) = rows.first() {
            li class=(class) {
                b { (account.engine) " " (account.method) } " " (verb) " on " (rows.len()) " of " (count(account.decides.len(), "robot")) " in "
                (labels::quantity(account.quantity)) ". Worst: "
                (opener(
                    &overview.chunk_of(row),
                    &[("study", STUDY), ("engine", &row.engine), ("method", &row.method), ("quantity", &row.quantity)],
                    &match (row.value, row.bound) {
                        (Some(value), Some(bound)) => format!("{}, {} where {} is allowed", row.robot, short(value), short(bound)),
                        _ => format!("{}, {}", row.robot, row.reason),
                    },
                ))
            }
        }
    }
}

fn body(overview: &Overview, own: &[&Row], accounts: &[Account], differences: Option<(Markup, &[Line])>, all: &[Row]) -> Markup {
    let mut lacking: BTreeMap<&str, BTreeSet<(usize, &str)>> = BTreeMap::new();
    for row in own.iter().filter(|row| row.verdict == Verdict::Skip && row.method == NONE) {
        lacking.entry(&row.engine).or_default().insert(labels::quantity_rank(&row.quantity));
    }
    html! {
        section #derivatives {
            h2 { "Derivatives: who is right" }
            p.lead {
                "Derivatives of inverse and forward dynamics by q and v, the Coriolis matrix and the torque regressor, each against its true value in 32 digits. "
                "An error is the largest entry of the difference over the largest of the derivative, both without units: of D" sup { "−½" } " ∂ID D" sup { "−½" }
                " and D" sup { "½" } " ∂FD D" sup { "−½" } " with D = diag M."
            }
            (answer(overview, accounts))
            (joints::table(overview, own))
            @if !lacking.is_empty() {
                p.note {
                    @for (engine, quantities) in &lacking {
                        (engine) " does not offer "
                        (listed(&quantities.iter().map(|(_, quantity)| labels::quantity(quantity).to_owned()).collect::<Vec<_>>())) ". "
                    }
                }
            }
            @if let Some((drawn, lines)) = differences {
                h3 { "Finite differences: the error against the step" }
                (drawn)
                p.note {
                    "Medians over the states. From the right an error falls with the step, forward differences at first order and centred ones at second; from the left it falls with rounding over the step. "
                    "Level lines: methods that are no differences."
                }
                div.scroll.tall { (lines::table(overview, lines)) }
            }
            (cost::table(overview, all))
        }
    }
}
