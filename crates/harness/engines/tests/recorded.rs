//! Recorded answers are returned to the bit. A file that is truncated, damaged or about another robot is an error that names the file.
//! It never gives a wrong answer, a panic, or a failure of the other robots.

use featherbench_bench::{Engine, Identity, NoAnswer, Outcome, Quantity, Robot};
use featherbench_engines::{
    EngineRecording, Featherbench, Recorded, Recording, RecordingError, Recordings, read_recordings, recording_name,
};
use featherbench_model::Description;
use featherbench_results::{EngineSource, ModelOrigin};
use featherbench_robots::Family;
use std::path::{Path, PathBuf};
use std::sync::Arc;

const QUANTITIES: [Quantity; 5] =
    [Quantity::Readback, Quantity::InverseDynamics, Quantity::MassMatrix, Quantity::ForwardDynamics, Quantity::Momentum];

fn describe(spec: &str) -> Description {
    Family::parse(spec).unwrap().generate().unwrap()
}

fn robot_of(description: &Description, seed: u64) -> Robot {
    Robot::new(description, "test", ModelOrigin::Generated, 4, seed).unwrap()
}

fn robot(spec: &str) -> Robot {
    robot_of(&describe(spec), 1)
}

fn identity(engine: &str, version: &str) -> Identity {
    let build = [("language".to_owned(), "rust".to_owned())].into();
    Identity { name: engine.into(), version: version.into(), source: EngineSource::Recorded, build }
}

/// The answers of our kernels, each number k changed by ulps·(k mod 3) units in the last place.
fn answers(robot: &Robot, engine: &str, version: &str, ulps: u64) -> EngineRecording {
    let featherbench = Featherbench::new();
    let mut outcomes = Vec::new();
    for quantity in QUANTITIES {
        for method in featherbench.methods(quantity) {
            let mut prepared = featherbench.prepare(robot, quantity, &method, &robot.states).unwrap();
            prepared.run(0..robot.asked(quantity)).unwrap();
            let moved = prepared.read().iter().enumerate().map(|(k, x)| f64::from_bits(x.to_bits() + ulps * (k as u64 % 3)));
            outcomes.push((quantity, method, Outcome::Values(moved.collect())));
        }
    }
    EngineRecording { identity: identity(engine, version), outcomes }
}

/// Two engines. One has numbers that are not finite, does not offer one question, and fails at another.
fn recording(robot: &Robot) -> Recording {
    let mut second = answers(robot, "second", "2", 1);
    let Outcome::Values(values) = &mut second.outcomes[1].2 else { panic!("{:?}", second.outcomes[1]) };
    values.splice(..6, [f64::NAN, -f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -0.0, f64::MIN_POSITIVE / 8.0]);
    // A matrix that is not symmetric, and zeros of either sign.
    let Outcome::Values(values) = &mut second.outcomes[2].2 else { panic!("{:?}", second.outcomes[2]) };
    values.splice(1..4, [-0.0, 0.0, 7.5]);
    second.outcomes.push((Quantity::Bias, "a".into(), Outcome::NoAnswer(NoAnswer::NotOffered("no such joint".into()))));
    second.outcomes.push((Quantity::Bias, "b".into(), Outcome::NoAnswer(NoAnswer::Failed("a \"quoted\"\nreason, ünïcode".into()))));
    Recording { engines: vec![answers(robot, "first", "1", 0), second] }
}

fn write(folder: &Path, robot: &Robot, bytes: &[u8]) -> PathBuf {
    let path = folder.join(recording_name(&robot.name));
    std::fs::write(&path, bytes).unwrap();
    path
}

/// An outcome with its values as bits.
type Bits = (Quantity, String, Result<Vec<u64>, NoAnswer>);

/// The contents of a recording.
fn bits(recording: &Recording) -> Vec<(Identity, Vec<Bits>)> {
    let outcome = |outcome: &Outcome| match outcome {
        Outcome::Text(_) => panic!("texts are not recorded"),
        Outcome::Values(values) => Ok(values.iter().map(|x| x.to_bits()).collect()),
        Outcome::NoAnswer(refusal) => Err(refusal.clone()),
    };
    let engine = |engine: &EngineRecording| {
        let outcomes = engine.outcomes.iter().map(|(quantity, method, values)| (*quantity, method.clone(), outcome(values)));
        (engine.identity.clone(), outcomes.collect())
    };
    recording.engines.iter().map(engine).collect()
}

/// A recording without its last line, for damage that the checksum does not show.
fn unsealed(bytes: &[u8]) -> &[u8] {
    featherbench_results::unsealed(bytes).unwrap()
}

fn sealed(bytes: &[u8]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    featherbench_results::seal(&mut bytes);
    bytes
}

