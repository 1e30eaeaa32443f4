//! A run may be killed at any moment and byte. The resumed run repeats nothing that is finished, and ends in the same bytes as a run that
//! was not killed. Tested by truncating its file of outcomes, by ending a real process, by a panic, and on any number of threads.

use featherbench_bench::run::{Progress, Silent, compare, evaluate, plan};
use featherbench_bench::{
    Asked, Cell, Context, Entries, Finished, Gates, HarnessError, Lost, NoAnswer, OUTCOMES_NAME, Outcome, OutcomeStore, Robot, Study,
};
use featherbench_protocol::Message;
use featherbench_results::{ModelOrigin, Row, Verdict};
use featherbench_robots::{Family, Random};
use rayon::ThreadPoolBuilder;
use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::process::Command;
use std::sync::Mutex;

/// Cells per robot.
const METHODS: usize = 12;

/// A study that counts how often each cell is evaluated, and fails where it is told to.
#[derive(Default)]
struct Counting {
    evaluated: Mutex<BTreeMap<String, usize>>,
    /// Panic in this many of the cells' methods, from the first.
    panics: usize,
    /// End the process at this evaluation, without a message.
    dies_at: Option<usize>,
    exclusive: bool,
}

impl Counting {
    fn counts(&self) -> BTreeMap<String, usize> {
        self.evaluated.lock().unwrap().clone()
    }
}

impl Study for Counting {
    fn name(&self) -> &'static str {
        "counting"
    }

    fn exclusive(&self) -> bool {
        self.exclusive
    }

    fn plan(&self, context: &Context) -> Vec<Cell> {
        let cell = |robot: &Robot, method: usize| Cell {
            study: self.name().into(),
            robot: robot.name.clone(),
            robot_hash: robot.hash.clone(),
            params: serde_json::json!({"method": method}),
            engine: ["some", "other"][method % 2].into(),
            version: "1".into(),
            method: format!("method {method}"),
            quantity: "id".into(),
            scalar: "f64".into(),
        };
        context.robots.iter().flat_map(|robot| (0..METHODS).map(move |method| cell(robot, method))).collect()
    }

    /// Values that depend on the cell alone, among them both kinds of missing answers.
    fn evaluate(&self, &Asked { context, cell, .. }: &Asked) -> Outcome {
        let total = {
            let mut evaluated = self.evaluated.lock().unwrap();
            *evaluated.entry(cell.id()).or_default() += 1;
            evaluated.values().sum::<usize>()
        };
        if let Some(last) = self.dies_at {
            match total.cmp(&last) {
                Ordering::Less => {}
                Ordering::Equal => std::process::exit(70),
                // The exit takes a while: no other thread begins a cell meanwhile, however busy the machine is.
                Ordering::Greater => loop {
                    std::thread::park();
                },
            }
        }
        let method = cell.params["method"].as_u64().unwrap() as usize;
        assert!(method >= self.panics, "method {method} breaks");
        match method % 6 {
            4 => Outcome::NoAnswer(NoAnswer::NotOffered("not \"this\", or\nthat".into())),
            5 => Outcome::NoAnswer(NoAnswer::Failed("it broke".into())),
            3 => Outcome::Text(format!("{{\"cell\": \"{}\"}}\n", cell.id())),
            _ => {
                let mut random = Random::named(context.seed, &cell.id());
                Outcome::Values((0..1 + 40 * method).map(|_| random.uniform(-1.0, 1.0)).collect())
            }
        }
    }

    fn compare(&self, _: &Context, robot: &Robot, finished: &[Finished]) -> Vec<Row> {
        let row = |(cell, outcome): &Finished| {
            let blank = Row { cell: cell.id(), robot: robot.name.clone(), method: cell.method.clone(), ..Row::default() };
            match outcome {
                Outcome::Values(values) => blank.informed(values.iter().sum()),
                Outcome::Text(text) => blank.informed(text.len() as f64),
                Outcome::NoAnswer(NoAnswer::NotOffered(reason)) => blank.without_value(Verdict::Skip, reason.as_str()),
                Outcome::NoAnswer(NoAnswer::Failed(reason)) => blank.without_value(Verdict::Error, reason.as_str()),
            }
        };
        finished.iter().map(row).collect()
    }
}

fn robots() -> Vec<Robot> {
    let robot = |n: usize| {
        let description = Family::parse(&format!("chain:n={n}")).unwrap().generate().unwrap();
        Robot::new(&description, "chain", ModelOrigin::Generated, 1, 1).unwrap()
    };
    // Not in the order of their names.
    [3, 1, 4, 2].map(robot).into()
}

