//! Scaling: what becomes of sparsity, operations and errors as robots grow. Every row is exact: times are of the study `growth`.
//!
//! | what | question | judged by |
//! |---|---|---|
//! | counts | are stored numbers and operations the integers of the theory, also at 10⁶ dofs? | equality, with the depths of the description |
//! | fill-in | what does each order of elimination add to the pattern of M? | equality: zero leaves first, everything root first |
//! | factors | how far are LᵀDL from M, and a solution from its right side, per dof? | a gate, in double-double arithmetic |
//! | others | what fills the factors of other engines, and how far are these and their solutions from M? | a gate, as ours, for those that are given our M |
//! | dynamics | how far is forward dynamics from the truth? | a gate, and one over the conditioning bound |
//! | work | where do the articulated-body algorithm and the mass matrix take equally many operations? | nothing: `growth` measures it |
//! | parallel | how much more work has one robot on several cores, and how much of it must wait? | a gate on the work: twice the serial one |
//!
//! A tree is a robot of the suite or a generator's text. A generated tree is made when a cell needs it, and not kept: the robots of a suite
//! are all in memory at once.

mod dynamics;
mod factor;
mod fill;
mod floor;
pub(crate) mod others;
mod parallel;
mod rows;
pub(crate) mod section;
mod tree;
pub(crate) mod words;
mod work;

pub(crate) use dynamics::{relative_error, truth};
pub(crate) use work::crossing;

use crate::operations;
use featherbench_bench::{Asked, Cell, Context, Finished, NoAnswer, OWN, Outcome, Quantity, Robot, Study};
use featherbench_results::Row;
use featherbench_study::Entry;
use fill::Order;
use serde::{Deserialize, Serialize};

/// The scaling study.
pub struct Scaling {
    /// The table of the suite.
    pub settings: Settings,
}

/// The table `[scaling]` of a suite. A tree is a generator's text, as of `featherbench gen`. The suite's robots that take the study are
/// among `counts` and `factors`.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Settings {
    /// Trees whose stored numbers and operations are counted.
    pub counts: Vec<String>,
    /// Trees whose fill-in is counted, and whose factors are compared with M.
    pub factors: Vec<String>,
    /// Engines beside ours, if they are installed, whose factors of the suite's robots are compared with M too.
    pub engines: Vec<String>,
    /// Trees whose forward dynamics is compared with the truth.
    pub dynamics: Vec<String>,
    /// Of these, those whose M is factorized too.
    pub by_factorization: Vec<String>,
    /// Trees whose work and span are counted for the methods that divide a tree into sub-trees.
    pub sub_trees: Vec<String>,
    /// Chains whose work and span are counted for the method that divides a chain.
    pub both_ends: Vec<String>,
    /// Families along which the work of forward dynamics is counted.
    pub lines: Vec<Line>,
}

/// A family along which robots grow.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Line {
    /// Its name in rows.
    pub name: String,
    /// The generator's text, with `*` in the place of the size.
    pub of: String,
    /// The sizes, ascending.
    pub sizes: Vec<usize>,
}

impl Line {
    /// The generators' texts.
    pub fn trees(&self) -> impl Iterator<Item = String> + '_ {
        self.sizes.iter().map(|size| self.of.replace('*', &size.to_string()))
    }
}

/// The study in the registry.
pub const ENTRY: Entry = Entry {
    name: "scaling",
    make: |setup| setup.made("scaling", |settings| Scaling { settings }),
    sections: section::sections,
    words: words::WORDS,
};

/// What a cell or a row is about: its parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "what", rename_all = "snake_case")]
pub(crate) enum What {
    /// Of a row: whether the operations were counted, or taken from the pattern.
    Counts {
        #[serde(default, skip_serializing_if = "Option::is_none")]
        route: Option<String>,
    },
    FillIn,
    Factors,
    Others,
    Floor,
    Dynamics,
    Parallel,
    /// Of a cell: its line.
    Work {
        #[serde(default)]
        line: String,
    },
    /// Of a row alone: where two ways are predicted to take the same time, with so many numbers in a register.
    Crossover {
        lanes: f64,
    },
}

/// Up to this many multiply-subtracts the kernels run on a scalar that counts: some seconds. Above it the kernels' pattern is counted.
const MOST_COUNTED: f64 = 2e8;
/// Larger integers are not all numbers of f64.
const LARGEST_INTEGER: f64 = 9_007_199_254_740_992.0;
/// Methods of ours that take O(n).
const METHODS: [&str; 2] = ["aba", "refined_1"];

