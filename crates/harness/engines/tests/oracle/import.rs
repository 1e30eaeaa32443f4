//! Files that an oracle imports.

use super::script::{PATIENT, READING, Script, Trial, robot};
use featherbench_bench::{Engine, FileBase, FileFormat, Import, NoAnswer, RobotFile};
use featherbench_robots::StateBatch;

impl Trial {
    fn file(&self) -> RobotFile {
        RobotFile {
            path: "/robots/p.urdf".into(),
            format: FileFormat::Urdf,
            base: FileBase::Free,
            hash: "0".into(),
            links: Vec::new(),
            features: Vec::new(),
        }
    }

    fn read(&self) -> Result<Import, NoAnswer> {
        self.oracle.as_ref().unwrap().read(&self.file())
    }

    /// The imports that the engine was asked for.
    fn reads(&self) -> Vec<String> {
        let text = std::fs::read_to_string(self.folder.path().join("read")).unwrap_or_default();
        text.lines().map(str::to_owned).collect()
    }
}

#[test]
fn a_file_is_read_once_and_computed_with_as_it_was_read() {
    let trial = Trial::new(&Script::honest(), PATIENT);
    let reading = trial.read().unwrap();
    assert_eq!((reading.description.bodies.len(), reading.description.bodies[0].name.as_str()), (1, "rod"));
    assert_eq!((reading.notes[0].cause.as_str(), reading.notes[0].about.as_deref()), ("mass_edited", Some("rod")));
    let robot = robot("chain:n=1").from_file(trial.file());
    let as_read = robot.as_read(&reading, |model| StateBatch::agreement(model, 2, 1)).unwrap();
    assert_ne!(as_read.hash, robot.hash, "the route is part of what is asked");
    assert_eq!(trial.ask_about(&as_read).unwrap(), [2.0, 2.0]);
    assert_eq!(trial.reads().len(), 1, "the session still holds what it has read");
    assert!(
        trial.reads()[0].contains(r#""base":"free""#) && trial.reads()[0].contains(r#""file":"/robots/p.urdf""#),
        "{:?}",
        trial.reads()
    );
    // Another request came between: the file must be imported again.
    assert_eq!(trial.ask().unwrap(), [2.0, 2.0]);
    assert_eq!(trial.ask_about(&as_read).unwrap(), [2.0, 2.0]);
    assert_eq!(trial.reads().len(), 2);
}

#[test]
fn a_reading_that_is_no_robot_is_a_failure() {
    let cases = [
        (r#"echo '{"status":"ok","nq":1,"nv":1}'"#.to_owned(), "there is no model"),
        (READING.replace("\"nv\":1", "\"nv\":2"), "nv is 2"),
        (READING.replace("\"mass\":1.0", "\"mass\":-1.0"), "negative"),
        (READING.replace("revolute", "fixed").replace("\"axis\":[0.0,1.0,0.0],", ""), "no moving body"),
        (r#"echo '{"status":"error","reason":"line 3: what is this?"}'"#.to_owned(), "line 3"),
    ];
    for (read, words) in cases {
        match Trial::new(&Script::reading(&read), PATIENT).read() {
            Err(NoAnswer::Failed(reason)) => assert!(reason.contains(words), "{words}: {reason}"),
            other => panic!("{words}: {other:?}"),
        }
    }
}

/// Each question about a file begins with its import. One that the engine refuses, or that ends its process, is asked for once.
#[test]
fn a_refused_file_is_asked_for_once() {
    let refusals = [r#"echo '{"status":"error","reason":"line 3"}'"#, r#"echo '{"status":"unsupported","reason":"no meshes"}'"#, "exit 1"];
    for refusal in refusals {
        let trial = Trial::new(&Script::reading(refusal), PATIENT);
        let first = trial.read().unwrap_err();
        for _ in 0..3 {
            assert_eq!(trial.read().unwrap_err(), first, "{refusal}");
        }
        assert_eq!(trial.reads().len(), 1, "{refusal}: {:?}", trial.reads());
        // Another file is another question.
        let other = RobotFile { path: "/robots/other.urdf".into(), ..trial.file() };
        assert!(trial.oracle.as_ref().unwrap().read(&other).is_err());
        assert_eq!(trial.reads().len(), 2, "{refusal}");
    }
}

#[test]
fn an_engine_that_reads_another_robot_the_second_time_is_not_believed() {
    let trial = Trial::new(&Script::honest(), PATIENT);
    let mut reading = trial.read().unwrap();
    reading.description.bodies[0].mass = 2.0;
    let robot = robot("chain:n=1").from_file(trial.file());
    let as_read = robot.as_read(&reading, |model| StateBatch::agreement(model, 2, 1)).unwrap();
    match trial.ask_about(&as_read) {
        Err(NoAnswer::Failed(reason)) => assert!(reason.contains("does not read the same robot twice"), "{reason}"),
        other => panic!("{other:?}"),
    }
}
