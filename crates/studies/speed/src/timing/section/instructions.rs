//! Figures of instruction counts, which no run has by itself: `ci/instructions.py` counts them under callgrind. They are drawn over the robots
//! of a run, and beside its times.

use std::collections::BTreeMap;

use featherbench_bench::OWN;
use featherbench_report::figure::{Axis, Figure, Line, Plot, Point, Series, Style};
use featherbench_report::numbers::{count, short};
use featherbench_report::{Overview, labels};
use featherbench_results::{Row, RunInfo};

use super::STUDY;
use featherbench_bench::statistics::quantile;

/// Instructions per state of a kernel (`quantity/method`) on a robot.
pub type InstructionCounts = BTreeMap<(String, String), u64>;

/// Figures: their names, titles and quantities.
const FIGURES: [(&str, &str, &[&str]); 2] = [
    (
        "instructions-dynamics",
        "Instructions of dynamics against size",
        &["id", "bias", "mass_matrix_sparse", "factorization", "solve", "fd", "mass_matrix_inverse"],
    ),
    (
        "instructions-derivatives",
        "Instructions of derivatives against size",
        &["id_dq", "id_dv", "fd_dq", "fd_dv", "coriolis_matrix", "torque_regressor"],
    ),
];

/// The figures of counts over the robots that the run has; none if it has none of the counted ones.
///
/// ```
/// use featherbench_results::{Row, RunInfo};
/// use featherbench_speed::instructions;
///
/// let row = |robot: &str, nv: u64| Row { robot: robot.into(), nv: Some(nv), ..Row::default() };
/// let rows = [row("short", 10), row("long", 100)];
/// let counts = [("short", 4000), ("long", 40_000)].map(|(robot, number)| (("id/rnea_packed".to_owned(), robot.to_owned()), number));
/// let figures = instructions(&RunInfo::default(), &rows, &counts.into());
/// assert_eq!(figures.iter().map(|figure| figure.name).collect::<Vec<_>>(), ["instructions-dynamics"]);
/// ```
pub fn instructions(run: &RunInfo, rows: &[Row], counts: &InstructionCounts) -> Vec<Figure> {
    let overview = Overview::of(run, rows);
    let sized = FIGURES.iter().filter_map(|(name, title, quantities)| against_size(&overview, counts, name, title, quantities));
    sized.chain(beside_times(rows, counts)).collect()
}

/// The kernels of a quantity: their methods, with what is known of each robot.
fn methods<'a>(counts: &'a InstructionCounts, quantity: &str) -> Vec<(&'a str, Vec<(&'a str, u64)>)> {
    let mut methods: Vec<(&str, Vec<(&str, u64)>)> = Vec::new();
    for ((kernel, robot), &number) in counts {
        let Some((_, method)) = kernel.split_once('/').filter(|(known, _)| *known == quantity) else { continue };
        match methods.iter_mut().find(|(known, _)| *known == method) {
            Some((_, robots)) => robots.push((robot, number)),
            None => methods.push((method, vec![(robot, number)])),
        }
    }
    methods
}

fn against_size(overview: &Overview, counts: &InstructionCounts, name: &'static str, title: &str, quantities: &[&str]) -> Option<Figure> {
    let size = |robot: &str| overview.robots[overview.robot(robot)?].nv.filter(|&nv| nv > 0);
    let mut series = Vec::new();
    // Of each kernel its name, and its count on the largest robot.
    let mut ends: Vec<(u64, u64, String)> = Vec::new();
    for (colour, quantity) in quantities.iter().enumerate() {
        for (index, (method, robots)) in methods(counts, quantity).into_iter().enumerate() {
            let mut found: Vec<(u64, &str, u64)> =
                robots.into_iter().filter_map(|(robot, number)| Some((size(robot)?, robot, number))).collect();
            found.sort_unstable();
            let words = format!("{} {method}", labels::quantity(quantity));
            let Some(&(largest, _, number)) = found.last() else { continue };
            ends.push((largest, number, words.clone()));
            let points = found.into_iter().map(|(nv, robot, number)| Point::new(robot, nv as f64, number as f64));
            series.push(Series { dash: index, ..Series::new(words, Style::nth(index).coloured(colour), points.collect()) });
        }
    }
    let biggest = ends.iter().map(|(nv, ..)| *nv).max()?;
    ends.retain(|(nv, ..)| *nv == biggest);
    let (least, most) = (ends.iter().min_by_key(|(_, number, _)| *number)?, ends.iter().max_by_key(|(_, number, _)| *number)?);
    let caption = format!(
        "Instructions per state, at {biggest} degrees of freedom from {} ({}) to {} ({}). They are counted under callgrind in a build for x86-64-v3. \
         Robots of one size differ in shape; a batch computes a state in each lane of a register.",
        short(least.1 as f64),
        least.2,
        short(most.1 as f64),
        most.2
    );
    Plot::new(title, Axis::log("degrees of freedom nv"), Axis::log("instructions per state"), series).figure(name, caption)
}

/// Each kernel's time in the run against its count. On one line all kernels have the same instructions per nanosecond.
fn beside_times(rows: &[Row], counts: &InstructionCounts) -> Option<Figure> {
    let timed = |row: &&Row| row.study == STUDY && row.engine == OWN && row.metric == "ns_per_call" && row.cache == "stream" && row.valid;
    let mut quantities: BTreeMap<(usize, &str), Vec<Point>> = BTreeMap::new();
    let mut rates = Vec::new();
    for row in rows.iter().filter(timed) {
        let kernel = (format!("{}/{}", row.quantity, row.method), row.robot.clone());
        let Some((&number, ns)) = counts.get(&kernel).zip(row.value.filter(|&ns| ns > 0.0)) else { continue };
        rates.push(number as f64 / ns);
        let point = Point::new(format!("{} on {}", row.method, row.robot), number as f64, ns);
        quantities.entry(labels::quantity_rank(&row.quantity)).or_default().push(point);
    }
    rates.sort_unstable_by(f64::total_cmp);
    let (least, most) = rates.first().zip(rates.last())?;
    let caption = format!(
        "{} of ours with a time that counts execute {} to {} instructions per nanosecond, the median {}. The counts are of a build for x86-64-v3, \
         the times of this machine's own build.",
        count(rates.len(), "kernel"),
        short(*least),
        short(*most),
        short(quantile(&rates, 0.5))
    );
    let series = quantities.into_iter().enumerate().map(|(index, ((_, quantity), points))| Series {
        line: Line::Marks,
        ..Series::new(labels::quantity(quantity), Style::nth(index), points)
    });
    let (x, y) = (Axis::log("instructions per state"), Axis::log("time per call, ns"));
    Plot::new("Time against instructions of our kernels", x, y, series.collect()).figure("instructions-time", caption)
}
