//! The section's drawings: accuracy against work, rates against their prediction, the map of the sliding rod, and the friction that a body feels.

use super::{Figures, Lines};
use featherbench_report::figure::{Axis, Series};
use featherbench_study::figures::{drawing, errors, nth, point, scattered, told};
use maud::Markup;

/// The fastest rate of the map of the sliding rod, rad/s.
const FASTEST: f64 = 5.0;
/// Marks of each angle of the map: a first page has at most 3000 nodes, and a mark is one.
const MARKS: usize = 24;
/// What the laws allow on the map: words, the number of forces, and whether it is above the critical rate.
const REGIONS: [(&str, f64, bool); 4] =
    [("one force, it presses", 1.0, false), ("no force: lift-off", 1.0, true), ("no solution", 0.0, false), ("two solutions", 2.0, true)];

fn of_problems(lines: &Lines) -> Vec<Series> {
    let mut series = Vec::new();
    for (index, (method, problems)) in lines.iter().enumerate() {
        let points = problems.iter().map(|&(problem, iterations, value)| {
            point(problem, iterations, value, [format!("{} iterations", told(iterations)), told(value)])
        });
        series.push(scattered(index, *method, points.collect()));
    }
    series
}

/// Residuals against iterations, per solver.
pub(super) fn accuracy(figures: &Figures) -> Markup {
    let (x, y) = (Axis::log("iterations"), errors("residual of the natural map"));
    drawing("contact-accuracy", "Residuals against iterations, per solver", x, y, of_problems(&figures.accuracy))
}

/// Fitted against predicted rates.
pub(super) fn rates(figures: &Figures) -> Markup {
    let (x, y) = (Axis::log("iterations"), errors("|fitted / predicted rate − 1|"));
    drawing("contact-rates", "Fitted against predicted rates", x, y, of_problems(&figures.rates))
}

/// How many forces Painlevé's rod has: of each angle a column of marks, by what the laws allow at that rate.
pub(super) fn existence(figures: &Figures) -> Markup {
    let region = |(index, (name, forces, above)): (usize, (&str, f64, bool))| {
        let mut points = Vec::new();
        for &[angle, critical, below_count, above_count] in &figures.existence {
            let count = if above { above_count } else { below_count };
            for mark in (0..MARKS).filter(|_| count == forces) {
                let rate = FASTEST * (mark as f64 + 0.5) / MARKS as f64;
                if (rate > critical) == above {
                    let about = [format!("{}°, {} rad/s", told(angle), told(rate)), format!("changes at {} rad/s", told(critical))];
                    points.push(point(name, angle, rate, about));
                }
            }
        }
        scattered(index, name, points)
    };
    let series = REGIONS.into_iter().enumerate().map(region).collect();
    let (x, y) = (Axis::linear("angle to the ground, °"), Axis::linear("rate, rad/s"));
    drawing("contact-existence", "How many forces Painlevé's rod has, over its angle and rate", x, y, series)
}

/// The friction that a body feels against its heading.
pub(super) fn felt(figures: &Figures) -> Markup {
    let mut series = Vec::new();
    for (index, (section, points)) in figures.felt.iter().enumerate() {
        let points = points.iter().map(|&(heading, felt)| {
            point(section, heading, felt, [format!("heading {}°", told(heading)), format!("{} of the cone's friction", told(felt))])
        });
        series.push(nth(index, *section, points.collect()));
    }
    let (x, y) = (Axis::linear("heading, °"), Axis::linear("felt friction / μ"));
    drawing("contact-felt", "Friction that a body feels against its heading", x, y, series)
}
