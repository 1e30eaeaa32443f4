//! Whether an engine that was asked for takes part at all.

use crate::oracles::engines::Opened;
use ::featherbench_results::{Culprit, Expectation, GateKind, Row};
use featherbench_bench::{Cell, Quantity};
use std::collections::BTreeSet;

/// One condition for each engine that was asked for and answered to its name: its `hello` offers something that the suite asks, and in a
/// whole run it answers about some robot. Without it an engine without methods would be green for want of rows.
///
/// `cells` are those of all studies, whatever a filter leaves.
pub fn conditions(opened: &Opened, asked: &[&str], cells: &[Cell], records: &[Row], complete: bool) -> Vec<Expectation> {
    let there = opened.infos.iter().filter(|engine| engine.status == "ok" && asked.contains(&engine.name.as_str()));
    there.map(|engine| condition(&engine.name, cells, records, complete)).collect()
}

fn condition(engine: &str, cells: &[Cell], records: &[Row], complete: bool) -> Expectation {
    let readback = Quantity::Readback.name();
    let of_dynamics = || cells.iter().filter(|cell| cell.study != "repeatability" && cell.quantity != readback);
    let offered: BTreeSet<&str> = of_dynamics().filter(|cell| cell.engine == engine).map(|cell| cell.quantity.as_str()).collect();
    let is_answer = |row: &&Row| row.engine == engine && row.value.is_some() && row.quantity != readback;
    let answered = records.iter().any(|row| is_answer(&row));
    let reason = if offered.is_empty() {
        let due: BTreeSet<&str> = of_dynamics().map(|cell| cell.quantity.as_str()).collect();
        let due: Vec<&str> = due.into_iter().collect();
        format!("its hello names no method for any quantity that the suite asks: {}", due.join(", "))
    } else if complete && !answered {
        let said = records.iter().find(|row| row.engine == engine && !row.reason.is_empty()).map_or("no row", |row| &row.reason);
        format!("it has no number for any robot; the first reason: {said}")
    } else {
        String::new()
    };
    let what = format!("engine {engine} answers something that the suite asks");
    Expectation::new(GateKind::Engine, what, 1, u64::from(reason.is_empty())).because(reason).about(Culprit::engine(engine))
}
