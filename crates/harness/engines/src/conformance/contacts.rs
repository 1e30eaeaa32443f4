//! Contact problems, if an oracle solves them: requests without an answer, repetition, and problems that are solved by hand.

use super::Standing;
use super::exchange::Exchange;
use crate::oracle::{contacts, own_time, shaped};
use featherbench_bench::ContactProblems;
use serde_json::{Value, json};

/// The tolerance that is asked.
const TOLERANCE: f64 = 1e-9;
/// The largest error of an impulse. A solver's own measure may let some digits go; mistaken rows or signs cause errors of one.
const NEAR: f64 = 1e-6;

/// Two problems of two contacts each, with G = 1 and μ = ½: one sticks and one slides, one opens and one slides along the second tangent.
fn problems() -> ContactProblems {
    let one = (0..36).map(|k| f64::from(u8::from(k % 7 == 0)));
    ContactProblems {
        count: 2,
        contacts: 2,
        delassus: one.clone().chain(one).collect(),
        free: vec![-1.0, 0.2, 0.0, -1.0, 2.0, 0.0, 1.0, 0.3, 0.0, -2.0, 0.0, -3.0],
        friction: vec![0.5; 4],
    }
}

/// Their impulses: with G = 1 contacts do not act on each other.
const DUE: [f64; 12] = [1.0, -0.2, 0.0, 1.0, -0.5, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 1.0];

/// Those of the relaxation, where c_n = μ |c_t| of a contact that slides: the projection of −b onto the cone.
const RELAXED: [f64; 12] = [1.0, -0.2, 0.0, 1.6, -0.8, 0.0, 0.0, 0.0, 0.0, 2.8, 0.0, 1.4];

/// What a method solves.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Law {
    /// Signorini's and Coulomb's laws.
    Coulomb,
    /// The convex relaxation.
    Relaxed,
}

impl Law {
    /// The impulses that the problems have, and how far an answer may be.
    fn due(self) -> ([f64; 12], f64) {
        match self {
            Self::Coulomb => (DUE, NEAR),
            // A gap of 1e-9 is an error of its root.
            Self::Relaxed => (RELAXED, 1e-4),
        }
    }
}

/// Asks for everything.
pub(super) fn ask(exchange: &mut Exchange, methods: &[String], law: Law) {
    let Some(first) = methods.first() else { return };
    exchange.expect("contacts without problems are an error", question(first, 0, 1), Vec::new(), &["error"]);
    let refused = |exchange: &mut Exchange, what: &str, change: fn(&mut ContactProblems)| {
        let mut wrong = problems();
        change(&mut wrong);
        let (header, blocks) = contacts::request(&wrong);
        exchange.expect(what, header, blocks, &["error"]);
    };
    refused(exchange, "a negative friction is an error", |wrong| wrong.friction[1] = -0.1);
    refused(exchange, "a contact problem with NaN is an error", |wrong| wrong.free[3] = f64::NAN);
    refused(exchange, "no contact problems are an error", |wrong| *wrong = ContactProblems { contacts: 2, ..ContactProblems::default() });
    let (header, blocks) = contacts::request(&problems());
    if exchange.expect("contact problems are kept", header, blocks, &["ok"]).is_none() {
        return;
    }
    let nobody = question("no such solver", 0, 1);
    exchange.expect("contacts by a solver that it does not have are unsupported", nobody, Vec::new(), &["unsupported"]);
    let mut loose = question(first, 0, 1);
    loose["tolerance"] = 0.0.into();
    exchange.expect("a tolerance of zero is an error", loose, Vec::new(), &["error"]);
    for method in methods {
        solved(exchange, method, law);
    }
}

fn question(method: &str, first: usize, count: usize) -> Value {
    json!({"op": "solve_contacts", "method": method, "first": first, "count": count, "tolerance": TOLERANCE, "iterations": 10_000})
}

/// Both problems, twice; and the first again after the second, as problems begin again.
fn solved(exchange: &mut Exchange, method: &str, law: Law) {
    let (due, near) = law.due();
    let what = if law == Law::Coulomb { format!("contacts by {method}") } else { format!("relaxed contacts by {method}") };
    let mut answer = |first, count| -> Result<Vec<f64>, String> {
        let answer = exchange.ask(question(method, first, count), Vec::new())?;
        own_time(&answer).map_err(|refusal| refusal.to_string())?;
        shaped(&answer, "impulses", &[count, 6]).map_err(|refusal| refusal.to_string())
    };
    let answers = answer(0, 2).and_then(|once| Ok((once, answer(0, 2)?, answer(1, 2)?)));
    let (once, again, around) = match answers {
        Ok(answers) => answers,
        Err(reason) => return exchange.note(Standing::Wrong, &what, &reason, &[]),
    };
    let bits = |impulses: &[f64]| impulses.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
    if bits(&once) != bits(&again) || bits(&around) != bits(&[&once[6..], &once[..6]].concat()) {
        let advice = ["each solution begins at impulses of zero, whatever was asked before"];
        return exchange.note(Standing::Wrong, &what, "the same problem has other impulses when it is asked again", &advice);
    }
    let off = once.iter().zip(due).map(|(found, due)| (found - due).abs());
    // A NaN is not near.
    if off.clone().all(|off| off <= near) {
        return exchange.note(Standing::Right, &what, "the impulses that two problems have by hand", &[]);
    }
    let advice = [
        "the rows of a contact are normal, tangent, tangent",
        "impulses push the contact open: c = G λ + b",
        "friction opposes sliding, and its cone is round",
    ];
    exchange.note(Standing::Wrong, &what, &format!("the impulses are {once:?}; due are {due:?}"), &advice);
}
