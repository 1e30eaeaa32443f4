//! The contents of the run, and its rows grouped by model × engine × quantity.

use std::collections::{BTreeMap, BTreeSet};

use featherbench_results::{Row, RunInfo, Verdict};
use serde::Serialize;

use crate::labels;
use crate::tally::{Tally, gravity};

/// The study whose rows make the heatmap.
pub const AGREEMENT: &str = "agreement";
/// The study whose rows are times.
pub const TIMING: &str = "timing";
/// The study whose rows compare with the truth.
pub const ACCURACY: &str = "accuracy";
/// The study whose rows are condition numbers.
pub const CONDITIONING: &str = "conditioning";
/// The study whose rows are reproductions of known deviations.
pub const REPRODUCTIONS: &str = "reproductions";
/// The study of small steps.
pub const STEPS: &str = "steps";
/// The engine of rows about all engines together.
pub const EVERYONE: &str = "all";
/// The metric of rows that compare two engines with each other.
pub const PAIRWISE: &str = "pairwise";

/// A model on the page.
#[derive(Clone, Debug, Serialize)]
pub struct Model<'a> {
    /// Its name.
    pub name: &'a str,
    /// Its family.
    pub family: &'a str,
    /// Degrees of freedom.
    pub nv: Option<u64>,
    /// Moving bodies.
    pub bodies: Option<u64>,
    /// Longest path.
    pub depth: Option<u64>,
}

/// All rows of one model, engine and quantity.
#[derive(Clone, Debug)]
pub struct Cell<'a> {
    /// Their verdicts.
    pub tally: Tally,
    /// The row that decides: of the worst verdict, the one with the smallest margin.
    pub worst: &'a Row,
}

/// The run's vocabulary, each list in the order of the page, and its heatmap.
#[derive(Debug)]
pub struct Overview<'a> {
    /// Names of the engines, also of those that failed to answer.
    pub engines: Vec<&'a str>,
    /// Models, families together.
    pub models: Vec<Model<'a>>,
    /// Studies, in alphabetical order.
    pub studies: Vec<&'a str>,
    /// The heatmap's columns: engine and quantity, as indices.
    pub columns: Vec<(usize, usize)>,
    /// Quantities of the heatmap.
    pub quantities: Vec<&'a str>,
    /// The heatmap's cells by model, engine and quantity.
    pub cells: BTreeMap<(usize, usize, usize), Cell<'a>>,
    model_index: BTreeMap<&'a str, usize>,
}

impl<'a> Overview<'a> {
    /// Groups a run's rows.
    pub fn of(run: &'a RunInfo, records: &'a [Row]) -> Self {
        let met = records.iter().map(|row| row.engine.as_str()).filter(|&name| name != EVERYONE);
        let engines = in_order(run.engines.iter().map(|engine| engine.name.as_str()), met);
        let models = models(run, records);
        let model_index: BTreeMap<&str, usize> = models.iter().enumerate().map(|(index, model)| (model.name, index)).collect();
        let studies: BTreeSet<&str> = records.iter().map(|row| row.study.as_str()).collect();

        let judged: Vec<&Row> = records.iter().filter(|row| in_heatmap(row)).collect();
        let named = judged.iter().filter(|row| !row.quantity.is_empty());
        let mut quantities: Vec<&str> = named.clone().map(|row| row.quantity.as_str()).collect::<BTreeSet<_>>().into_iter().collect();
        quantities.sort_by_key(|name| labels::quantity_rank(name));

        let engine_index = |name: &str| engines.iter().position(|&engine| engine == name);
        let quantity_index = |name: &str| quantities.iter().position(|&quantity| quantity == name);
        let mut cells: BTreeMap<(usize, usize, usize), Cell> = BTreeMap::new();
        for row in named {
            if let (Some(&model), Some(engine), Some(quantity)) =
                (model_index.get(row.robot.as_str()), engine_index(&row.engine), quantity_index(&row.quantity))
            {
                cells.entry((model, engine, quantity)).or_insert_with(|| Cell::empty(row)).add(row);
            }
        }
        let mut columns: BTreeSet<(usize, usize)> = cells.keys().map(|&(_, engine, quantity)| (engine, quantity)).collect();

        // A row without a quantity is about the whole model: it fills the gaps. An engine without other rows has one column.
        for row in judged.iter().filter(|row| row.quantity.is_empty()) {
            let (Some(&model), Some(engine)) = (model_index.get(row.robot.as_str()), engine_index(&row.engine)) else { continue };
            if !columns.iter().any(|&(other, _)| other == engine) {
                let whole = quantities.iter().position(|name| name.is_empty()).unwrap_or(quantities.len());
                if whole == quantities.len() {
                    quantities.push("");
                }
                columns.insert((engine, whole));
            }
            for &(_, quantity) in columns.iter().filter(|&&(other, _)| other == engine) {
                cells.entry((model, engine, quantity)).or_insert_with(|| Cell::empty(row)).add(row);
            }
        }
        let columns = columns.into_iter().collect();
        Self { engines, models, studies: studies.into_iter().collect(), columns, quantities, cells, model_index }
    }

