//! The section's drawings: error against time per engine, and errors of accelerations beside a singularity.

use super::{Figures, Point};
use featherbench_report::figure::{self, Axis, Series};
use featherbench_study::figures::{drawing, errors, nth, point, told};
use maud::Markup;

/// A series for each method, in the order in which they come; `style` says which colour and mark a method has.
fn series<T>(
    all: &[T],
    name: impl Fn(&T) -> String,
    style: impl Fn(usize, &str) -> usize,
    place: impl Fn(&T) -> figure::Point,
) -> Vec<Series> {
    let mut methods: Vec<(String, Vec<figure::Point>)> = Vec::new();
    for one in all {
        let name = name(one);
        match methods.iter_mut().find(|(known, _)| *known == name) {
            Some((_, points)) => points.push(place(one)),
            None => methods.push((name, vec![place(one)])),
        }
    }
    methods.into_iter().enumerate().map(|(index, (name, points))| nth(style(index, &name), name, points)).collect()
}

/// The error at the end of a motion against its time.
pub(super) fn work(figures: &Figures, index: usize, motion: &str) -> Markup {
    let name = |point: &&Point| format!("{} {}", point.engine, point.method);
    // A method has one colour in all motions.
    let mut known: Vec<String> = Vec::new();
    for point in &figures.points {
        if !known.contains(&name(&point)) {
            known.push(name(&point));
        }
    }
    let place = |one: &&Point| {
        let optional = |words: &str, value: Option<f64>| value.map(|value| format!("{words} {}", told(value))).unwrap_or_default();
        let about = [
            format!("dt {} s, {} s", told(one.dt), told(one.seconds)),
            format!("error {}", told(one.error)),
            optional("energy drift, J:", one.drift),
            optional("loops open:", one.open),
        ];
        point(one.name, one.seconds, one.error, about)
    };
    let own: Vec<&Point> = figures.points.iter().filter(|point| point.name == motion).collect();
    let series = series(&own, name, |_, name| known.iter().position(|other| other == name).unwrap_or(0), place);
    let (x, y) = (Axis::log(format!("{motion}: time, s")), errors("error at the end"));
    drawing(&format!("loops-work-{index}"), &format!("Error of {motion} against time, per engine"), x, y, series)
}

/// The error of accelerations against the angle beside the singularity.
pub(super) fn near(figures: &Figures) -> Markup {
    let place =
        |near: &super::Near| point(near.method, near.beside, near.error, [format!("{} rad beside", told(near.beside)), told(near.error)]);
    let series = series(&figures.near, |near| format!("{} {}", near.engine, near.method), |index, _| index, place);
    let (x, y) = (Axis::log("angle beside the flat four-bar, rad"), errors("error of the acceleration"));
    drawing("loops-near", "Error of accelerations against the angle beside the singularity", x, y, series)
}
