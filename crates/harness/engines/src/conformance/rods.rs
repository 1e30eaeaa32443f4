//! Elastic rods, if an oracle has them: requests without an answer, repetition, and a rod that is solved by hand.

use super::Standing;
use super::exchange::Exchange;
use crate::oracle::rods;
use featherbench_bench::{RodAnswer, RodQuestion};

/// The elements of the rods.
const COUNTS: [usize; 2] = [12, 24];
/// The largest relative error of a frequency, and of a deflection, in the limit of many elements: 2e(24) − e(12). An error c₁/n + c₂/n² leaves
/// c₂/288 in it. With c₂ of the order of one that is 0.004; wrong units, axes or signs cause errors of one.
const NEAR: f64 = 0.01;

/// A rod of 2 m with EI = 3 N·m² and 0.5 kg/m, without a force and with α = P L²/EI = 0.01.
fn question(count: usize) -> RodQuestion {
    RodQuestion { count, length: 2.0, bending: 3.0, mass_per_length: 0.5, forces: vec![0.0, 0.0075, -0.0075] }
}

/// Asks for everything.
pub(super) fn ask(exchange: &mut Exchange, elements: &[String]) {
    let Some(first) = elements.first() else { return };
    let refused = |exchange: &mut Exchange, what: &str, element: &str, status: &str, change: fn(&mut RodQuestion)| {
        let mut wrong = question(COUNTS[0]);
        change(&mut wrong);
        let (header, blocks) = rods::request(&wrong, element);
        exchange.expect(what, header, blocks, &[status]);
    };
    refused(exchange, "a rod without elements is an error", first, "error", |rod| rod.count = 0);
    refused(exchange, "a rod with a negative stiffness is an error", first, "error", |rod| rod.bending = -1.0);
    refused(exchange, "a force of NaN is an error", first, "error", |rod| rod.forces[0] = f64::NAN);
    refused(exchange, "a rod of an element that it does not have is unsupported", "no such element", "unsupported", |_| ());
    for element in elements {
        solved(exchange, element);
    }
}

/// The rods, the first of them twice.
fn solved(exchange: &mut Exchange, element: &str) {
    let what = format!("a rod by {element}");
    let mut answer = |count: usize| -> Result<RodAnswer, String> {
        let (header, blocks) = rods::request(&question(count), element);
        let answer = exchange.ask(header, blocks)?;
        rods::read(&answer, &question(count)).map_err(|refusal| refusal.to_string())
    };
    let [coarse, again, fine] = match [COUNTS[0], COUNTS[0], COUNTS[1]].map(&mut answer) {
        [Ok(coarse), Ok(again), Ok(fine)] => [coarse, again, fine],
        answers => {
            let reason = answers.into_iter().find_map(Result::err).unwrap_or_default();
            return exchange.note(Standing::Wrong, &what, &reason, &[]);
        }
    };
    if (&coarse.tips, &coarse.frequencies) != (&again.tips, &again.frequencies) {
        return exchange.note(Standing::Wrong, &what, "the same rod has other answers when it is asked again", &[]);
    }
    // What an error of first order leaves is not seen: engines may clamp a rod within its first element.
    let off: Vec<f64> = errors(&coarse).into_iter().zip(errors(&fine)).map(|(coarse, fine)| 2.0 * fine - coarse).collect();
    // A NaN is not near.
    if off.iter().all(|off| off.abs() <= NEAR) {
        return exchange.note(Standing::Right, &what, "the first frequency and the small deflections of a cantilever", &[]);
    }
    let advice = ["the rod lies along x, clamped at the origin, and bends about z", "the force is along y, in world axes"];
    exchange.note(Standing::Wrong, &what, &format!("the relative errors are {off:?}"), &advice);
}

/// Relative errors of the first frequency, ω = β² √(EI/ρA)/L² with β = 1.875, and of tips, δ = P L³/3EI to α² of itself.
fn errors(answer: &RodAnswer) -> Vec<f64> {
    let RodQuestion { length, bending, mass_per_length, ref forces, .. } = question(COUNTS[0]);
    let first = 1.875_104_068_711_961_f64.powi(2) * (bending / mass_per_length).sqrt() / length.powi(2);
    let mut off = vec![answer.frequencies[0] / first - 1.0];
    for (tip, force) in answer.tips.iter().zip(forces) {
        let deflection = force * length.powi(3) / (3.0 * bending);
        off.push(tip[0] / length - 1.0);
        off.push(if *force == 0.0 { tip[1] / length } else { tip[1] / deflection - 1.0 });
    }
    off
}
