//! The drawing of a plot: its frame, series and legend as elements of SVG.

use maud::{Markup, html};

use super::axis::{Scale, Tick};
use super::marks::{self, Sample, legend, legend_width, path};
use super::paper::{at, width};
use super::plot::{Line, Plot, Point, Rows, Series};
use super::style::{Style, ink};
use crate::numbers::larger;

/// Width and height of the box in a paper.
const BOX: [f64; 2] = [430.0, 310.0];
/// The same on the page, whose width it takes.
const PAGE: [f64; 2] = [860.0, 400.0];
/// Room left of the box and above it.
const CORNER: [f64; 2] = [72.0, 16.0];
/// Room below the box: for the title of the axis across, and for labels that are level.
const BELOW: [f64; 2] = [28.0, 22.0];
/// Width of a place with a name on the axis across.
const NAMED: f64 = 18.0;
/// Heights at which the words of events stand.
const EVENT_LINES: usize = 6;
/// Series that are seen at once on the page. The reader switches on the others.
const AT_ONCE: usize = 6;
/// Marks on stairs, which may have thousands of points.
const SPARSE: usize = 8;
/// The slope of names along the axis across, in degrees.
const SLOPE: f64 = 38.0;

/// Where things are.
struct Layout<'a> {
    plot: &'a Plot,
    x: Scale,
    y: Scale,
    left: f64,
    top: f64,
    right: f64,
    bottom: f64,
    /// Room for the labels of the axis across.
    labels: f64,
}

impl<'a> Layout<'a> {
    fn of(plot: &'a Plot, size: [f64; 2]) -> Option<Self> {
        plot.shown().next()?;
        let names = plot.x.names().map(|names| (names.iter().map(|name| width(name, 12.0)).fold(0.0, larger), names));
        let slope = SLOPE.to_radians();
        let [mut left, top] = CORNER;
        let mut across = size[0];
        let mut labels = BELOW[1];
        if let Some((longest, names)) = &names {
            across = larger(across, NAMED * names.len() as f64);
            labels = larger(labels, longest * slope.sin() + 20.0);
            // A name ends below its place and begins on the left of it.
            left = larger(left, longest * slope.cos() - 0.5 * across / (names.len() as f64 + 0.2) + 12.0);
        }
        let [right, bottom] = [left + across, top + size[1]];
        let x = Scale::of(&plot.x, plot.numbers(0), [left, right])?;
        let y = Scale::of(&plot.y, plot.numbers(1), [bottom, top])?;
        Some(Self { plot, x, y, left, top, right, bottom, labels })
    }

    fn place(&self, x: f64, y: f64) -> Option<(f64, f64)> {
        (self.plot.x.fits(x) && self.plot.y.fits(y)).then(|| (self.x.place(x), self.y.place(y)))
    }

    fn places(&self, way: &[[f64; 2]]) -> Vec<(f64, f64)> {
        way.iter().filter_map(|&[x, y]| self.place(x, y)).collect()
    }
}

impl Plot {
    /// All numbers along an axis: marks, intervals, lines and bands are seen whole.
    fn numbers(&self, axis: usize) -> impl Iterator<Item = f64> {
        let points = self.shown().flat_map(move |(_, point)| {
            let (value, ends) = if axis == 0 { (point.x, point.across) } else { (point.y, point.upwards) };
            [Some(value), ends[0], ends[1]].into_iter().flatten()
        });
        let way = move |series: &Series| -> Vec<f64> {
            series.broad.iter().chain(series.path.iter().flatten()).map(|point| point[axis]).collect()
        };
        let levels = self.series.iter().filter_map(|series| series.level).chain(self.bands.iter().flatten().copied());
        points.chain(self.series.iter().flat_map(way)).chain(levels.filter(move |_| axis == 1))
    }
}

/// The size and the elements of a plot; `None` if no point has a place. For the page marks have their words and rows with them, which a paper
/// has no use for.
pub(super) fn draw(plot: &Plot, events: &[(f64, String)], page: bool) -> Option<([f64; 2], Markup)> {
    let layout = Layout::of(plot, if page { PAGE } else { BOX })?;
    let Layout { left, top, right, bottom, labels, .. } = layout;
    let seen = at_once(&plot.series);
    let entries: Vec<(&str, Style, Sample)> = plot.series.iter().zip(seen).map(|(series, seen)| entry(series, !seen && page)).collect();
    let below = bottom + labels + BELOW[0];
    // In a paper names stand beside the box, on the page below it, in columns.
    let column = legend_width(&entries);
    let columns = if page { ((right - left) / column).floor().clamp(1.0, entries.len().max(1) as f64) as usize } else { 1 };
    let rows = 20.0 * entries.len().div_ceil(columns) as f64 + 10.0;
    let size = if page { [right + 14.0, below + rows] } else { [right + 14.0 + column, larger(below, top + rows)] };
    let corner = if page { [left, below + 10.0] } else { [right + 14.0, top + 8.0] };
    let body = html! {
        (bands(&layout))
        (frame(&layout, page))
        @for (index, (value, words)) in events.iter().filter(|(value, _)| plot.x.fits(*value)).enumerate() {
            @let place = layout.x.place(*value);
            // Words of neighbours stand below one another.
            @let height = top + 14.0 + 13.0 * (index % EVENT_LINES) as f64;
            path.event d={ "M" (at(place)) " " (at(top)) "V" (at(bottom)) } stroke="#8a5a00" stroke-dasharray="2 3" {}
            @let late = place > (left + right) / 2.0;
            text x=(at(if late { place - 4.0 } else { place + 4.0 })) y=(at(height)) font-size="11" fill="#6b4700"
                text-anchor=(if late { "end" } else { "start" }) { (words) }
        }
        @for series in &plot.series { (drawn(&layout, series, page)) }
        (legend(&entries, corner, [columns as f64, column]))
    };
    Some((size, body))
}