impl Study for Scaling {
    fn name(&self) -> &'static str {
        "scaling"
    }

    fn engines(&self) -> &[String] {
        &self.settings.engines
    }

    fn plan(&self, context: &Context) -> Vec<Cell> {
        let Some(featherbench) = context.engine(OWN) else { return Vec::new() };
        let Settings { counts, factors, engines, dynamics, by_factorization, sub_trees, both_ends, lines } = &self.settings;
        let cell = |tree: &str, quantity: Quantity, method: &str, what: What| {
            tree::cell(self.name(), context.seed, tree, featherbench.identity(), quantity.name(), method, what)
        };
        let robots: Vec<&String> = context.robots.iter().filter(|robot| robot.takes(self.name())).map(|robot| &robot.name).collect();
        let mut cells = Vec::new();
        for tree in counts.iter().chain(robots.iter().copied()) {
            cells.push(cell(tree, Quantity::StoredEntries, "ltdl", What::Counts { route: None }));
        }
        for tree in factors.iter().chain(robots.iter().copied()) {
            for order in Order::ALL {
                cells.push(cell(tree, Quantity::Factorization, order.name(), What::FillIn));
            }
            cells.push(cell(tree, Quantity::Factorization, "ltdl", What::Factors));
        }
        let others = others::engines(context, engines);
        for robot in context.robots.iter().filter(|robot| robot.takes(self.name())) {
            cells.extend(others::cells(&others, self.name(), robot));
        }
        for tree in dynamics {
            cells.push(cell(tree, Quantity::ForwardDynamics, "floor", What::Floor));
            let factorizing = by_factorization.contains(tree).then_some("ltdl");
            for method in METHODS.into_iter().chain(factorizing) {
                cells.push(cell(tree, Quantity::ForwardDynamics, method, What::Dynamics));
            }
        }
        for tree in sub_trees {
            for (quantity, method, _) in parallel::BY_SUB_TREES {
                cells.push(cell(tree, quantity, method, What::Parallel));
            }
        }
        for tree in both_ends {
            cells.push(cell(tree, Quantity::ForwardDynamics, parallel::FROM_BOTH_ENDS, What::Parallel));
        }
        for line in lines {
            for tree in line.trees() {
                cells.push(cell(&tree, Quantity::ForwardDynamics, "ltdl", What::Work { line: line.name.clone() }));
            }
        }
        cells
    }

    fn evaluate(&self, asked: &Asked) -> Outcome {
        let answer = || -> Result<Vec<f64>, NoAnswer> {
            let robot = tree::robot(asked)?;
            let mut values = tree::sizes(&robot).to_vec();
            values.extend(values_of(asked, &robot)?);
            Ok(values)
        };
        answer().into()
    }

    /// All rows come from [`Study::compare_all`]: most trees are no robots of the suite.
    fn compare_all(&self, context: &Context, finished: &[Finished]) -> Vec<Row> {
        rows::rows(context, &self.settings.lines, finished)
    }
}

/// The values of a cell behind the sizes of its tree.
fn values_of(asked: &Asked, robot: &Robot) -> Result<Vec<f64>, NoAnswer> {
    let method = asked.cell.method.as_str();
    let lost = || NoAnswer::Failed("there is no question of this cell".into());
    match asked.cell.params()? {
        What::Counts { .. } => counts(robot),
        What::FillIn => Ok(fill_in(robot, Order::ALL.into_iter().find(|order| order.name() == method).ok_or_else(lost)?)),
        What::Factors => Ok(factor::errors(robot).map_err(NoAnswer::Failed)?.to_vec()),
        What::Others => Ok(vec![others::value(asked, robot)?]),
        What::Floor => floor::estimate(robot, 0, asked.context.seed).map(|floor| vec![floor]).ok_or_else(lost),
        What::Dynamics => Ok(vec![dynamics::error(asked.engine()?, robot, method)?]),
        What::Parallel => Ok(parallel::counts(robot, method)?.to_vec()),
        What::Work { .. } => Ok(work::of_forward_dynamics(robot).map_err(NoAnswer::Failed)?.to_vec()),
        What::Crossover { .. } => Err(lost()),
    }
}

/// One if the kernels ran on a scalar that counts and zero if their pattern was counted; the integers of the theory; those that were found.
fn counts(robot: &Robot) -> Result<Vec<f64>, NoAnswer> {
    let due = operations::expected(&robot.description);
    if due.iter().any(|count| *count >= LARGEST_INTEGER) {
        return Err(NoAnswer::Failed("its counts are too large for f64: take a smaller tree".into()));
    }
    let [_, _, multiply_subtracts, ..] = due;
    let counted = multiply_subtracts <= MOST_COUNTED;
    let found = if counted { operations::counts(robot).map_err(NoAnswer::Failed)? } else { of_pattern(robot).to_vec() };
    Ok([f64::from(u8::from(counted))].into_iter().chain(due).chain(found).collect())
}

/// The same counts from the pattern that the kernels use: the length of each row of M.
fn of_pattern(robot: &Robot) -> [f64; 5] {
    let topology = &robot.model.topology;
    let (mut d1, mut d2) = (0_u64, 0_u64);
    for dof in 0..topology.nv() {
        let depth = topology.dof_depth(dof) as u64;
        d1 += depth - 1;
        d2 += depth * (depth - 1) / 2;
    }
    let n = topology.nv() as u64;
    [topology.stored() as u64, d1, d2, 2 * d1, n].map(|count| count as f64)
}

/// Stored numbers of M; stored numbers of the factor by the theory; those that symbolic elimination finds, and its multiply-subtracts.
fn fill_in(robot: &Robot, order: Order) -> Vec<f64> {
    let parents = tree::dof_parents(&robot.description);
    let [stored, ..] = operations::expected(&robot.description);
    let due = match order {
        Order::LeavesFirst | Order::MinimumDegree => stored,
        // A tree's dofs follow each other, and its factor is full.
        Order::RootFirst => {
            let roots: Vec<usize> = (0..parents.len()).filter(|&dof| parents[dof].is_none()).chain([parents.len()]).collect();
            roots.windows(2).map(|pair| (pair[1] - pair[0]) as f64).map(|size| size * (size + 1.0) / 2.0).sum()
        }
    };
    let found = fill::factor(&parents, &order.of(&parents));
    vec![stored, due, found.stored as f64, found.multiply_subtracts as f64]
}
