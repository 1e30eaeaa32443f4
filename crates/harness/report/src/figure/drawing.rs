//! Drawings on the page.

use maud::{Markup, PreEscaped, html};

use super::draw::draw;
use super::file;
use super::plot::Plot;

impl Plot {
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
                    Some((size, body)) => div.paper { (PreEscaped(file(&self.title, size, body))) },
                    None => p.empty { (empty) },
                }
            }
        }
    }
}
