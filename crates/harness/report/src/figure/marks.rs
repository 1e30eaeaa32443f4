//! Marks, lines and their samples.

use maud::{Markup, html};

use super::paper::{at, width};
use super::style::{Style, TICK, ink};

/// Dashes of lines, by index.
const DASHES: [Option<&str>; 6] = [None, Some("6 4"), Some("1.5 3"), Some("7 3 1.5 3"), Some("12 4"), Some("12 3 1.5 3")];
/// The radius of a mark.
const RADIUS: f64 = 4.0;

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

/// What the page needs to know of a mark.
#[derive(Default)]
pub(super) struct Data<'a> {
    /// Its values, as numbers.
    pub(super) value: Option<String>,
    /// The chunk of its rows.
    pub(super) chunk: Option<&'a str>,
    /// What these are of, if not of what the mark is named after.
    pub(super) title: Option<&'a str>,
    /// Their filters beyond those of its series.
    pub(super) filter: Option<String>,
}

/// A mark at a place, in a group that fills marks with their colour and gives them a thin edge of the paper's colour: marks on one another can
/// be told apart.
pub(super) fn mark(style: Style, hollow: bool, estimated: bool, x: f64, y: f64, words: Markup, data: &Data) -> Markup {
    let colour = ink(style.colour);
    let tick = style.mark == TICK;
    let open = hollow || style.hollow || tick;
    let [fill, stroke, thick] = ["#ffffff", colour, "1.4"].map(|own| open.then_some(own));
    let place = format!("translate({} {})", at(x), at(y));
    html! {
        @if style.mark == 0 && !estimated {
            circle.mark transform=(place) r=(at(RADIUS)) fill=[fill] stroke=[stroke] stroke-width=[thick]
                data-value=[&data.value] data-rows=[data.chunk] data-title=[data.title] data-filter=[&data.filter] { (words) }
        } @else {
            path.mark transform=(place) d=(outline(if estimated { usize::MAX } else { style.mark })) fill=[fill] stroke=[stroke] stroke-width=[thick]
                data-value=[&data.value] data-rows=[data.chunk] data-title=[data.title] data-filter=[&data.filter] { (words) }
        }
    }
}

fn outline(mark: usize) -> String {
    if mark == TICK {
        return "M-5 0h10".into();
    }
    let points: Vec<String> = corners(mark).into_iter().map(|(a, b)| format!("{} {}", at(RADIUS * a), at(RADIUS * b))).collect();
    format!("M{}z", points.join("L"))
}

/// A line through places; a step goes across first, then up or down.
pub(super) fn path(style: Style, dash: usize, places: &[(f64, f64)], step: bool) -> Markup {
    let dashes = if style.hollow && dash == 0 { Some("5 3") } else { DASHES[dash % DASHES.len()] };
    html! { path d=(way(places, step)) fill="none" stroke=(ink(style.colour)) stroke-width="1.5" stroke-dasharray=[dashes] {} }
}

/// A broad pale line through places.
pub(super) fn broad(style: Style, places: &[(f64, f64)]) -> Markup {
    html! { path d=(way(places, false)) fill="none" stroke=(ink(style.colour)) stroke-width="6" stroke-opacity="0.18" {} }
}

fn way(places: &[(f64, f64)], step: bool) -> String {
    let mut way = String::new();
    for (index, &(x, y)) in places.iter().enumerate() {
        way += &match (index, step) {
            (0, _) => format!("M{} {}", at(x), at(y)),
            (_, true) => format!("H{}V{}", at(x), at(y)),
            (_, false) => format!("L{} {}", at(x), at(y)),
        };
    }
    way
}

/// What a legend shows of a series.
#[derive(Clone, Copy)]
pub(super) struct Sample {
    /// Whether its points are joined.
    pub(super) line: bool,
    /// Its dashes.
    pub(super) dash: usize,
    /// Whether it has marks, and whether all of them are hollow and estimates.
    pub(super) marks: Option<(bool, bool)>,
    /// Whether it is a broad line alone.
    pub(super) broad: bool,
    /// Whether the page switches its series off at first.
    pub(super) off: bool,
}

/// The names of series, each with its sample, in so many columns of a width.
pub(super) fn legend(entries: &[(&str, Style, Sample)], [left, top]: [f64; 2], [columns, width]: [f64; 2]) -> Markup {
    html! {
        g.legend {
            @for (index, (name, style, sample)) in entries.iter().enumerate() {
                @let left = left + width * (index as f64 % columns);
                @let y = top + 20.0 * (index as f64 / columns).floor();
                @let ends = [(left, y), (left + 26.0, y)];
                g.entry data-off[sample.off] {
                    @if sample.broad { (broad(*style, &ends)) }
                    @if sample.line { (path(*style, sample.dash, &ends, false)) }
                    @if let Some((hollow, estimated)) = sample.marks { g fill=(ink(style.colour)) stroke="#ffffff" stroke-width="0.6" { (mark(*style, hollow, estimated, left + 13.0, y, html! {}, &Data::default())) } }
                    text x=(at(left + 33.0)) y=(at(y + 4.0)) font-size="12" { (name) }
                }
            }
        }
    }
}

/// The room of a legend.
pub(super) fn legend_width(entries: &[(&str, Style, Sample)]) -> f64 {
    entries.iter().map(|(name, ..)| width(name, 12.0)).fold(0.0, crate::numbers::larger) + 45.0
}
