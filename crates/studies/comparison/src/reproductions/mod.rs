//! Reproductions: do the engines' known deviations still exist, and in their known size?
//!
//! `ci/deviations/ENGINE.toml` names each reproduction with the engine's version and the range of its value over twenty seeds. There are
//! two rows each: the smallest value over the seeds must not be below the range, and the largest must not be above it, each by more than [`SLACK`].
//! So a deviation that its engine has corrected fails the gate, and so does one that has grown. Then the list must be corrected.

pub(crate) mod section;
pub(crate) mod words;

use featherbench_bench::{Asked, Cell, Context, Finished, NoSettings, Outcome, Reproduction, SEEDS, SLACK, Study, hash};
use featherbench_results::{Relation, Row, Verdict};
use featherbench_study::{Entry, Reproduce, case_row};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The study of known deviations.
pub struct Reproductions {
    /// Evaluates a reproduction.
    pub reproduce: Reproduce,
}

/// The study in the registry.
pub const ENTRY: Entry = Entry {
    name: "reproductions",
    make: |setup| setup.made("reproductions", |_: NoSettings| Reproductions { reproduce: Arc::clone(&setup.reproduce) }),
    sections: section::sections,
    words: words::WORDS,
};

impl Study for Reproductions {
    fn name(&self) -> &'static str {
        "reproductions"
    }

    fn plan(&self, context: &Context) -> Vec<Cell> {
        let cell = |known: &Reproduction| {
            let Reproduction { name, engine, version, condition, measure, range, upstream, .. } = known;
            let [condition, measure, upstream] = [condition, measure, upstream].map(String::clone);
            let params = Params { condition, measure, range: *range, seeds: SEEDS, upstream };
            let cell = Cell::of_case(self.name(), name, (engine, version), "deviation", name, params);
            Cell { robot_hash: hash::of(name.as_bytes()), ..cell }
        };
        context.gates.reproductions().iter().map(cell).collect()
    }

    fn evaluate(&self, asked: &Asked) -> Outcome {
        (self.reproduce)(&asked.cell.robot, SEEDS).into()
    }

    fn compare_all(&self, context: &Context, finished: &[Finished]) -> Vec<Row> {
        let known = context.gates.reproductions();
        let of = |(cell, outcome): &Finished| {
            let reproduction = known.iter().find(|known| known.name == cell.robot)?;
            Some(rows(context, reproduction, cell, outcome))
        };
        finished.iter().filter_map(of).flatten().collect()
    }
}

/// The parameters of a cell and its rows.
#[derive(Default, Serialize, Deserialize)]
struct Params {
    condition: String,
    measure: String,
    range: [f64; 2],
    seeds: u64,
    upstream: String,
}

fn rows(context: &Context, known: &Reproduction, cell: &Cell, outcome: &Outcome) -> Vec<Row> {
    let blank = Row { states: "seeds".into(), unit: "1".into(), ..case_row(cell) };
    let installed = context.engine(&known.engine).map(|engine| engine.identity().version.clone());
    if installed.as_ref().is_some_and(|installed| *installed != known.version) {
        let reason = format!("the range is that of {} {}, here is {}", known.engine, known.version, installed.unwrap_or_default());
        return vec![blank.without_value(Verdict::Error, reason)];
    }
    let values = match outcome.answer() {
        Ok(values) => values,
        Err(no_answer) => return vec![blank.without_value(Verdict::Error, no_answer.to_string())],
    };
    // A NaN must not be lost here: it is neither small nor large.
    let fold = |pick: fn(f64, f64) -> f64| {
        values.iter().copied().reduce(|a, b| {
            if a.is_nan() {
                a
            } else if b.is_nan() {
                b
            } else {
                pick(a, b)
            }
        })
    };
    let [low, high] = known.range;
    let judged = |metric: &str, value: Option<f64>, relation, bound| {
        Row { metric: metric.into(), ..blank.clone() }.gated(value.unwrap_or(f64::NAN), relation, bound)
    };
    vec![judged("smallest", fold(f64::min), Relation::Ge, low / SLACK), judged("largest", fold(f64::max), Relation::Le, high * SLACK)]
}
