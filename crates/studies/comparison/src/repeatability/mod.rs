//! Repeatability: the same question, put twice to the same process, must have the same answer to the bit.
//!
//! A counter-based generator draws a robot and a method for each engine and each quantity that it offers. The cells run alone, after all
//! others: the question, a question about another robot, and the first question again. The value is the largest distance between the two
//! answers in units in the last place. The bound is zero. An engine that is not repeatable has no answer that could be checked. So no known
//! deviation excuses it. The causes may be random numbers, memory that was not initialised, or sums over threads in any order.
//! Recorded answers cannot be asked twice: their engine is asked when it is recorded.

pub(crate) mod words;

use crate::agreement::{self, QUANTITIES};
use featherbench_bench::{Asked, Cell, Context, Engine, Finished, NoAnswer, NoSettings, Outcome, Quantity, Robot, Study, hash};
use featherbench_results::{EngineSource, Relation, Row, Verdict};
use featherbench_robots::Random;
use featherbench_study::{Entry, Made, Setup, answer, case_row, no_section, row};
use serde_json::json;

/// The repeatability study.
pub struct Repeatability {
    /// The draw depends on the seed, the engine, the quantity and this: the hash of the program. So another build asks about other cells,
    /// and a resumed run about the same.
    pub key: String,
}

/// The study in the registry.
pub const ENTRY: Entry = Entry { name: "repeatability", make: of_suite, sections: no_section, words: words::WORDS };

/// The study, if the suite asks engines for answers: no answer counts without it, so it needs no table.
fn of_suite(setup: &Setup) -> Made {
    let named = setup.suite.settings::<NoSettings>("repeatability")?.is_some();
    Ok((named || setup.suite.engines.is_some()).then(|| Box::new(Repeatability { key: setup.program.to_owned() }) as _))
}

/// The number of failures after which no further robot is tried; the agreement study has rows for them.
const PATIENCE: usize = 3;

/// A robot and a method that an engine can be asked about.
type Candidate<'a> = (&'a Robot, String);

/// The robots of the agreement study, with the methods of a quantity.
fn candidates<'a>(context: &Context<'a>, engine: &dyn Engine, quantity: Quantity) -> Vec<Candidate<'a>> {
    let methods = engine.methods(quantity);
    let robots = context.robots.iter().filter(|robot| robot.takes("agreement") && agreement::asked(robot, quantity));
    robots.flat_map(|robot| methods.iter().map(move |method| (robot, method.clone()))).collect()
}

/// The result of asking twice, as the values of an outcome.
struct Twice {
    /// The index of the candidate that was asked.
    candidate: usize,
    /// Numbers that differ.
    differing: usize,
    /// Numbers of the answer.
    total: usize,
    /// The largest distance in units in the last place.
    ulps: f64,
}

impl Twice {
    fn new(candidate: usize, first: &[f64], second: &[f64]) -> Self {
        let distances = first.iter().zip(second).map(|(a, b)| (ordered(*a) - ordered(*b)).unsigned_abs());
        let (mut differing, mut largest) = (0, 0);
        for distance in distances {
            differing += usize::from(distance > 0);
            largest = largest.max(distance);
        }
        Self { candidate, differing, total: first.len(), ulps: largest as f64 }
    }

    fn to_values(&self) -> Vec<f64> {
        vec![self.candidate as f64, self.differing as f64, self.total as f64, self.ulps]
    }

    fn from_values(values: &[f64]) -> Option<Self> {
        let [candidate, differing, total, ulps] = *values else { return None };
        Some(Self { candidate: candidate as usize, differing: differing as usize, total: total as usize, ulps })
    }
}

/// The bits of a double as an integer that increases with the double: two doubles have the same integer if they have the same bits.
fn ordered(x: f64) -> i128 {
    let bits = x.to_bits() as i64;
    i128::from(bits ^ (bits >> 63) & i64::MAX)
}

impl Repeatability {
    /// The order in which candidates are tried.
    fn order(&self, context: &Context, cell: &Cell, count: usize) -> Vec<usize> {
        let mut random = Random::named(context.seed, &format!("repeatability {} {} {}", self.key, cell.engine, cell.quantity));
        let mut order: Vec<usize> = (0..count).collect();
        for last in (1..count).rev() {
            order.swap(last, random.below(last + 1));
        }
        order
    }