/// Which series are seen first: levels and bounds, then the first series of each colour, then the second ones.
fn at_once(series: &[Series]) -> Vec<bool> {
    let rank = |index: usize| {
        let style = series[index].style;
        (style != Style::NEUTRAL, series[..index].iter().filter(|before| before.style.colour == style.colour).count(), index)
    };
    let mut order: Vec<usize> = (0..series.len()).collect();
    order.sort_by_key(|&index| rank(index));
    order.truncate(AT_ONCE);
    (0..series.len()).map(|index| order.contains(&index)).collect()
}

/// The entry of a series in the legend.
fn entry(series: &Series, off: bool) -> (&str, Style, Sample) {
    let line = series.line != Line::Marks && (series.points.len() > 1 || series.level.is_some() || series.path.is_some());
    let marks = series
        .points
        .first()
        .map(|point| (series.points.iter().all(|other| other.hollow) && point.hollow, series.points.iter().all(|other| other.estimated)));
    (
        &series.name,
        series.style,
        Sample { line, dash: series.dash, marks, broad: series.points.is_empty() && !series.broad.is_empty(), off },
    )
}

fn bands(layout: &Layout) -> Markup {
    html! {
        @for [from, to] in &layout.plot.bands {
            @let (from, to) = (layout.y.place(*from), layout.y.place(*to));
            rect.band x=(at(layout.left)) y=(at(to)) width=(at(layout.right - layout.left)) height=(at(larger(1.0, from - to))) fill="#d5dbe1" {}
        }
    }
}

/// A series: its lines, the intervals of its points, and its marks.
fn drawn(layout: &Layout, series: &Series, page: bool) -> Markup {
    let Layout { plot, left, right, .. } = layout;
    let shown: Vec<(&Point, f64, f64)> =
        series.points.iter().filter_map(|point| layout.place(point.x, point.y).map(|(x, y)| (point, x, y))).collect();
    let every = if series.line == Line::Stairs { shown.len().div_ceil(SPARSE).max(1) } else { 1 };
    let through: Vec<(f64, f64)> = match (&series.path, series.line) {
        (_, Line::Marks) => Vec::new(),
        (Some(path), _) => layout.places(path),
        (None, _) => shown.iter().map(|&(_, x, y)| (x, y)).collect(),
    };
    let broad = layout.places(&series.broad);
    let level = series.level.filter(|&value| plot.y.fits(value)).map(|value| layout.y.place(value));
    let colour = ink(series.style.colour);
    let intervals: String = shown.iter().map(|(point, x, y)| interval(layout, point, *x, *y)).collect();
    // What all rows of a series share stands once.
    let of_rows = || series.points.iter().filter_map(|point| point.rows.as_ref()).filter(|_| page);
    let mut shared = of_rows().next().map(|rows| rows.filters.clone()).unwrap_or_default();
    shared.retain(|filter| of_rows().all(|rows| rows.filters.contains(filter)));
    let filters = of_rows().next().and_then(|_| Rows { filters: shared.clone(), ..Rows::default() }.filters_beyond(&[]));
    html! {
        g.series data-filter=[filters] {
            g.lines {
                @if broad.len() > 1 { (marks::broad(series.style, &broad)) }
                @if let Some(level) = level { (path(series.style, series.dash, &[(*left, level), (*right, level)], false)) }
                @if through.len() > 1 { (path(series.style, series.dash, &through, series.line == Line::Stairs)) }
                @if !intervals.is_empty() { path.interval d=(intervals) stroke=(colour) stroke-width="1.2" {} }
            }
            g.marks fill=(colour) stroke="#ffffff" stroke-width="0.6" {
                @for &(point, x, y) in shown.iter().skip((every - 1) / 2).step_by(every) {
                    @let hollow = point.hollow || plot.y.is_below(point.y);
                    @let rows = point.rows.as_ref().filter(|_| page);
                    (marks::mark(series.style, hollow, point.estimated, x, y, html! {
                        @if page {
                            title { (point.name) @for line in &point.about { "\n" (line) } }
                        }
                    }, &marks::Data {
                        value: page.then(|| format!("{} {}", brief(point.x), brief(point.y))),
                        chunk: rows.map(|rows| rows.chunk.as_str()),
                        title: rows.map(|rows| rows.title.as_str()).filter(|title| *title != point.name),
                        filter: rows.and_then(|rows| rows.filters_beyond(&shared)),
                    }))
                }
            }
        }
    }
}