/// Runs or resumes in a folder and returns the final rows as bytes.
fn run_in(folder: &Path, study: &Counting, progress: &dyn Progress) -> Result<Vec<u8>, HarnessError> {
    let (robots, gates) = (robots(), Gates::default());
    let context = Context { robots: &robots, engines: &[], gates: &gates, seed: 7 };
    let store = OutcomeStore::open(folder)?;
    let finished = evaluate(study, &context, plan(study, &context, &|_| true), &store, progress)?;
    Ok(featherbench_results::to_csv(&compare(study, &context, finished), folder).unwrap())
}

/// The ids in a file of outcomes, up to the first incomplete entry.
fn whole_entries(mut bytes: &[u8]) -> BTreeSet<String> {
    std::iter::from_fn(|| Message::read(&mut bytes).ok().flatten()).map(|entry| entry.text("cell").to_owned()).collect()
}

/// A finished run: its bytes on disk, its rows and the cells' ids.
fn whole() -> (Vec<u8>, Vec<u8>, BTreeSet<String>) {
    let folder = tempfile::tempdir().unwrap();
    let study = Counting::default();
    let csv = run_in(folder.path(), &study, &Silent).unwrap();
    let counts = study.counts();
    assert_eq!(counts.len(), 4 * METHODS);
    assert!(counts.values().all(|&count| count == 1));
    (std::fs::read(folder.path().join(OUTCOMES_NAME)).unwrap(), csv, counts.into_keys().collect())
}

#[test]
fn a_killed_run_repeats_nothing_that_is_finished() {
    let (bytes, csv, ids) = whole();
    assert_eq!(whole_entries(&bytes), ids);
    let mut random = Random::named(1, "cuts");
    let cuts = [0, 1, bytes.len() - 1, bytes.len()].into_iter().chain((0..60).map(|_| random.below(bytes.len())));
    for cut in cuts {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(OUTCOMES_NAME), &bytes[..cut]).unwrap();
        let study = Counting::default();
        assert_eq!(run_in(folder.path(), &study, &Silent).unwrap(), csv, "cut at {cut}");
        let missing: BTreeMap<String, usize> = ids.difference(&whole_entries(&bytes[..cut])).map(|id| (id.clone(), 1)).collect();
        assert_eq!(study.counts(), missing, "cut at {cut}");
        let again = Counting::default();
        assert_eq!(run_in(folder.path(), &again, &Silent).unwrap(), csv);
        assert!(again.counts().is_empty(), "a finished run has nothing left to do");
    }
}

/// A resumed run is killed many times.
#[test]
fn many_kills_are_as_good_as_none() {
    let (_, csv, ids) = whole();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(OUTCOMES_NAME);
    let mut random = Random::named(2, "kills");
    for _ in 0..20 {
        assert_eq!(run_in(folder.path(), &Counting::default(), &Silent).unwrap(), csv);
        let bytes = std::fs::read(&path).unwrap();
        assert_eq!(whole_entries(&bytes), ids);
        std::fs::write(&path, &bytes[..random.below(bytes.len() + 1)]).unwrap();
    }
}

/// Damage in the middle: no entry after it is trusted, and nothing of it gets into the rows.
#[test]
fn a_damaged_file_is_used_as_far_as_it_is_whole() {
    let (bytes, csv, _) = whole();
    let lines: Vec<usize> = (0..bytes.len()).filter(|&at| bytes[at..].starts_with(b"{\"blake3\"")).collect();
    // One line per cell, its checksum first.
    assert!(lines.len() >= 4 * METHODS, "{} lines", lines.len());
    for &line in lines.iter().step_by(7) {
        for junk in [&b"\n"[..], b"}", b"\0\0\0\0", b"{}\n"] {
            let folder = tempfile::tempdir().unwrap();
            let mut damaged = bytes.clone();
            damaged[line..line + junk.len()].copy_from_slice(junk);
            std::fs::write(folder.path().join(OUTCOMES_NAME), damaged).unwrap();
            let study = Counting::default();
            assert_eq!(run_in(folder.path(), &study, &Silent).unwrap(), csv, "{junk:?} at {line}");
            assert_eq!(study.counts().len(), 4 * METHODS - whole_entries(&bytes[..line]).len());
        }
    }
}

