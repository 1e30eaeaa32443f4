//! Our methods on every question but the longest, rows of answers that are wrong, and the closed form.

use super::ask::{Judged, OfCell, Question, Truths};
use super::drive::Driven;
use super::ours::{Ours, methods};
use super::rows::rows;
use super::systems::{PLANS, System, errors, scalar};
use super::{STUDY, Settings};
use crate::tests::gates;
use featherbench_bench::{Cell, LoopStates, NoAnswer, OWN, Outcome};
use featherbench_constrained::systems::{Ladder, Squeezer};
use featherbench_results::{Row, Verdict};
use featherbench_robots::Random;
use serde_json::json;

fn cell(question: &Question, engine: &str, method: &str) -> Cell {
    Cell::of_case(STUDY, &question.label(), (engine, ""), question.quantity(), method, OfCell { asked: question.params(), seed: 1 })
}

/// Those that take no minute: in a run of the suite all are evaluated.
fn short(question: &Question) -> bool {
    match question {
        Question::Motion(plan, step) => *step + 1 == PLANS[*plan].steps.len() && question.windows() <= 1 && PLANS[*plan].seconds < 5.0,
        _ => question.windows() <= 5,
    }
}

#[test]
fn our_answers_are_within_their_gates() {
    let (gates, truths) = (gates(), Truths::default());
    let (mut judged, mut wrong) = (0, Vec::new());
    for question in Question::all().into_iter().filter(short) {
        for method in methods(&question) {
            let outcome = match question.answer(&truths, &Ours, method, 1) {
                Ok(text) => Outcome::Text(text),
                Err(no_answer) => Outcome::NoAnswer(no_answer),
            };
            for row in rows(&gates, &cell(&question, OWN, method), &outcome) {
                println!("{:<32} {method:<20} {:<14} {:?} {:?} {}", question.label(), row.metric, row.value, row.bound, row.reason);
                judged += usize::from(row.verdict == Verdict::Pass);
                if matches!(row.verdict, Verdict::Fail | Verdict::Error) {
                    wrong.push((question.label(), *method, row.metric, row.value));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(judged > 30, "{judged}");
}

/// Every number of ours that has a gate fails where it is too large, and is an error where it is none.
#[test]
fn wrong_answers_fail() {
    let gates = gates();
    let verdicts = |value: Option<f64>, question: &Question, method: &str| -> Vec<Row> {
        let count = if *question == Question::Singular { 8 } else { 1 };
        let judged = Judged {
            errors: vec![value; count],
            energy_drift: value,
            open: value,
            of_steps: value,
            energy_of_steps: value,
            nanoseconds: 1.0,
            settings: json!({}),
        };
        rows(&gates, &cell(question, OWN, method), &Outcome::Text(serde_json::to_string(&judged).unwrap()))
    };
    let mut failed = 0;
    for question in Question::all() {
        for method in methods(&question) {
            let found = verdicts(Some(1e3), &question, method);
            assert!(found.iter().any(|row| row.verdict == Verdict::Fail) || *method == "proximal", "{} {method}", question.label());
            failed += found.iter().filter(|row| row.verdict == Verdict::Fail).count();
            assert!(verdicts(None, &question, method).iter().any(|row| row.verdict == Verdict::Error), "{} {method}", question.label());
        }
    }
    assert!(failed > 60, "{failed}");
}

/// Another engine's answers inform; that it has none is told.
#[test]
fn answers_of_engines_inform() {
    let gates = gates();
    let question = Question::Accelerations(System::Bricard);
    let of = |outcome: &Outcome| rows(&gates, &cell(&question, "other", "any"), outcome);
    let judged = Judged { errors: vec![Some(1e3)], nanoseconds: 5.0, settings: json!({"mu": 1e-6}), ..Judged::default() };
    let found = of(&Outcome::Text(serde_json::to_string(&judged).unwrap()));
    assert!(found.iter().all(|row| row.verdict == Verdict::Info && row.params.contains("\"mu\":1e-6")), "{found:#?}");
    assert_eq!((found[0].value, found[1].value, found[1].unit.as_str()), (Some(1e3), Some(5.0), "ns"));
    let lost = Judged { errors: vec![None], ..Judged::default() };
    assert_eq!(of(&Outcome::Text(serde_json::to_string(&lost).unwrap()))[0].verdict, Verdict::Info);
    let skip = of(&Outcome::NoAnswer(NoAnswer::NotOffered("it has no loops".into())));
    assert_eq!((skip[0].verdict, skip[0].reason.as_str()), (Verdict::Skip, "it has no loops"));
    assert_eq!(of(&Outcome::NoAnswer(NoAnswer::Failed("it ended".into())))[0].verdict, Verdict::Info);
    assert_eq!(of(&Outcome::Text("{".into()))[0].verdict, Verdict::Error);
}

/// The steps of the closed form keep energy to order four.
#[test]
fn the_closed_form_converges() {
    let ladder = Ladder::default();
    let drift = |steps: usize| {
        let (q, v) = scalar(&ladder, (3.0, 1.0), 1.0 / steps as f64, steps);
        (ladder.energy(q, v) - ladder.energy(3.0, 1.0)).abs()
    };
    let order = (drift(50) / drift(100)).log2();
    assert!((3.5..6.0).contains(&order), "{order}");
}

#[test]
fn an_error_of_nan_is_nan() {
    let states = LoopStates { count: 2, q: vec![0.0; 2], v: vec![1.0, 2.0], tau: vec![0.0; 2] };
    let found = errors(&states, &[1.0, f64::NAN], &[3.0, 4.0]);
    assert_eq!(found[0], 0.5);
    assert!(found[1].is_nan());
}

/// The squeezer's spring and torque between points are the moments of its closed form, and the negative slope of their potential.
#[test]
fn a_drive_is_that_of_the_squeezer() {
    let (drive, mechanism) = (System::Squeezer.drive().unwrap(), System::Squeezer.mechanism().unwrap());
    let driven = Driven { drive: &drive, model: &mechanism.model };
    let mut random = Random::new(7, 0);
    for _ in 0..20 {
        let q: Vec<f64> = (0..7).map(|_| random.uniform(-2.0, 2.0)).collect();
        let (mut found, mut due) = (vec![0.0; 7], vec![0.0; 7]);
        driven.add(&q, &mut found).unwrap();
        Squeezer::default().add_forces(&q, &mut due);
        for k in 0..7 {
            // Rounding of a pull of k·0.1 m = 450 N at an arm of 0.03 m.
            assert!((found[k] - due[k]).abs() < 1e-12, "{k}: {found:?} {due:?}");
            let moved = |by: f64| {
                let mut q = q.clone();
                q[k] += by;
                driven.potential(&q).unwrap()
            };
            // Centred differences lose 1e-10 of the third derivative, and ε/1e-5 of some 50 J.
            let slope = (moved(1e-5) - moved(-1e-5)) / 2e-5;
            assert!((slope + due[k]).abs() < 1e-7, "{k}: {slope} {due:?}");
        }
    }
}

/// No two questions make the same cell, and records end with the motion.
#[test]
fn questions_differ() {
    let labels: std::collections::BTreeSet<_> = Question::all().iter().map(|question| (question.label(), question.quantity())).collect();
    assert_eq!(labels.len(), Question::all().len());
    for plan in &PLANS {
        for dt in plan.steps {
            let steps = plan.of(*dt);
            assert_eq!(steps.steps % steps.every, 0);
            assert!((steps.steps as f64 * dt - plan.seconds).abs() < 1e-9, "{} {dt}", plan.name);
        }
    }
}

#[test]
fn settings_are_read() {
    let settings: Settings = serde_json::from_value(json!({})).unwrap();
    assert_eq!(settings, Settings { engines: Vec::new(), windows: 40 });
    assert!(serde_json::from_value::<Settings>(json!({"engine": []})).is_err());
}
