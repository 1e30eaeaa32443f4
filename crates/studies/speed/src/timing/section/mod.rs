//! The sections of this study: time against size, ratios of times, and time against true error.

mod best;
mod drawings;
mod figures;
mod instructions;
mod line;
mod ratios;
mod speed;
mod time;
mod tradeoff;
mod verdict;

use crate::timing::rows::RowParams;
use featherbench_bench::params;
use featherbench_bench::statistics::PROCESSES;
use featherbench_report::{Overview, Section};
use featherbench_results::{Row, RunInfo};

pub use instructions::{InstructionCounts, instructions};
use ratios::Speed;
use verdict::SpeedVerdict;

/// The study's name in rows.
const STUDY: &str = "timing";
/// Terms that the page explains.
const TERMS: &[(&str, &str)] = &[(
    "Times",
    "One thread, pinned to one core where the system allows it, after all accuracy work is done. stream reads another state at each call, hot the same one again. Inside the clock is everything from q, q̇, q̈ or τ to the result: sines and cosines, gravity, rotors' inertia; only factorization and solve start from a mass matrix or factors made before. Everyone who is timed has one block per round, in random order, beside a second copy of ours; a value is the mean over those of ten processes in which the core was at its fastest, of eight and more without the least and the largest, of the lower decile of the blocks of rounds in which it was not shared; its bars are the 95 % interval by the scatter of the processes.",
)];

/// A smaller share of slowed processes is not told.
const TOLD: f64 = 0.1;

/// What disturbed the times of a run, in a sentence for each, if anything did: other programs, and what slowed the core.
pub fn disturbed(run: &RunInfo, rows: &[Row]) -> Option<String> {
    let times = rows.iter().filter(|row| row.study == STUDY && row.metric == "ns_per_call");
    let fastest = |row: &Row| params::of_row::<RowParams>(row).and_then(|params| params.fastest).unwrap_or(PROCESSES);
    let shares: Vec<f64> = times.map(|row| 1.0 - fastest(row) as f64 / PROCESSES as f64).collect();
    let slowed = shares.iter().sum::<f64>() / shares.len() as f64;
    let slowed = (slowed >= TOLD).then(|| {
        format!(
            "Something slowed the core in {:.0} % of the processes that took times. Those do not count, and intervals are of the others.",
            100.0 * slowed
        )
    });
    let told: Vec<String> = run.busy().into_iter().chain(slowed).collect();
    (!told.is_empty()).then(|| told.join(" "))
}

/// Makes the sections; ratios appear only with paired experiments, and the last one only with rows of accuracy.
pub(crate) fn sections<'a>(run: &RunInfo, rows: &'a [Row], overview: &Overview<'a>) -> Vec<Section> {
    let (times, speed) = (time::lines(overview, rows), Speed::of(overview, rows));
    let best = best::summaries(overview, rows);
    let verdict = SpeedVerdict::of(overview, rows);
    let points = tradeoff::points(overview, rows, &times);
    let (answer, part) = verdict.markup(overview).unzip();
    let disturbed = disturbed(run, rows);
    let (body, drawn) = time::markup(disturbed.as_deref(), overview, &times, verdict.first_times(overview));
    let mut sections = vec![Section {
        terms: if times.is_empty() { &[] } else { TERMS },
        lines: line::line(overview, rows, &speed).into_iter().chain(best::lines(&best)).collect(),
        style: include_str!("speed.css"),
        answer,
        parts: part.into_iter().chain(drawn).collect(),
        figures: figures::figures(overview, rows, &verdict, &speed, &points),
        ..Section::new("time", "Time", body)
    }];
    if !speed.is_empty() || !best.is_empty() {
        let (body, parts) = speed::markup(run, disturbed.as_deref(), overview, &speed, &best);
        sections.push(Section { parts, ..Section::new("speed", "Speed", body) });
    }
    if !points.is_empty() {
        let (body, parts) = tradeoff::markup(overview, &points);
        sections.push(Section { parts, ..Section::new("tradeoff", "Work–precision", body) });
    }
    sections
}
