//! Our kernels in a process of their own: what they answer there, and what is said of a process that a limit ends.

use featherbench_bench::alone::{self, Question};
use featherbench_bench::{Limits, NoAnswer, OWN, Quantity};
use featherbench_engines::Featherbench;
use featherbench_engines::alone::{ask, command};
use std::ffi::OsString;
use std::path::Path;
use std::time::Duration;

fn question(robot: &str, limits: Limits) -> Question {
    let (engine, method) = (OWN.to_owned(), "aba".to_owned());
    Question { engine, robot: robot.into(), quantity: Quantity::ForwardDynamics, method, threads: 1, seed: 3, seconds: 0.001, limits }
}

fn program() -> Vec<OsString> {
    command(Path::new(env!("CARGO_BIN_EXE_featherbench")))
}

fn failure(command: &[OsString], question: &Question) -> String {
    match ask(command, question) {
        Err(NoAnswer::Failed(reason)) => reason,
        other => panic!("{other:?} is no failure"),
    }
}

#[test]
fn a_child_gives_the_answer_of_this_process_with_its_time_and_memory() {
    let question = question("chain:n=200,layout=spatial", Limits::default());
    let measured = ask(&program(), &question).unwrap();
    let robot = alone::robot(&question.robot, question.seed).unwrap();
    let here = alone::measure(&Featherbench::new(), &robot, &question, || None).unwrap();
    let bits = |values: &[f64]| values.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
    assert_eq!((measured.dofs, bits(&measured.answer)), (200, bits(&here.answer)));
    assert!(measured.calls.len() >= 3 && measured.calls.iter().all(|&time| time > 0.0) && measured.build > 0.0, "{measured:?}");
    let memory = measured.memory.unwrap();
    assert!(memory.peak >= memory.resident && memory.resident > 100_000, "{memory:?}");
}

#[test]
fn a_method_on_two_threads_gives_the_bits_of_one() {
    let ask = |robot: &str, quantity, method: &str, threads| {
        let question = Question { quantity, method: method.into(), threads, ..question(robot, Limits::default()) };
        ask(&program(), &question).map(|measured| measured.answer.iter().map(|x| x.to_bits()).collect::<Vec<_>>())
    };
    let tree = "binary_tree:depth=9";
    for (quantity, parallel, serial) in [
        (Quantity::InverseDynamics, "rnea_parallel", None),
        (Quantity::ForwardDynamics, "aba_parallel", Some("aba")),
        (Quantity::ForwardDynamics, "ltdl_parallel", None),
        (Quantity::MassMatrixSparse, "crba_parallel", Some("crba")),
        (Quantity::Factorization, "ltdl_parallel", Some("ltdl")),
    ] {
        let one = ask(tree, quantity, parallel, 1).unwrap();
        assert!(!one.is_empty() && ask(tree, quantity, parallel, 2).unwrap() == one, "{parallel}");
        if let Some(serial) = serial {
            assert!(ask(tree, quantity, serial, 1).unwrap() == one, "{parallel} beside {serial}");
        }
    }
    let chain = "chain:n=40,layout=spatial";
    assert_eq!(ask(chain, Quantity::ForwardDynamics, "twisted", 2), ask(chain, Quantity::ForwardDynamics, "twisted", 1));
    // What does not divide this robot says so.
    for (robot, method) in [(chain, "aba_parallel"), (tree, "twisted")] {
        assert!(matches!(ask(robot, Quantity::ForwardDynamics, method, 2), Err(NoAnswer::NotOffered(_))), "{robot} {method}");
    }
}

#[test]
fn a_limit_of_memory_or_time_is_the_reason() {
    // A million links do not fit in 256 MiB.
    let memory = Limits { memory: 256 << 20, ..Limits::default() };
    let reason = failure(&program(), &question("chain:n=1000000,layout=spatial", memory));
    assert!(reason.contains("memory limit 256 MiB") && reason.contains("memory allocation of"), "{reason}");
    let time = Limits { answer: Duration::from_millis(300), ..Limits::default() };
    let reason = failure(&["sh".into(), "-c".into(), "sleep 20".into()], &question("chain:n=2", time));
    assert_eq!(reason, "no answer within 0.3 s");
    let reason = failure(&["sh".into(), "-c".into(), "kill -9 $$".into()], &question("chain:n=2", Limits::default()));
    assert!(reason.contains("signal: 9"), "{reason}");
}

#[test]
fn a_question_that_makes_no_sense_is_refused_with_a_reason() {
    let reason = failure(&program(), &question("chain:n=0", Limits::default()));
    assert!(reason.contains("n=0 does not do"), "{reason}");
    let other = Question { method: "guess".into(), ..question("chain:n=2", Limits::default()) };
    assert!(matches!(ask(&program(), &other), Err(NoAnswer::NotOffered(reason)) if reason.contains("guess")));
}
