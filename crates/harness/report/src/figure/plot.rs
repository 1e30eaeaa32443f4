//! Plots: lines and marks over two axes.

use super::axis::Axis;
use super::style::Style;

/// How points are joined.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Line {
    /// By straight lines, in the order given.
    #[default]
    Straight,
    /// By stairs: across, then up. Only some points have marks.
    Stairs,
    /// Not at all.
    Marks,
}

/// Rows that a mark leads to on the page.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rows {
    /// Their chunk, as `overview.chunk_of` has it.
    pub chunk: String,
    /// What they are of; nothing is the name of the point.
    pub title: String,
    /// What their columns hold.
    pub filters: Vec<(String, String)>,
}

impl Rows {
    /// Rows of a chunk whose columns have the given values. A filter without a value is left out.
    pub fn of(chunk: impl Into<String>, title: impl Into<String>, filters: &[(&str, &str)]) -> Self {
        let kept = filters.iter().filter(|(_, value)| !value.is_empty());
        let filters = kept.map(|&(column, value)| (column.to_owned(), value.to_owned())).collect();
        Self { chunk: chunk.into(), title: title.into(), filters }
    }

    /// The filters that are not among the given ones, as an attribute has them: a line for each.
    pub(super) fn filters_beyond(&self, known: &[(String, String)]) -> Option<String> {
        let own = self.filters.iter().filter(|filter| !known.contains(filter));
        let lines: Vec<String> = own.map(|(column, value)| format!("{column}={value}")).collect();
        (!lines.is_empty()).then(|| lines.join("\n"))
    }
}

/// A point with its name in the data.
#[derive(Clone, Debug, Default)]
pub struct Point {
    /// A robot, for example.
    pub name: String,
    /// Across.
    pub x: f64,
    /// Up.
    pub y: f64,
    /// The ends of its interval upwards; an end that is absent is at the mark.
    pub upwards: [Option<f64>; 2],
    /// The ends of its interval across.
    pub across: [Option<f64>; 2],
    /// Whether its mark is hollow: a value that does not count, or that stands for all below the axis.
    pub hollow: bool,
    /// Whether it is an estimate, whose mark is a cross.
    pub estimated: bool,
    /// What the page says of it, in lines below its name.
    pub about: Vec<String>,
    /// The rows that it leads to on the page.
    pub rows: Option<Rows>,
}

impl Point {
    /// A point with a name.
    pub fn new(name: impl Into<String>, x: f64, y: f64) -> Self {
        Self { name: name.into(), x, y, ..Self::default() }
    }
}

/// Points of one name.
///
/// ```
/// use featherbench_report::figure::{Point, Series, style};
///
/// let series = Series::new("drake", style("drake"), vec![Point::new("arm", 7.0, 1e-15)]);
/// assert!(series.points[0].rows.is_none() && series.level.is_none());
/// ```
#[derive(Clone, Debug, Default)]
pub struct Series {
    /// The name in the legend.
    pub name: String,
    /// Colour and mark.
    pub style: Style,
    /// How its points are joined.
    pub line: Line,
    /// The dashes of its line, an index; zero is none.
    pub dash: usize,
    /// The points. Those without a place on an axis are in the data alone.
    pub points: Vec<Point>,
    /// The way of its line, if it does not go through all points.
    pub path: Option<Vec<[f64; 2]>>,
    /// A broad pale line, for fits and fronts.
    pub broad: Vec<[f64; 2]>,
    /// A level from edge to edge, which is no value of its own.
    pub level: Option<f64>,
}

impl Series {
    /// Points that are joined by straight lines.
    pub fn new(name: impl Into<String>, style: Style, points: Vec<Point>) -> Self {
        Self { name: name.into(), style, points, ..Self::default() }
    }

    /// A level from edge to edge, dotted.
    pub fn level(name: impl Into<String>, value: f64) -> Self {
        Self { name: name.into(), style: Style::NEUTRAL, dash: 2, level: Some(value), ..Self::default() }
    }
}

/// A plot.
#[derive(Clone, Debug, Default)]
pub struct Plot {
    /// What it shows.
    pub title: String,
    /// The axis across.
    pub x: Axis,
    /// The axis upwards.
    pub y: Axis,
    /// Its series.
    pub series: Vec<Series>,
    /// Grey bands along the axis across, each from one value of the other axis to another.
    pub bands: Vec<[f64; 2]>,
}

impl Plot {
    /// A plot with nothing behind its series.
    pub fn new(title: impl Into<String>, x: Axis, y: Axis, series: Vec<Series>) -> Self {
        Self { title: title.into(), x, y, series, bands: Vec::new() }
    }

    /// The points that have a place, with their series.
    pub(super) fn shown(&self) -> impl Iterator<Item = (&Series, &Point)> {
        let points = self.series.iter().flat_map(|series| series.points.iter().map(move |point| (series, point)));
        points.filter(|(_, point)| self.x.fits(point.x) && self.y.fits(point.y))
    }
}
