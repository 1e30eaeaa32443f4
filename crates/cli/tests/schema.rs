//! `schema.json` of a run explains every name in its rows.

use crate::support::Sandbox;
use std::collections::BTreeSet;

#[test]
fn a_run_explains_every_name_in_its_rows() {
    let sandbox = Sandbox::new();
    sandbox.run(&["run", "--suite", "smoke", "--no-timing", "--out", "run"]).expect(0, &["report:"]);
    let (_, rows) = featherbench_results::read_run(&sandbox.path("run")).unwrap();
    let schema: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(sandbox.path("run/schema.json")).unwrap()).unwrap();
    let named = |list: &str| -> BTreeSet<(String, String)> {
        let of = |term: &serde_json::Value| {
            assert!(term["meaning"].as_str().is_some_and(|meaning| meaning.len() > 3), "{list}: {term} has no meaning");
            (term["study"].as_str().unwrap().to_owned(), term["name"].as_str().unwrap().to_owned())
        };
        schema[list].as_array().unwrap().iter().map(of).collect()
    };
    let metrics: BTreeSet<_> =
        rows.iter().filter(|row| !row.metric.is_empty()).map(|row| (row.study.clone(), row.metric.clone())).collect();
    let quantities: BTreeSet<_> =
        rows.iter().filter(|row| !row.quantity.is_empty()).map(|row| (row.study.clone(), row.quantity.clone())).collect();
    assert!(metrics.len() > 5 && quantities.len() > 10, "{metrics:?} {quantities:?}");
    assert_eq!((named("metrics"), named("quantities")), (metrics, quantities));
    assert!(named("parameters").contains(&("agreement".to_owned(), "joints".to_owned())));
    assert_eq!(schema["columns"].as_array().unwrap().len(), featherbench_results::COLUMNS.len());
}
