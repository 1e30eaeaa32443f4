//! Plots as figures for papers, and as drawings on the page.

use maud::{Markup, PreEscaped, html};

use super::draw::draw;
use super::paper::{Figure, csv_line, file, inline};
use super::plot::Plot;

impl Plot {
    /// Draws it; `None` if no point has a place.
    pub fn figure(self, name: &'static str, caption: String) -> Option<Figure> {
        self.figure_with(name, caption, &[])
    }

    /// The same with events: a vertical line at a place of the axis across, and what happened there.
    pub fn figure_with(self, name: &'static str, caption: String, events: &[(f64, String)]) -> Option<Figure> {
        let (size, body) = draw(&self, events, false)?;
        let svg = file(&self.title, size, body);
        let csv = self.csv();
        Some(Figure { name, title: self.title, caption, size, svg, csv })
    }

    /// The plot as it stands in a section: the drawing, and with each mark its words, its values and the rows that it leads to. The name is
    /// one that no other drawing of the page has at the same time. Without a point it says `empty`.
    ///
    /// ```
    /// use featherbench_report::figure::{Axis, Plot, Point, Series, style};
    ///
    /// let series = Series::new("drake", style("drake"), vec![Point::new("arm", 7.0, 1e-15)]);
    /// let plot = Plot::new("Error", Axis::log("n"), Axis::log("error"), vec![series]);
    /// assert!(plot.drawing("error", "nothing was measured").0.contains("<title>arm</title>"));
    /// ```
    pub fn drawing(&self, name: &str, empty: &str) -> Markup {
        html! {
            div.drawing data-name=(name) {
                @match draw(self, &[], true) {
                    Some((size, body)) => div.paper { (PreEscaped(inline(&self.title, size, body))) },
                    None => p.empty { (empty) },
                }
            }
        }
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
