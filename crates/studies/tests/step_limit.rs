//! The study of small steps on a robot whose fast state meets the energy guard of rapier.

use engines::Rapier;
use featherbench_studies::StepLimit;
use harness::Subject;
use record::{Record, Verdict};
use serde_json::Value;
use support::{gates, robot, whole};

mod support;

fn params(row: &Record) -> (f64, Option<String>) {
    let params: Value = serde_json::from_str(&row.params).unwrap();
    (params["dt"].as_f64().unwrap(), params["regime"].as_str().map(str::to_owned))
}

/// Checks the rows of one robot; how many of its steps are explicit, and how many of those at a fast state implicit.
fn regimes(spec: &str) -> [usize; 2] {
    let subjects: [Box<dyn Subject>; 1] = [Box::new(Rapier::new())];
    let rows = whole(&StepLimit, &robot(spec), &gates(""), &subjects);
    let steps = |method: &str| -> Vec<&Record> { rows.iter().filter(|row| row.metric == "step_error" && row.method == method).collect() };
    assert_eq!((steps("step").len(), steps("step_default").len()), (18, 18), "{spec}");
    let (mut explicit, mut implicit) = (0, 0);
    for row in steps("step") {
        let (dt, regime) = params(row);
        let value = row.value.unwrap();
        match regime.as_deref() {
            Some("explicit") => {
                assert!(
                    value < 1e-14 && row.case == "fast" && row.reason.contains("this step is explicit"),
                    "{dt}: {value:e}: {}",
                    row.reason
                );
                explicit += 1;
            }
            Some("implicit") => {
                assert!(value > 1e-14 && row.reason.is_empty(), "{dt}: {value:e}: {}", row.reason);
                implicit += usize::from(row.case == "fast");
            }
            other => panic!("{other:?}"),
        }
        assert_eq!(row.verdict, Verdict::Info);
    }
    // With damping and substeps the acceleration has another limit, and its error no regime.
    assert!(steps("step_default").iter().all(|row| params(row).1.is_none() && row.reason.is_empty()));
    assert!(rows.iter().filter(|row| row.metric == "energy_drift").all(|row| params(row).1.is_none()));
    let order: Vec<f64> = rows.iter().filter(|row| row.metric == "order" && row.quantity == "fd").map(|row| row.value.unwrap()).collect();
    assert!(order.len() == 1 && (order[0] - 1.0).abs() < 0.01, "{order:?}");
    [explicit, implicit]
}

#[test]
fn each_step_names_its_regime() {
    let robots =
        ["chain:n=3,layout=spatial", "chain:n=6,layout=spatial", "joints:kind=spherical,base=fixed", "joints:kind=revolute,base=fixed"];
    let found = robots.map(regimes);
    assert!(found.iter().any(|[explicit, _]| *explicit > 0), "{found:?}");
    assert!(found.iter().all(|[explicit, implicit]| explicit + implicit == 9 && *implicit >= 6), "{found:?}");
}