/// One flipped bit anywhere: the rows of the resumed run are those of the complete one, and a lost entry is reported.
#[test]
fn a_flipped_bit_never_makes_other_rows() {
    let (bytes, csv, ids) = whole();
    let first = bytes.iter().position(|&byte| byte == b'\n').unwrap();
    let mut random = Random::named(3, "flips");
    let anywhere = (0..300).map(|_| random.below(bytes.len())).collect::<Vec<_>>();
    for at in (0..=first).chain(anywhere) {
        let folder = tempfile::tempdir().unwrap();
        let mut flipped = bytes.clone();
        flipped[at] ^= 1 << random.below(8);
        std::fs::write(folder.path().join(OUTCOMES_NAME), &flipped).unwrap();
        let entries = Entries::open(folder.path()).unwrap();
        let found = entries.cells().count();
        let lost = entries.lost().unwrap_or_else(|| panic!("nothing was noticed at {at}")).to_string();
        assert!(lost.contains(OUTCOMES_NAME) && lost.contains(&format!("entry {}:", found + 1)), "{lost}");
        let refused = Entries::whole(folder.path()).unwrap_err().to_string();
        assert!(refused.contains(OUTCOMES_NAME), "{refused}");
        let study = Counting::default();
        assert_eq!(run_in(folder.path(), &study, &Silent).unwrap(), csv, "at {at}");
        assert_eq!(study.counts().len(), ids.len() - found, "at {at}");
    }
}

/// Another spelling of the same JSON, which one flipped bit makes of an exponent: the checksum is over the values, and the bytes are compared too.
#[test]
fn another_spelling_of_a_number_is_damage() {
    let (bytes, csv, ids) = whole();
    let folder = tempfile::tempdir().unwrap();
    let text = bytes.iter().map(|&byte| if byte.is_ascii() { byte as char } else { ' ' }).collect::<String>();
    let number = text.find("\"seconds\":").unwrap() + "\"seconds\":".len();
    let end = number + text[number..].find([',', '}']).unwrap();
    // The seconds of the first entry.
    let again = match text[number..end].split_once('e') {
        Some((digits, exponent)) => format!("{digits}E{exponent}"),
        None => format!("{}e0", &text[number..end]),
    };
    let spelled = [&bytes[..number], again.as_bytes(), &bytes[end..]].concat();
    assert_ne!(spelled, bytes);
    std::fs::write(folder.path().join(OUTCOMES_NAME), &spelled).unwrap();
    let entries = Entries::open(folder.path()).unwrap();
    assert!(entries.cells().count() == 0 && entries.lost().unwrap().to_string().contains("entry 1: "));
    let study = Counting::default();
    assert_eq!(run_in(folder.path(), &study, &Silent).unwrap(), csv);
    assert_eq!(study.counts().len(), ids.len());
}

const FOLDER: &str = "FEATHERBENCH_TEST_DIE_IN";
const MOMENT: &str = "FEATHERBENCH_TEST_DIE_AT";

/// The process that exits: the run, up to an evaluation that ends it.
fn die(folder: &str, moment: &str) -> ! {
    let study = Counting { dies_at: Some(moment.parse().unwrap()), ..Counting::default() };
    run_in(folder.as_ref(), &study, &Silent).unwrap();
    unreachable!("the study ends the process");
}

/// The test starts itself again: with the variables set it is the process that exits.
#[test]
fn a_process_that_dies_loses_only_what_it_was_doing() {
    if let (Ok(folder), Ok(moment)) = (std::env::var(FOLDER), std::env::var(MOMENT)) {
        die(&folder, &moment);
    }
    let (_, csv, ids) = whole();
    let folder = tempfile::tempdir().unwrap();
    let mut finished = 0;
    for moment in [1_usize, 2, 7, 20] {
        let mut child = Command::new(std::env::current_exe().unwrap());
        child
            .args(["--exact", "resume::a_process_that_dies_loses_only_what_it_was_doing", "--nocapture"])
            .env(FOLDER, folder.path())
            .env(MOMENT, moment.to_string());
        let output = child.output().unwrap();
        assert_eq!(output.status.code(), Some(70), "{output:?}");
        let done = whole_entries(&std::fs::read(folder.path().join(OUTCOMES_NAME)).unwrap());
        assert!(done.is_subset(&ids));
        // All cells that it began, except one per thread, are on disk. Those that other threads finish during the exit may be, but
        // never the one that ended the process.
        let threads = rayon::current_num_threads();
        let sure = (finished + moment).saturating_sub(threads);
        assert!((sure..finished + moment).contains(&done.len()), "{} after {moment}", done.len());
        finished = done.len();
    }
    let study = Counting::default();
    assert_eq!(run_in(folder.path(), &study, &Silent).unwrap(), csv);
    assert_eq!(study.counts().len(), ids.len() - finished);
}

