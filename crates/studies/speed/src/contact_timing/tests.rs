use super::*;
use featherbench_doubles::gates;
use featherbench_results::Verdict;
use serde_json::json;

fn cell(candidates: &[(&str, &str, bool)]) -> Cell {
    let of = |(engine, method, control): &(&str, &str, bool)| Candidate::new(engine, method, *control);
    let of_robot = OfRobot { contacts: 4, rank: 12, seconds: 1.0, own_model: None, drift: None };
    let params = Params { of_robot, seed: 1, target: TARGET, process: 0, candidates: candidates.iter().map(of).collect() };
    Cell::of_case(STUDY, "quadruped, 4 contacts", ("featherbench", "1"), QUANTITY, SOLVERS[0], params)
}

const FOUR: [(&str, &str, bool); 4] = [
    ("featherbench", "block_gauss_seidel", false),
    ("featherbench", "newton", false),
    ("featherbench", "block_gauss_seidel", true),
    ("peer", "pgs", false),
];

/// An outcome: constant times of the four candidates, and their tolerances and residuals.
fn outcome(ns: [f64; 4], told: [[f64; 3]; 4]) -> Outcome {
    let mut samples = Samples::new(vec![1; 4], 60);
    for (which, ns) in ns.into_iter().enumerate() {
        for round in 0..60 {
            samples.set(which, round, ns);
            samples.crowded(round, 1.0);
        }
    }
    Outcome::Values(std::iter::once(3.0).chain(told.into_iter().flatten()).chain(samples.to_values()).collect())
}

/// The rows of an experiment whose processes all have this outcome.
fn rows_of(cell: &Cell, outcome: Outcome) -> Vec<Row> {
    rows::rows(&gates(""), &vec![(cell.clone(), outcome); PROCESSES])
}

fn find<'r>(rows: &'r [Row], engine: &str, metric: &str) -> Option<&'r Row> {
    rows.iter().find(|row| row.engine == engine && row.metric == metric)
}

const GOOD: [[f64; 3]; 4] = [[1e-8, 9e-9, f64::NAN]; 4];

#[test]
fn ratios_are_over_the_reference() {
    let rows = rows_of(&cell(&FOUR), outcome([100.0, 300.0, 100.0, 250.0], GOOD));
    let ratio = find(&rows, "peer", "ratio").unwrap();
    assert_eq!((ratio.value, ratio.ci_low, ratio.valid), (Some(2.5), Some(2.5), true));
    assert_eq!(find(&rows, "featherbench", "control").unwrap().value, Some(1.0));
    assert_eq!(rows.iter().filter(|row| row.metric == "residual" && row.verdict == Verdict::Pass).count(), 3);
    assert_eq!(rows.iter().filter(|row| row.metric == "ns_per_call").count(), 3, "the replicate is no candidate of its own");
}

#[test]
fn a_noisy_experiment_has_no_valid_time() {
    let rows = rows_of(&cell(&FOUR), outcome([100.0, 300.0, 110.0, 250.0], GOOD));
    let times: Vec<&Row> = rows.iter().filter(|row| ["ns_per_call", "ratio", "control"].contains(&row.metric.as_str())).collect();
    assert!(times.len() == 6 && times.iter().all(|row| !row.valid), "{times:?}");
    let alone = cell(&FOUR[..2]);
    let uncontrolled = rows_of(&alone, Outcome::Values(vec![]));
    assert_eq!(uncontrolled[0].verdict, Verdict::Error);
}

#[test]
fn an_answer_that_is_not_good_enough_has_no_time() {
    let mut told = GOOD;
    told[3] = Told::NONE.to_values();
    let nothing = outcome([100.0, 300.0, 100.0, f64::NAN], told);
    let rows_of_peer = rows_of(&cell(&FOUR), nothing);
    assert_eq!(find(&rows_of_peer, "peer", "residual").unwrap().verdict, Verdict::Info);
    assert!(find(&rows_of_peer, "peer", "ns_per_call").is_none());
    told = GOOD;
    told[0] = Told::NONE.to_values();
    let ours = rows_of(&cell(&FOUR), outcome([100.0; 4], told));
    assert_eq!(find(&ours, "featherbench", "residual").unwrap().verdict, Verdict::Error);
    told = GOOD;
    told[0][1] = 2e-8;
    let ours = rows_of(&cell(&FOUR), outcome([100.0; 4], told));
    assert_eq!(find(&ours, "featherbench", "residual").unwrap().verdict, Verdict::Fail);
}

