//! The section of small steps: it appears with its rows alone, with a line for each way to step, longest steps first, and its order.

use record::{Record, Verdict};
use written::Written;

mod support;
mod written;

#[test]
fn steps_become_lines_and_orders() {
    let run = support::run_info();
    let blank = Record {
        study: "step_limit".into(),
        model: run.models[0].name.clone(),
        engine: run.engines[0].name.clone(),
        quantity: "fd".into(),
        method: "step".into(),
        case: "random".into(),
        metric: "step_error".into(),
        unit: "1".into(),
        ..Record::default()
    };
    let at = |dt: &str, error: f64| Record { params: format!("{{\"dt\":{dt}}}"), ..blank.clone() }.informed(error);
    let judged = Record { metric: "order_off_one".into(), verdict: Verdict::Fail, value: Some(0.25), ..blank.clone() };
    let other = Record { method: "step_default".into(), ..at("0.001", 0.5) };
    let drift = Record { quantity: "kinetic_energy".into(), metric: "energy_drift".into(), ..at("0.01", 0.125) };
    let order = Record { metric: "order".into(), ..blank.clone() }.informed(1.25);
    let records = [at("0.001", 2e-3), at("0.01", 2e-2), at("1e-10", 2e-10), order, judged, other, drift];

    let written = Written::of(&run, &records);
    let lines = &written.data("figures")["steps"];
    let kinds: Vec<_> =
        lines.as_array().unwrap().iter().map(|line| (line["method"].as_str().unwrap(), line["energy"].as_bool().unwrap())).collect();
    assert_eq!(kinds, [("step", false), ("step_default", false), ("step", true)]);
    assert_eq!(lines[0]["points"], serde_json::json!([[0.01, 2e-2], [0.001, 2e-3], [1e-10, 2e-10]]));
    assert_eq!((&lines[0]["order"], &lines[1]["order"]), (&serde_json::json!(1.25), &serde_json::Value::Null));
    let section = written.section("steps");
    assert!(section.contains("1.2500") && section.contains("badge fail"), "{section}");
    assert!(written.index.contains("<a href=\"#steps\">"));

    let without = Written::of(&run, &support::records(&run));
    assert!(!without.index.contains("<section id=\"steps\"") && !without.index.contains("<a href=\"#steps\">"));
}
