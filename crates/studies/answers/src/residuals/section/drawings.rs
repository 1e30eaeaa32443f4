//! The section's drawings: the change of the true energy over a motion without forces, per learned model.

use super::Line;
use featherbench_report::figure::Axis;
use featherbench_study::figures::{drawing, errors, nth, point, told};
use maud::Markup;

/// The change against time, of models learned from one set of data.
pub(super) fn drift(place: usize, case: &str, lines: &[Line]) -> Markup {
    let series = lines.iter().enumerate().map(|(index, (model, points))| {
        let points = points
            .iter()
            .map(|&(time, change)| point(&format!("{model}, {case}"), time, change, [format!("{} s", told(time)), told(change)]));
        nth(index, *model, points.collect())
    });
    let (x, y) = (Axis::log(format!("time, s ({case})")), errors("change of the true energy"));
    drawing(&format!("residuals-drift-{place}"), &format!("Change of the true energy against time, {case}"), x, y, series.collect())
}
