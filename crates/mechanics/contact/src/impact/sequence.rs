//! Simultaneous impacts as sequences of single ones. Another order may end in other velocities; the disagreement is a result.

use super::{Impact, Law, NoImpact, impact};
use crate::problem::{Level, Problem};
use nalgebra::DVector;

/// The end of a sequence of single impacts.
#[derive(Clone, Debug, PartialEq)]
pub struct Sequence {
    /// The contacts in the order in which each pass looked at them.
    pub order: Vec<usize>,
    /// The contacts that had an impact, in time.
    pub history: Vec<usize>,
    /// Sums of impulses, velocities at the end, and the change of kinetic energy.
    pub end: Impact,
    /// Whether no contact closes any more. Otherwise the cap was reached.
    pub complete: bool,
}

/// The ends of all orders of a simultaneous impact.
#[derive(Clone, Debug, PartialEq)]
pub struct Orders {
    /// One end per order.
    pub sequences: Vec<Sequence>,
    /// The largest distance ‖v_a − v_b‖_M = √(Δλᵀ G Δλ) between two ends, in √J.
    pub disagreement: f64,
}

/// A contact closes if it approaches faster than this part of the velocity scale: rounding leaves 1e-16.
const CLOSES: f64 = 1e-12;
/// More contacts than this have too many orders: 6! = 720.
const MOST: usize = 6;

/// Impacts one after another: passes over the contacts in an order, until none closes or `cap` impacts have been.
///
/// # Errors
/// [`NoImpact`] of a single impact, or if `order` is not an order of the contacts.
pub fn sequence(problem: &Problem, law: Law, order: &[usize], cap: usize) -> Result<Sequence, NoImpact> {
    let mut sorted = order.to_vec();
    sorted.sort_unstable();
    if !sorted.iter().copied().eq(0..problem.contacts().len()) {
        return Err(NoImpact::Law { law: law.name(), reason: "needs an order that names every contact once" });
    }
    let closes = CLOSES * problem.scales().velocity;
    let (mut impulses, mut history) = (DVector::zeros(problem.rows()), Vec::new());
    let mut velocities = problem.free().clone();
    let mut complete = false;
    while !complete && history.len() < cap {
        complete = true;
        for &index in order {
            let range = problem.range(index);
            if velocities[range.start] >= -closes || history.len() >= cap {
                complete &= velocities[range.start] >= -closes;
                continue;
            }
            complete = false;
            let matrix = problem.delassus().view((range.start, range.start), (range.len(), range.len())).into_owned();
            let free = velocities.rows(range.start, range.len()).into_owned();
            let contact = vec![problem.contacts()[index].clone()];
            let single = Problem::from_delassus(problem.name(), Level::Impulse, contact, matrix, free)
                .map_err(|_| NoImpact::Law { law: law.name(), reason: "needs finite velocities" })?;
            let single = impact(&single, law)?;
            for (row, impulse) in range.zip(single.impulses.iter()) {
                impulses[row] += impulse;
            }
            velocities = problem.velocities(&impulses);
            history.push(index);
        }
    }
    let end = Impact { velocities, energy: problem.energy_change(&impulses), impulses };
    Ok(Sequence { order: order.to_vec(), history, end, complete })
}

/// The impacts in every order of the contacts, and how much their ends differ.
///
/// # Errors
/// [`NoImpact`] of a single impact, or if there are more than six contacts.
pub fn orders(problem: &Problem, law: Law, cap: usize) -> Result<Orders, NoImpact> {
    let count = problem.contacts().len();
    if count > MOST {
        return Err(NoImpact::Law { law: law.name(), reason: "is tried in all orders of at most six contacts" });
    }
    let sequences = permutations(count).iter().map(|order| sequence(problem, law, order, cap)).collect::<Result<Vec<_>, _>>()?;
    let mut disagreement = 0.0;
    for a in &sequences {
        for b in &sequences {
            let difference = &a.end.impulses - &b.end.impulses;
            let square = difference.dot(&(problem.delassus() * &difference));
            // A rounding error below zero is zero; NaN stays.
            let distance = if square < 0.0 { 0.0 } else { square.sqrt() };
            disagreement = featherbench_spatial::larger(disagreement, distance);
        }
    }
    Ok(Orders { sequences, disagreement })
}

fn permutations(count: usize) -> Vec<Vec<usize>> {
    (0..count).fold(vec![Vec::new()], |orders, new| {
        orders.iter().flat_map(|order| (0..=order.len()).map(move |place| [&order[..place], &[new], &order[place..]].concat())).collect()
    })
}
