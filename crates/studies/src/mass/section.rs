//! Section: the mass of each robot.

use featherbench_report::numbers::short;
use featherbench_report::{Overview, Section};
use featherbench_results::{Row, RunInfo};
use maud::html;

/// Makes the section, if the run has masses.
pub(crate) fn sections<'a>(_: &RunInfo, rows: &'a [Row], _: &Overview<'a>) -> Vec<Section> {
    let masses: Vec<&Row> = rows.iter().filter(|row| row.study == "mass").collect();
    if masses.is_empty() {
        return Vec::new();
    }
    let body = html! {
        section #mass {
            h2 { "Mass" }
            table.compact {
                thead { tr { th scope="col" { "robot" } th.number scope="col" { "kg" } } }
                tbody { @for row in &masses { tr { th scope="row" { (row.robot) } td.number { (short(row.value.unwrap_or(f64::NAN))) } } } }
            }
        }
    };
    vec![Section::new("mass", "Mass", body)]
}
