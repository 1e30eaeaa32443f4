//! The study of scaling: its integers by a second route, planted errors, and a resumed run.

use featherbench_bench::run::{Silent, compare, evaluate, plan};
use featherbench_bench::{Context, Engine, Finished, Gates, Outcome, OutcomeStore, Study};
use featherbench_engines::Featherbench;
use featherbench_results::{Row, Verdict};
use featherbench_speed::{Scaling, ScalingSettings};
use std::collections::BTreeMap;
use std::path::Path;

/// The sizes of a tree stand before the values of a cell.
const SIZES: usize = 4;

fn settings() -> ScalingSettings {
    let list = |trees: &[&str]| trees.iter().map(|&tree| tree.to_owned()).collect();
    ScalingSettings {
        counts: list(&["chain:n=30,layout=spatial", "star:n=30", "humanoid", "quadruped", "hand", "binary_tree:depth=8"]),
        factors: list(&["chain:n=36,layout=spatial", "humanoid", "binary_tree:depth=6", "star:n=5"]),
        dynamics: list(&["chain:n=60,layout=spatial"]),
        by_factorization: list(&["chain:n=60,layout=spatial"]),
        engines: Vec::new(),
        sub_trees: list(&["binary_tree:depth=8"]),
        both_ends: list(&["chain:n=60,layout=spatial"]),
        lines: Vec::new(),
    }
}

/// Plans and evaluates a study in a folder.
fn finished(study: &dyn Study, context: &Context, folder: &Path) -> Vec<Finished> {
    let store = OutcomeStore::open(folder).unwrap();
    evaluate(study, context, plan(study, context, &|_| true), &store, &Silent).unwrap()
}

/// Runs `judge` on the context and the outcomes of the whole study.
fn with_outcomes<T>(judge: impl FnOnce(&Scaling, &Context, Vec<Finished>) -> T) -> T {
    let gates: Gates = featherbench_doubles::gates("");
    let engines: Vec<Box<dyn Engine>> = vec![Box::new(Featherbench::new())];
    let context = Context { robots: &[], engines: &engines, gates: &gates, seed: featherbench_doubles::SEED };
    let study = Scaling { settings: settings() };
    let folder = tempfile::tempdir().unwrap();
    let outcomes = finished(&study, &context, folder.path());
    judge(&study, &context, outcomes)
}

/// [n + D1, D1, D2] from the depths of all dofs, given as (how often, the depths of a path).
fn sums(paths: &[(u64, std::ops::RangeInclusive<u64>)]) -> [f64; 3] {
    let of = |term: fn(u64) -> u64| paths.iter().map(|(times, depths)| times * depths.clone().map(term).sum::<u64>()).sum::<u64>() as f64;
    [of(|d| d), of(|d| d - 1), of(|d| d * (d - 1) / 2)]
}

#[test]
fn the_integers_are_those_of_the_depths() {
    // The depths follow from what each robot is: base, then limbs.
    let due: BTreeMap<&str, [f64; 3]> = [
        ("chain:n=30,layout=spatial", sums(&[(1, 1..=30)])),
        ("star:n=30", sums(&[(30, 1..=1)])),
        // Base 6, two legs of 6; torso 3 with two arms of 7 and a head of 1.
        ("humanoid", sums(&[(1, 1..=6), (2, 7..=12), (1, 7..=9), (2, 10..=16), (1, 10..=10)])),
        ("quadruped", sums(&[(1, 1..=6), (4, 7..=9)])),
        ("hand", sums(&[(1, 1..=6), (5, 7..=10)])),
        ("binary_tree:depth=8", sums(&(1..=8).map(|level| (1 << (level - 1), level..=level)).collect::<Vec<_>>())),
    ]
    .into();
    // As SCIENCE and Featherstone's book have them: n (n² − 1)/6 of a chain, and the sum over levels of a binary tree.
    assert_eq!(due["chain:n=30,layout=spatial"][2], (30.0 * (30.0 * 30.0 - 1.0)) / 6.0);
    assert_eq!((due["humanoid"], due["quadruped"], due["hand"]), ([351.0, 315.0, 1787.0], [117.0, 99.0, 375.0], [191.0, 165.0, 685.0]));
    assert_eq!(sums(&(1..=20).map(|level| (1 << (level - 1), level..=level)).collect::<Vec<_>>())[2], 180_355_070.0);
    let rows = with_outcomes(|study, context, outcomes| compare(study, context, outcomes));
    let mut seen = 0;
    for (tree, due) in due {
        for (metric, due) in ["stored", "factor_divisions", "factor_multiply_subtracts"].into_iter().zip(due) {
            let row = rows.iter().find(|row| row.robot == tree && row.metric == metric).unwrap();
            assert_eq!((row.value, row.verdict), (Some(due), Verdict::Pass), "{tree} {metric}");
            assert!(row.params.contains("\"route\":\"counted\""), "{}", row.params);
            seen += 1;
        }
    }
    assert_eq!(seen, 18);
}

