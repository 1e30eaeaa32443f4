//! Engines whose answers to the same question differ: by noise of a few units in the last place, by a memory of earlier questions, or
//! because only the first answer exists. Each has a row that fails, with its size. Right engines pass, and recordings are not asked.

use featherbench_bench::run::{Silent, compare, evaluate, plan};
use featherbench_bench::{Context, Engine, Evaluation, Gates, Identity, NoAnswer, OutcomeStore, Quantity, Robot};
use featherbench_comparison::Repeatability;
use featherbench_engines::Featherbench;
use featherbench_results::{EngineSource, ModelOrigin, Relation, Row, Verdict};
use featherbench_robots::{Family, StateBatch};
use std::collections::BTreeSet;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

/// The fault of an engine; the engine counts its answers to the quantity that it is wrong about.
#[derive(Clone, Copy, PartialEq)]
enum Fault {
    Honest,
    /// Every answer is multiplied by 1 + k·2ε, where k is their count.
    Noise,
    /// The sign of a zero depends on the count.
    SignOfZero,
    /// Only the first question about a robot has an answer.
    Once,
    /// It has no robot.
    NoRobot,
    /// Every question ends in a failure.
    Broken,
}

struct Faulty {
    identity: Identity,
    featherbench: Featherbench,
    fault: Fault,
    about: Quantity,
    answers: AtomicU64,
}

impl Faulty {
    fn new(fault: Fault, source: EngineSource) -> Self {
        let identity = Identity { name: "faulty".into(), version: "1".into(), source, build: Default::default() };
        Self { identity, featherbench: Featherbench::new(), fault, about: Quantity::Bias, answers: AtomicU64::new(0) }
    }
}

struct Spoiled<'a> {
    of: &'a Faulty,
    honest: Box<dyn Evaluation + 'a>,
    quantity: Quantity,
    values: Vec<f64>,
}

impl Engine for Faulty {
    fn identity(&self) -> &Identity {
        &self.identity
    }

    fn methods(&self, quantity: Quantity) -> Vec<String> {
        self.featherbench.methods(quantity)
    }

    fn prepare<'a>(
        &'a self,
        robot: &'a Robot,
        quantity: Quantity,
        method: &str,
        states: &'a StateBatch,
    ) -> Result<Box<dyn Evaluation + 'a>, NoAnswer> {
        match self.fault {
            Fault::NoRobot => return Err(NoAnswer::NotOffered("no such robot".into())),
            Fault::Broken => return Err(NoAnswer::Failed("no licence".into())),
            _ => {}
        }
        let honest = self.featherbench.prepare(robot, quantity, method, states)?;
        Ok(Box::new(Spoiled { of: self, honest, quantity, values: Vec::new() }))
    }
}

impl Evaluation for Spoiled<'_> {
    fn run(&mut self, range: Range<usize>) -> Result<(), NoAnswer> {
        self.honest.run(range)?;
        self.values = self.honest.read().to_vec();
        if self.quantity == self.of.about {
            let count = self.of.answers.fetch_add(1, Ordering::Relaxed);
            match self.of.fault {
                Fault::Noise => self.values.iter_mut().for_each(|x| *x *= 1.0 + 2.0 * f64::EPSILON * count as f64),
                Fault::SignOfZero => self.values[0] = if count.is_multiple_of(3) { 0.0 } else { -0.0 },
                Fault::Once if count > 1 => return Err(NoAnswer::Failed("the buffer is gone".into())),
                _ => {}
            }
        }
        Ok(())
    }

    fn read(&self) -> &[f64] {
        &self.values
    }
}

fn robots() -> Vec<Robot> {
    let robot = |spec: &str| Robot::new(&Family::parse(spec).unwrap().generate().unwrap(), "test", ModelOrigin::Generated, 3, 1).unwrap();
    ["chain:n=2", "chain:n=3", "chain:n=4,layout=spatial", "joints:kind=revolute,base=free,shape=single"].map(robot).into()
}

