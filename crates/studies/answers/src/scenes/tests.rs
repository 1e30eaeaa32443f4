//! The study of scenes: rows of good and bad answers, laws, and our own answers.

use super::{MOTION, NONE, Scenes, Settings, cell, rows};
use crate::tests::gates;
use featherbench_bench::{Asked, Cell, Context, NoAnswer, Outcome, Study};
use featherbench_results::{Row, Verdict};
use featherbench_scenes::{Question, systems};
use serde_json::json;

fn question(name: &str) -> Question {
    systems::all().into_iter().find(|question| question.scene.name == name).unwrap()
}

fn asked(scene: &str, engine: &str, method: &str) -> (Question, Cell) {
    let settings = json!({"solref": [0.02, 1.0], "solimp": [0.9, 0.95, 0.001, 0.5, 2.0], "impratio": 1.0});
    (question(scene), cell(scene, (engine, "1"), method, MOTION, json!({"settings": settings})))
}

fn judged(rows: &[Row], metric: &str) -> Vec<Verdict> {
    rows.iter().filter(|row| row.metric == metric).map(|row| row.verdict).collect()
}

#[test]
fn our_errors_are_judged_and_those_of_others_inform() {
    let gates = gates();
    for (engine, method, judges) in
        [("featherbench", "newton", true), ("featherbench", "block_gauss_seidel", false), ("peer", "any", false)]
    {
        let (question, cell) = asked("sliding_sphere", engine, method);
        let good: Vec<f64> = question.dts.iter().flat_map(|_| question.measures.iter().map(|measure| measure.exact)).collect();
        let rows = rows::of_motion(&gates, &question, &cell, &Outcome::Values(good.clone()));
        assert!(rows.iter().all(|row| !row.params.is_empty() && row.family == "sliding_sphere"));
        assert_eq!(judged(&rows, "error").iter().filter(|verdict| **verdict == Verdict::Pass).count(), if judges { 2 } else { 0 });
        for wrong in [f64::NAN, 1e3] {
            let mut values = good.clone();
            let last = values.len() - 1;
            values[last] = wrong;
            let rows = rows::of_motion(&gates, &question, &cell, &Outcome::Values(values));
            let bad = rows.iter().filter(|row| matches!(row.verdict, Verdict::Fail | Verdict::Error)).count();
            assert!(if judges { bad >= 1 } else { wrong.is_nan() || bad == 0 }, "{engine} {wrong}");
        }
    }
}

#[test]
fn laws_of_contact_models_are_judged() {
    let gates = gates();
    let cases = [
        ("incline_45", "mujoco", "pyramidal_newton", 0.5_f64.sqrt()),
        ("incline_45", "mujoco", "elliptic_cg", 1.0),
        ("incline_45", "dart", "dantzig", 2.0_f64.sqrt()),
        ("incline_45", "rapier", "simplified", 1.0),
        ("incline_0", "rapier", "coulomb", 0.838_69),
        ("incline_sticking", "mujoco", "elliptic_newton", 8.77e-4),
    ];
    for (scene, engine, method, due) in cases {
        let (question, cell) = asked(scene, engine, method);
        let of = |value: f64| {
            let values = question.dts.iter().flat_map(|_| [value, 0.0]).collect();
            judged(&rows::of_motion(&gates, &question, &cell, &Outcome::Values(values)), "law_error")
        };
        assert_eq!(of(due), [Verdict::Pass], "{scene} {engine}");
        assert_eq!(of(due * 1.2), [Verdict::Fail], "{scene} {engine}");
        assert_ne!(of(f64::NAN), [Verdict::Pass], "{scene} {engine}");
    }
    let (question, cell) = asked("incline_30", "mujoco", "pyramidal_newton");
    assert!(rows::law(&cell, &question, &question.measures[0]).is_none());
}

#[test]
fn what_is_not_offered_is_a_skip() {
    let gates = gates();
    let (question, cell) = asked("bouncing_ball", "mujoco", "pyramidal_pgs");
    let refused = Outcome::NoAnswer(NoAnswer::NotOffered("no restitution".into()));
    let rows = rows::of_motion(&gates, &question, &cell, &refused);
    assert!(rows.len() == 1 && rows[0].verdict == Verdict::Skip && rows[0].reason.contains("no restitution"));
    let failed = Outcome::NoAnswer(NoAnswer::Failed("it fell".into()));
    assert_eq!(rows::of_motion(&gates, &question, &cell, &failed)[0].verdict, Verdict::Info);
    let (question, ours) = asked("bouncing_ball", "featherbench", "newton");
    assert_eq!(rows::of_motion(&gates, &question, &ours, &failed)[0].verdict, Verdict::Error);
    let short = rows::of_motion(&gates, &question, &ours, &Outcome::Values(vec![1.0]));
    assert_eq!(short[0].verdict, Verdict::Error);
}

/// An engine that is asked and is not there has one cell, and its row says what to do.
#[test]
fn an_absent_engine_is_a_row() {
    let gates = gates();
    let settings = Settings { engines: vec!["rapier".into(), "dart".into()] };
    let study = Scenes { settings, questions: systems::all() };
    let context = Context { robots: &[], engines: &[], gates: &gates, seed: 1 };
    let cells = study.plan(&context);
    assert!(cells.len() == 2 && cells.iter().all(|cell| cell.method == NONE));
    let finished: Vec<_> = cells.into_iter().map(|cell| (cell.clone(), study.evaluate(&Asked::of(&context, &cell)))).collect();
    let rows = study.compare_all(&context, &finished);
    for (row, engine) in rows.iter().zip(["rapier", "dart"]) {
        assert!(row.engine == engine && row.verdict == Verdict::Skip && row.value.is_none(), "{row:?}");
        assert!(row.reason.contains("not installed") && row.reason.contains(&format!("oracles install {engine}")), "{}", row.reason);
    }
    assert_eq!(rows.len(), 2);
}
