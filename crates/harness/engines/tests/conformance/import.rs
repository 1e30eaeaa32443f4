//! The op `import`: an oracle without it lacks it, and mistakes in an import result are named.

use super::kernels::{HONEST, Kernels, Plant};
use super::{test, wrong};
use featherbench_engines::conformance::Standing;
use featherbench_protocol::Message;
use serde_json::{Value, json};

/// The lacking findings, as text.
fn lacking(plant: Plant) -> Vec<String> {
    let conformance = test(plant);
    assert!(conformance.conforms(), "{:#?}", conformance.of(Standing::Wrong).collect::<Vec<_>>());
    conformance.of(Standing::Lacks).map(|finding| format!("{}: {}", finding.what, finding.found)).collect()
}

/// Whether it is an answer to `import` that reports a robot.
fn tells(answer: &Message, request: &Message) -> bool {
    request.text("op") == "import" && answer.text("status") == "ok"
}

fn bodies(answer: &mut Message) -> &mut Vec<Value> {
    answer.header.get_mut("model").and_then(|model| model["bodies"].as_array_mut()).expect("a robot")
}

#[test]
fn what_is_not_read_is_lacking() {
    let unknown = |answer: &mut Message, request: &Message, _: &Kernels| {
        if request.text("op") == "import" {
            *answer = Message::new(json!({"status": "error", "reason": "there is no op 'import'"}), Vec::new());
        }
    };
    let found = lacking(Plant { answer: unknown, ..HONEST });
    assert!(found.iter().any(|line| line == "the op `import`: there is no op 'import'"), "{found:#?}");
    let blind = |answer: &mut Message, request: &Message, _: &Kernels| {
        if request.text("op") == "import" {
            *answer = Message::new(json!({"status": "unsupported", "reason": "no parser"}), Vec::new());
        }
    };
    let found = lacking(Plant { answer: blind, ..HONEST });
    assert!(found.iter().any(|line| line == "it reads a URDF on a fixed base: no parser"), "{found:#?}");
    let fails = |answer: &mut Message, request: &Message, _: &Kernels| {
        if tells(answer, request) {
            *answer = Message::new(json!({"status": "error", "reason": "ParserError: 7"}), Vec::new());
        }
    };
    let found = wrong(Plant { answer: fails, ..HONEST });
    assert!(found.len() == 2 && found.iter().all(|line| line.contains("ParserError: 7")), "{found:#?}");
}

/// An edit by the parser is not a fault, if the answers are those of the reported robot.
#[test]
fn an_edit_is_told_and_no_fault() {
    let mirrored = |answer: &mut Message, request: &Message, _: &Kernels| {
        if tells(answer, request) {
            bodies(answer).iter_mut().for_each(|body| body["joint"]["damping"] = json!([]));
        }
    };
    assert!(lacking(Plant { answer: mirrored, ..HONEST }).len() == 5, "damping is not compared");
    let lighter = |answer: &mut Message, request: &Message, _: &Kernels| {
        if tells(answer, request) {
            bodies(answer)[1]["mass"] = json!(0.25);
        }
    };
    // It reports one robot and computes with the file's. That is a fault, and both robots are named.
    let conformance = test(Plant { answer: lighter, ..HONEST });
    let edits: Vec<_> = conformance.of(Standing::Lacks).filter(|finding| finding.what.ends_with("as it stands")).collect();
    assert!(edits[0].found == "mass of prismatic_middle is another" && edits.len() == 2, "{edits:#?}");
    let wrong: Vec<_> = conformance.of(Standing::Wrong).map(|finding| finding.what.as_str()).collect();
    let quantities = ["bias", "fd", "id", "kinetic_energy", "mass_matrix"].map(|quantity| format!("{quantity} by kernel, as read"));
    assert_eq!(wrong, quantities, "{:#?}", conformance.findings);
}

/// Mistakes in an import result: the planted mistake, and words of the finding that names it.
#[test]
fn mistakes_of_a_reading_are_named() {
    type Change = fn(&mut Message, &Message, &Kernels);
    let planted: [(&str, Change); 8] = [
        ("there is no model", |answer, request, _| {
            if tells(answer, request) {
                answer.header.remove("model");
            }
        }),
        ("nv is 7, the model has 6", |answer, request, _| {
            if tells(answer, request) {
                answer.header["nv"] = json!(answer.header["nv"].as_u64().unwrap() + 1);
            }
        }),
        // Level by level: the arms, then their tips.
        ("prismatic_side_arm stands where prismatic_tip is due", |answer, request, _| {
            if tells(answer, request) && bodies(answer).len() == 6 {
                let bodies = bodies(answer);
                bodies.swap(3, 4);
                bodies[5]["parent"] = json!(3);
            }
        }),
        ("there is no 'link 0' in the file", |answer, request, _| {
            if tells(answer, request) {
                bodies(answer)[0]["name"] = json!("link 0");
            }
        }),
        ("there is no cause 'rounded'", |answer, request, _| {
            if tells(answer, request) {
                answer.header["notes"] = json!([{"cause": "rounded", "about": null, "text": "x"}]);
            }
        }),
        ("the base is not free", |answer, request, kernels| {
            if tells(answer, request) && request.text("base") == "free" {
                let fixed =
                    Message::new(json!({"op": "import", "file": request.text("file"), "format": "urdf", "base": "fixed"}), Vec::new());
                *answer = featherbench_engines::conformance::Connection::ask(&mut Kernels::new(HONEST), &fixed).unwrap();
                assert!(kernels.robot.is_some());
            }
        }),
        ("quantities of bodies are unsupported of a robot as read: answered 'ok'", |answer, _, _| {
            if answer.text("reason").contains("as read") {
                *answer = super::ok();
            }
        }),
        ("a file that is not there is an error: answered 'ok'", |answer, request, _| {
            if request.text("op") == "import" && answer.text("status") == "error" {
                *answer = super::ok();
            }
        }),
    ];
    for (words, answer) in planted {
        let found = wrong(Plant { answer, ..HONEST });
        assert!(found.iter().any(|line| line.contains(words)), "'{words}' is not in {found:#?}");
    }
}

/// The reported bodies have the second of two branches first; the states are taken in the file's order.
#[test]
fn states_in_another_order_than_the_bodies_told() {
    let branches = |answer: &mut Message, request: &Message, _: &Kernels| {
        if tells(answer, request) && bodies(answer).len() == 6 {
            let bodies = bodies(answer);
            bodies[2..].rotate_left(2);
            (bodies[3]["parent"], bodies[5]["parent"]) = (json!(2), json!(4));
        }
    };
    let found = wrong(Plant { answer: branches, ..HONEST });
    assert_eq!(found.len(), 5, "{found:#?}");
    for line in &found {
        assert!(line.contains(", as read:") && line.contains("depth-first with siblings") && !line.contains("another cause"), "{line}");
    }
}