/// Progress that panics at a given cell.
struct Fainting(&'static str);

impl Progress for Fainting {
    fn lost(&self, _: &Lost) {}
    fn begin(&self, _: &str, _: usize) {}
    fn cell(&self, cell: &Cell) {
        assert!(cell.path() != self.0, "a panic outside of any cell");
    }
    fn done(&self, _: &Cell, _: &Outcome) {}
    fn end(&self) {}
}

#[test]
fn a_panic_of_the_harness_itself_loses_nothing_finished() {
    let (_, csv, ids) = whole();
    let folder = tempfile::tempdir().unwrap();
    let first = Counting::default();
    let watcher = Fainting("counting/chain-planar-4/other/id/method 7");
    assert!(catch_unwind(AssertUnwindSafe(|| run_in(folder.path(), &first, &watcher))).is_err());
    let second = Counting::default();
    assert_eq!(run_in(folder.path(), &second, &Silent).unwrap(), csv);
    let (first, second): (BTreeSet<_>, BTreeSet<_>) = (first.counts().into_keys().collect(), second.counts().into_keys().collect());
    assert!(first.is_disjoint(&second) && first.len() + second.len() == ids.len());
}

#[test]
fn a_panic_is_the_failure_of_its_cell_alone() {
    let folder = tempfile::tempdir().unwrap();
    let (robots, gates) = (robots(), Gates::default());
    let context = Context { robots: &robots, engines: &[], gates: &gates, seed: 7 };
    for study in [Counting { panics: 2, ..Counting::default() }, Counting { panics: 2, exclusive: true, ..Counting::default() }] {
        let store = OutcomeStore::open(&tempfile::tempdir_in(&folder).unwrap().keep()).unwrap();
        let finished = evaluate(&study, &context, study.plan(&context), &store, &Silent).unwrap();
        assert_eq!(finished.len(), 4 * METHODS);
        for (cell, outcome) in &finished {
            let method = cell.params["method"].as_u64().unwrap();
            if method < 2 {
                let reason = format!("internal error: method {method} breaks");
                assert_eq!(*outcome, Outcome::NoAnswer(NoAnswer::Failed(reason)));
            } else {
                assert_eq!(*outcome, Counting::default().evaluate(&Asked::of(&context, cell)));
            }
        }
        assert!(study.counts().values().all(|&count| count == 1));
    }
}

#[test]
fn threads_and_order_leave_no_trace() {
    let (_, csv, ids) = whole();
    for threads in [1, 4] {
        for exclusive in [false, true] {
            let folder = tempfile::tempdir().unwrap();
            let study = Counting { exclusive, ..Counting::default() };
            let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            assert_eq!(pool.install(|| run_in(folder.path(), &study, &Silent)).unwrap(), csv, "{threads} threads");
            assert_eq!(study.counts().len(), ids.len());
        }
    }
}

/// Cells outside the filter are not evaluated, and the complete run evaluates them later.
#[test]
fn a_part_of_a_run_is_a_part_of_the_whole() {
    let (_, csv, ids) = whole();
    let folder = tempfile::tempdir().unwrap();
    let (robots, gates, part) = (robots(), Gates::default(), Counting::default());
    let context = Context { robots: &robots, engines: &[], gates: &gates, seed: 7 };
    let cells = plan(&part, &context, &|cell| cell.path().contains("chain-planar-4/some"));
    assert_eq!(cells.len(), METHODS / 2);
    evaluate(&part, &context, cells, &OutcomeStore::open(folder.path()).unwrap(), &Silent).unwrap();
    let rest = Counting::default();
    assert_eq!(run_in(folder.path(), &rest, &Silent).unwrap(), csv);
    assert_eq!((part.counts().len(), rest.counts().len()), (METHODS / 2, ids.len() - METHODS / 2));
}

/// A change of any field makes another cell: an outcome of another version, robot or parameter is never used.
#[test]
fn an_outcome_belongs_to_its_cell_to_the_last_letter() {
    let (robots, gates, study) = (robots(), Gates::default(), Counting::default());
    let context = Context { robots: &robots, engines: &[], gates: &gates, seed: 7 };
    let cells = study.plan(&context);
    let ids: BTreeSet<String> = cells.iter().map(Cell::id).collect();
    assert_eq!(ids.len(), cells.len());
    let cell = &cells[0];
    let changes: [fn(&mut Cell); 9] = [
        |cell| cell.study += "x",
        |cell| cell.robot += "x",
        |cell| cell.robot_hash += "x",
        |cell| cell.params["more"] = 1.into(),
        |cell| cell.engine += "x",
        |cell| cell.version += "x",
        |cell| cell.method += "x",
        |cell| cell.quantity += "x",
        |cell| cell.scalar += "x",
    ];
    for change in changes {
        let mut other = cell.clone();
        change(&mut other);
        assert!(!ids.contains(&other.id()));
    }
    let swapped = Cell { engine: cell.version.clone(), version: cell.engine.clone(), ..cell.clone() };
    assert!(!ids.contains(&swapped.id()));
}
