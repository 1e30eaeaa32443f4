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
    "One thread, pinned to one core where the system allows it, after all accuracy work is done. stream reads another state at each call, hot the same one again. Inside the clock is everything from q, q̇, q̈ or τ to the result: sines and cosines, gravity, rotors' inertia; only factorization and solve start from a mass matrix or factors made before. Everyone who is timed has one block per round, in random order, beside a second copy of ours; a value is the mean over ten processes, without the least and the largest, of the lower decile of the blocks, its bars the 95 % interval by the scatter of the processes.",
)];

/// Makes the sections; ratios appear only with paired experiments, and the last one only with rows of accuracy.
pub(crate) fn sections<'a>(run: &RunInfo, rows: &'a [Row], overview: &Overview<'a>) -> Vec<Section> {
    let (times, speed) = (time::lines(overview, rows), Speed::of(overview, rows));
    let best = best::summaries(overview, rows);
    let verdict = SpeedVerdict::of(overview, rows);
    let points = tradeoff::points(overview, rows, &times);
    let (answer, part) = verdict.markup(overview).unzip();
    let (body, drawn) = time::markup(run, overview, &times, verdict.first_times(overview));
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
        let (body, parts) = speed::markup(run, overview, &speed, &best);
        sections.push(Section { parts, ..Section::new("speed", "Speed", body) });
    }
    if !points.is_empty() {
        let (body, parts) = tradeoff::markup(overview, &points);
        sections.push(Section { parts, ..Section::new("tradeoff", "Work–precision", body) });
    }
    sections
}
