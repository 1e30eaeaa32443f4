//! The section's drawings: κ on the left; what it would excuse and what is unavoidable on the right; κ of floating bases before and after scaling.

use super::floating_base::Base;
use super::{Family, Point, STUDY};
use featherbench_report::figure::{self, Axis, Rows, Series, Style};
use featherbench_report::fit::Fit;
use featherbench_report::{Overview, robot_chunk};
use featherbench_study::figures::{drawing, joined, point, scattered, told, with_exponent};
use maud::{Markup, html};

/// Half the spacing of doubles at one.
const HALF_ULP: f64 = 0.5 * f64::EPSILON;

fn rows(overview: &Overview, robot: usize) -> Option<Rows> {
    Some(Rows::of(robot_chunk(robot), overview.robots[robot].name, &[("study", STUDY)]))
}

/// What is drawn of each point of a family: its name, its colour and mark, a value, and the fit whose exponent stands beside the name.
type Shown<'a> = (&'a str, Style, fn(&Point) -> Option<f64>, fn(&Family) -> Option<Fit>);

fn of_families(overview: &Overview, families: &[Family], shown: &[Shown]) -> Vec<Series> {
    let mut series = Vec::new();
    for (dash, family) in families.iter().enumerate() {
        for (label, style, value, fit) in shown {
            let points = family.points.iter().filter_map(|at| {
                let value = value(at)?;
                let name = overview.robots[at.robot].name;
                Some(figure::Point { rows: rows(overview, at.robot), ..point(name, at.size as f64, value, [told(value)]) })
            });
            let name = joined(&[label, if families.len() > 1 { family.name } else { "" }]);
            let name = with_exponent(name, fit(family).map(|fit| fit.slope), 2);
            series.push(Series { dash, ..Series::new(name, *style, points.collect()) });
        }
    }
    series
}

/// Condition numbers, and beside them the errors that they would excuse.
pub(super) fn chains(overview: &Overview, families: &[Family]) -> Markup {
    let sizes = || families.iter().flat_map(|family| &family.points).map(|point| point.size as f64).collect();
    let x = || Axis::log("degrees of freedom n").at(sizes());
    let [first, second] = [Style::nth(0), Style::nth(1)];
    let numbers: [Shown; 2] =
        [("κ(M)", first, |point| point.raw, |family| family.raw), ("κ scaled", second, |point| point.scaled, |family| family.scaled)];
    let excused: [Shown; 3] = [
        ("κ(M)·2⁻⁵³", first, |point| Some(point.raw? * HALF_ULP), |_| None),
        ("κ scaled·2⁻⁵³", second, |point| Some(point.scaled? * HALF_ULP), |_| None),
        ("conditioning bound", Style { mark: 2, ..Style::NEUTRAL }, |point| point.floor, |_| None),
    ];
    html! {
        (drawing("conditioning-plot", "Condition number against the degrees of freedom", x(), Axis::log("condition number"), of_families(overview, families, &numbers)))
        (drawing("floor-plot", "Error that the condition number would excuse, and the conditioning bound", x(), Axis::log("relative error"), of_families(overview, families, &excused)))
    }
}

/// A mark for each matrix of each robot: κ before and after scaling to a unit diagonal.
pub(super) fn bases(overview: &Overview, bases: &[Base]) -> Markup {
    let series = ["κ(M)", "κ(S_bb)", "κ(S_jj)"].into_iter().enumerate().map(|(place, name)| {
        let points = bases.iter().filter_map(|base| {
            let (raw, scaled) = base.kappa[2 * place].zip(base.kappa[2 * place + 1])?;
            let about = [format!("{}, scaled {}", told(raw), told(scaled))];
            Some(figure::Point { rows: rows(overview, base.robot), ..point(overview.robots[base.robot].name, raw, scaled, about) })
        });
        scattered(place, name, points.collect())
    });
    let (x, y) = (Axis::log("condition number κ"), Axis::log("κ after scaling"));
    drawing("floating-base-plot", "Condition numbers after scaling to a unit diagonal against those before", x, y, series.collect())
}