fn rows_of(fault: Fault, source: EngineSource, key: &str, seed: u64) -> Vec<Row> {
    let (robots, gates) = (robots(), Gates::default());
    let engines: Vec<Box<dyn Engine>> = vec![Box::new(Faulty::new(fault, source))];
    let context = Context { robots: &robots, engines: &engines, gates: &gates, seed };
    let study = Repeatability { key: key.into() };
    let folder = tempfile::tempdir().unwrap();
    let store = OutcomeStore::open(folder.path()).unwrap();
    let finished = evaluate(&study, &context, plan(&study, &context, &|_| true), &store, &Silent).unwrap();
    compare(&study, &context, finished)
}

/// The rows that do not pass.
fn red(rows: &[Row]) -> Vec<&Row> {
    rows.iter().filter(|row| row.verdict != Verdict::Pass).collect()
}

#[test]
fn an_honest_engine_passes_for_each_quantity_that_it_offers() {
    let rows = rows_of(Fault::Honest, EngineSource::Live, "a", 1);
    assert!(red(&rows).is_empty(), "{rows:#?}");
    let asked: BTreeSet<&str> = rows.iter().map(|row| row.params.as_str()).collect();
    // The probe replaces M on big robots only, and there is none.
    assert_eq!((rows.len(), asked.len()), (15, 15));
    assert!(rows.iter().all(|row| row.relation == Some(Relation::Eq) && row.bound == Some(0.0) && row.quantity == "repeatability"));
}

#[test]
fn noise_below_every_bound_is_a_failing_row_with_its_size() {
    let rows = rows_of(Fault::Noise, EngineSource::Live, "a", 1);
    let red = red(&rows);
    assert_eq!(red.len(), 1, "{red:#?}");
    let row = red[0];
    assert_eq!((row.verdict, row.unit.as_str()), (Verdict::Fail, "ulp"));
    // Two answers later: 4 ε is 4 to 8 units in the last place, and one more by rounding.
    assert!(row.value.is_some_and(|ulps| (2.0..=10.0).contains(&ulps)), "{row:#?}");
    assert!(row.reason.contains("asked twice for bias") && row.reason.contains("units in the last place"), "{}", row.reason);
    assert!(robots().iter().any(|robot| robot.name == row.robot) && ["rnea_packed", "batch"].contains(&row.method.as_str()));
}

#[test]
fn what_a_comparison_of_numbers_does_not_see_is_seen() {
    let rows = rows_of(Fault::SignOfZero, EngineSource::Live, "a", 1);
    let red = red(&rows);
    assert!(red.len() == 1 && red[0].value == Some(1.0), "zero of either sign: {red:#?}");
    assert!(red[0].reason.contains("1 of "), "{}", red[0].reason);
}

#[test]
fn an_answer_that_comes_once_is_an_error() {
    let rows = rows_of(Fault::Once, EngineSource::Live, "a", 1);
    let red = red(&rows);
    assert_eq!(red.iter().map(|row| row.verdict).collect::<Vec<_>>(), [Verdict::Error], "{red:#?}");
    assert!(red[0].reason.contains("was answered, and then not: the buffer is gone"), "{}", red[0].reason);
}

#[test]
fn who_has_no_answer_at_all_has_no_row_here() {
    assert_eq!(rows_of(Fault::NoRobot, EngineSource::Live, "a", 1), []);
    assert_eq!(rows_of(Fault::Broken, EngineSource::Live, "a", 1), []);
    assert_eq!(rows_of(Fault::Noise, EngineSource::Recorded, "a", 1), [], "a recording answers nothing anew");
    assert!(!rows_of(Fault::Honest, EngineSource::Own, "a", 1).is_empty(), "our own kernels are asked");
}

/// Other keys and seeds choose other cells, the same ones the same cells.
#[test]
fn the_draw_is_by_a_counter_and_not_always_the_same() {
    let drawn = |key: &str, seed| {
        let rows = rows_of(Fault::Honest, EngineSource::Live, key, seed);
        rows.into_iter().map(|row| (row.params.split("quantity").nth(1).map(str::to_owned), row.robot, row.method)).collect::<Vec<_>>()
    };
    assert_eq!(drawn("a", 1), drawn("a", 1));
    assert_ne!(drawn("a", 1), drawn("b", 1));
    assert_ne!(drawn("a", 1), drawn("a", 2));
    let models: BTreeSet<String> = drawn("a", 1).into_iter().map(|(_, model, _)| model).collect();
    assert!(models.len() > 1, "one run asks about several robots: {models:?}");
}