    /// Asks the first candidate that is answered twice.
    fn twice(&self, asked: &Asked) -> Result<Twice, NoAnswer> {
        let (engine, quantity) = (asked.engine()?, asked.quantity()?);
        let candidates = candidates(asked.context, engine, quantity);
        let order = self.order(asked.context, asked.cell, candidates.len());
        let ask = |index: usize| answer(engine, candidates[index].0, quantity, &candidates[index].1);
        let mut failures = 0;
        for (place, &index) in order.iter().enumerate() {
            match ask(index) {
                Ok(first) => {
                    // Otherwise a stored answer would count as a second one. The outcome of this question does not matter.
                    let other = order[place + 1..].iter().find(|&&other| candidates[other].0.hash != candidates[index].0.hash);
                    let _ = other.map(|&other| ask(other));
                    let (robot, method) = &candidates[index];
                    let again = ask(index).map_err(|no_answer| {
                        let what = format!("{} of {} by {method}", asked.cell.quantity, robot.name);
                        NoAnswer::Failed(format!("{what} was answered, and then not: {no_answer}"))
                    });
                    return again.map(|second| Twice::new(index, &first, &second));
                }
                Err(NoAnswer::NotOffered(_)) => {}
                Err(NoAnswer::Failed(_)) => {
                    failures += 1;
                    if failures == PATIENCE {
                        break;
                    }
                }
            }
        }
        Err(NoAnswer::NotOffered("there is no robot about which it answers".into()))
    }
}

impl Study for Repeatability {
    fn name(&self) -> &'static str {
        "repeatability"
    }

    /// Alone: so the same process is asked both times.
    fn exclusive(&self) -> bool {
        true
    }

    fn asks(&self, engine: &dyn Engine) -> bool {
        engine.identity().source != EngineSource::Recorded
    }

    fn plan(&self, context: &Context) -> Vec<Cell> {
        let mut cells = Vec::new();
        let live = context.engines.iter().filter(|engine| engine.identity().source != EngineSource::Recorded);
        for engine in live {
            let identity = engine.identity();
            for quantity in QUANTITIES {
                let candidates = candidates(context, engine.as_ref(), quantity);
                if candidates.is_empty() {
                    continue;
                }
                let parts: Vec<&[u8]> = candidates.iter().flat_map(|(robot, method)| [robot.hash.as_bytes(), method.as_bytes()]).collect();
                let params = json!({"draw": self.key, "quantity": quantity.name()});
                let cell = Cell::of_case(self.name(), "all", (&identity.name, &identity.version), quantity.name(), "drawn", params);
                cells.push(Cell { robot_hash: hash::of_parts(&parts), ..cell });
            }
        }
        cells
    }

    fn evaluate(&self, asked: &Asked) -> Outcome {
        self.twice(asked).map(|twice| twice.to_values()).into()
    }

    fn compare_all(&self, context: &Context, finished: &[Finished]) -> Vec<Row> {
        finished.iter().filter_map(|(cell, outcome)| self.judged(context, cell, outcome)).collect()
    }
}

impl Repeatability {
    /// The row of a cell; `None` if the engine answers about no robot, which the rows of the agreement study say.
    fn judged(&self, context: &Context, cell: &Cell, outcome: &Outcome) -> Option<Row> {
        let blank = Row {
            quantity: self.name().into(),
            method: String::new(),
            states: "all".into(),
            metric: "repeated".into(),
            unit: "ulp".into(),
            reference: "the same question before".into(),
            ..case_row(cell)
        };
        let lost = |reason: &str| Some(blank.clone().without_value(Verdict::Error, reason));
        let values = match outcome {
            Outcome::NoAnswer(NoAnswer::NotOffered(_)) => return None,
            Outcome::NoAnswer(NoAnswer::Failed(reason)) => return lost(reason),
            Outcome::Text(_) => return lost("the outcome is a text"),
            Outcome::Values(values) => values,
        };
        let engine = context.engine(&cell.engine)?;
        let quantity = Quantity::parse(&cell.quantity)?;
        let candidates = candidates(context, engine, quantity);
        let Some((twice, (robot, method))) =
            Twice::from_values(values).and_then(|twice| Some((candidates.get(twice.candidate)?, twice))).map(|(of, twice)| (twice, of))
        else {
            return lost("the outcome is none of this study");
        };
        let of_robot = row(cell, robot);
        let row = Row {
            family: of_robot.family,
            robot: of_robot.robot,
            nq: of_robot.nq,
            nv: of_robot.nv,
            bodies: of_robot.bodies,
            depth: of_robot.depth,
            method: method.clone(),
            ..blank
        };
        let mut row = row.gated(twice.ulps, Relation::Eq, 0.0);
        if row.verdict == Verdict::Fail {
            let Twice { differing, total, ulps, .. } = twice;
            row.reason = format!(
                "asked twice for {}, it answers otherwise: {differing} of {total} numbers differ, by up to {ulps} units in the last place",
                cell.quantity
            );
        }
        Some(row)
    }
}
