//! The figures of a run as a paper takes them: `featherbench report RUN --figures DIR`.

use crate::support;

use featherbench_results::{Kind, Row, RunInfo};
use std::fs;
use support::Sandbox;

/// Errors against the truth on two robots, and times on them.
fn rows() -> Vec<Row> {
    let row = |study: &str, engine: &str, robot: &str, nv: u64, metric: &str, value: f64| {
        let row = Row {
            study: study.into(),
            engine: engine.into(),
            robot: robot.into(),
            nv: Some(nv),
            bodies: Some(nv),
            depth: Some(nv),
            method: "aba".into(),
            precision: "f64".into(),
            quantity: "fd".into(),
            metric: metric.into(),
            kind: Kind::Measured,
            ..Row::default()
        };
        row.informed(value)
    };
    let timed =
        |engine: &str, robot: &str, nv: u64, ns: f64| Row { cache: "stream".into(), ..row("timing", engine, robot, nv, "ns_per_call", ns) };
    let error = |engine: &str, robot: &str, nv: u64, value: f64| row("accuracy", engine, robot, nv, "error_worst", value);
    vec![
        error("featherbench", "arm", 7, 1e-15),
        error("featherbench", "long", 70, 1e-14),
        error("drake", "arm", 7, 1e-13),
        error("drake", "long", 70, 1e-12),
        timed("featherbench", "arm", 7, 500.0),
        timed("featherbench", "long", 70, 5000.0),
        timed("pinocchio", "arm", 7, 1000.0),
    ]
}

#[test]
fn a_run_gives_figures_data_captions_and_references() {
    let sandbox = Sandbox::new();
    let info = RunInfo { run: "r".into(), started: "2026-03-04T05:06:07Z".into(), ..RunInfo::default() };
    featherbench_results::write_run(&sandbox.path("run"), &info, &rows()).unwrap();
    // What has no rows is absent, and named with what it needs.
    sandbox.run(&["report", "run", "--figures", "paper"]).expect(
        0,
        &[
            "figures: 5 in paper: error-depth-fd, error-size-fd, error-distribution, time-size, speed-profile",
            "absent: error-depth-id, which needs errors of inverse dynamics",
            "absent: speed-ratios",
            "PDF",
        ],
    );
    let text = |name: &str| fs::read_to_string(sandbox.path("paper").join(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
    for name in ["error-depth-fd", "error-size-fd", "error-distribution", "time-size", "speed-profile"] {
        assert!(text(&format!("{name}.svg")).starts_with("<svg "), "{name}");
        assert_eq!(
            text(&format!("{name}.svg")),
            fs::read_to_string(sandbox.path("run/figures").join(format!("{name}.svg"))).unwrap(),
            "the page shows the same"
        );
        assert!(text("captions.md").contains(&format!("`{name}.svg`")));
    }
    assert!(text("error-size-fd.csv").contains("drake aba,long,70,0.000000000001\n"), "{}", text("error-size-fd.csv"));
    assert!(text("captions.md").contains("The largest errors, from the worst engine: drake 1e-12 on long, featherbench 1e-14 on long."));
    // One problem has times of two engines: ours takes half as long.
    assert!(text("captions.md").contains("Of 1 problem ") && text("captions.md").contains("the fastest engine: featherbench of 1."));
    assert!(text("speed-profile.csv").contains("pinocchio,forward dynamics of arm,2,1\n"), "{}", text("speed-profile.csv"));
    assert!(text("references.bib").starts_with("@misc{featherbench,"));
}

/// Counts are drawn for the robots that the run has, and beside its times.
#[test]
fn instruction_counts_are_drawn_over_the_robots_of_a_run() {
    let sandbox = Sandbox::new();
    featherbench_results::write_run(&sandbox.path("run"), &RunInfo { run: "r".into(), ..RunInfo::default() }, &rows()).unwrap();
    let counts = "rustc,kernel,model,instructions\n1.95.0,fd/aba,arm,2000\n1.95.0,fd/aba,long,20000\n1.95.0,fd/aba,unknown,7\n";
    fs::write(sandbox.path("counts.csv"), counts).unwrap();
    sandbox
        .run(&["report", "run", "--figures", "paper", "--instructions", "counts.csv"])
        .expect(0, &["instructions-dynamics, instructions-time"]);
    let text = |name: &str| fs::read_to_string(sandbox.path("paper").join(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
    assert!(text("instructions-dynamics.csv").ends_with("forward dynamics aba,arm,7,2000\nforward dynamics aba,long,70,20000\n"));
    // 2000 over 500 ns and 20 000 over 5000 ns.
    assert!(text("captions.md").contains("2 kernels of ours") && text("captions.md").contains("4 to 4 instructions per nanosecond"));
    fs::write(sandbox.path("counts.csv"), "rustc,kernel,model,instructions\n1.95.0,fd/aba,arm,many\n").unwrap();
    sandbox
        .run(&["report", "run", "--figures", "paper", "--instructions", "counts.csv"])
        .expect(2, &["counts.csv: line 2: 'many' is no count"]);
    fs::write(sandbox.path("counts.csv"), "rustc,kernel,model,instructions\n").unwrap();
    sandbox.run(&["report", "run", "--figures", "paper", "--instructions", "counts.csv"]).expect(0, &["absent: instructions"]);
}

#[test]
fn a_run_without_rows_for_a_figure_is_told() {
    let sandbox = Sandbox::new();
    featherbench_results::write_run(&sandbox.path("run"), &RunInfo { run: "r".into(), ..RunInfo::default() }, &rows()[..0]).unwrap();
    sandbox.run(&["report", "run", "--figures", "paper"]).expect(2, &["--figures: run r has no rows for any figure", "absent: time-size"]);
    assert!(!sandbox.path("paper").exists());
}
