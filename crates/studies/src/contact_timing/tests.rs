use super::*;
use featherbench_bench::Gates;
use featherbench_results::Verdict;

fn gates() -> Gates {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../ci/gates.toml");
    Gates::parse(&std::fs::read_to_string(&path).unwrap(), &path).unwrap()
}

fn cell(candidates: &[(&str, &str, bool)]) -> Cell {
    let listed =
        candidates.iter().map(|(engine, method, control)| json!({"engine": engine, "version": "1", "method": method, "control": control}));
    Cell {
        study: STUDY.into(),
        robot: "quadruped, 4 contacts".into(),
        robot_hash: String::new(),
        params: json!({"contacts": 4, "rank": 12, "seconds": 1.0, "candidates": listed.collect::<Vec<_>>()}),
        engine: "featherbench".into(),
        version: "1".into(),
        method: OWN[0].into(),
        quantity: QUANTITY.into(),
        scalar: "f64".into(),
    }
}

const FOUR: [(&str, &str, bool); 4] = [
    ("featherbench", "block_gauss_seidel", false),
    ("featherbench", "newton", false),
    ("featherbench", "block_gauss_seidel", true),
    ("peer", "pgs", false),
];

/// An outcome: constant times of the four candidates, and their tolerances and residuals.
fn outcome(ns: [f64; 4], told: [[f64; 2]; 4]) -> Outcome {
    let mut samples = Samples::new(vec![1; 4], 60);
    for (which, ns) in ns.into_iter().enumerate() {
        for round in 0..60 {
            samples.set(which, round, ns);
        }
    }
    Outcome::Values(std::iter::once(3.0).chain(told.into_iter().flatten()).chain(samples.to_values()).collect())
}

fn find<'r>(rows: &'r [Row], engine: &str, metric: &str) -> Option<&'r Row> {
    rows.iter().find(|row| row.engine == engine && row.metric == metric)
}

const GOOD: [[f64; 2]; 4] = [[1e-8, 9e-9]; 4];

#[test]
fn ratios_are_over_the_reference() {
    let rows = rows::rows(&gates(), &cell(&FOUR), &outcome([100.0, 300.0, 100.0, 250.0], GOOD));
    let ratio = find(&rows, "peer", "ratio").unwrap();
    assert_eq!((ratio.value, ratio.ci_low, ratio.valid), (Some(2.5), Some(2.5), true));
    assert_eq!(find(&rows, "featherbench", "control").unwrap().value, Some(1.0));
    assert_eq!(rows.iter().filter(|row| row.metric == "residual" && row.verdict == Verdict::Pass).count(), 3);
    assert_eq!(rows.iter().filter(|row| row.metric == "ns_per_call").count(), 3, "the replicate is no candidate of its own");
}

#[test]
fn a_noisy_experiment_has_no_valid_time() {
    let rows = rows::rows(&gates(), &cell(&FOUR), &outcome([100.0, 300.0, 110.0, 250.0], GOOD));
    let times: Vec<&Row> = rows.iter().filter(|row| ["ns_per_call", "ratio", "control"].contains(&row.metric.as_str())).collect();
    assert!(times.len() == 6 && times.iter().all(|row| !row.valid), "{times:?}");
    let alone = cell(&FOUR[..2]);
    let uncontrolled = rows::rows(&gates(), &alone, &Outcome::Values(vec![]));
    assert_eq!(uncontrolled[0].verdict, Verdict::Error);
}

#[test]
fn an_answer_that_is_not_good_enough_has_no_time() {
    let mut told = GOOD;
    told[3] = [f64::NAN; 2];
    let nothing = outcome([100.0, 300.0, 100.0, f64::NAN], told);
    let rows_of_peer = rows::rows(&gates(), &cell(&FOUR), &nothing);
    assert_eq!(find(&rows_of_peer, "peer", "residual").unwrap().verdict, Verdict::Info);
    assert!(find(&rows_of_peer, "peer", "ns_per_call").is_none());
    told = GOOD;
    told[0] = [f64::NAN; 2];
    let ours = rows::rows(&gates(), &cell(&FOUR), &outcome([100.0; 4], told));
    assert_eq!(find(&ours, "featherbench", "residual").unwrap().verdict, Verdict::Error);
    told = GOOD;
    told[0][1] = 2e-8;
    let ours = rows::rows(&gates(), &cell(&FOUR), &outcome([100.0; 4], told));
    assert_eq!(find(&ours, "featherbench", "residual").unwrap().verdict, Verdict::Fail);
}

/// Our own methods reach the target on a real robot, by a tolerance that the residual confirms.
#[test]
fn our_methods_reach_the_target() {
    let gates = gates();
    let context = Context { robots: &[], engines: &[], gates: &gates, seed: 1 };
    let landed = Landed::of(Stand::Quadruped(1), 1).unwrap();
    assert!(landed.problems.len() >= 10, "{}", landed.problems.len());
    for method in OWN {
        let candidate = Candidate::new("featherbench", method, false);
        let (tolerance, residual) = candidate.at_target(&context, &landed).unwrap();
        assert!(residual <= TARGET && tolerance >= 1e-10, "{method}: {tolerance:e} {residual:e}");
        let mut ready = candidate.prepare(&context, &landed, tolerance).unwrap();
        ready.run(0..2 * landed.problems.len()).unwrap();
    }
    let stranger = Candidate::new("stranger", "pgs", false);
    assert!(stranger.at_target(&context, &landed).is_err());
}