#[test]
fn leaves_first_fills_nothing_and_every_row_of_ours_passes() {
    let rows = with_outcomes(|study, context, outcomes| compare(study, context, outcomes));
    let red: Vec<&Row> = rows.iter().filter(|row| !matches!(row.verdict, Verdict::Pass | Verdict::Info)).collect();
    assert!(red.is_empty(), "{red:#?}");
    let fill = |tree: &str, order: &str| {
        let of = |row: &&Row| row.robot == tree && row.method == order && row.metric == "fill_in";
        rows.iter().find(of).and_then(|row| row.value).unwrap()
    };
    for tree in &settings().factors {
        assert_eq!((fill(tree, "leaves_first"), fill(tree, "minimum_degree")), (0.0, 0.0), "{tree}");
    }
    // 36 dofs full: 666 numbers, of which the humanoid's M has 351.
    assert_eq!(fill("humanoid", "root_first"), 666.0 - 351.0);
    // 63 dofs full: 2016, of which the tree's M has 321.
    assert_eq!(fill("binary_tree:depth=6", "root_first"), 2016.0 - 321.0);
    let over: Vec<f64> =
        rows.iter().filter(|row| row.metric == "error_over_floor" && row.method == "aba").filter_map(|row| row.value).collect();
    assert!(over.len() == 1 && over[0] > 0.0, "{over:?}");
}

/// Changes one number of an outcome of a question behind the sizes, and returns what is red.
fn planted(what: &str, at: usize, spoil: fn(f64) -> f64) -> Vec<(String, Verdict)> {
    with_outcomes(|study, context, mut outcomes| {
        let of = |item: &&mut Finished| item.0.params["what"] == what;
        let Some((_, Outcome::Values(values))) = outcomes.iter_mut().find(of) else { panic!("no outcome of {what}") };
        values[SIZES + at] = spoil(values[SIZES + at]);
        let rows = compare(study, context, outcomes);
        let red = rows.into_iter().filter(|row| !matches!(row.verdict, Verdict::Pass | Verdict::Info));
        red.map(|row| (row.metric, row.verdict)).collect()
    })
}

#[test]
fn planted_errors_are_found() {
    let red = |metric: &str, verdict| vec![(metric.to_owned(), verdict)];
    // Behind the route and the five integers of the theory.
    for (at, metric) in [(6, "stored"), (7, "factor_divisions"), (8, "factor_multiply_subtracts"), (9, "solve_multiply_adds")] {
        assert_eq!(planted("counts", at, |count| count + 1.0), red(metric, Verdict::Fail));
    }
    assert_eq!(planted("counts", 8, |_| f64::NAN), red("factor_multiply_subtracts", Verdict::Error));
    assert_eq!(planted("fill_in", 2, |stored| stored + 1.0), red("fill_in", Verdict::Fail), "fill-in that nobody expects");
    assert_eq!(planted("factors", 0, |_| 1e-12), red("factor_error_per_dof", Verdict::Fail));
    assert_eq!(planted("factors", 1, |_| 1e-12), red("solution_error_per_dof", Verdict::Fail));
    assert_eq!(planted("factors", 0, |_| f64::NAN), red("factor_error_per_dof", Verdict::Error));
    assert_eq!(planted("dynamics", 0, |_| 1e-12), red("error_over_floor", Verdict::Fail), "no gate is on the error of aba itself");
    // Without a bound every ratio is an error: of aba, refined_1 and ltdl.
    assert_eq!(planted("floor", 0, |_| f64::NAN).iter().filter(|(_, verdict)| *verdict == Verdict::Error).count(), 4);
}

