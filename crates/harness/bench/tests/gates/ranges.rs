//! Ranges of known deviations: measured over runs, and read from files.

use super::{on, plain, range, row};
use featherbench_bench::{Range, RangeKey, Ranges, RangesMeter};
use featherbench_results::Row;
use std::path::Path;

#[test]
fn ranges_are_measured_over_runs() {
    let gates = plain();
    let run = |values: &[(&str, &str, f64)]| -> Vec<Row> {
        values.iter().map(|&(model, case, value)| gates.judge(Row { states: case.into(), ..on(model) }, value, 1.0)).collect()
    };
    let mut meter = RangesMeter::default();
    meter.add(&gates, &run(&[("gantry", "fast", 2e-14), ("gantry", "fast", 4e-14), ("gantry", "zero", 1e-9), ("hoist-1", "fast", 5e-15)]));
    meter.add(&gates, &run(&[("gantry", "fast", 1.5e-14), ("hoist-1", "fast", 3e-14), ("hoist-2", "fast", 1e-15)]));
    meter.add(&gates, &run(&[("gantry", "fast", 8e-14), ("pulley", "fast", 1e-9)]));
    let ranges = meter.ranges(&Ranges::default()).unwrap();
    let expected: Ranges = [(RangeKey::of(&row()), range(1.5e-14, 8e-14, 3, 3)), (RangeKey::of(&on("hoist-1")), range(5e-15, 3e-14, 1, 2))]
        .into_iter()
        .collect();
    assert_eq!(ranges, expected, "the worst of each run; another case, a robot always inside, and one without a cause do not count");
    let (up, down) = meter.leaps(&ranges);
    assert_eq!((up.len(), down.len()), (2, 1));
    assert!((up[0] - 2.0).abs() < 1e-12 && (up[1] - 6.0).abs() < 1e-12 && (down[0] - 4.0 / 1.5).abs() < 1e-12, "{up:?} {down:?}");
    // Failures that are excused already are the same failures.
    let gates = plain().with_ranges(ranges.clone(), Path::new("here")).unwrap();
    let mut again = RangesMeter::default();
    again.add(&gates, &[gates.judge(row(), 4e-14, 1.0)]);
    assert_eq!(again.ranges(&ranges).unwrap().get(&row()), Some(&range(4e-14, 4e-14, 1, 1)));
    assert_eq!(ranges.get(&on("hoist-2")), None);
    // And the text gives the same ranges.
    let text = ranges.to_csv();
    assert_eq!(Ranges::parse(&text, Path::new("ranges.csv")).unwrap(), ranges);
    assert!(text.contains("crane,2,rnea,id,gantry,scaled,cables,1.5e-14,8e-14,3,3\n"), "{text}");
}

/// A robot of two suites has the range of both.
#[test]
fn ranges_of_several_files_span_both() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, range: Range| {
        let ranges: Ranges = [(RangeKey::of(&row()), range)].into_iter().collect();
        std::fs::write(folder.path().join(name), ranges.to_csv()).unwrap();
    };
    assert_eq!(Ranges::read(&folder.path().join("none")).unwrap(), Ranges::default());
    write("a.csv", range(2e-14, 3e-14, 20, 20));
    write("b.csv", range(1e-14, 2e-14, 4, 10));
    std::fs::write(folder.path().join("README.md"), "no ranges").unwrap();
    assert_eq!(Ranges::read(folder.path()).unwrap().get(&row()), Some(&range(1e-14, 3e-14, 24, 30)));
    // But not of two deviations.
    write("b.csv", Range { deviation: "winds".into(), ..range(1e-14, 2e-14, 4, 10) });
    let error = Ranges::read(folder.path()).unwrap_err().to_string();
    assert!(["b.csv", "gantry", "'winds'", "'cables'"].iter().all(|word| error.contains(word)), "{error}");
}
