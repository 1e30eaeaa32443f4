//! The rows of the heatmap by robot, engine and quantity.

use std::collections::{BTreeMap, BTreeSet};

use featherbench_report::{Overview, Tally, labels, worst_first};
use featherbench_results::{Row, Verdict};
use serde::Serialize;

use super::{PAIRWISE, STUDY};

/// All rows of one robot, engine and quantity.
#[derive(Clone, Debug)]
pub struct Cell<'a> {
    /// Their verdicts.
    pub tally: Tally,
    /// The row that decides: of the worst verdict, the one with the smallest margin.
    pub worst: &'a Row,
}

/// The heatmap.
#[derive(Debug)]
pub struct Cells<'a> {
    /// The columns: engine and quantity, as indices.
    pub columns: Vec<(usize, usize)>,
    /// The quantities, in the order of the page.
    pub quantities: Vec<&'a str>,
    /// The cells by robot, engine and quantity.
    pub cells: BTreeMap<(usize, usize, usize), Cell<'a>>,
}

impl<'a> Cells<'a> {
    /// Groups a run's rows.
    pub fn of(overview: &Overview<'a>, rows: &'a [Row]) -> Self {
        let judged: Vec<&Row> = rows.iter().filter(|row| in_heatmap(row)).collect();
        let named = judged.iter().filter(|row| !row.quantity.is_empty());
        let mut quantities: Vec<&str> = named.clone().map(|row| row.quantity.as_str()).collect::<BTreeSet<_>>().into_iter().collect();
        quantities.sort_by_key(|name| labels::quantity_rank(name));

        let quantity_index = |name: &str| quantities.iter().position(|&quantity| quantity == name);
        let mut cells: BTreeMap<(usize, usize, usize), Cell> = BTreeMap::new();
        for row in named {
            if let (Some(robot), Some(engine), Some(quantity)) =
                (overview.robot(&row.robot), overview.engine(&row.engine), quantity_index(&row.quantity))
            {
                cells.entry((robot, engine, quantity)).or_insert_with(|| Cell::empty(row)).add(row);
            }
        }
        let mut columns: BTreeSet<(usize, usize)> = cells.keys().map(|&(_, engine, quantity)| (engine, quantity)).collect();

        // A row without a quantity is about the whole robot: it fills the gaps. An engine without other rows has one column.
        for row in judged.iter().filter(|row| row.quantity.is_empty()) {
            let (Some(robot), Some(engine)) = (overview.robot(&row.robot), overview.engine(&row.engine)) else { continue };
            if !columns.iter().any(|&(other, _)| other == engine) {
                let whole = quantities.iter().position(|name| name.is_empty()).unwrap_or(quantities.len());
                if whole == quantities.len() {
                    quantities.push("");
                }
                columns.insert((engine, whole));
            }
            for &(_, quantity) in columns.iter().filter(|&&(other, _)| other == engine) {
                cells.entry((robot, engine, quantity)).or_insert_with(|| Cell::empty(row)).add(row);
            }
        }
        Self { columns: columns.into_iter().collect(), quantities, cells }
    }

    /// The data for the script.
    pub fn data(&self) -> CellsData<'_> {
        let cells = self.cells.iter().map(|(&(robot, engine, quantity), cell)| {
            let row = cell.worst;
            CellData {
                at: [robot, engine, quantity],
                verdict: cell.tally.verdict(),
                rows: cell.tally.words(),
                margin: row.margin,
                value: row.value,
                bound: row.bound,
                worst: [&row.metric, &row.states, &row.method, &row.reason],
            }
        });
        CellsData {
            quantities: self.quantities.iter().map(|&name| [name, labels::quantity(name)]).collect(),
            columns: &self.columns,
            cells: cells.collect(),
        }
    }
}

/// The heatmap for the script; a quantity has its name and its text.
#[derive(Serialize)]
pub struct CellsData<'a> {
    quantities: Vec<[&'a str; 2]>,
    columns: &'a [(usize, usize)],
    cells: Vec<CellData<'a>>,
}

/// A cell for the script.
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
        if worst_first(row) < worst_first(self.worst) {
            self.worst = row;
        }
    }
}

/// Whether a row is about one engine's answer for one robot, with a verdict or a known deviation.
fn in_heatmap(row: &Row) -> bool {
    row.study == STUDY && row.metric != PAIRWISE && !row.robot.is_empty()
}
