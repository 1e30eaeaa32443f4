//! Known deviations that are reproduced: one that no longer exists, has grown, or cannot be evaluated must fail the run.

use featherbench_bench::run::{Silent, compare, evaluate, plan};
use featherbench_bench::{Context, DeviationFile, Engine, Gates, NoAnswer, OutcomeStore};
use featherbench_comparison::Reproductions;
use featherbench_doubles::Double;
use featherbench_results::{Row, Verdict};
use std::path::Path;
use std::sync::Arc;

const KNOWN: &str = r#"
[[reproduction]]
name = "double_loss"
condition = "always"
measure = "a share"
range = [0.1, 0.4]
upstream = "none found"
"#;

/// The rows when the reproduction's values are these.
fn rows(known: &Gates, values: impl Fn() -> Result<Vec<f64>, NoAnswer> + Send + Sync + 'static) -> Vec<Row> {
    let engines: Vec<Box<dyn Engine>> = vec![Box::new(Double::of(&featherbench_doubles::robot("chain:n=2")))];
    let context = Context { robots: &[], engines: &engines, gates: known, seed: 1 };
    let study = Reproductions {
        reproduce: Arc::new(move |name, seeds| {
            assert_eq!((name, seeds), ("double_loss", 20));
            values()
        }),
    };
    let folder = tempfile::tempdir().unwrap();
    let store = OutcomeStore::open(folder.path()).unwrap();
    let cells = plan(&study, &context, &|_| true);
    assert_eq!(cells.len(), 1);
    compare(&study, &context, evaluate(&study, &context, cells, &store, &Silent).unwrap())
}

fn verdicts(values: Vec<f64>) -> Vec<(String, Verdict)> {
    rows(&featherbench_doubles::gates(KNOWN), move || Ok(values.clone())).into_iter().map(|row| (row.metric, row.verdict)).collect()
}

#[test]
fn a_deviation_within_its_range_passes_and_others_do_not() {
    let [smallest, largest] = ["smallest", "largest"].map(String::from);
    let of = |a, b| vec![(smallest.clone(), a), (largest.clone(), b)];
    assert_eq!(verdicts(vec![0.11, 0.39]), of(Verdict::Pass, Verdict::Pass));
    // Rounding differs by a factor of two at most.
    assert_eq!(verdicts(vec![0.051, 0.79]), of(Verdict::Pass, Verdict::Pass));
    assert_eq!(verdicts(vec![0.2, 0.049]), of(Verdict::Fail, Verdict::Pass), "it has shrunk at one seed");
    assert_eq!(verdicts(vec![0.0, 0.0]), of(Verdict::Fail, Verdict::Pass), "it is gone");
    assert_eq!(verdicts(vec![0.2, 0.81]), of(Verdict::Pass, Verdict::Fail), "it has grown");
    assert_eq!(verdicts(vec![0.2, f64::NAN, 0.3]), of(Verdict::Error, Verdict::Error));
    assert_eq!(verdicts(vec![]), of(Verdict::Error, Verdict::Error));
}

#[test]
fn what_cannot_be_evaluated_is_an_error_with_its_reason() {
    let failed = rows(&featherbench_doubles::gates(KNOWN), || Err(NoAnswer::Failed("ImportError: no engine".into())));
    assert_eq!(failed.len(), 1);
    assert_eq!((failed[0].verdict, failed[0].reason.as_str()), (Verdict::Error, "ImportError: no engine"));
    let file = DeviationFile::parse(&format!("version = \"0.9\"\n{KNOWN}"), Path::new("double.toml")).unwrap();
    let older = Gates::default().with_deviations(file);
    let other = rows(&older, || Ok(vec![0.2]));
    assert_eq!(other[0].verdict, Verdict::Error);
    assert!(other[0].reason.contains("double 0.9, here is 1"), "{}", other[0].reason);
}
