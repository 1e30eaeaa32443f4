//! Marks, lines and their samples.

use maud::{Markup, html};

use super::style::{COLOURS, Style};
use super::{at, width};

/// Corners of each mark about the origin, in radii; the first is a circle.
fn corners(mark: usize) -> Vec<(f64, f64)> {
    let ring = |count: usize, radii: &[f64], turn: f64| -> Vec<(f64, f64)> {
        let all = count * radii.len();
        let corner = |index: usize| {
            let angle = std::f64::consts::TAU * index as f64 / all as f64 - std::f64::consts::FRAC_PI_2 + turn;
            let radius = radii[index % radii.len()];
            (radius * angle.cos(), radius * angle.sin())
        };
        (0..all).map(corner).collect()
    };
    match mark {
        1 => ring(4, &[1.25], std::f64::consts::FRAC_PI_4),
        2 => ring(4, &[1.3], 0.0),
        3 => ring(3, &[1.35], 0.0),
        4 => ring(4, &[1.4, 0.5], 0.0),
        5 => ring(5, &[1.45, 0.6], 0.0),
        6 => ring(3, &[1.35], std::f64::consts::PI),
        _ => ring(4, &[1.4, 0.5], std::f64::consts::FRAC_PI_4),
    }
}

/// A mark at a place, with a thin edge of the paper's colour: marks on one another can be told apart.
pub(super) fn mark(style: Style, x: f64, y: f64) -> Markup {
    let radius = 4.0;
    let ink = COLOURS[style.colour];
    let (fill, stroke, thick) = if style.hollow { ("#ffffff", ink, "1.4") } else { (ink, "#ffffff", "0.6") };
    html! {
        @if style.mark == 0 {
            circle.mark cx=(at(x)) cy=(at(y)) r=(at(radius)) fill=(fill) stroke=(stroke) stroke-width=(thick) {}
        } @else {
            @let points: Vec<String> = corners(style.mark).into_iter().map(|(a, b)| format!("{} {}", at(x + radius * a), at(y + radius * b))).collect();
            path.mark d={ "M" (points.join("L")) "z" } fill=(fill) stroke=(stroke) stroke-width=(thick) {}
        }
    }
}

/// A line through places; a step goes across first, then up or down.
pub(super) fn path(style: Style, places: &[(f64, f64)], step: bool) -> Markup {
    let mut way = String::new();
    for (index, &(x, y)) in places.iter().enumerate() {
        way += &match (index, step) {
            (0, _) => format!("M{} {}", at(x), at(y)),
            (_, true) => format!("H{}V{}", at(x), at(y)),
            (_, false) => format!("L{} {}", at(x), at(y)),
        };
    }
    html! { path d=(way) fill="none" stroke=(COLOURS[style.colour]) stroke-width="1.5" stroke-linejoin="round" stroke-dasharray=[style.hollow.then_some("5 3")] {} }
}

/// The names of series, each with its sample, below one another.
pub(super) fn legend(names: &[(String, Style, bool)], left: f64, top: f64) -> Markup {
    html! {
        g.legend {
            @for (index, (name, style, line)) in names.iter().enumerate() {
                @let y = top + 20.0 * index as f64;
                @if *line { (path(*style, &[(left, y), (left + 26.0, y)], false)) }
                (mark(*style, left + 13.0, y))
                text x=(at(left + 33.0)) y=(at(y + 4.0)) font-size="12" { (name) }
            }
        }
    }
}

/// The room of a legend.
pub(super) fn legend_width(names: &[(String, Style, bool)]) -> f64 {
    names.iter().map(|(name, ..)| width(name, 12.0)).fold(0.0, crate::numbers::larger) + 45.0
}