#[test]
fn a_question_without_an_answer_is_an_error_row() {
    let rows = with_outcomes(|study, context, mut outcomes| {
        outcomes[0].1 = Outcome::NoAnswer(featherbench_bench::NoAnswer::Failed("it broke".into()));
        outcomes[1].1 = Outcome::Values(vec![1.0]);
        compare(study, context, outcomes)
    });
    let errors: Vec<&str> = rows.iter().filter(|row| row.verdict == Verdict::Error).map(|row| row.reason.as_str()).collect();
    assert_eq!(errors, ["it broke", "the outcome has too few numbers"]);
}

#[test]
fn a_resumed_run_has_the_same_bytes() {
    let gates: Gates = featherbench_doubles::gates("");
    let engines: Vec<Box<dyn Engine>> = vec![Box::new(Featherbench::new())];
    let context = Context { robots: &[], engines: &engines, gates: &gates, seed: featherbench_doubles::SEED };
    let study = Scaling { settings: settings() };
    let folder = tempfile::tempdir().unwrap();
    let bytes =
        |folder: &Path| featherbench_results::to_csv(&compare(&study, &context, finished(&study, &context, folder)), folder).unwrap();
    let whole = bytes(folder.path());
    let path = folder.path().join(featherbench_bench::OUTCOMES_NAME);
    let outcomes = std::fs::read(&path).unwrap();
    for share in [0, 3, 7] {
        std::fs::write(&path, &outcomes[..outcomes.len() * share / 10]).unwrap();
        assert!(bytes(folder.path()) == whole, "killed at {share} tenths");
    }
}

/// An engine named faer is given our M, and has our gate; one with its own M has none. An engine that refuses has skips.
#[test]
fn factors_of_other_engines_stand_beside_ours() {
    let robot = featherbench_doubles::robot("hand");
    let rows_of = |double: featherbench_doubles::Double| {
        let settings = ScalingSettings { engines: vec!["faer".into(), "double".into()], ..ScalingSettings::default() };
        let engines: Vec<Box<dyn Engine>> = vec![Box::new(Featherbench::new()), Box::new(double)];
        let rows = featherbench_doubles::whole(&Scaling { settings }, &robot, &featherbench_doubles::gates(""), &engines);
        let asked = |row: &Row| row.params == "{\"what\":\"others\"}" && row.method == "ltdl";
        let answers = rows.into_iter().filter(asked).map(|row| (row.metric, row.value, row.verdict)).collect::<Vec<_>>();
        assert_eq!(answers.len(), 3, "{answers:?}");
        answers
    };
    let honest = rows_of(featherbench_doubles::Double::of(&robot).named("faer"));
    assert_eq!(honest[0], ("fill_in".into(), Some(0.0), Verdict::Info));
    for (at, metric) in [(1, "factor_error_per_dof"), (2, "solution_error_per_dof")] {
        assert!(honest[at].0 == metric && honest[at].2 == Verdict::Pass, "{honest:?}");
    }
    let spoil: featherbench_doubles::Twist = |answer| answer.values.iter_mut().for_each(|x| *x += 1e-9);
    let spoilt = rows_of(featherbench_doubles::Double::twisting(&robot, spoil).named("faer"));
    assert!(spoilt[1].2 == Verdict::Fail && spoilt[2].2 == Verdict::Fail, "{spoilt:?}");
    let other = rows_of(featherbench_doubles::Double::twisting(&robot, spoil));
    assert!(other[1].2 == Verdict::Info && other[2].2 == Verdict::Info, "{other:?}");
    assert!(
        rows_of(featherbench_doubles::Double::refusing(&robot))
            .iter()
            .all(|(_, value, verdict)| value.is_none() && *verdict == Verdict::Skip)
    );
}
