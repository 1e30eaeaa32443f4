//! Engines of a run that offer nothing of what a study asks: a row each, which says so. Without it the study would be silent about them.

use crate::{Cell, Context, OWN, Study};
use featherbench_results::{Row, Verdict};
use serde_json::json;
use std::collections::BTreeSet;

/// What such a row is about: all that the study asks.
const ALL: &str = "all";

/// The rows of a study; `planned` are the engines that have cells in its whole plan.
pub(crate) fn rows(study: &dyn Study, context: &Context, planned: &BTreeSet<String>, keep: &dyn Fn(&Cell) -> bool) -> Vec<Row> {
    // A study of the suite's robots asks nothing where it has none.
    if planned.is_empty() && !context.robots.iter().any(|robot| robot.takes(study.name())) {
        return Vec::new();
    }
    let silent = context.engines.iter().filter(|engine| {
        let name = &engine.identity().name;
        name != OWN && !planned.contains(name) && study.asks(engine.as_ref())
    });
    let of = |(name, version): (&str, &str)| {
        let cell = Cell::of_case(study.name(), ALL, (name, version), "", "", json!({}));
        let blank = Row {
            cell: cell.id(),
            study: cell.study.clone(),
            family: ALL.into(),
            engine: name.into(),
            engine_version: version.into(),
            params: "{}".into(),
            ..Row::default()
        };
        let reason = format!("{name} has nothing that the study {} asks about the robots of this suite", study.name());
        keep(&cell).then(|| blank.without_value(Verdict::Skip, reason))
    };
    silent.map(|engine| engine.identity()).filter_map(|identity| of((&identity.name, &identity.version))).collect()
}
