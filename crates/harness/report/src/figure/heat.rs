//! Heatmaps of ratios: a number in each cell, and a colour that says on which side of 1 it is.

use maud::html;

use super::paper::{Figure, at, csv_line, file, width};
use crate::numbers::larger;

/// Width and height of a cell.
const CELL: [f64; 2] = [74.0, 26.0];
/// Above 1, from near to far.
const ABOVE: [&str; 3] = ["#e4eef8", "#c6dcf1", "#9cc3e6"];
/// Below 1.
const BELOW: [&str; 2] = ["#fbe3d0", "#f6bd91"];
/// Ratios nearer to 1 have no colour.
const ALIKE: f64 = 0.02;

/// A table of ratios.
#[derive(Clone, Debug)]
pub struct Heat {
    /// What it shows.
    pub title: String,
    /// The meaning of a ratio, for the data.
    pub unit: String,
    /// Names of the rows.
    pub rows: Vec<String>,
    /// Names of the columns.
    pub columns: Vec<String>,
    /// The ratios, row by row.
    pub cells: Vec<Vec<Option<f64>>>,
}

impl Heat {
    /// Draws it; `None` without a number.
    pub fn figure(self, name: &'static str, caption: String) -> Option<Figure> {
        if !self.cells.iter().flatten().any(Option::is_some) {
            return None;
        }
        let longest = |names: &[String]| names.iter().map(|name| width(name, 12.0)).fold(0.0, larger);
        // The names of columns are turned by 35°.
        let angle = 35.0_f64.to_radians();
        let (left, top) = (longest(&self.rows) + 18.0, longest(&self.columns) * angle.sin() + 20.0);
        let over = longest(&self.columns) * angle.cos();
        let size =
            [left + CELL[0] * self.columns.len() as f64 + over - CELL[0] / 2.0 + 10.0, top + CELL[1] * self.rows.len() as f64 + 10.0];
        let x = |column: usize| left + CELL[0] * column as f64;
        let y = |row: usize| top + CELL[1] * row as f64;
        let body = html! {
            @for (column, name) in self.columns.iter().enumerate() {
                text transform={ "translate(" (at(x(column) + CELL[0] / 2.0)) " " (at(top - 8.0)) ") rotate(-35)" } font-size="12" { (name) }
            }
            @for (row, name) in self.rows.iter().enumerate() {
                text x=(at(left - 10.0)) y=(at(y(row) + 17.0)) text-anchor="end" font-size="12" { (name) }
                @for (column, cell) in self.cells.get(row).into_iter().flatten().enumerate() {
                    rect.cell x=(at(x(column))) y=(at(y(row))) width=(at(CELL[0] - 2.0)) height=(at(CELL[1] - 2.0)) fill=(colour(*cell)) {}
                    text x=(at(x(column) + CELL[0] / 2.0 - 1.0)) y=(at(y(row) + 17.0)) text-anchor="middle" font-size="12" {
                        @match cell { Some(ratio) => (if *ratio >= 10.0 { format!("{ratio:.0}") } else { format!("{ratio:.2}") }), None => "–" }
                    }
                }
            }
        };
        let svg = file(&self.title, size, body);
        let csv = self.csv();
        Some(Figure { name, title: self.title, caption, size, svg, csv })
    }

    fn csv(&self) -> String {
        let mut text = csv_line(["row", "column", &self.unit]);
        for (row, cells) in self.rows.iter().zip(&self.cells) {
            for (column, ratio) in self.columns.iter().zip(cells) {
                if let Some(ratio) = ratio {
                    text += &csv_line([row.as_str(), column, &ratio.to_string()]);
                }
            }
        }
        text
    }
}

fn colour(ratio: Option<f64>) -> &'static str {
    match ratio {
        Some(ratio) if ratio < 0.67 => BELOW[1],
        Some(ratio) if ratio < 1.0 - ALIKE => BELOW[0],
        Some(ratio) if ratio > 3.0 => ABOVE[2],
        Some(ratio) if ratio > 1.5 => ABOVE[1],
        Some(ratio) if ratio > 1.0 + ALIKE => ABOVE[0],
        _ => "#f5f7f9",
    }
}
