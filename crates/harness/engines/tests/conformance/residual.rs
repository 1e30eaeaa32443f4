//! A residual: an oracle without one gets no requests for it, and mistakes in it are found.

use super::kernels::{HONEST, Kernels, Plant};
use super::{test, wrong};
use featherbench_engines::conformance::Standing;
use featherbench_protocol::Message;
use serde_json::{Value, json};

/// Makes `hello` say this about the residual.
fn told(answer: &mut Message, request: &Message, residual: Value) {
    if request.text("op") == "hello" {
        answer.header.insert("residual".into(), residual);
    }
}

/// The kernels' residual 0.3 v + 0.2 a.
fn offered(answer: &mut Message, request: &Message, _: &Kernels) {
    told(answer, request, json!({"acceleration": true}));
}

/// The same, with each number of its answers changed.
fn change(answer: &mut Message, request: &Message, kernels: &Kernels, to: impl Fn(&mut f64)) {
    offered(answer, request, kernels);
    if request.text("op") == "residual" {
        answer.blocks.iter_mut().for_each(|block| block.data.iter_mut().for_each(&to));
    }
}

#[test]
fn one_without_a_residual_hears_nothing_of_it() {
    let conformance = test(HONEST);
    assert!(conformance.findings.iter().all(|finding| !finding.what.contains("residual")));
}

#[test]
fn an_honest_residual_is_right() {
    let conformance = test(Plant { answer: offered, ..HONEST });
    assert!(conformance.conforms(), "{:#?}", conformance.of(Standing::Wrong).collect::<Vec<_>>());
    let found = conformance.of(Standing::Right).find(|finding| finding.what == "residual").map(|finding| finding.found.as_str());
    assert!(found.is_some_and(|found| found.starts_with("27 robots, affine in a")), "{found:?}");
    let right: Vec<&str> = conformance.of(Standing::Right).map(|finding| finding.what.as_str()).collect();
    for what in [
        "a residual before states is an error",
        "a residual of a robot without states is an error",
        "a residual beyond the states is an error",
        "an answer is the same to the bit for one state",
    ] {
        assert!(right.contains(&what), "{what} is not among {right:?}");
    }
}

#[test]
fn mistakes_are_found() {
    type Change = fn(&mut Message, &Message, &Kernels);
    let cases: [(Change, &str); 6] = [
        (|answer, request, _| told(answer, request, json!({"acceleration": false})), "r changes with the acceleration"),
        (|answer, request, _| told(answer, request, json!({"accelerates": true})), "unknown field `accelerates`, expected `acceleration`"),
        (|answer, request, kernels| change(answer, request, kernels, |r| *r *= *r), "the second difference of r"),
        (|answer, request, kernels| change(answer, request, kernels, |r| *r = f64::NAN), "is NaN"),
        (
            |answer, request, kernels| {
                offered(answer, request, kernels);
                if request.text("op") == "residual" && request.header.get("count") == Some(&json!(1)) {
                    answer.blocks.iter_mut().for_each(|block| block.data[0] += 1e-12);
                }
            },
            "residual has other bits",
        ),
        (
            |answer, request, kernels| {
                offered(answer, request, kernels);
                // A range beyond the states is answered.
                if request.text("op") == "residual" && answer.text("status") == "error" {
                    answer.header.insert("status".into(), "ok".into());
                }
            },
            "a residual beyond the states is an error",
        ),
    ];
    for (answer, words) in cases {
        let found = wrong(Plant { answer, ..HONEST });
        assert!(!found.is_empty() && found.iter().any(|line| line.contains(words)), "'{words}' is not in {found:#?}");
    }
}
