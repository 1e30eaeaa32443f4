//! Elastic rods, if an oracle has them: requests without an answer, repetition, and a rod that is solved by hand.

use super::Standing;
use super::exchange::Exchange;
use crate::oracle::rods;
use featherbench_bench::{RodAnswer, RodQuestion};

/// The elements of the rod.
const COUNT: usize = 24;
/// The largest relative error of a frequency, and of a deflection. Rigid links have 0.23/n² and 1/(4n²), so 5e-4; wrong units, axes or signs cause
/// errors of one.
const NEAR: f64 = 0.01;

/// A rod of 2 m with EI = 3 N·m² and 0.5 kg/m, without a force and with α = P L²/EI = 0.01.
fn question() -> RodQuestion {
    RodQuestion { count: COUNT, length: 2.0, bending: 3.0, mass_per_length: 0.5, forces: vec![0.0, 0.0075, -0.0075] }
}

/// Asks for everything.
pub(super) fn ask(exchange: &mut Exchange, elements: &[String]) {
    let Some(first) = elements.first() else { return };
    let refused = |exchange: &mut Exchange, what: &str, element: &str, status: &str, change: fn(&mut RodQuestion)| {
        let mut wrong = question();
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

/// The rod, twice.
fn solved(exchange: &mut Exchange, element: &str) {
    let what = format!("a rod by {element}");
    let mut answer = || -> Result<RodAnswer, String> {
        let (header, blocks) = rods::request(&question(), element);
        let answer = exchange.ask(header, blocks)?;
        rods::read(&answer, &question()).map_err(|refusal| refusal.to_string())
    };
    let (once, again) = match answer().and_then(|once| Ok((once, answer()?))) {
        Ok(answers) => answers,
        Err(reason) => return exchange.note(Standing::Wrong, &what, &reason, &[]),
    };
    if (&once.tips, &once.frequencies) != (&again.tips, &again.frequencies) {
        return exchange.note(Standing::Wrong, &what, "the same rod has other answers when it is asked again", &[]);
    }
    // ω = β² √(EI/ρA)/L², β = 1.875; δ = P L³/3EI, to α² of itself.
    let RodQuestion { length, bending, mass_per_length, ref forces, .. } = question();
    let first = 1.875_104_068_711_961_f64.powi(2) * (bending / mass_per_length).sqrt() / length.powi(2);
    let mut off = vec![once.frequencies[0] / first - 1.0];
    for (tip, force) in once.tips.iter().zip(forces) {
        let deflection = force * length.powi(3) / (3.0 * bending);
        off.push(tip[0] / length - 1.0);
        off.push(if *force == 0.0 { tip[1] / length } else { tip[1] / deflection - 1.0 });
    }
    // A NaN is not near.
    if off.iter().all(|off| off.abs() <= NEAR) {
        return exchange.note(Standing::Right, &what, "the first frequency and the small deflections of a cantilever", &[]);
    }
    let advice = ["the rod lies along x, clamped at the origin, and bends about z", "the force is along y, in world axes"];
    exchange.note(Standing::Wrong, &what, &format!("the relative errors are {off:?}"), &advice);
}
