//! §11: the energies of the Mathematica lab belong to no body, and the accelerations that it prints.
//!
//! Three routes: the Lagrangian's symbols, the closed form in double-double, and, for real bodies, our kernels.

use crate::arm::{ARGUMENTS, Arm, Links, Symbolic};
use crate::claim::{Claim, Failure, Holds, Number};
use featherbench_dynamics::forward_dynamics;
use featherbench_spatial::{DoubleDouble, Real};

/// The first moment of link 2 that T has, (m₁₂ − m₂₂)/(l₁ cos q₂), and that V has, −(∂V/∂q₂)/(g sin(q₁ + q₂)).
pub(crate) fn first_moments(arm: &Arm) -> Result<[f64; 2], Failure> {
    let mut symbolic = Symbolic::of(arm.links)?;
    let mass = &symbolic.equations.mass;
    let (m12, m22) = (mass[0][1], mass[1][1]);
    let q2 = symbolic.algebra.symbol("q2");
    let slope = symbolic.algebra.derivative(symbolic.potential, q2);
    let found = symbolic.algebra.evaluate(&[m12, m22, slope], &ARGUMENTS, &arm.arguments([0.0; 2]))?;
    let by_kinetic = (found[0] - found[1]) / (arm.lengths[0] * arm.q[1].cos());
    let by_potential = -found[2] / (arm.gravity * (arm.q[0] + arm.q[1]).sin());
    Ok([by_kinetic, by_potential])
}

/// The lab's body.
pub(super) const BODY: Claim = Claim {
    id: "arm_body",
    place: "§11",
    title: "The body of the symbolic arm",
    says: "T and V are those of one planar arm.",
    right: "T needs the first moment m₂l₂ of link 2, V needs m₂l₂/2. No body has both: either masses at the tips, or rods with their own inertia.",
    holds: Holds::No,
    numbers: |_| {
        let arm = Arm::default();
        let moment = arm.masses[1] * arm.lengths[1];
        let mut numbers = Vec::new();
        for (links, share) in [(Links::TipMasses, 1.0), (Links::UniformRods, 0.5)] {
            let [by_kinetic, by_potential] = first_moments(&arm.with(links))?;
            let difference = (by_kinetic - by_potential).abs();
            let name = |what: &str| format!("{what}, {}", links.name());
            numbers.push(Number::new(name("first moment by T"), "kg·m", by_kinetic, share * moment));
            numbers.push(Number::new(name("first moment by V"), "kg·m", by_potential, share * moment));
            let [lesson_kinetic, lesson_potential] = first_moments(&arm.with(Links::Lesson))?;
            let zero = if difference <= 1e-14 * moment { 0.0 } else { difference };
            numbers.push(
                Number::new(name("first moment by T less that by V"), "kg·m", zero, 0.0)
                    .stated(lesson_kinetic - lesson_potential, 0.5 * moment),
            );
        }
        Ok(numbers)
    },
};

/// The lab's accelerations.
pub(super) const ACCELERATIONS: Claim = Claim {
    id: "arm_accelerations",
    place: "§11",
    title: "Accelerations of the symbolic arm",
    says: "The solved equations of motion are those of the planar arm.",
    right: "They are those of no arm. Below are the two consistent ones.",
    holds: Holds::No,
    numbers: |_| accelerations_of(&Arm::default()),
};

pub(crate) fn accelerations_of(arm: &Arm) -> Result<Vec<Number>, Failure> {
    let by_symbols = |links: Links| -> Result<Vec<f64>, Failure> {
        let symbolic = Symbolic::of(links)?;
        Ok(symbolic.algebra.evaluate(&symbolic.accelerations, &ARGUMENTS, &arm.arguments([0.0; 2]))?)
    };
    let by_hand = |links: Links| arm.with(links).accelerations(arm.masses.map(DoubleDouble::from_f64));
    let (lesson, lesson_second) = (by_symbols(Links::Lesson)?, by_hand(Links::Lesson));
    let mut numbers = Vec::new();
    for links in [Links::TipMasses, Links::UniformRods] {
        let (found, second) = (by_symbols(links)?, by_hand(links));
        let model = arm.with(links).body()?;
        let kernels = forward_dynamics(&model, &arm.q, &arm.v, &arm.tau)?;
        for k in 0..2 {
            let name = format!("acceleration of joint {}, {}", k + 1, links.name());
            let off_by = (lesson_second[k] - second[k]).to_f64();
            numbers.push(Number::new(name, "rad/s²", found[k], second[k].to_f64()).stated(lesson[k], off_by));
            let name = format!("acceleration of joint {}, {}, by our kernels", k + 1, links.name());
            numbers.push(Number::new(name, "rad/s²", kernels[k], found[k]));
        }
    }
    for k in 0..2 {
        let name = format!("acceleration of joint {}, {}", k + 1, Links::Lesson.name());
        numbers.push(Number::new(name, "rad/s²", lesson[k], lesson_second[k].to_f64()));
    }
    Ok(numbers)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Other arms: all routes agree to the rounding of M⁻¹.
    #[test]
    fn drawn_arms_agree() {
        let mut random = featherbench_robots::Random::new(2, 0);
        for _ in 0..30 {
            let mut draw = |low: f64, high: f64| random.uniform(low, high);
            let arm = Arm {
                masses: [draw(0.5, 4.0), draw(0.5, 4.0)],
                lengths: [draw(0.3, 1.5), draw(0.3, 1.5)],
                q: [draw(-3.0, 3.0), draw(-3.0, 3.0)],
                v: [draw(-2.0, 2.0), draw(-2.0, 2.0)],
                tau: [draw(-5.0, 5.0), draw(-5.0, 5.0)],
                gravity: draw(1.0, 20.0),
                ..Arm::default()
            };
            for number in accelerations_of(&arm).unwrap() {
                // κ(M) up to 10³.
                let scale = 1.0 / number.corrected.abs().min(1.0);
                assert!(number.error() < 1e-12 * scale, "{number:?}");
            }
            let [by_kinetic, by_potential] = first_moments(&arm.with(Links::Lesson)).unwrap();
            assert!((by_kinetic / by_potential - 2.0).abs() < 1e-11, "{by_kinetic} {by_potential}");
        }
    }
}