/// An engine that answers by a model of its own is told apart: its residual informs, and its ratio has another name and reference.
#[test]
fn an_own_model_is_told_apart() {
    let four = [
        ("featherbench", SOLVERS[0], false),
        ("featherbench", SOLVERS[1], false),
        ("featherbench", SOLVERS[0], true),
        ("peer", "soft_newton", false),
    ];
    let mut cell = cell(&four);
    cell.params["candidates"][3]["own_model"] = json!({"model": "soft", "limit": "soft_newton", "time": "all"});
    let mut told = GOOD;
    told[3] = [1e-6, 0.3, 4e-9];
    let rows = rows_of(&cell, outcome([100.0, 200.0, 100.0, 250.0], told));
    let residual = find(&rows, "peer", "residual").unwrap();
    assert_eq!((residual.value, residual.verdict), (Some(0.3), Verdict::Info));
    assert!(residual.params.contains("\"model\":\"soft\""));
    assert_eq!(find(&rows, "peer", "from_limit").unwrap().value, Some(4e-9));
    assert!(find(&rows, "peer", "ratio").is_none());
    let ratio = find(&rows, "peer", "own_model_ratio").unwrap();
    assert_eq!((ratio.value, ratio.reference.as_str()), (Some(1.25), "featherbench block_gauss_seidel_whole"));
    told[3] = Told::NONE.to_values();
    let rows = rows_of(&cell, outcome([100.0, 200.0, 100.0, f64::NAN], told));
    assert!(find(&rows, "peer", "residual").unwrap().reason.contains("its own model"));
}

/// What an engine gets of a robot has the contact problems that are solved beside it.
#[test]
fn a_robot_is_what_its_problems_are_of() {
    let standing = Stand::Quadruped(2).make().unwrap();
    let taken = standing.run(3).unwrap();
    let steps = standing.steps(&taken[..1]).unwrap();
    assert_eq!((steps.count, steps.bodies.len(), steps.points.len()), (1, 8, 24));
    // v + dt M⁻¹ (τ − h) and J of our own kernels, from what an engine gets, are the free velocities of the problem.
    let model: featherbench_model::Model<f64> = featherbench_model::Model::build(&steps.robot).unwrap();
    let touches = steps.bodies.iter().zip(steps.points.chunks_exact(3)).zip(&steps.friction);
    let touches = touches.map(|((body, point), friction)| featherbench_contact::Touch {
        name: String::new(),
        body: model.described[*body],
        point: [point[0], point[1], point[2]],
        friction: *friction,
        restitution: 0.0,
    });
    let robot = featherbench_contact::Grounded::new(&model, touches.collect());
    let again = robot.problem("again", &steps.q, &steps.v, &steps.tau, steps.dt).unwrap().unwrap();
    assert_eq!(again.free(), taken[0].problem.free());
    assert_eq!(again.delassus(), taken[0].problem.delassus());
}

/// Our own methods reach the target on a real robot, by a tolerance that the residual confirms.
#[test]
fn our_methods_reach_the_target() {
    let gates = gates("");
    let context = Context { robots: &[], engines: &[], gates: &gates, seed: 1 };
    let landed = Landed::of(Stand::Quadruped(1), 1).unwrap();
    assert!(landed.problems.len() >= 10, "{}", landed.problems.len());
    for method in SOLVERS {
        let candidate = Candidate::new("featherbench", method, false);
        let Told { tolerance, residual, .. } = candidate.at_target(&context, &landed).unwrap();
        assert!(residual <= TARGET && tolerance >= 1e-10, "{method}: {tolerance:e} {residual:e}");
        let mut ready = candidate.prepare(&context, &landed, tolerance).unwrap();
        ready.run(0..2 * landed.problems.len()).unwrap();
    }
    let stranger = Candidate::new("stranger", "pgs", false);
    assert!(stranger.at_target(&context, &landed).is_err());
}
