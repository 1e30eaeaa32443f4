//! What the tests of the studies share: an engine with planted errors, and a whole agreement run in memory.

use featherbench_bench::run::{Silent, compare, evaluate, plan};
use featherbench_bench::{
    Context, Counts, DeviationFile, Engine, Engines, Evaluation, Gates, Identity, NoAnswer, OutcomeStore, Quantity, Robot, Study, Suite,
};
use featherbench_comparison::Agreement;
use featherbench_engines::Featherbench;
use featherbench_model::{Description, Model};
use featherbench_results::{EngineSource, Expectation, ModelOrigin, Row, RunInfo, Verdict};
use featherbench_robots::{Family, StateBatch};
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// One state of each case: errors that the gates can find must be found with these.
pub const STATES: usize = StateBatch::HEAD;
/// The seed of the states.
pub const SEED: u64 = 1;

/// The robot of a family, with its states.
pub fn robot(spec: &str) -> Robot {
    let family = Family::parse(spec).unwrap();
    Robot::new(&family.generate().unwrap(), family.name(), ModelOrigin::Generated, STATES, SEED).unwrap()
}

/// The folder of the repository's own gates.
pub fn gates_folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../ci")
}

/// The description of the engines.
pub fn engines() -> Engines {
    Engines::read(&gates_folder().join("../oracles/engines.toml")).unwrap()
}

/// The repository's own gates, with these known deviations of the double or with none.
pub fn gates(deviations: &str) -> Gates {
    let path = gates_folder().join("gates.toml");
    let gates = Gates::parse(&std::fs::read_to_string(&path).unwrap(), &path).unwrap();
    gates.with_deviations(of_engine("double", deviations))
}

/// Known deviations of version 1 of an engine.
pub fn of_engine(engine: &str, deviations: &str) -> DeviationFile {
    let file = PathBuf::from(format!("{engine}.toml"));
    DeviationFile::parse(&format!("version = \"1\"\n{deviations}"), &file).unwrap()
}

/// A question and an answer for one state, to be changed.
pub struct Answer<'a> {
    /// The robot.
    pub robot: &'a Robot,
    /// What is asked.
    pub quantity: Quantity,
    /// The method by which it is asked.
    pub method: &'a str,
    /// The state of the question.
    pub state: usize,
    /// The answer.
    pub values: &'a mut Vec<f64>,
}

/// The overhead that a double subtracts if its times are estimates.
pub const OVERHEAD: Duration = Duration::from_nanos(700);

/// A change of an engine's answers.
pub type Twist = fn(Answer);
/// The same with what it depends on.
type Lie = Arc<dyn Fn(Answer) + Send + Sync>;

/// An engine named `double` that answers with our kernels, but on another robot than it reports, at other states, or with changed answers.
///
/// Its read-back is the right robot: only the answers of its algorithms can show the error.
pub struct Double {
    identity: Identity,
    featherbench: Featherbench,
    held: Robot,
    states: Option<StateBatch>,
    twist: Lie,
    refuses: bool,
    estimates: bool,
    /// Whether it offers the usual method alone, except of forward dynamics.
    usual: bool,
}

impl Double {
    /// A right one.
    pub fn of(robot: &Robot) -> Self {
        let identity = Identity { name: "double".into(), version: "1".into(), source: EngineSource::Own, build: BTreeMap::new() };
        Self {
            identity,
            featherbench: Featherbench::new(),
            held: robot.clone(),
            states: None,
            twist: Arc::new(|_: Answer| ()),
            refuses: false,
            estimates: false,
            usual: false,
        }
    }

    /// One with an altered robot.
    pub fn altered(robot: &Robot, alter: impl FnOnce(&mut Description)) -> Self {
        let mut double = Self::of(robot);
        alter(&mut double.held.description);
        double.held.model = Model::build(&double.held.description).unwrap();
        double
    }

    /// One that changes its answers.
    pub fn twisting(robot: &Robot, twist: impl Fn(Answer) + Send + Sync + 'static) -> Self {
        Self { twist: Arc::new(twist), ..Self::of(robot) }
    }

    /// One that misinterprets the states.
    pub fn misreading(robot: &Robot, misread: impl FnOnce(&mut StateBatch)) -> Self {
        let mut states = robot.states.clone();
        misread(&mut states);
        Self { states: Some(states), ..Self::of(robot) }
    }

    /// The same under another name.
    pub fn named(mut self, name: &str) -> Self {
        self.identity.name = name.into();
        self
    }

    /// One whose times are estimates, for one method of each quantity.
    pub fn estimating(self) -> Self {
        Self { estimates: true, ..self }
    }

    /// One that offers the usual method of each quantity alone, and all of forward dynamics.
    pub fn by_usual_methods(self) -> Self {
        Self { usual: true, ..self }
    }

    /// One that supports nothing, although it offers methods.
    pub fn refusing(robot: &Robot) -> Self {
        Self { refuses: true, ..Self::of(robot) }
    }
}

impl Engine for Double {
    fn identity(&self) -> &Identity {
        &self.identity
    }

    fn methods(&self, quantity: Quantity) -> Vec<String> {
        let mut methods = self.featherbench.methods(quantity);
        if self.usual && quantity != Quantity::ForwardDynamics {
            methods.truncate(1);
        }
        methods
    }

    fn timed(&self, quantity: Quantity) -> Vec<String> {
        let mut methods = self.methods(quantity);
        if self.estimates {
            methods.truncate(1);
        }
        methods
    }

