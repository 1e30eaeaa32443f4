//! Operations: the counts of the sparse algorithms are known integers.
//!
//! Let d_k be the depth of dof k in dofs, itself included (the book, section 6.5):
//! - a tree-sparse matrix stores `n + Σ(d_k−1)` numbers;
//! - its LᵀDL factorization takes `Σ(d_k−1)` divisions and `Σ d_k(d_k−1)/2` multiply-subtracts;
//! - a solve takes `2·Σ(d_k−1)` multiply-adds and n divisions.
//!
//! The depths are computed here from the description, without the topology of the kernels. The operations are counted by running the
//! kernels on a scalar that counts.

pub(crate) mod words;

use featherbench_bench::{Asked, Cell, Context, Engine, Finished, NoAnswer, NoSettings, OWN, Outcome, Quantity, Robot, Study};
use featherbench_dynamics::{Crba, Ltdl, TreeSparse};
use featherbench_model::Description;
use featherbench_results::{Relation, Row, Verdict};
use featherbench_spatial::{Counted, Operations};
use featherbench_study::{Entry, no_section, row, unanswered};
use serde_json::json;

/// The operations study.
pub struct OperationCounts;

/// The study in the registry.
pub const ENTRY: Entry = Entry {
    name: "operations",
    make: |setup| setup.made("operations", |_: NoSettings| OperationCounts),
    sections: no_section,
    words: words::WORDS,
};

/// A scalar that counts is a hundred times slower; larger robots are counted in the tests of `dynamics`.
const MOST_DOFS: usize = 1100;

/// The counts, in the order of our cell's values.
pub const COUNTS: [(&str, &str); 5] = [
    ("stored", "stored numbers of M"),
    ("factor_divisions", "divisions of the factorization"),
    ("factor_multiply_subtracts", "multiply-subtracts of the factorization"),
    ("solve_multiply_adds", "multiply-adds of a solve"),
    ("solve_divisions", "divisions of a solve"),
];

impl Study for OperationCounts {
    fn name(&self) -> &'static str {
        "operations"
    }

    fn compares_all(&self) -> bool {
        false
    }

    fn asks(&self, _: &dyn Engine) -> bool {
        true
    }

    fn plan(&self, context: &Context) -> Vec<Cell> {
        let mut cells = Vec::new();
        let robots = context.robots.iter().filter(|robot| robot.takes(self.name()) && robot.states.nv <= MOST_DOFS);
        for robot in robots {
            for engine in context.engines {
                let identity = engine.identity();
                let method = match engine.methods(Quantity::StoredEntries).into_iter().next() {
                    Some(_) if identity.name == OWN => "ltdl".to_owned(),
                    Some(method) => method,
                    None => continue,
                };
                cells.push(Cell::new(self.name(), robot, identity, Quantity::StoredEntries.name(), method, json!({})));
            }
        }
        cells
    }

    fn evaluate(&self, asked: &Asked) -> Outcome {
        let stored = || {
            let (robot, engine) = (asked.robot()?, asked.engine()?);
            if asked.cell.engine == OWN {
                return counts(robot).map_err(NoAnswer::Failed);
            }
            let mut prepared = engine.prepare(robot, Quantity::StoredEntries, &asked.cell.method, &robot.states)?;
            prepared.run(0..1)?;
            Ok(prepared.read().to_vec())
        };
        stored().into()
    }

    fn compare(&self, context: &Context, robot: &Robot, finished: &[Finished]) -> Vec<Row> {
        let expected = expected(&robot.description);
        let mut rows = Vec::new();
        for (cell, outcome) in finished {
            match outcome {
                Outcome::Text(_) => {}
                Outcome::Values(values) => {
                    for ((&value, &expected), (metric, _)) in values.iter().zip(&expected).zip(COUNTS) {
                        let row = Row { metric: metric.into(), unit: "1".into(), reference: "theory".into(), ..row(cell, robot) };
                        rows.push(context.gates.explain(row.gated(value, Relation::Eq, expected)));
                    }
                }
                Outcome::NoAnswer(no_answer) => {
                    rows.push(context.gates.explain(unanswered(row(cell, robot), no_answer, Verdict::Skip)));
                }
            }
        }
        rows
    }
}

/// The counts by theory, from the description alone.
pub(crate) fn expected(robot: &Description) -> [f64; 5] {
    let bodies = &robot.bodies;
    let mut depth_of_body = Vec::with_capacity(bodies.len());
    let (mut n, mut d1, mut d2) = (0_u64, 0_u64, 0_u64);
    for body in bodies {
        let above: u64 = body.parent.map_or(0, |parent: usize| depth_of_body[parent]);
        let nv = body.joint.kind.nv() as u64;
        depth_of_body.push(above + nv);
        for depth in above + 1..=above + nv {
            n += 1;
            d1 += depth - 1;
            d2 += depth * (depth - 1) / 2;
        }
    }
    [n + d1, d1, d2, 2 * d1, n].map(|count| count as f64)
}

/// The counts by running the kernels.
pub(crate) fn counts(robot: &Robot) -> Result<Vec<f64>, String> {
    let (model, states) = (&robot.model, &robot.states);
    let q: Vec<Counted> = states.q(0).iter().map(|&x| Counted(x)).collect();
    let mut matrix = TreeSparse::<Counted>::new(&model.topology);
    Crba::new(&model.topology).run(model, &q, &mut matrix).map_err(|error| error.to_string())?;
    let mut ltdl = Ltdl::new(&model.topology);
    let mut x: Vec<Counted> = states.tau(0).iter().map(|&x| Counted(x)).collect();
    let (mut factored, mut solved) = (Ok(()), Ok(()));
    let factor: Operations = Counted::count(|| factored = ltdl.run(&matrix));
    factored.map_err(|error| error.to_string())?;
    let solve: Operations = Counted::count(|| solved = ltdl.solve(&mut x));
    solved.map_err(|error| error.to_string())?;
    let counts = [matrix.values().len() as u64, factor.divisions, factor.fused, solve.fused, solve.divisions];
    Ok(counts.map(|count| count as f64).to_vec())
}
