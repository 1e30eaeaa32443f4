//! Section: the engines' imports of the robots' own files, as a matrix of robots and engines, and the number of differences by cause.

use std::collections::BTreeMap;

use featherbench_results::{Row, Verdict};
use maud::{Markup, html};
use serde_json::Value;

use crate::labels;
use crate::numbers::{count, larger, short};
use crate::overview::Overview;

/// The study whose rows the section shows.
const READING: &str = "import";

/// The result of one robot in one engine.
#[derive(Default)]
struct Cell<'a> {
    /// The row that counts the differences, or says why there is no import.
    read: Option<&'a Row>,
    /// The row that counts the parts that the differences do not explain.
    unexplained: Option<&'a Row>,
    /// The largest error of inverse dynamics and mass matrix of the imported robot, against the reference import.
    error: Option<f64>,
}

/// The effect of rounding, if a run's rows do not give it.
const SHALLOW: f64 = 1e-12;

impl Cell<'_> {
    /// The effect of rounding on M and inverse dynamics of this robot. The study gives it beside its replay, as it grows with the depth.
    fn bound(&self) -> f64 {
        let said = self.unexplained.and_then(|row| serde_json::from_str::<Value>(&row.params).ok()?["gate"].as_f64());
        said.unwrap_or(SHALLOW)
    }

    /// Whether the answers about the imported robot are those of the reference. A NaN is not.
    fn agrees(&self) -> Option<bool> {
        self.error.map(|error| error <= self.bound())
    }
}

/// The data of the section.
pub struct Imports<'a> {
    engines: Vec<usize>,
    models: Vec<usize>,
    cells: BTreeMap<(usize, usize), Cell<'a>>,
    /// Cause and field → engine → how many.
    causes: BTreeMap<(String, String), BTreeMap<usize, usize>>,
}

impl<'a> Imports<'a> {
    /// Collects the rows of imports.
    pub fn of(overview: &Overview, records: &'a [Row]) -> Self {
        let mut readings = Self { engines: Vec::new(), models: Vec::new(), cells: BTreeMap::new(), causes: BTreeMap::new() };
        for row in records.iter().filter(|row| row.study == READING) {
            let (Some(model), Some(engine)) = (overview.model(&row.robot), overview.engine(&row.engine)) else { continue };
            if !readings.models.contains(&model) {
                readings.models.push(model);
            }
            if !readings.engines.contains(&engine) {
                readings.engines.push(engine);
            }
            let cell = readings.cells.entry((model, engine)).or_default();
            match row.metric.as_str() {
                "differences" if row.quantity == READING => cell.read = Some(row),
                "unexplained" => cell.unexplained = Some(row),
                "as_read" => cell.error = row.value.map(|value| larger(cell.error.unwrap_or(0.0), value)).or(cell.error),
                "difference" => {
                    let params: Value = serde_json::from_str(&row.params).unwrap_or_default();
                    let cause = params["cause"].as_str().unwrap_or_default().to_owned();
                    *readings.causes.entry((cause, row.quantity.clone())).or_default().entry(engine).or_default() += 1;
                }
                _ => {}
            }
        }
        readings.engines.sort_unstable();
        readings
    }

    /// Whether the run had no imports.
    pub fn is_empty(&self) -> bool {
        self.models.is_empty()
    }
}

/// Writes the section, if the run had imports.
pub fn section(overview: &Overview, readings: &Imports) -> Markup {
    if readings.is_empty() {
        return html! {};
    }
    html! {
        section #import {
            h2 { "How engines read it" }
            p.lead {
                "Every engine's own parser reads the robot's file, and what it then holds is compared body by body with the reference: "
                "our reading of URDF, that of MuJoCo's compiler of MJCF. That is another question than whether engines compute alike from "
                "one model. A number counts the differences that a simulation feels; click it to see them with their causes."
            }
            (summary(overview, readings))
            div.scroll.tall { (matrix(overview, readings)) }
            p.note {
                span.legend.d0 { "✓" } " alike, "
                span.legend.d2 { "n" } " differences, of which nothing enters M or inverse dynamics beyond rounding (1e-12, and 1e-14 per joint of a chain beyond a hundred), "
                span.legend.d5 { "n" } " differences that do, "
                "– not read, "
                span.legend.unexplained { "?" } " answers that the differences do not explain. "
                "The answers are replayed: the engine computes with what it read, our kernels with what it says to have read."
            }
            div #import-details role="region" aria-live="polite" tabindex="-1" {}
            h3 { "Causes" }
            (causes(overview, readings))
        }
    }
}

