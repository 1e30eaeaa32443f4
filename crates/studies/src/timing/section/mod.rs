//! The sections of this study: time against size, ratios of times, and time against true error.

mod best;
mod figures;
mod line;
mod ratios;
mod speed;
mod time;
mod tradeoff;
mod verdict;

use featherbench_report::{Overview, Section};
use featherbench_results::{Row, RunInfo};

use ratios::Speed;
use verdict::SpeedVerdict;

/// The study's name in rows.
const STUDY: &str = "timing";
/// Terms that the page explains.
const TERMS: &[(&str, &str)] = &[(
    "Times",
    "One thread, pinned to one core where the system allows it, after all accuracy work is done. stream reads another state at each call, hot the same one again. Inside the clock is everything from q, q̇, q̈ or τ to the result: sines and cosines, gravity, rotors' inertia; only factorization and solve start from a mass matrix or factors made before. Everyone who is timed has one block per round, in random order, beside a second copy of ours; a value is the median over the rounds, its bars the 95 % interval of a bootstrap that draws whole epochs, each with a memory layout of its own.",
)];

/// Makes the sections; ratios appear only with paired experiments, and the last one only with rows of accuracy.
pub(crate) fn sections<'a>(run: &RunInfo, rows: &'a [Row], overview: &Overview<'a>) -> Vec<Section> {
    let (times, speed) = (time::lines(overview, rows), Speed::of(overview, rows));
    let best = best::summaries(overview, rows);
    let verdict = SpeedVerdict::of(overview, rows);
    let points = tradeoff::points(overview, rows, &times);
    let (answer, part) = verdict.markup(overview).unzip();
    let mut sections = vec![Section {
        script: include_str!("time.js"),
        terms: if times.is_empty() { &[] } else { TERMS },
        lines: line::line(overview, rows, &speed).into_iter().chain(best::lines(&best)).collect(),
        style: include_str!("speed.css"),
        answer,
        parts: part.into_iter().collect(),
        figures: figures::figures(overview, rows, &verdict, &speed, &points),
        ..Section::new("time", "Time", time::markup(overview, &times, verdict.first_times(overview))).with_data(&times)
    }];
    if !speed.is_empty() || !best.is_empty() {
        let body = speed::markup(run, overview, &speed, &best);
        sections.push(Section { script: include_str!("speed.js"), ..Section::new("speed", "Speed", body).with_data(&speed) });
    }
    if !points.is_empty() {
        let body = tradeoff::markup(overview, &points);
        sections
            .push(Section { script: include_str!("tradeoff.js"), ..Section::new("tradeoff", "Work–precision", body).with_data(&points) });
    }
    sections
}
