//! The fuzz targets: for each of our parsers, a function that takes any bytes.
//!
//! A robot that is read must be written and read again alike. `ci/fuzz/run` gives the targets to libFuzzer. `crates/cli/tests/parsers.rs`
//! compiles this file and gives them some thousand mutations of the seeds in every test run.

use featherbench_bench::{
    Counts, DeviationFile, Engines, Gates, Identity, NoAnswer, NoSettings, Outcome, Quantity, Robot, RobotEntry, Suite,
};
use featherbench_engines::{EngineRecording, Recording};
use featherbench_formats::urdf::{Base, Options};
use featherbench_formats::{OnLoss, mjcf, neutral, urdf};
use featherbench_protocol::Message;
use featherbench_results::{EngineSource, ModelOrigin, Relation, Row, RunInfo, Verdict};
use featherbench_robots::{Chain, Family};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::LazyLock;

/// A target: bytes in, a panic when something is wrong.
pub type Target = fn(&[u8]);

/// Every target by its name, which is that of its folder of seeds.
pub const TARGETS: [(&str, Target); 12] = [
    ("urdf", urdf_file),
    ("mjcf", mjcf_file),
    ("neutral", neutral_file),
    ("message", message),
    ("recording", recording),
    ("family", family),
    ("suite", suite),
    ("gates", gates),
    ("records", records),
    ("run_info", run_info),
    ("drawings", drawings),
    ("contact", contact_file),
];

/// Bytes that are text.
fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap_or("")
}

fn file() -> &'static Path {
    Path::new("fuzzed")
}

/// A URDF file; what is read goes into both formats, and through URDF back to the same text.
pub fn urdf_file(bytes: &[u8]) {
    for base in [Base::Fixed, Base::Floating] {
        let options = Options { base, allow_massless: true, independent_mimics: true };
        let Ok((robot, _)) = urdf::import(text(bytes), "fuzzed", &options) else { continue };
        assert_eq!(robot.canonical().as_ref(), Ok(&robot), "what is read is canonical");
        let _ = mjcf::to_string(&robot, OnLoss::LeaveOut);
        let Ok((written, _)) = urdf::to_string(&robot, OnLoss::LeaveOut) else { continue };
        let options = Options { base: Base::Fixed, ..options };
        let (again, _) = urdf::import(&written, "written", &options).unwrap_or_else(|error| panic!("{error}\n{written}"));
        let (twice, _) = urdf::to_string(&again, OnLoss::LeaveOut).unwrap_or_else(|error| panic!("{error}\n{written}"));
        assert_eq!(twice, written, "a second trip changes nothing");
    }
}

/// An MJCF file; what is read goes into MJCF and back to the same text.
pub fn mjcf_file(bytes: &[u8]) {
    let Ok((robot, _)) = mjcf::import(text(bytes), "fuzzed") else { return };
    assert_eq!(robot.canonical().as_ref(), Ok(&robot), "what is read is canonical");
    let Ok((written, _)) = mjcf::to_string(&robot, OnLoss::LeaveOut) else { return };
    // A mass that MuJoCo refuses is a loss of the writer, and an error of the reader.
    let Ok((again, _)) = mjcf::import(&written, "written") else { return };
    let (twice, _) = mjcf::to_string(&again, OnLoss::LeaveOut).unwrap_or_else(|error| panic!("{error}\n{written}"));
    let (third, _) = mjcf::import(&twice, "twice").unwrap_or_else(|error| panic!("{error}\n{twice}"));
    assert_eq!(mjcf::to_string(&third, OnLoss::LeaveOut).map(|(text, _)| text).ok(), Some(twice), "a further trip changes nothing");
}

/// A description file; what is read is written to the same numbers.
pub fn neutral_file(bytes: &[u8]) {
    let Ok(robot) = neutral::parse(text(bytes), "fuzzed") else { return };
    let written = neutral::to_string(&robot).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(neutral::parse(&written, "written").unwrap_or_else(|error| panic!("{error}\n{written}")), robot);
    let _ = (urdf::to_string(&robot, OnLoss::LeaveOut), mjcf::to_string(&robot, OnLoss::LeaveOut), neutral::to_line(&robot));
}

/// A file of a contact problem; what is read is written to the same numbers.
pub fn contact_file(bytes: &[u8]) {
    let Ok(problem) = featherbench_contact::file::parse(text(bytes), "fuzzed") else { return };
    let written = featherbench_contact::file::to_text(&problem);
    assert_eq!(featherbench_contact::file::parse(&written, "written").unwrap_or_else(|error| panic!("{error}\n{written}")), problem);
}

/// Messages of the oracle protocol, one after the other.
pub fn message(mut bytes: &[u8]) {
    while let Ok(Some(message)) = Message::read(&mut bytes) {
        let written = message.to_bytes();
        let again = Message::read(&mut written.as_slice());
        assert_eq!(again.ok().flatten().map(|message| message.to_bytes()), Some(written));
    }
}

/// A recording of one small robot's answers: as it is, and with a right checksum, which the rest of the parser requires.
pub fn recording(bytes: &[u8]) {
    static PROBLEM: LazyLock<Robot> = LazyLock::new(recorded_robot);
    let mut sealed = bytes.to_vec();
    featherbench_results::seal(&mut sealed);
    let read = Recording::from_bytes(bytes, &PROBLEM).or_else(|_| Recording::from_bytes(&sealed, &PROBLEM));
    let Ok(recording) = read else { return };
    let written = recording.to_bytes(&PROBLEM);
    let again = Recording::from_bytes(&written, &PROBLEM).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(again.to_bytes(&PROBLEM), written);
}

