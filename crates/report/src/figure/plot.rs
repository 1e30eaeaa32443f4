//! Plots: lines and marks over two axes.

use maud::{Markup, html};

use super::axis::{Axis, Scale};
use super::marks::{legend, legend_width, mark, path};
use super::style::Style;
use super::{Figure, at, csv_line, file};

/// Width and height of the box.
const BOX: [f64; 2] = [430.0, 310.0];
/// Room left of the box and above it.
const CORNER: [f64; 2] = [72.0, 16.0];
/// Room below the box.
const BELOW: f64 = 50.0;
/// Heights at which the words of events stand.
const EVENT_LINES: usize = 6;
/// Marks on stairs, which may have thousands of points.
const SPARSE: usize = 8;

/// How points are joined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Line {
    /// By straight lines, in the order given.
    Straight,
    /// By stairs: across, then up. Only some points have marks.
    Stairs,
    /// Not at all.
    Marks,
}

/// A point with its name in the data.
#[derive(Clone, Debug)]
pub struct Point {
    /// A robot, for example.
    pub name: String,
    /// Across.
    pub x: f64,
    /// Up.
    pub y: f64,
}

/// Points of one name.
#[derive(Clone, Debug)]
pub struct Series {
    /// The name in the legend.
    pub name: String,
    /// Colour and mark.
    pub style: Style,
    /// How its points are joined.
    pub line: Line,
    /// The points. Those without a place on an axis are in the data alone.
    pub points: Vec<Point>,
}

/// A plot.
#[derive(Clone, Debug)]
pub struct Plot {
    /// What it shows.
    pub title: String,
    /// The axis across.
    pub x: Axis,
    /// The axis upwards.
    pub y: Axis,
    /// Its series.
    pub series: Vec<Series>,
}

impl Plot {
    /// Draws it; `None` if no point has a place.
    pub fn figure(self, name: &'static str, caption: String) -> Option<Figure> {
        self.figure_with(name, caption, &[])
    }

    /// The same with events: a vertical line at a place of the axis across, and what happened there.
    pub fn figure_with(self, name: &'static str, caption: String, events: &[(f64, String)]) -> Option<Figure> {
        let shown = |point: &&Point| self.x.fits(point.x) && self.y.fits(point.y);
        let points = || self.series.iter().flat_map(|series| &series.points).filter(shown);
        let [left, top] = CORNER;
        let [right, bottom] = [left + BOX[0], top + BOX[1]];
        let x = Scale::of(&self.x, points().map(|point| point.x), [left, right])?;
        let y = Scale::of(&self.y, points().map(|point| point.y), [bottom, top])?;
        let names: Vec<(String, Style, bool)> =
            self.series.iter().map(|series| (series.name.clone(), series.style, series.line != Line::Marks)).collect();
        let below = bottom + BELOW;
        let size = [right + 14.0 + legend_width(&names), crate::numbers::larger(below, top + 20.0 * names.len() as f64 + 10.0)];
        let body = html! {
            (frame(&self, &x, &y, [left, top, right, bottom]))
            @for (index, (value, words)) in events.iter().filter(|(value, _)| self.x.fits(*value)).enumerate() {
                @let place = x.place(*value);
                // Words of neighbours stand below one another.
                @let height = top + 14.0 + 13.0 * (index % EVENT_LINES) as f64;
                path.event d={ "M" (at(place)) " " (at(top)) "V" (at(bottom)) } stroke="#8a5a00" stroke-dasharray="2 3" {}
                @let late = place > (left + right) / 2.0;
                text x=(at(if late { place - 4.0 } else { place + 4.0 })) y=(at(height)) font-size="11" fill="#6b4700"
                    text-anchor=(if late { "end" } else { "start" }) { (words) }
            }
            @for series in &self.series {
                @let places: Vec<(f64, f64)> = series.points.iter().filter(shown).map(|point| (x.place(point.x), y.place(point.y))).collect();
                @let every = if series.line == Line::Stairs { places.len().div_ceil(SPARSE).max(1) } else { 1 };
                g.series {
                    @if places.len() > 1 && series.line != Line::Marks { (path(series.style, &places, series.line == Line::Stairs)) }
                    @for &(x, y) in places.iter().skip((every - 1) / 2).step_by(every) { (mark(series.style, x, y)) }
                }
            }
            (legend(&names, right + 14.0, top + 8.0))
        };
        let svg = file(&self.title, size, body);
        let csv = self.csv();
        Some(Figure { name, title: self.title, caption, size, svg, csv })
    }

    fn csv(&self) -> String {
        let mut text = csv_line(["series", "name", &self.x.title, &self.y.title]);
        for series in &self.series {
            for point in &series.points {
                text += &csv_line([series.name.as_str(), &point.name, &point.x.to_string(), &point.y.to_string()]);
            }
        }
        text
    }
}

/// The box with its grid, ticks and titles.
fn frame(plot: &Plot, x: &Scale, y: &Scale, [left, top, right, bottom]: [f64; 4]) -> Markup {
    let middle = (left + right) / 2.0;
    let turned = format!("translate(18 {}) rotate(-90)", at((top + bottom) / 2.0));
    html! {
        g.axes stroke-width="1" {
            @for (value, label) in x.ticks() {
                @let place = at(x.place(value));
                @if !label.is_empty() { path d={ "M" (place) " " (at(top)) "V" (at(bottom)) } stroke="#e6eaee" {} }
                path d={ "M" (place) " " (at(bottom)) "v" (if label.is_empty() { "3" } else { "6" }) } stroke="#566472" {}
                text x=(place) y=(at(bottom + 20.0)) text-anchor="middle" font-size="12" { (label) }
            }
            @for (value, label) in y.ticks() {
                @let place = y.place(value);
                @if !label.is_empty() { path d={ "M" (at(left)) " " (at(place)) "H" (at(right)) } stroke="#e6eaee" {} }
                path d={ "M" (at(left)) " " (at(place)) "h" (if label.is_empty() { "-3" } else { "-6" }) } stroke="#566472" {}
                text x=(at(left - 9.0)) y=(at(place + 4.0)) text-anchor="end" font-size="12" { (label) }
            }
            rect x=(at(left)) y=(at(top)) width=(at(right - left)) height=(at(bottom - top)) fill="none" stroke="#566472" {}
        }
        text x=(at(middle)) y=(at(bottom + 42.0)) text-anchor="middle" { (plot.x.title) }
        text transform=(turned) text-anchor="middle" { (plot.y.title) }
    }
}