    fn estimates(&self) -> bool {
        self.estimates
    }

    fn prepare<'a>(
        &'a self,
        robot: &'a Robot,
        quantity: Quantity,
        method: &str,
        states: &'a StateBatch,
    ) -> Result<Box<dyn Evaluation + 'a>, NoAnswer> {
        if self.refuses {
            return Err(NoAnswer::NotOffered("it supports nothing".into()));
        }
        if quantity == Quantity::Readback {
            return self.featherbench.prepare(robot, quantity, method, states);
        }
        let inner = self.featherbench.prepare(&self.held, quantity, method, self.states.as_ref().unwrap_or(states))?;
        Ok(Box::new(Twisted {
            inner,
            robot,
            quantity,
            method: method.to_owned(),
            count: states.count(),
            twist: Arc::clone(&self.twist),
            overhead: self.estimates.then_some(OVERHEAD),
            values: Vec::new(),
        }))
    }
}

struct Twisted<'a> {
    inner: Box<dyn Evaluation + 'a>,
    robot: &'a Robot,
    quantity: Quantity,
    method: String,
    count: usize,
    twist: Lie,
    overhead: Option<Duration>,
    values: Vec<f64>,
}

impl Evaluation for Twisted<'_> {
    fn run(&mut self, range: Range<usize>) -> Result<(), NoAnswer> {
        self.inner.run(range.clone())?;
        self.values.clear();
        for (state, values) in range.zip(self.inner.read().chunks_exact(self.quantity.size(self.robot))) {
            let mut values = values.to_vec();
            let (robot, quantity, method) = (self.robot, self.quantity, &*self.method);
            (self.twist)(Answer { robot, quantity, method, state, values: &mut values });
            self.values.extend(values);
        }
        Ok(())
    }

    fn clock(&mut self, range: Range<usize>) -> Result<Duration, NoAnswer> {
        let start = Instant::now();
        for state in range {
            self.run(state % self.count..state % self.count + 1)?;
        }
        Ok(start.elapsed())
    }

    fn overhead(&self) -> Option<Duration> {
        self.overhead
    }

    fn read(&self) -> &[f64] {
        &self.values
    }
}

/// The rows of the whole agreement study: planned, evaluated with outcomes on disk, compared and judged.
pub fn agreement(robot: &Robot, gates: &Gates, engines: &[Box<dyn Engine>]) -> Vec<Row> {
    whole(&Agreement, robot, gates, engines)
}

/// The rows of a whole study.
pub fn whole(study: &dyn Study, robot: &Robot, gates: &Gates, engines: &[Box<dyn Engine>]) -> Vec<Row> {
    let context = Context { robots: std::slice::from_ref(robot), engines, gates, seed: SEED };
    let folder = tempfile::tempdir().unwrap();
    let store = OutcomeStore::open(folder.path()).unwrap();
    let cells = plan(study, &context, &|_| true);
    let finished = evaluate(study, &context, cells, &store, &Silent).unwrap();
    compare(study, &context, finished)
}

/// The rows of our own kernels and a double.
pub fn beside_native(robot: &Robot, gates: &Gates, double: Double) -> Vec<Row> {
    agreement(robot, gates, &[Box::new(Featherbench::new()), Box::new(double)])
}

/// A suite that asks the double beside our own kernels, with the counts of given rows.
pub struct Expected {
    /// The suite.
    pub suite: Suite,
    counts: Counts,
}

impl Expected {
    /// The conditions of a run of it with these rows.
    pub fn conditions(&self, gates: &Gates, rows: &[Row], complete: bool) -> Vec<Expectation> {
        let mut conditions = gates.conditions(&self.suite, rows, complete);
        if complete {
            let info = RunInfo { suite: "one".into(), studies: vec!["agreement".into()], ..RunInfo::default() };
            conditions.extend(self.counts.conditions(&info, self.suite.engines(), rows));
        }
        conditions
    }
}

/// A suite that asks the double beside our own kernels. It expects the cells and rows of the given rows.
pub fn suite(expected: &[Row]) -> Expected {
    let text = format!(
        "about = \"one robot\"\nseed = {SEED}\nthorough = true\nrobot = []\nstates = {STATES}\nengines = [\"double\"]\n[agreement]\n"
    );
    let suite = Suite::parse(&text, Path::new("suite.toml")).unwrap();
    Expected { counts: Counts::of("one", suite.engines(), expected), suite }
}

/// The beginning of the conditions on the sharpness of computed bounds.
pub const SHARPNESS: &str = "kinds of joint and base for which";
/// The common text of the conditions on our own errors over the best engine's. They need many robots; these tests have one, and no other
/// engine.
pub const OVER_BEST: &str = " of over_best on ";

/// The conditions that are not met, except the sharp bounds, which a suite as a whole must have.
pub fn red(conditions: &[Expectation]) -> Vec<&str> {
    let about_the_engine = |what: &str| !what.starts_with(SHARPNESS) && !what.contains(OVER_BEST);
    let unmet = conditions.iter().filter(|condition| condition.verdict != Verdict::Pass && about_the_engine(&condition.what));
    unmet.map(|condition| condition.what.as_str()).collect()
}

/// The rows of the double with this verdict.
pub fn doubles(records: &[Row], verdict: Verdict) -> Vec<&Row> {
    records.iter().filter(|row| row.engine == "double" && row.verdict == verdict).collect()
}
