//! Single precision: our own kernels have rounding errors alone, a fault of known size is told in its units, and engines in double precision
//! are not asked.

use featherbench_bench::run::{Silent, compare, evaluate, plan};
use featherbench_bench::{Context, Engine, Evaluation, Gates, Identity, NoAnswer, OutcomeStore, Quantity, Robot};
use featherbench_comparison::Single;
use featherbench_engines::Featherbench;
use featherbench_results::{EngineSource, ModelOrigin, Row, Verdict};
use featherbench_robots::{Family, StateBatch};
use std::ops::Range;

/// An engine that rounds our answers to single precision, and adds this to each.
struct Rounded {
    identity: Identity,
    featherbench: Featherbench,
    fault: f64,
}

impl Rounded {
    fn new(precision: &str, fault: f64) -> Self {
        let build = [("precision".to_owned(), precision.to_owned())].into();
        let identity = Identity { name: "rounded".into(), version: "1".into(), source: EngineSource::Live, build };
        Self { identity, featherbench: Featherbench::new(), fault }
    }
}

struct Answer<'a> {
    exact: Box<dyn Evaluation + 'a>,
    fault: f64,
    values: Vec<f64>,
}

impl Engine for Rounded {
    fn identity(&self) -> &Identity {
        &self.identity
    }

    fn methods(&self, quantity: Quantity) -> Vec<String> {
        self.featherbench.methods(quantity).into_iter().take(1).collect()
    }

    fn prepare<'a>(
        &'a self,
        robot: &'a Robot,
        quantity: Quantity,
        method: &str,
        states: &'a StateBatch,
    ) -> Result<Box<dyn Evaluation + 'a>, NoAnswer> {
        let exact = self.featherbench.prepare(robot, quantity, method, states)?;
        Ok(Box::new(Answer { exact, fault: self.fault, values: Vec::new() }))
    }
}

impl Evaluation for Answer<'_> {
    fn run(&mut self, range: Range<usize>) -> Result<(), NoAnswer> {
        self.exact.run(range)?;
        self.values = self.exact.read().iter().map(|x| f64::from((x + self.fault) as f32)).collect();
        Ok(())
    }

    fn read(&self) -> &[f64] {
        &self.values
    }
}

fn rows_of(engine: impl Engine + 'static, specs: &[&str]) -> Vec<Row> {
    let robot = |spec: &&str| {
        let description = Family::parse(spec).unwrap().generate().unwrap();
        Robot::new(&description, "test", ModelOrigin::Generated, 6, 1).unwrap()
    };
    let (robots, gates): (Vec<Robot>, _) = (specs.iter().map(robot).collect(), Gates::default());
    let engines: Vec<Box<dyn Engine>> = vec![Box::new(engine)];
    let context = Context { robots: &robots, engines: &engines, gates: &gates, seed: 1 };
    let folder = tempfile::tempdir().unwrap();
    let store = OutcomeStore::open(folder.path()).unwrap();
    let finished = evaluate(&Single, &context, plan(&Single, &context, &|_| true), &store, &Silent).unwrap();
    compare(&Single, &context, finished)
}

fn value(rows: &[Row], quantity: &str, metric: &str) -> f64 {
    let found = rows.iter().find(|row| row.quantity == quantity && row.metric == metric);
    found.and_then(|row| row.value).unwrap_or_else(|| panic!("{quantity} {metric}: {rows:#?}"))
}

const ROBOTS: [&str; 3] = ["chain:n=3,layout=spatial", "joints:kind=revolute,base=free,shape=branched", "binary_tree:depth=3"];

#[test]
fn our_own_kernels_lose_what_rounding_takes() {
    for robot in ROBOTS {
        let rows = rows_of(Featherbench::new(), &[robot]);
        assert!(rows.iter().all(|row| row.precision == "f32" && row.verdict == Verdict::Info), "{rows:#?}");
        let share = value(&rows, "fd_f32", "off_bound");
        // A stable method keeps near the bound, which is that of the exact answer at rounded inputs.
        assert!(share > 1e-4 && share < 20.0, "{robot}: {share} of the conditioning bound");
        let [off, drift] = [value(&rows, "fd_f32", "off_share"), value(&rows, "drift", "off")];
        assert!(off > 1e-10 && off < 1e-3, "{robot}: {off}");
        assert!(drift > 0.0 && drift < 1.0, "{robot}: {drift} rad");
    }
}

#[test]
fn a_fault_is_told_in_its_units() {
    // Of a pendulum: so its drift is ½·fault·t², but for the pull of gravity.
    let rows = rows_of(Rounded::new("single", 1e-2), &["chain:n=1"]);
    for quantity in ["id", "fd"] {
        let off = value(&rows, quantity, "off");
        assert!((off - 1e-2).abs() < 1e-4, "{quantity}: {off}");
    }
    let drift = value(&rows, "drift", "off");
    assert!(drift > 1e-3 && drift < 1e-1, "{drift}");
    let honest = value(&rows_of(Rounded::new("single", 0.0), &["chain:n=1"]), "drift", "off");
    assert!(honest < 1e-4, "{honest}");
}

#[test]
fn an_engine_in_double_precision_is_not_asked() {
    assert!(rows_of(Rounded::new("double", 0.0), &ROBOTS).is_empty());
}

#[test]
fn a_simulation_that_leaves_the_numbers_is_told() {
    let rows = rows_of(Rounded::new("single", f64::NAN), &["chain:n=2"]);
    let drift = rows.iter().find(|row| row.quantity == "drift").unwrap();
    assert!(drift.verdict == Verdict::Error && drift.reason.contains("is no number"), "{drift:#?}");
}
