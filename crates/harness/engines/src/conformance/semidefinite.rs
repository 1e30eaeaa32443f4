//! Least squares under semidefinite conditions, if an oracle solves them: requests without an answer, and a problem that is solved by hand.

use super::Standing;
use super::exchange::Exchange;
use crate::oracle::{semidefinite, shaped};
use featherbench_bench::SemidefiniteProblem;

/// The tolerance that is asked, and the largest error: both conditions are active, so errors are of the size of the gap.
const TOLERANCE: f64 = 1e-9;
const NEAR: f64 = 1e-6;

/// Minimise ½ |x − (0.2, 3)|² with x₀ 1 − ½ 1 ⪰ 0 and [[1, x₁], [x₁, 1]] ⪰ 0 beside an identity: x = (0.5, 1).
fn problem() -> SemidefiniteProblem {
    let mut maps = vec![0.0; 2 * 16 * 3];
    for k in 0..4 {
        (maps[15 * k], maps[15 * k + 2]) = (1.0, -0.5);
        maps[48 + 15 * k + 2] = 1.0;
    }
    (maps[48 + 3 + 1], maps[48 + 12 + 1]) = (1.0, 1.0);
    SemidefiniteProblem { unknowns: 2, matrix: vec![1.0, 0.0, 0.0, 1.0], target: vec![0.2, 3.0], maps }
}

/// x, and the traces of the multipliers: tr Z₀ is the slope 0.3; Z₁ = [[1, −1], [−1, 1]] has the slope 2 = −2 z₁₂.
const X: [f64; 2] = [0.5, 1.0];
const TRACES: [f64; 2] = [0.3, 2.0];

/// Asks for everything.
pub(super) fn ask(exchange: &mut Exchange, methods: &[String]) {
    let Some(first) = methods.first() else { return };
    let refused = |exchange: &mut Exchange, what: &str, allowed: &[&str], method: &str, change: fn(&mut SemidefiniteProblem)| {
        let mut wrong = problem();
        change(&mut wrong);
        let (header, blocks) = semidefinite::request(&wrong, method, TOLERANCE, 100);
        exchange.expect(what, header, blocks, allowed);
    };
    refused(exchange, "least squares with NaN are an error", &["error"], first, |wrong| wrong.target[0] = f64::NAN);
    refused(exchange, "a map that is not symmetric is an error", &["error"], first, |wrong| wrong.maps[3] += 1.0);
    let nobody = "no such method";
    refused(exchange, "least squares by a method that it does not have are unsupported", &["unsupported"], nobody, |_| ());
    for method in methods {
        let what = format!("semidefinite least squares by {method}");
        let (header, blocks) = semidefinite::request(&problem(), method, TOLERANCE, 100);
        let answer = exchange.ask(header, blocks).and_then(|answer| {
            let block = |name: &str, shape: &[usize]| shaped(&answer, name, shape).map_err(|refusal| refusal.to_string());
            Ok((block("x", &[2])?, block("multipliers", &[2, 16])?))
        });
        let (x, multipliers) = match answer {
            Ok(answer) => answer,
            Err(reason) => {
                exchange.note(Standing::Wrong, &what, &reason, &[]);
                continue;
            }
        };
        let traces = multipliers.chunks_exact(16).map(|z| (0..4).map(|k| z[5 * k]).sum::<f64>());
        // A NaN is not near.
        let near = |found: f64, due: &f64| (found - due).abs() <= NEAR;
        let right = x.iter().zip(&X).all(|(found, due)| near(*found, due)) && traces.zip(&TRACES).all(|(found, due)| near(found, due));
        if right {
            exchange.note(Standing::Right, &what, "the answer and multipliers that a problem has by hand", &[]);
        } else {
            let advice = [
                "entry 4·i + j of a map belongs to entry ij",
                "the last number of a map is added",
                "½ |A x − b|² has the slope Aᵀ(A x − b)",
            ];
            exchange.note(Standing::Wrong, &what, &format!("x is {x:?}; due is {X:?}, with multipliers of the traces {TRACES:?}"), &advice);
        }
    }
}
