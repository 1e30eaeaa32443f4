//! A process that exchanges messages: answers, request numbers, and what is said of a process that exits.

use featherbench_protocol::{Block, Limits, Message, Process};
use serde_json::json;

/// A process of the shell with this script. Its limits are those of an oracle: nothing here comes near them.
fn shell(script: &str) -> Process {
    Process::start(&["sh".into(), "-c".into(), script.into()], Limits::default()).expect("there is a shell")
}

fn question() -> Message {
    Message::new(json!({"op": "hello"}), vec![Block::new("x", &[2], &[1.0, -0.0])])
}

#[test]
fn a_process_that_echoes_gives_the_request_back_with_its_number() {
    let mut echo = shell("exec cat");
    for number in 1..4 {
        let answer = echo.ask(&question()).expect("cat answers");
        assert_eq!(answer.header.get("id"), Some(&json!(number)));
        assert_eq!(answer.blocks, question().blocks);
    }
    assert!(echo.alive());
    assert_eq!(echo.close(), Ok(()));
}

#[test]
fn an_answer_to_another_request_is_an_error_and_ends_the_process() {
    let mut other = shell(r#"read line; echo '{"id":7}'; exec cat >/dev/null"#);
    assert!(other.ask(&question()).unwrap_err().contains("to request 7, not to 1"));
    assert!(!other.alive());
    assert!(other.ask(&question()).unwrap_err().contains("has ended"), "it is not asked again");
}

#[test]
fn a_line_that_is_no_message_is_named() {
    let mut chatty = shell("read line; echo hello; exec cat >/dev/null");
    assert!(chatty.ask(&question()).unwrap_err().contains("not in the protocol: bad message header"));
}

#[test]
fn an_exit_is_told_with_its_status_and_the_last_lines_of_standard_error() {
    let mut failing = shell("read line; for k in 1 2 3 4 5 6 7; do echo line $k >&2; done; exit 3");
    let reason = failing.ask(&question()).unwrap_err();
    assert!(reason.contains("the oracle exited (exit status: 3; memory limit 8192 MiB): line 2 | line 3"), "{reason}");
    assert!(reason.ends_with("line 7"), "{reason}");
}

#[test]
fn the_end_of_a_process_is_checked() {
    let refused = |script: &str| shell(script).close().unwrap_err();
    assert_eq!(refused("cat; exit 4"), "it ended with exit status: 4");
    assert_eq!(refused("echo '{}'; exec cat"), "it sent an answer that nobody asked for");
    assert!(Process::start(&[], Limits::default()).is_err_and(|reason| reason.contains("no program")));
}
