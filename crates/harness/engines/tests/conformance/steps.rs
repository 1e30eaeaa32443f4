//! Steps: an oracle that does not offer them gets no requests for them, and mistakes in them are found.

use super::kernels::{HONEST, Kernels, Plant};
use super::{test, wrong};
use featherbench_engines::conformance::Standing;
use featherbench_protocol::Message;
use serde_json::{Value, json};

/// Makes `hello` say this about steps.
fn told(answer: &mut Message, request: &Message, steps: Value) {
    if request.text("op") == "hello" {
        answer.header.insert("steps".into(), steps);
    }
}

/// Makes it offer the integrator without error.
fn offered(answer: &mut Message, request: &Message, _: &Kernels) {
    told(answer, request, json!({"methods": ["exact"]}));
}

/// The kernels with their integrator.
const STEPPING: Plant = Plant { answer: offered, ..HONEST };

/// Changes the numbers that answer one op, state after state.
fn change(answer: &mut Message, request: &Message, op: &str, to: impl Fn(&mut f64)) {
    let value = answer.blocks.iter_mut().filter(|block| request.text("op") == op && block.name == "value");
    value.for_each(|block| block.data.iter_mut().for_each(&to));
}

#[test]
fn one_that_does_not_integrate_hears_nothing_of_steps() {
    let conformance = test(HONEST);
    assert!(conformance.conforms() && conformance.steps.is_empty());
    let about = conformance.findings.iter().filter(|finding| finding.what.contains("step") || finding.what.contains("fall"));
    assert_eq!(about.count(), 0);
}

#[test]
fn honest_steps_are_right() {
    let conformance = test(STEPPING);
    assert!(conformance.conforms(), "{:#?}", conformance.of(Standing::Wrong).collect::<Vec<_>>());
    assert_eq!(conformance.steps, ["exact"]);
    let right: Vec<&str> = conformance.of(Standing::Right).map(|finding| finding.what.as_str()).collect();
    for what in ["step by exact", "fall by exact", "a step of no length is refused", "a fall from a state that was not sent is refused"] {
        assert!(right.contains(&what), "{what} is not among {right:?}");
    }
    let compared = conformance.of(Standing::Right).filter(|finding| finding.what.ends_with("by exact"));
    assert!(compared.map(|finding| &finding.found).all(|found| found.starts_with("27 robots")));
}

#[test]
fn another_acceleration_is_found() {
    let answer = |answer: &mut Message, request: &Message, kernels: &Kernels| {
        offered(answer, request, kernels);
        change(answer, request, "step", |a| *a *= 1.001);
    };
    let found = wrong(Plant { answer, ..HONEST });
    assert!(found.len() == 1 && found[0].starts_with("step by exact: 27 of 27 robots are off"), "{found:?}");
    let answer = |answer: &mut Message, request: &Message, kernels: &Kernels| {
        offered(answer, request, kernels);
        change(answer, request, "step", |a| *a = f64::NAN);
    };
    let found = wrong(Plant { answer, ..HONEST });
    assert!(found.len() == 1 && found[0].contains("by NaN"), "{found:?}");
}

#[test]
fn another_energy_is_found() {
    let answer = |answer: &mut Message, request: &Message, kernels: &Kernels| {
        offered(answer, request, kernels);
        change(answer, request, "fall", |e| *e = -*e);
    };
    let found = wrong(Plant { answer, ..HONEST });
    assert!(found.len() == 1 && found[0].starts_with("fall by exact: 27 of 27") && found[0].contains("world's origin"), "{found:?}");
}

#[test]
fn other_shapes_and_lengths_are_found() {
    let answer = |answer: &mut Message, request: &Message, kernels: &Kernels| {
        offered(answer, request, kernels);
        if request.text("op") == "fall"
            && let Some(block) = answer.blocks.first_mut()
        {
            block.shape.reverse();
        }
    };
    let found = wrong(Plant { answer, ..HONEST });
    assert!(!found.is_empty() && found.iter().all(|line| line.starts_with("fall by exact") && line.contains("is due")), "{found:?}");
    let request = |message: &mut Message, _: &Kernels| {
        if message.header.get("dt").and_then(Value::as_f64) == Some(0.0) {
            message.header.insert("dt".into(), json!(1.0));
        }
    };
    let found = wrong(Plant { request, ..STEPPING });
    assert!(found.len() == 2 && found.iter().all(|line| line.contains("of no length is refused")), "{found:?}");
}

#[test]
fn steps_that_are_none_are_found() {
    let answer = |answer: &mut Message, request: &Message, _: &Kernels| told(answer, request, json!({"methods": []}));
    let found = wrong(Plant { answer, ..HONEST });
    assert!(found.len() == 1 && found[0].contains("no method"), "{found:?}");
}