/// A number with six digits, which is enough for a copy of what is drawn.
fn brief(value: f64) -> String {
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    format!("{rounded:?}").trim_end_matches(".0").to_owned()
}

/// The way of the intervals of a point. An end that has no place goes on to the edge.
fn interval(layout: &Layout, point: &Point, x: f64, y: f64) -> String {
    let Layout { plot, left, right, top, bottom, .. } = layout;
    let up = |end: Option<f64>, edge: f64| end.map_or(y, |value| if plot.y.fits(value) { layout.y.place(value) } else { edge });
    let aside = |end: Option<f64>, edge: f64| end.map_or(x, |value| if plot.x.fits(value) { layout.x.place(value) } else { edge });
    let mut way = String::new();
    if point.upwards.iter().any(Option::is_some) {
        way += &format!("M{} {}V{}", at(x), at(up(point.upwards[0], *bottom)), at(up(point.upwards[1], *top)));
    }
    if point.across.iter().any(Option::is_some) {
        way += &format!("M{} {}H{}", at(aside(point.across[0], *left)), at(y), at(aside(point.across[1], *right)));
    }
    way
}

/// The ticks across with their places, and whether there is room for their labels: one that would touch its neighbour is left out.
fn spaced(x: &Scale, named: bool) -> Vec<(Tick, f64, bool)> {
    let mut end = f64::NEG_INFINITY;
    let spaced = |tick: Tick| {
        let place = x.place(tick.value);
        let half = if named { 7.0 } else { width(&tick.label, 12.0) / 2.0 + 2.0 };
        let free = !tick.label.is_empty() && place - half >= end;
        if free {
            end = place + half;
        }
        (tick, place, free)
    };
    x.ticks().into_iter().map(spaced).collect()
}

/// The box with its grid, ticks and titles.
fn frame(layout: &Layout, page: bool) -> Markup {
    let Layout { plot, x, y, left, top, right, bottom, labels } = layout;
    let [across, up] = [right - left, bottom - top];
    let turned = format!("translate(18 {}) rotate(-90)", at((top + bottom) / 2.0));
    // A title that is longer than its axis is written smaller.
    let fitted = |title: &str, room: f64| format!("{:.1}", 13.0_f64.min(13.0 * room / larger(width(title, 13.0), 1.0)));
    let named = plot.x.names().is_some();
    let below = plot.shown().any(|(_, point)| plot.y.is_below(point.y));
    html! {
        g.axes stroke-width="1" {
            g.xticks text-anchor=(if named { "end" } else { "middle" }) font-size="12" {
                @for (tick, place, free) in spaced(x, named) {
                    // A tick without a label has its number with it on the page: a zoom makes room.
                    g.tick transform={ "translate(" (at(place)) " " (at(*bottom)) ")" } data-label=[(page && !free).then(|| tick.full())] {
                        @if free { path d={ "M0 0V" (at(-up)) } stroke="#e6eaee" {} }
                        path d={ "M0 0v" (if free { "6" } else { "3" }) } stroke="#566472" {}
                        @if free && named { text transform={ "translate(3 14) rotate(-" (SLOPE) ")" } { (tick.label) } }
                        @else if free { text y="20" { (tick.label) } }
                    }
                }
            }
            g.yticks text-anchor="end" font-size="12" {
                @for tick in y.ticks() {
                    @let labelled = !tick.label.is_empty();
                    g.tick transform={ "translate(" (at(*left)) " " (at(y.place(tick.value))) ")" } data-label=[(page && !labelled).then(|| tick.full())] {
                        @if labelled { path d={ "M0 0H" (at(across)) } stroke="#e6eaee" {} }
                        path d={ "M0 0h" (if labelled { "-6" } else { "-3" }) } stroke="#566472" {}
                        @if labelled { text x="-9" y="4" { @if below && plot.y.is_least(tick.value) { "≤ " } (tick.label) } }
                    }
                }
            }
            rect.box x=(at(*left)) y=(at(*top)) width=(at(across)) height=(at(up)) fill="none" stroke="#566472" {}
        }
        text.xtitle x=(at((left + right) / 2.0)) y=(at(bottom + labels + 20.0)) text-anchor="middle" font-size=(fitted(&plot.x.title, across + 120.0)) { (plot.x.title) }
        text.ytitle transform=(turned) text-anchor="middle" font-size=(fitted(&plot.y.title, up + 40.0)) { (plot.y.title) }
    }
}