    /// The index of a model, by which its rows are found.
    pub fn model(&self, name: &str) -> Option<usize> {
        self.model_index.get(name).copied()
    }

    /// The index of an engine.
    pub fn engine(&self, name: &str) -> Option<usize> {
        self.engines.iter().position(|&engine| engine == name)
    }

    /// The name of the chunk with a row: its model's, or its study's if it has no model.
    pub fn chunk_of(&self, row: &Row) -> String {
        match self.model(&row.robot) {
            Some(model) => format!("model-{model}"),
            None => format!("study-{}", self.studies.iter().position(|&study| study == row.study).unwrap_or_default()),
        }
    }

    /// The data that the page's script needs first.
    pub fn data(&self) -> OverviewData<'_> {
        let cells = self.cells.iter().map(|(&(model, engine, quantity), cell)| {
            let row = cell.worst;
            CellData {
                at: [model, engine, quantity],
                verdict: cell.tally.verdict(),
                rows: cell.tally.words(),
                margin: row.margin,
                value: row.value,
                bound: row.bound,
                worst: [&row.metric, &row.states, &row.method, &row.reason],
            }
        });
        OverviewData {
            engines: &self.engines,
            models: &self.models,
            quantities: self.quantities.iter().map(|&name| [name, labels::quantity(name)]).collect(),
            columns: &self.columns,
            cells: cells.collect(),
        }
    }
}

/// The data of the run for the script.
#[derive(Serialize)]
pub struct OverviewData<'a> {
    engines: &'a [&'a str],
    models: &'a [Model<'a>],
    quantities: Vec<[&'a str; 2]>,
    columns: &'a [(usize, usize)],
    cells: Vec<CellData<'a>>,
}

/// The data of a cell for the script.
#[derive(Serialize)]
struct CellData<'a> {
    at: [usize; 3],
    verdict: Verdict,
    rows: String,
    margin: Option<f64>,
    value: Option<f64>,
    bound: Option<f64>,
    worst: [&'a str; 4],
}

impl<'a> Cell<'a> {
    fn empty(row: &'a Row) -> Self {
        Self { tally: Tally::default(), worst: row }
    }

    fn add(&mut self, row: &'a Row) {
        self.tally.add(row.verdict);
        if severity(row) < severity(self.worst) {
            self.worst = row;
        }
    }
}

/// Orders rows from the worst: by verdict, then by margin. A failure without a margin is the worst.
pub fn severity(row: &Row) -> (usize, i64) {
    let unknown = if matches!(row.verdict, Verdict::Fail | Verdict::Error) { i64::MIN } else { i64::MAX };
    // Margins are within ±16: millionths of decades order them like the numbers themselves.
    (gravity(row.verdict), row.margin.map_or(unknown, |margin| (margin * 1e6) as i64))
}

/// Whether a row is about one engine's answer for one model, with a verdict or a known deviation.
fn in_heatmap(row: &Row) -> bool {
    row.study == AGREEMENT && row.metric != PAIRWISE && !row.robot.is_empty()
}

/// The announced names, then the others in alphabetical order.
fn in_order<'a>(announced: impl Iterator<Item = &'a str>, met: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut names: Vec<&str> = Vec::new();
    for name in announced {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let met: BTreeSet<&str> = met.filter(|name| !name.is_empty()).collect();
    let others: Vec<&str> = met.into_iter().filter(|name| !names.contains(name)).collect();
    names.extend(others);
    names
}

/// Every model that is announced or has rows: families together, otherwise in the order of the announcement.
fn models<'a>(run: &'a RunInfo, records: &'a [Row]) -> Vec<Model<'a>> {
    let mut first_rows: BTreeMap<&str, &Row> = BTreeMap::new();
    for row in records.iter().filter(|row| !row.robot.is_empty()) {
        // The agreement study gives the family; a timing row of the same model may have another.
        let entry = first_rows.entry(&row.robot).or_insert(row);
        if entry.study != AGREEMENT && row.study == AGREEMENT {
            *entry = row;
        }
    }
    let names = in_order(run.models.iter().map(|model| model.name.as_str()), first_rows.keys().copied());
    let announced: BTreeMap<&str, _> = run.models.iter().map(|model| (model.name.as_str(), model)).collect();
    let mut models: Vec<Model> = names
        .into_iter()
        .map(|name| {
            let row = first_rows.get(name);
            let info = announced.get(name);
            let size = |of_info: fn(&featherbench_results::ModelInfo) -> u64, of_row: fn(&Row) -> Option<u64>| {
                info.map(|info| of_info(info)).or_else(|| row.and_then(|row| of_row(row)))
            };
            Model {
                name,
                family: row.map_or_else(|| info.map_or("", |info| info.origin.as_str()), |row| row.family.as_str()),
                nv: size(|info| info.nv, |row| row.nv),
                bodies: size(|info| info.bodies, |row| row.bodies),
                depth: size(|info| info.depth, |row| row.depth),
            }
        })
        .collect();
    let mut families: Vec<&str> = Vec::new();
    for model in &models {
        if !families.contains(&model.family) {
            families.push(model.family);
        }
    }
    models.sort_by_key(|model| families.iter().position(|&family| family == model.family));
    models
}
