//! The rows of the heatmap: by robot and engine, and of each engine by robot and quantity.

use std::collections::{BTreeMap, BTreeSet};

use featherbench_report::map::{Map, engine_heads, quantity_head, robot_heads};
use featherbench_report::{Overview, labels};
use featherbench_results::Row;
use serde::Serialize;

use super::{PAIRWISE, STUDY};

/// The heatmap.
#[derive(Debug)]
pub struct Cells<'a> {
    /// The quantities, in the order of the page.
    pub quantities: Vec<&'a str>,
    /// Robot × engine: the worst row over all quantities.
    pub whole: Map<'a>,
    /// Robot × quantity of each engine that has rows, by its index.
    pub engines: BTreeMap<usize, Map<'a>>,
}

impl<'a> Cells<'a> {
    /// Groups a run's rows.
    pub fn of(overview: &Overview<'a>, rows: &'a [Row]) -> Self {
        let judged: Vec<&Row> = rows.iter().filter(|row| in_heatmap(row)).collect();
        let named = || judged.iter().copied().filter(|row| !row.quantity.is_empty());
        let mut quantities: Vec<&str> = named().map(|row| row.quantity.as_str()).collect::<BTreeSet<_>>().into_iter().collect();
        quantities.sort_by_key(|name| labels::quantity_rank(name));

        let mut whole = Map {
            id: "heat".into(),
            label: "Margin to the gate by robot and engine".into(),
            axes: ["robot", "engine"],
            filters: vec![("study", STUDY.into())],
            lines: robot_heads(overview),
            columns: engine_heads(overview),
            cells: BTreeMap::new(),
            named: true,
        };
        let mut engines: BTreeMap<usize, Map> = BTreeMap::new();
        for &row in &judged {
            let (Some(robot), Some(engine)) = (overview.robot(&row.robot), overview.engine(&row.engine)) else { continue };
            whole.add((robot, engine), row);
            let of_engine = engines.entry(engine).or_insert_with(|| Map {
                id: format!("heat-{engine}"),
                label: format!("Margin to the gate by robot and quantity: {}", row.engine),
                axes: ["robot", "quantity"],
                filters: vec![("study", STUDY.into()), ("engine", row.engine.clone())],
                lines: robot_heads(overview),
                columns: quantities.iter().map(|quantity| quantity_head(quantity)).collect(),
                cells: BTreeMap::new(),
                named: false,
            });
            if let Some(quantity) = quantities.iter().position(|&name| name == row.quantity) {
                of_engine.add((robot, quantity), row);
            }
        }
        // A row without a quantity is about the whole robot: it stands in each column of its engine, or in one of its own if there is no other.
        for &row in judged.iter().filter(|row| row.quantity.is_empty()) {
            let (Some(robot), Some(engine)) = (overview.robot(&row.robot), overview.engine(&row.engine)) else { continue };
            let Some(map) = engines.get_mut(&engine) else { continue };
            let mut shown: BTreeSet<usize> = map.cells.keys().map(|&(_, column)| column).collect();
            if shown.is_empty() {
                map.columns.push(quantity_head(""));
                shown.insert(map.columns.len() - 1);
            }
            shown.into_iter().for_each(|column| map.add((robot, column), row));
        }
        // Rows of the whole robot have no quantity to filter by.
        for map in engines.values_mut() {
            map.columns.iter_mut().for_each(|head| head.filters.retain(|(_, value)| !value.is_empty()));
        }
        Self { quantities, whole, engines }
    }

    /// The data for the scripts.
    pub fn data(&self) -> Data<'_> {
        Data { quantities: self.quantities.iter().map(|&name| [name, labels::quantity(name)]).collect() }
    }
}

/// The quantities for the scripts, each with its name and its text.
#[derive(Serialize)]
pub struct Data<'a> {
    quantities: Vec<[&'a str; 2]>,
}

/// Whether a row is about one engine's answer for one robot, with a verdict or a known deviation.
fn in_heatmap(row: &Row) -> bool {
    row.study == STUDY && row.metric != PAIRWISE && !row.robot.is_empty()
}
