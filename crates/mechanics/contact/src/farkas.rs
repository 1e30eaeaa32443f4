//! Proofs that a contact problem has no solution, checked apart from the solver that suggests them.
//!
//! y ≥ 0 has one number per contact. u = Σ y e_n combines the normal velocities, and g = G u. For impulses λ within the cones F of a
//! problem with a solution, with the shift r of restitution,
//!
//! ```text
//! 0 ≤ Σ y (c_n + r_n) = uᵀ(G λ + b + r) = gᵀλ + (b + r)ᵀu ≤ Σ λ_n (g_n + max over F of g_t·f) + (b + r)ᵀu
//! ```
//!
//! so y proves that there is none if g_n + max g_t·f ≤ 0 at each contact and (b + r)ᵀu < 0. G is symmetric. So
//! uᵀg = Σ y g_n, and without sliding contacts the first condition asks g = 0: the contacts y press against each other (Jᵀu = 0), whatever
//! the masses are. A zero is then proven exactly or not at all. With Jᵀu = 0 the free velocity J v has no part in bᵀu either. Therefore a
//! mechanism without sliding contacts and without restitution always has a solution, at any masses.
//!
//! A proof is about the numbers of the problem as they are given, to the last bit: M, J and v of a mechanism, otherwise G and b.

use crate::ball::Ball;
use crate::extended;
use crate::problem::{Friction, Problem};
use crate::solution::Certificate;
use nalgebra::DVector;

/// A direction whose entries have the ratios of integers up to this is tried with these integers: rounded ratios prove no zero.
const RATIOS: u32 = 64;

/// The proof whose direction is in the normal rows of `impulses`, if it is one.
pub(crate) fn proof(problem: &Problem, impulses: &DVector<f64>) -> Option<Certificate> {
    let normals = (0..problem.contacts().len()).map(|contact| impulses[problem.range(contact).start]);
    let normals: Vec<f64> = normals.map(|y| if y > 0.0 { y } else { 0.0 }).collect();
    let largest = normals.iter().copied().fold(0.0, featherbench_spatial::larger);
    let direction: Vec<f64> = normals.iter().map(|y| y / largest).collect();
    let integers = (1..=RATIOS).map(f64::from).map(|k| direction.iter().map(|y| y * k).collect::<Vec<f64>>());
    // Pivoting leaves 1e-9 of an entry: what is this near an integer may be one.
    let mut integers = integers.filter(|entries| entries.iter().all(|y| (y - y.round()).abs() <= 1e-6));
    let integers = integers.next().map(|entries| entries.iter().map(|y| y.round()).collect());
    [Some(direction), integers].into_iter().flatten().find_map(|direction| checked(problem, direction))
}

fn checked(problem: &Problem, direction: Vec<f64>) -> Option<Certificate> {
    let rows = problem.rows();
    let mut combination = vec![Ball::exact(0.0); rows];
    for (contact, y) in direction.iter().enumerate() {
        combination[problem.range(contact).start] = Ball::exact(*y);
    }
    let zeros = |count: usize| vec![Ball::exact(0.0); count];
    let dot = |numbers: &[Ball]| numbers.iter().zip(&combination).fold(Ball::exact(0.0), |sum, (b, u)| sum + *b * *u);
    let given = |numbers: &DVector<f64>| numbers.iter().map(|b| Ball::exact(*b)).collect::<Vec<_>>();
    let mut before = given(problem.before());
    let (along, free) = if let Some(mechanism) = problem.mechanism() {
        let (matrix, free) = mechanism.delassus()?;
        let pull = extended::times_plus(&extended::wide(&mechanism.jacobian.transpose()), &combination, &zeros(mechanism.mass.nrows()));
        if problem.before() == problem.free() {
            before.clone_from(&free);
        }
        if pull.iter().all(|force| force.is_zero()) {
            (zeros(rows), Ball::exact(0.0))
        } else {
            (extended::times_plus(&matrix, &combination, &zeros(rows)), dot(&free))
        }
    } else {
        let transposed = extended::wide(&problem.delassus().transpose());
        (extended::times_plus(&transposed, &combination, &zeros(rows)), dot(&given(problem.free())))
    };
    // A given G may be indefinite by its rounding; then it says nothing along u.
    if dot(&along).is_negative() {
        return None;
    }
    let mut descent = free;
    let mut growth = f64::NEG_INFINITY;
    for (index, contact) in problem.contacts().iter().enumerate() {
        let range = problem.range(index);
        if before[range.start].is_negative() {
            let shift = Ball::exact(contact.restitution) * before[range.start];
            descent = descent + combination[range.start] * shift;
        }
        for bound in bounds(&contact.friction, &along[range]) {
            if !(bound.is_zero() || bound.is_negative()) {
                return None;
            }
            growth = featherbench_spatial::larger(growth, bound.to_f64());
        }
    }
    descent.is_negative().then(|| Certificate::Ray { direction, growth, descent: descent.to_f64() })
}

/// Numbers that are all zero or less exactly where g_n + max g_t·f ≤ 0 over the friction set F at λ_n = 1.
fn bounds(friction: &Friction, along: &[Ball]) -> Vec<Ball> {
    let (normal, tangent) = (along[0], &along[1..]);
    let dot = |numbers: &[f64]| numbers.iter().zip(tangent).fold(Ball::exact(0.0), |sum, (v, g)| sum + Ball::exact(*v) * *g);
    match friction {
        Friction::None => vec![normal],
        Friction::Sliding { coefficient, direction } => vec![normal - Ball::exact(*coefficient) * dot(direction)],
        Friction::Pyramid { vertices } => std::iter::once(normal).chain(vertices.iter().map(|v| normal + dot(v))).collect(),
        Friction::Coulomb { coefficients } => match coefficients[..] {
            [mu] => vec![normal + Ball::exact(mu) * tangent[0].abs()],
            // ‖D g_t‖ ≤ −g_n.
            _ => {
                let square = |x: Ball| x * x;
                let support = coefficients.iter().zip(tangent).fold(Ball::exact(0.0), |sum, (mu, g)| sum + square(Ball::exact(*mu) * *g));
                vec![normal, support - square(normal)]
            }
        },
    }
}