fn summary(overview: &Overview, readings: &Imports) -> Markup {
    let of = |engine: usize| readings.cells.iter().filter(move |((_, e), _)| *e == engine).map(|(_, cell)| cell);
    let value = |cell: &Cell| cell.read.and_then(|row| row.value);
    html! {
        table.compact {
            thead {
                tr {
                    th scope="col" { "engine" } th.number scope="col" { "files read" } th.number scope="col" { "alike" }
                    th.number scope="col" { "M and inverse dynamics within rounding" } th.number scope="col" { "not read" } th.number scope="col" { "unexplained" }
                }
            }
            tbody {
                @for &engine in &readings.engines {
                    tr {
                        th scope="row" { (overview.engines[engine]) }
                        td.number { (of(engine).filter(|cell| value(cell).is_some()).count()) }
                        td.number { (of(engine).filter(|cell| value(cell) == Some(0.0)).count()) }
                        td.number { (of(engine).filter(|cell| cell.agrees() == Some(true)).count()) }
                        td.number { (of(engine).filter(|cell| value(cell).is_none()).count()) }
                        td.number { (of(engine).filter(|cell| unexplained(cell)).count()) }
                    }
                }
            }
        }
    }
}

fn matrix(overview: &Overview, readings: &Imports) -> Markup {
    html! {
        table.compact.reading {
            thead { tr { th scope="col" { "robot" } @for &engine in &readings.engines { th.number scope="col" { (overview.engines[engine]) } } } }
            tbody {
                @for &model in &readings.models {
                    tr {
                        th scope="row" { (overview.models[model].name) }
                        @for &engine in &readings.engines {
                            @match readings.cells.get(&(model, engine)) {
                                Some(cell) => (entry(overview, model, engine, cell)),
                                None => td.number {},
                            }
                        }
                    }
                }
            }
        }
    }
}

fn entry(overview: &Overview, model: usize, engine: usize, cell: &Cell) -> Markup {
    let read = cell.read.and_then(|row| row.value);
    let text = match read {
        Some(0.0) => "✓".to_owned(),
        Some(many) => format!("{many}"),
        None => "–".to_owned(),
    };
    let class = match (read, cell.agrees()) {
        (None, _) => "none",
        (Some(0.0), Some(true)) => "d0",
        (_, Some(true)) => "d2",
        _ => "d5",
    };
    let about = match (read, cell.error, cell.read) {
        (None, _, Some(row)) => row.reason.clone(),
        (_, Some(error), _) => format!("M or inverse dynamics off by {}", short(error)),
        _ => String::new(),
    };
    html! {
        td class={ "number " (class) } title=(about) {
            button.open type="button" data-reading=(format!("model-{model}")) data-engine=(overview.engines[engine]) {
                (text) @if unexplained(cell) { span.unexplained { "?" } }
            }
        }
    }
}

/// Whether the differences do not explain the engine's answers, or that is not known.
fn unexplained(cell: &Cell) -> bool {
    cell.unexplained.is_some_and(|row| row.verdict == Verdict::Error || row.value.is_some_and(|value| value > 0.0))
}

fn causes(overview: &Overview, readings: &Imports) -> Markup {
    if readings.causes.is_empty() {
        return html! { p.empty { "There is no difference." } };
    }
    html! {
        div.scroll {
            table.compact.sortable {
                thead {
                    tr {
                        th scope="col" { "cause" } th scope="col" { "field" }
                        @for &engine in &readings.engines { th.number scope="col" { (overview.engines[engine]) } }
                    }
                }
                tbody {
                    @for ((cause, field), engines) in &readings.causes {
                        tr {
                            td { (labels::cause(cause)) }
                            td { (field.replace('_', " ")) }
                            @for engine in &readings.engines { td.number { @if let Some(many) = engines.get(engine) { (many) } } }
                        }
                    }
                }
            }
        }
        p.note { (count(readings.causes.values().flat_map(BTreeMap::values).sum(), "difference")) " in all, those included that are information only." }
    }
}
