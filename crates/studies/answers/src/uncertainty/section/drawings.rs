//! The section's drawings: errors against samples, first order against samples, and the density of a mixture.

use super::Figures;
use featherbench_report::figure::{Axis, Line, Series, Style};
use featherbench_report::numbers::{larger, short, smaller};
use featherbench_study::figures::{drawing, nth, point, scattered, told};
use maud::Markup;

/// Errors of a mean against samples, random and scrambled Sobol' points.
pub(super) fn rates(figures: &Figures) -> Markup {
    let series = figures.rates.iter().enumerate().map(|(index, (name, slope, points))| {
        let points = points
            .iter()
            .map(|&(samples, error)| point(name, samples as f64, error, [format!("{samples} samples"), format!("{} rad/s²", told(error))]));
        nth(index, format!("{name}, slope {}", short(*slope)), points.collect())
    });
    let (x, y) = (Axis::log("samples"), Axis::log("error of the mean, rad/s²"));
    drawing("uncertainty-rates", "Errors of a mean against samples", x, y, series.collect())
}

/// Deviations of joints' accelerations, samples against first order.
pub(super) fn arm(figures: &Figures) -> Markup {
    let joint = |(joint, &[first, found]): (usize, &[f64; 2])| {
        point(&format!("joint {joint}"), first, found, [format!("first order {}", told(first)), format!("samples {}", told(found))])
    };
    let ends = figures.arm.iter().map(|&[first, _]| first);
    let ends = [ends.clone().fold(f64::INFINITY, smaller), ends.fold(0.0, larger)];
    let equal =
        Series { name: "equal".into(), style: Style::NEUTRAL, dash: 1, path: Some(ends.map(|x| [x, x]).into()), ..Series::default() };
    let (x, y) = (Axis::log("deviation by first order, rad/s²"), Axis::log("deviation of samples, rad/s²"));
    let joints = Series { line: Line::Marks, ..nth(0, "joints of the arm", figures.arm.iter().enumerate().map(joint).collect()) };
    drawing("uncertainty-arm", "Deviations of joints' accelerations, samples against first order", x, y, vec![joints, equal])
}

/// The density of velocities after an impact.
pub(super) fn density(figures: &Figures) -> Markup {
    let of = |name: &str, column: usize| {
        let bin =
            |bin: &[f64; 3]| point(name, bin[0], bin[column], [format!("{} m/s", told(bin[0])), format!("{} s/m", told(bin[column]))]);
        figures.density.iter().map(bin).collect()
    };
    let (x, y) = (Axis::linear("velocity of drops after an impact, m/s (all others have −gT)"), Axis::linear("density, s/m"));
    let series = vec![nth(1, "exact", of("exact", 2)), scattered(0, "samples", of("samples", 1))];
    drawing("uncertainty-density", "Density of velocities after an impact", x, y, series)
}
