//! The trait [`Study`]: a question, asked as cells and answered as rows.

use crate::{Cell, Engine, Gates, NoAnswer, Outcome, Quantity, Robot};
use featherbench_results::Row;
use std::collections::BTreeMap;

/// The data of a study: the robots and the engines.
pub struct Context<'a> {
    /// The robots, in the suite's order.
    pub robots: &'a [Robot],
    /// The engines, ours first.
    pub engines: &'a [Box<dyn Engine>],
    /// Every threshold.
    pub gates: &'a Gates,
    /// The suite's seed.
    pub seed: u64,
}

impl Context<'_> {
    /// The robot of a cell.
    pub fn robot(&self, name: &str) -> Option<&Robot> {
        self.robots.iter().find(|robot| robot.name == name)
    }

    /// The engine of a cell.
    pub fn engine(&self, name: &str) -> Option<&dyn Engine> {
        self.engines.iter().find(|engine| engine.identity().name == name).map(AsRef::as_ref)
    }
}

/// What a cell asks: its robot, engine and quantity, looked up once by the run. Not every cell has all three: a study takes what it needs.
#[derive(Clone, Copy)]
pub struct Asked<'a> {
    /// The data of the study.
    pub context: &'a Context<'a>,
    /// The cell.
    pub cell: &'a Cell,
    robot: Option<&'a Robot>,
    engine: Option<&'a dyn Engine>,
    quantity: Option<Quantity>,
}

impl<'a> Asked<'a> {
    /// What a cell asks.
    pub fn of(context: &'a Context<'a>, cell: &'a Cell) -> Self {
        let (robot, engine) = (context.robot(&cell.robot), context.engine(&cell.engine));
        Self { context, cell, robot, engine, quantity: Quantity::parse(&cell.quantity) }
    }

    /// Its robot.
    ///
    /// # Errors
    /// [`NoAnswer::Failed`] if it has none.
    pub fn robot(&self) -> Result<&'a Robot, NoAnswer> {
        self.robot.ok_or_else(|| none("robot"))
    }

    /// Its engine.
    ///
    /// # Errors
    /// [`NoAnswer::Failed`] if it is not there.
    pub fn engine(&self) -> Result<&'a dyn Engine, NoAnswer> {
        self.engine.ok_or_else(|| none("engine"))
    }

    /// What only some engines offer, such as steps or loops.
    ///
    /// # Errors
    /// [`NoAnswer::Failed`] if the engine is not there, or does not offer it.
    pub fn offered<T>(&self, offer: impl FnOnce(&'a dyn Engine) -> Option<T>) -> Result<T, NoAnswer> {
        offer(self.engine()?).ok_or_else(|| NoAnswer::Failed(format!("{} does not offer what this cell asks", self.cell.engine)))
    }

    /// Its quantity, of those that every engine can be asked for.
    ///
    /// # Errors
    /// [`NoAnswer::Failed`] if it is one of its study alone.
    pub fn quantity(&self) -> Result<Quantity, NoAnswer> {
        self.quantity.ok_or_else(|| none("quantity"))
    }
}

fn none(what: &str) -> NoAnswer {
    NoAnswer::Failed(format!("there is no {what} of this cell"))
}

/// A finished cell.
pub type Finished = (Cell, Outcome);

/// A question about robots and engines.
///
/// A study plans its cells and evaluates each one alone (in any order, on any thread, once). It turns the outcomes into rows by a pure
/// function. So a resumed run is byte-identical.
pub trait Study: Sync {
    /// The study's name in rows.
    fn name(&self) -> &'static str;

    /// Whether its cells run alone on a quiet machine, after all others.
    fn exclusive(&self) -> bool {
        false
    }

    /// Whether it measures times, which a run may leave out.
    fn measures_time(&self) -> bool {
        false
    }

    /// The engines beside the suite's that it asks if they are installed.
    fn engines(&self) -> &[String] {
        &[]
    }

    /// Whether it asks an engine of the run, beside ours, for something. One that is asked and offers nothing of it gets a row that says so.
    ///
    /// By default those that it names.
    fn asks(&self, engine: &dyn Engine) -> bool {
        self.engines().contains(&engine.identity().name)
    }

    /// Whether these must have a clock of their own.
    fn needs_clocks(&self) -> bool {
        self.measures_time()
    }

    /// The cells, in the order of the report.
    fn plan(&self, context: &Context) -> Vec<Cell>;

    /// About how long a cell takes on one core, in seconds, where no run has measured it. It decides how a run is cut into shards, and no result.
    ///
    /// By default: a millisecond for the question, and a microsecond for each state and dof.
    fn seconds(&self, context: &Context, cell: &Cell) -> f64 {
        let robot = context.robot(&cell.robot);
        1e-3 + robot.map_or(0.0, |robot| 1e-6 * (robot.states.count() * robot.states.nv) as f64)
    }

    /// Whether a cell belongs to no robot. It is evaluated whenever any cell of the study is.
    fn is_common(&self, _cell: &Cell) -> bool {
        false
    }

    /// The number of the process in which a cell is evaluated, if it must be a new one. Cells of the same number share theirs.
    fn process(&self, _cell: &Cell) -> Option<usize> {
        None
    }

    /// Evaluates one cell.
    fn evaluate(&self, asked: &Asked) -> Outcome;

    /// Turns the outcomes of one robot into rows. Studies without robots of the suite have none.
    fn compare(&self, _context: &Context, _robot: &Robot, _finished: &[Finished]) -> Vec<Row> {
        Vec::new()
    }

    /// Whether [`compare_all`](Self::compare_all) or [`side_file`](Self::side_file) may have something to say: then the outcomes of all robots
    /// are in memory together. A study that says no is compared robot by robot, and these two are not asked.
    fn compares_all(&self) -> bool {
        true
    }

    /// Turns the outcomes into the rows that belong to no robot. Most studies have none.
    fn compare_all(&self, _context: &Context, _finished: &[Finished]) -> Vec<Row> {
        Vec::new()
    }

    /// A file of its own beside the rows, if the outcomes need one: its name and its text.
    fn side_file(&self, _: &[Finished]) -> Option<(&'static str, String)> {
        None
    }
}

/// Groups finished cells by robot, in the order of the robots.
pub(crate) fn by_robot(finished: Vec<Finished>) -> BTreeMap<String, Vec<Finished>> {
    let mut groups: BTreeMap<String, Vec<Finished>> = BTreeMap::new();
    for item in finished {
        groups.entry(item.0.robot.clone()).or_default().push(item);
    }
    groups
}
