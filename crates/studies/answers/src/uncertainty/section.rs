//! Section: what uncertain parameters do, where the answer is known.

mod drawings;

use super::STUDY;
use super::falls::Bin;
use super::rates::SIZES;
use featherbench_report::numbers::short;
use featherbench_report::{Overview, Section};
use featherbench_results::{Row, RunInfo};
use featherbench_study::known::{beside, defined_by, passed, table, value};
use featherbench_study::rows_of;
use maud::{Markup, html};

/// A kind of points: its name, its slope, and (samples, error of the mean).
type Rate<'a> = (&'a str, f64, Vec<(usize, f64)>);

/// What the section draws.
struct Figures<'a> {
    /// Of each kind of points.
    rates: Vec<Rate<'a>>,
    /// Of velocities after an impact: value, density of the samples, exact density.
    density: Vec<[f64; 3]>,
    /// Of each joint of the arm: the deviation of first order, and that of samples.
    arm: Vec<[f64; 2]>,
}

/// What the rows of a quantity are about, in the order of the table.
const QUANTITIES: [(&str, &str); 11] = [
    ("ratio", "moments of 1/m"),
    ("ratio_distribution", "the distribution of 1/m"),
    ("refusal", "a normal mass"),
    ("derivatives", "derivatives of accelerations by masses"),
    ("arm", "accelerations of an arm with uncertain masses"),
    ("indices", "Sobol' indices of the masses"),
    ("threads", "one thread and two"),
    ("convergence", "errors of means over samples"),
    ("drop", "a drop with two contact modes"),
    ("drop_density", "velocities after an impact"),
    ("torques", "six torques of one uncertain mass"),
];

/// Makes the section, if the run has rows of the study.
pub(crate) fn sections<'a>(_: &RunInfo, rows: &'a [Row], overview: &Overview<'a>) -> Vec<Section> {
    let Some((rows, chunk)) = rows_of(rows, STUDY, overview) else { return Vec::new() };
    let figures = Figures { rates: rates(&rows), density: density(&rows), arm: arm(&rows) };
    vec![Section::new("uncertainty", "Uncertainty", body(&rows, &figures, &chunk))]
}

fn rates<'a>(rows: &[&'a Row]) -> Vec<Rate<'a>> {
    let of = |row: &&'a Row| {
        let (row, slope) = (*row, row.value?);
        let points = SIZES.iter().filter_map(|&(size, metric)| Some((size, beside(rows, row, metric)?))).collect();
        Some((if row.method == "sobol" { "scrambled Sobol' points" } else { "random points" }, slope, points))
    };
    rows.iter().filter(|row| row.quantity == "convergence" && row.metric == "slope").filter_map(of).collect()
}

fn density(rows: &[&Row]) -> Vec<[f64; 3]> {
    let of = |row: &&Row| {
        let bin: Bin = defined_by(row)?;
        Some([bin.velocity, row.value?, beside(rows, row, "known_density")?])
    };
    rows.iter().filter(|row| row.quantity == "drop_density" && row.metric == "density").filter_map(of).collect()
}

fn arm(rows: &[&Row]) -> Vec<[f64; 2]> {
    let of = |row: &&Row| Some([beside(rows, row, "first_order_deviation")?, row.value?]);
    rows.iter().filter(|row| row.quantity == "arm" && row.metric == "deviation").filter_map(of).collect()
}

fn body(rows: &[&Row], figures: &Figures, chunk: &str) -> Markup {
    let (passed, judged) = passed(rows);
    let of = |quantity, family, method, metric| value(rows, quantity, family, method, metric);
    let shortfall = of("ratio", "1/m, uniform", "first_order", "variance_shortfall");
    let (mean, spread) = (of("drop", "drop", "quadrature", "mean"), of("drop", "drop", "quadrature", "deviation"));
    let (weight, straight) = (of("drop", "drop", "quadrature", "weight"), of("drop", "drop", "first_order", "mean"));
    let slopes = &figures.rates;
    html! {
        section #uncertainty {
            h2 { "Uncertainty" }
            p.lead { b { (passed) " of " (judged) " known numbers are reproduced." } }
            ul {
                @if let Some(shortfall) = shortfall {
                    li { "First order is " (short(100.0 * shortfall)) " % low in the variance of 1/m for a uniform mass of ±20 %. Where answers are smooth that is its only fault." }
                }
                @if let (Some(mean), Some(spread), Some(weight), Some(straight)) = (mean, spread, weight, straight) {
                    li {
                        "Where contact modes differ it says nothing true: a drop meets the ground with probability " (short(weight)) ", and its velocity is "
                        (short(mean)) " ± " (short(spread)) " m/s. The line through the mean says " (short(straight)) " ± 0."
                    }
                }
                @if !slopes.is_empty() {
                    li {
                        "Errors of a mean fall with the number of samples by the power "
                        @for (k, (name, slope, _)) in slopes.iter().enumerate() { @if k > 0 { ", " } (short(*slope)) " (" (name) ")" } "."
                    }
                }
                li { "A deviation is a difference to the known value in standard errors, as improbable as that of a normal variable. Results of one thread and of two are the same to the bit." }
            }
            div.pair {
                (drawings::rates(figures))
                (drawings::arm(figures))
            }
            (drawings::density(figures))
            (table(STUDY, rows, &QUANTITIES, chunk))
        }
    }
}
