//! Invariance: our own kernels keep their answers, and an engine that heeds what it must not is told by each change.

use featherbench_bench::run::{Silent, compare, evaluate, plan};
use featherbench_bench::{Context, Engine, Evaluation, Gates, Identity, NoAnswer, OutcomeStore, Quantity, Robot};
use featherbench_comparison::Invariance;
use featherbench_engines::Featherbench;
use featherbench_results::{EngineSource, ModelOrigin, Row};
use featherbench_robots::{Family, StateBatch};
use featherbench_spatial::larger;
use std::collections::BTreeMap;
use std::ops::Range;

/// What an engine heeds of a robot: a number that enters its answers.
type Heeds = Box<dyn Fn(&Robot) -> f64 + Send + Sync>;

/// An engine that adds to each of our answers what it heeds, in parts of 10⁶.
struct Heedful {
    identity: Identity,
    featherbench: Featherbench,
    heeds: Heeds,
}

struct Answer<'a> {
    exact: Box<dyn Evaluation + 'a>,
    factor: f64,
    values: Vec<f64>,
}

impl Engine for Heedful {
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
        Ok(Box::new(Answer { exact, factor: 1.0 + 1e-6 * (self.heeds)(robot), values: Vec::new() }))
    }
}

impl Evaluation for Answer<'_> {
    fn run(&mut self, range: Range<usize>) -> Result<(), NoAnswer> {
        self.exact.run(range)?;
        self.values = self.exact.read().iter().map(|x| x * self.factor).collect();
        Ok(())
    }

    fn read(&self) -> &[f64] {
        &self.values
    }
}

fn rows_of(engine: impl Engine + 'static, family: &str) -> Vec<Row> {
    let description = Family::parse(family).unwrap().generate().unwrap();
    let robots = [Robot::new(&description, "test", ModelOrigin::Generated, 6, 1).unwrap()];
    let gates = Gates::default();
    let engines: Vec<Box<dyn Engine>> = vec![Box::new(engine)];
    let context = Context { robots: &robots, engines: &engines, gates: &gates, seed: 1 };
    let folder = tempfile::tempdir().unwrap();
    let store = OutcomeStore::open(folder.path()).unwrap();
    let finished = evaluate(&Invariance, &context, plan(&Invariance, &context, &|_| true), &store, &Silent).unwrap();
    compare(&Invariance, &context, finished)
}

/// The largest distance that each change makes.
fn moved(rows: &[Row]) -> BTreeMap<String, f64> {
    let mut moved = BTreeMap::new();
    for row in rows {
        let params: serde_json::Value = serde_json::from_str(&row.params).unwrap();
        let most = moved.entry(params["change"].as_str().unwrap().to_owned()).or_insert(0.0);
        *most = larger(*most, row.value.unwrap_or_else(|| panic!("{row:?}")));
    }
    moved
}

const ROBOTS: [&str; 5] = [
    "chain:n=4,layout=spatial",
    "binary_tree:depth=3",
    "joints:kind=prismatic,base=free,shape=branched",
    "joints:kind=spherical,base=free,shape=branched",
    "joints:kind=helical,base=fixed",
];

#[test]
fn our_own_kernels_keep_their_answers() {
    for robot in ROBOTS {
        let moved = moved(&rows_of(Featherbench::new(), robot));
        assert_eq!(moved.len(), 5, "{robot}: {moved:?}");
        // Powers of two round nothing.
        for change in ["names", "units"] {
            assert_eq!(moved[change], 0.0, "{robot}: {change}");
        }
        // Children are added in another order, the model's own frames have another handedness, and other frames round: the bound is the gates'.
        for change in ["order", "mirror", "frames"] {
            assert!(moved[change] < 2e-14, "{robot}: {change} by {}", moved[change]);
        }
    }
}

#[test]
fn an_engine_that_heeds_a_change_is_told_by_it() {
    const TREE: &str = "binary_tree:depth=3";
    let last = Family::parse(TREE).unwrap().generate().unwrap().bodies.last().unwrap().name.clone();
    let heeds: [(&str, Heeds); 5] = [
        ("names", Box::new(|robot| f64::from(u8::from(robot.description.bodies[0].name.starts_with('z'))))),
        ("order", Box::new(move |robot| robot.description.bodies.iter().position(|body| body.name == last).unwrap_or(0) as f64)),
        ("units", Box::new(|robot| robot.description.gravity[2])),
        ("mirror", Box::new(|robot| robot.description.bodies[1].joint.kind.axis().map_or(0.0, |axis| axis[1] + axis[2]))),
        ("frames", Box::new(|robot| robot.description.bodies[2].com[0])),
    ];
    for (change, heeds) in heeds {
        let identity = Identity { name: "heedful".into(), version: "1".into(), source: EngineSource::Live, build: BTreeMap::new() };
        let moved = moved(&rows_of(Heedful { identity, featherbench: Featherbench::new(), heeds }, TREE));
        assert!(moved[change] > 1e-9, "{change}: {moved:?}");
    }
}