/// The robot that the seeds of [`recording`] are about.
pub fn recorded_robot() -> Robot {
    let robot = Family::Chain(Chain { n: 2, ..Chain::default() }).generate().expect("a small chain");
    Robot::new(&robot, "chain", ModelOrigin::Generated, 3, 1).expect("a small chain")
}

/// A recording of it by one engine, with two answers and one error.
pub fn recording_seed() -> Vec<u8> {
    let robot = recorded_robot();
    let states = robot.states.count();
    let identity = Identity { name: "engine".into(), version: "1".into(), source: EngineSource::Recorded, build: BTreeMap::new() };
    let values = |length: usize| Outcome::Values((0..length * states).map(|k| 0.1 * k as f64).collect());
    let outcomes = vec![
        (Quantity::InverseDynamics, "a".to_owned(), values(2)),
        (Quantity::InverseDynamics, "b".to_owned(), values(2)),
        (Quantity::MassMatrix, "a".to_owned(), values(4)),
        (Quantity::MassMatrix, "b".to_owned(), values(4)),
        (Quantity::Bias, "a".to_owned(), Outcome::NoAnswer(NoAnswer::NotOffered("why".into()))),
    ];
    Recording { engines: vec![EngineRecording { identity, outcomes }] }.to_bytes(&robot)
}

/// A file of rows, with every verdict.
pub fn records_seed() -> Vec<u8> {
    let row = Row { robot: "m \"quoted\", é".into(), nv: Some(3), floor: Some(1e-17), ..Row::default() };
    let rows = [
        row.clone().gated(1e-15, Relation::Le, 1e-14),
        row.clone().gated(1e-13, Relation::Within, 1e-14).deviating("known"),
        row.clone().informed(0.5),
        row.without_value(Verdict::Skip, "not offered"),
    ];
    featherbench_results::to_csv(&rows, file()).expect("finite")
}

/// The `run.json` of an empty run.
pub fn run_info_seed() -> Vec<u8> {
    let run = RunInfo { format: featherbench_results::RUN_FORMAT, run: "r".into(), ..RunInfo::default() };
    serde_json::to_vec(&run).expect("plain data")
}

/// The drawings of one small robot.
pub fn drawings_seed() -> Vec<u8> {
    let drawing = featherbench_bench::drawing::of(&recorded_robot()).expect("a small chain");
    let drawings = BTreeMap::from([("chain".to_owned(), drawing)]);
    featherbench_results::drawings_to_text(&drawings, file()).expect("finite").into_bytes()
}

/// The seeds of a target that are generated, because their formats change.
pub fn made_seeds(target: &str) -> Vec<Vec<u8>> {
    match target {
        "recording" => {
            let sealed = recording_seed();
            let bare = featherbench_results::unsealed(&sealed).map(<[u8]>::to_vec);
            [Some(sealed.clone()), bare].into_iter().flatten().collect()
        }
        "records" => vec![records_seed()],
        "run_info" => vec![run_info_seed()],
        "drawings" => vec![drawings_seed()],
        _ => Vec::new(),
    }
}

/// The text that names a generated robot.
pub fn family(bytes: &[u8]) {
    let Ok(family) = Family::parse(text(bytes)) else { return };
    let written = family.to_string();
    assert_eq!(Family::parse(&written).map(|again| again.to_string()), Ok(written));
}

/// A suite file.
pub fn suite(bytes: &[u8]) {
    if let Ok(suite) = Suite::parse(text(bytes), file()) {
        let sources = |entry: &RobotEntry| [&entry.model, &entry.generate, &entry.urdf, &entry.mjcf].into_iter().flatten().count();
        assert!(suite.robots.iter().all(|entry| sources(entry) == 1));
        let tables = suite.studies.iter().map(|study| suite.settings::<NoSettings>(study));
        assert!(tables.filter_map(Result::ok).all(|table| table.is_some()), "each table is found");
    }
    if let Ok(counts) = Counts::parse(text(bytes), file()) {
        assert_eq!(Counts::parse(&counts.to_csv(), file()).unwrap(), counts);
    }
}

/// Gates, deviations of an engine and a description of engines, separated by lines of hyphens.
pub fn gates(bytes: &[u8]) {
    let mut parts = text(bytes).split("\n---\n");
    let mut part = || parts.next().unwrap_or_default();
    let (gates, deviations, engines) = (part(), part(), part());
    if let Ok(mut gates) = Gates::parse(gates, file()) {
        if let Ok(deviations) = DeviationFile::parse(deviations, file()) {
            gates = gates.with_deviations(deviations);
        }
        if let Ok(engines) = Engines::parse(engines, file()) {
            gates = gates.with_lacks(engines.lacks());
        }
        let row = gates.judge(Row { study: "agreement".into(), ..Row::default() }, 1e-15, 1.0);
        assert!(row.verdict != Verdict::Pass || row.bound.is_some());
    }
}

/// A file of rows.
pub fn records(bytes: &[u8]) {
    let Ok(rows) = featherbench_results::parse_csv(text(bytes), file()) else { return };
    let written = featherbench_results::to_csv(&rows, file()).unwrap_or_else(|error| panic!("{error}"));
    let again = featherbench_results::parse_csv(text(&written), file()).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(again, rows);
}

/// A `run.json`.
pub fn run_info(bytes: &[u8]) {
    let Ok(run) = RunInfo::parse(text(bytes), file()) else { return };
    let written = serde_json::to_string(&run).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(RunInfo::parse(&written, file()).unwrap_or_else(|error| panic!("{error}")), run);
}

/// A file of drawings.
pub fn drawings(bytes: &[u8]) {
    let Ok(drawings) = featherbench_results::parse_drawings(text(bytes), file()) else { return };
    let written = featherbench_results::drawings_to_text(&drawings, file()).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(featherbench_results::parse_drawings(&written, file()).unwrap_or_else(|error| panic!("{error}")), drawings);
}