#[track_caller]
fn damaged(path: &Path, robot: &Robot) -> String {
    match Recording::read(path, robot) {
        Err(error @ RecordingError::Damaged { .. }) => {
            let message = error.to_string();
            assert!(message.contains(&path.display().to_string()), "{message} does not name the file");
            message
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn every_bit_comes_back() {
    for spec in ["joints:kind=mixed,base=free", "chain:n=3", "tree:n=12,joints=all,armature=true"] {
        let robot = robot(spec);
        let folder = tempfile::tempdir().unwrap();
        let recording = recording(&robot);
        let path = write(folder.path(), &robot, &recording.to_bytes(&robot));
        let read = Recording::read(&path, &robot).unwrap();
        assert!(bits(&read) == bits(&recording), "{spec}");
        assert_eq!(read.to_bytes(&robot), std::fs::read(&path).unwrap(), "{spec}: written again");
    }
}

#[test]
fn a_truncated_file_is_damaged_wherever_it_ends() {
    let robot = robot("joints:kind=universal,base=fixed");
    let folder = tempfile::tempdir().unwrap();
    let whole = recording(&robot).to_bytes(&robot);
    // Every cut near an end of line, where parts begin, and every 61st elsewhere: coprime with the eight bytes of a double.
    let near_a_line = |cut: &usize| whole[cut.saturating_sub(2)..(cut + 2).min(whole.len())].contains(&b'\n');
    for cut in (0..whole.len()).filter(|cut| cut % 61 == 0 || near_a_line(cut)) {
        let message = damaged(&write(folder.path(), &robot, &whole[..cut]), &robot);
        assert!(message.contains("checksum") && message.contains("truncated"), "{message}");
        // Without the checksum: the parts themselves show that something is missing.
        if cut < unsealed(&whole).len() {
            damaged(&write(folder.path(), &robot, &sealed(&whole[..cut])), &robot);
        }
    }
    let path = write(folder.path(), &robot, &[&whole[..], b"x"].concat());
    assert!(damaged(&path, &robot).contains("checksum"));
    let path = write(folder.path(), &robot, &sealed(&[unsealed(&whole), b"x"].concat()));
    assert!(damaged(&path, &robot).contains("behind the end"));
    write(folder.path(), &robot, &whole);
    assert!(Recording::read(&path, &robot).is_ok());
}

/// Every bit of the file.
#[test]
fn every_flipped_bit_is_an_error_that_names_the_file() {
    let robot = robot("chain:n=2");
    let folder = tempfile::tempdir().unwrap();
    let whole = recording(&robot).to_bytes(&robot);
    assert!(Recording::from_bytes(&whole, &robot).is_ok());
    for at in 0..whole.len() {
        for bit in 0..8 {
            let mut flipped = whole.clone();
            flipped[at] ^= 1 << bit;
            assert!(Recording::from_bytes(&flipped, &robot).is_err(), "bit {bit} of byte {at}");
            // From the file itself for one byte in sixteen: one place makes the message.
            if at % 16 == 0 {
                damaged(&write(folder.path(), &robot, &flipped), &robot);
            }
        }
    }
    assert!(whole.len() > 2000, "{} bytes", whole.len());
}

/// Whole parts that are missing, doubled or unknown, each with a right checksum.
#[test]
fn an_altered_file_is_damaged() {
    let robot = robot("chain:n=2");
    let folder = tempfile::tempdir().unwrap();
    let whole = recording(&robot).to_bytes(&robot);
    let whole = unsealed(&whole);
    let last = br#"{"bytes":0,"end":"#;
    let end = whole.windows(last.len()).rposition(|window| window == last).unwrap();
    for bytes in [b"".to_vec(), b"\n".to_vec(), b"{}\n".to_vec(), b"[]\n".to_vec(), b"null\n".to_vec(), whole[end..].to_vec(), vec![0; 100]]
    {
        damaged(&write(folder.path(), &robot, &sealed(&bytes)), &robot);
    }
    let second = whole.iter().position(|&byte| byte == b'\n').unwrap() + 1 + 8 * 4 * (2 * 4 + 6 * 2);
    assert_eq!(whole[second], b'{', "the states are four times q, v, a and τ of two dofs and wrenches of two bodies");
    damaged(&write(folder.path(), &robot, &sealed(&[&whole[..second], &whole[end..]].concat())), &robot);
    let huge = b"{\"bytes\":18446744073709551615,\"engine\":\"e\",\"version\":\"1\"}\n";
    damaged(&write(folder.path(), &robot, &sealed(&[&whole[..second], huge].concat())), &robot);
    let orphan = b"{\"bytes\":0,\"quantity\":\"id\",\"status\":\"ok\"}\n";
    assert!(damaged(&write(folder.path(), &robot, &sealed(&[&whole[..second], orphan].concat())), &robot).contains("before its engine"));
    let head = whole.iter().position(|&byte| byte == b'\n').unwrap();
    let older = String::from_utf8(whole[..head].to_vec()).unwrap().replace("\"recording\":2", "\"recording\":1");
    let message = damaged(&write(folder.path(), &robot, &sealed(&[older.as_bytes(), &whole[head..]].concat())), &robot);
    assert!(message.contains("format 1") && message.contains("record it again"), "{message}");
}

#[test]
fn another_robot_or_other_states_are_refused() {
    let description = describe("joints:kind=mixed,base=fixed");
    let robot = robot_of(&description, 1);
    let folder = tempfile::tempdir().unwrap();
    let path = write(folder.path(), &robot, &recording(&robot).to_bytes(&robot));
    let mut heavier = description.clone();
    heavier.bodies[3].mass *= 1.0 + f64::EPSILON;
    assert!(damaged(&path, &robot_of(&heavier, 1)).contains("another version"));
    assert!(damaged(&path, &robot_of(&description, 2)).contains("another version"));
    let mut moved = robot.clone();
    moved.states.wrench[5] = f64::from_bits(moved.states.wrench[5].to_bits() ^ 1);
    assert!(damaged(&path, &moved).contains("of its states"));
    assert!(Recording::read(&path, &robot).is_ok());
}

#[test]
fn a_missing_file_is_named() {
    let robot = robot("chain:n=2");
    let path = Path::new("nowhere").join(recording_name(&robot.name));
    let error = Recording::read(&path, &robot).unwrap_err();
    assert!(matches!(error, RecordingError::Io { .. }) && error.to_string().contains("chain-planar-2.recording"), "{error}");
    let recordings = Arc::new(read_recordings(Path::new("nowhere"), &[&robot]));
    assert!(Recorded::new(&recordings, "first").err().unwrap().contains("chain-planar-2.recording"));
    assert!(Recorded::new(&Arc::new(Recordings::new()), "first").err().unwrap().contains("first"));
}

#[test]
fn a_recorded_engine_answers_what_it_was_asked() {
    let (good, missing, broken) = (robot("joints:kind=mixed,base=free"), robot("chain:n=3"), robot("chain:n=2"));
    let folder = tempfile::tempdir().unwrap();
    let recording = recording(&good);
    write(folder.path(), &good, &recording.to_bytes(&good));
    write(folder.path(), &broken, b"not a recording");
    let recordings = Arc::new(read_recordings(folder.path(), &[&missing, &good, &broken]));
    assert!(Recorded::new(&recordings, "third").is_err(), "nobody recorded it");
    let recorded = Recorded::new(&recordings, "second").unwrap();
    assert_eq!(*recorded.identity(), identity("second", "2"));
    assert_eq!(recorded.methods(Quantity::ForwardDynamics), ["aba", "aba_packed", "ltdl", "refined_1", "refined_2", "batch"]);
    assert_eq!(recorded.methods(Quantity::Bias), ["a", "b"]);
    assert!(recorded.methods(Quantity::BodyVelocity).is_empty());

    let ask = |robot: &Robot, quantity, method: &str, range: std::ops::Range<usize>| {
        let mut prepared = recorded.prepare(robot, quantity, method, &robot.states)?;
        prepared.run(range)?;
        Ok(prepared.read().iter().map(|x| x.to_bits()).collect::<Vec<u64>>())
    };
    let nv = good.states.nv;
    let Outcome::Values(values) = &recording.engines[1].outcomes[1].2 else { panic!("no values") };
    let due: Vec<u64> = values.iter().map(|x| x.to_bits()).collect();
    assert!(ask(&good, Quantity::InverseDynamics, "rnea_packed", 0..4) == Ok(due.clone()));
    assert!(ask(&good, Quantity::InverseDynamics, "rnea_packed", 1..3) == Ok(due[nv..3 * nv].to_vec()));
    let failed = |answer: Result<Vec<u64>, NoAnswer>| match answer {
        Err(NoAnswer::Failed(reason)) => reason,
        other => panic!("{other:?}"),
    };
    assert!(failed(ask(&good, Quantity::InverseDynamics, "rnea_packed", 0..5)).contains("are due"), "more states than there are");
    assert!(failed(ask(&good, Quantity::InverseDynamics, "abacus", 0..1)).contains("was not recorded"));
    assert_eq!(ask(&good, Quantity::Bias, "a", 0..1), Err(NoAnswer::NotOffered("no such joint".into())));
    assert_eq!(failed(ask(&good, Quantity::Bias, "b", 0..1)), "a \"quoted\"\nreason, ünïcode");
    // The other robots have their own errors, which name their files.
    assert!(failed(ask(&missing, Quantity::InverseDynamics, "rnea_packed", 0..4)).contains("chain-planar-3.recording"));
    assert!(failed(ask(&broken, Quantity::InverseDynamics, "rnea_packed", 0..4)).contains("chain-planar-2.recording"));
    assert!(failed(ask(&robot("chain:n=4"), Quantity::InverseDynamics, "rnea_packed", 0..4)).contains("chain-planar-4"));
}

/// Rows have one version: answers of several versions are not one engine.
#[test]
fn versions_do_not_mix() {
    let folder = tempfile::tempdir().unwrap();
    let (one, two) = (robot("chain:n=1"), robot("chain:n=2"));
    for (robot, version) in [(&one, "1.0"), (&two, "1.1")] {
        let recording = Recording { engines: vec![answers(robot, "engine", version, 0), answers(robot, "other", "5", 0)] };
        write(folder.path(), robot, &recording.to_bytes(robot));
    }
    let recordings = Arc::new(read_recordings(folder.path(), &[&one, &two]));
    let reason = Recorded::new(&recordings, "engine").err().unwrap();
    assert!(reason.contains("1.0 and 1.1"), "{reason}");
    assert!(Recorded::new(&recordings, "other").is_ok());
}
