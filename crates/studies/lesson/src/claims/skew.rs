//! §2: Ṁ − 2C is skew for some C only.
//!
//! C q̇ is the same for C + N wherever N q̇ = 0. Christoffel's C has Ṁ = C + Cᵀ. Others with the same force violate it, while
//! q̇ᵀ(Ṁ − 2C)q̇ = 0 for all of them: the scalar test cannot tell.

use crate::arm::Arm;
use crate::claim::{Claim, Failure, Holds, Number};
use featherbench_dynamics::{coriolis_matrix, mass_matrix_rate};
use featherbench_spatial::largest;

type Matrix = [[f64; 2]; 2];

/// The largest entry of Ṁ − C − Cᵀ.
fn violation(rate: &Matrix, c: &Matrix) -> f64 {
    largest([(0, 0), (0, 1), (1, 1)].map(|(i, j)| rate[i][j] - c[i][j] - c[j][i]))
}

/// q̇ᵀ(Ṁ − 2C)q̇.
fn scalar(rate: &Matrix, c: &Matrix, v: [f64; 2]) -> f64 {
    (0..2).flat_map(|i| (0..2).map(move |j| (i, j))).map(|(i, j)| v[i] * (rate[i][j] - 2.0 * c[i][j]) * v[j]).sum()
}

fn numbers(arm: &Arm) -> Result<Vec<Number>, Failure> {
    let model = arm.body()?;
    let (c, rate) = (coriolis_matrix(&model, &arm.q, &arm.v)?, mass_matrix_rate(&model, &arm.q, &arm.v)?);
    let from = |entry: &dyn Fn(usize, usize) -> f64| [[entry(0, 0), entry(0, 1)], [entry(1, 0), entry(1, 1)]];
    let (ours, rate) = (from(&|i, j| c.get(i, j)), from(&|i, j| rate.get(i.max(j), i.min(j))));
    // By hand, with η = m₂ l₁ c₂ sin q₂ from the closed form: its change of m₁₁ by q₂ is −2η.
    let [v1, v2] = arm.v;
    let eta = arm.lengths[0] * arm.first_moment() * arm.q[1].sin();
    let rate_by_hand = [[-2.0 * eta * v2, -eta * v2], [-eta * v2, 0.0]];
    let grouped = [[0.0, -eta * (2.0 * v1 + v2)], [eta * v1, 0.0]];
    let first_column = [[-2.0 * eta * v2, -eta * v2], [eta * v1, 0.0]];
    let mut numbers = vec![
        Number::new("Christoffel's C: largest entry of Ṁ − C − Cᵀ", "N·m·s", snapped(violation(&rate, &ours), eta), 0.0).stated(0.0, 0.0),
        Number::new("Ṁ by our kernel, entry 11", "N·m·s", rate[0][0], rate_by_hand[0][0]),
    ];
    for (name, c, known) in [
        ("C with all velocity products in column 2", grouped, largest([2.0 * eta * v2, eta * v1])),
        ("C with q̇₁q̇₂ in column 1", first_column, largest([2.0 * eta * v2, eta * v1])),
    ] {
        let same = |i: usize| (c[i][0] * v1 + c[i][1] * v2 - ours[i][0] * v1 - ours[i][1] * v2).abs();
        let force = snapped(same(0) + same(1), eta);
        let found = violation(&rate, &c);
        numbers.push(Number::new(format!("{name}: largest entry of Ṁ − C − Cᵀ"), "N·m·s", found, known).stated(0.0, -known));
        numbers.push(Number::new(format!("{name}: difference of the force Cq̇"), "N·m", force, 0.0));
        numbers.push(Number::new(format!("{name}: q̇ᵀ(Ṁ − 2C)q̇"), "W", snapped(scalar(&rate, &c, arm.v), eta), 0.0));
    }
    Ok(numbers)
}

/// Zero, where rounding alone is left of numbers of this size.
fn snapped(value: f64, size: f64) -> f64 {
    if value.abs() <= 16.0 * f64::EPSILON * (1.0 + size.abs()) { 0.0 } else { value }
}

/// §2's structural property.
pub(super) const CLAIM: Claim = Claim {
    id: "skew_symmetry",
    place: "§2",
    title: "Ṁ − 2C is skew-symmetric",
    says: "It is a structural property of rigid-body dynamics.",
    right: "It is one of Christoffel's C. Other C with the same Cq̇ violate it, though q̇ᵀ(Ṁ − 2C)q̇ = 0 for each: test the matrix.",
    holds: Holds::InPart,
    numbers: |_| numbers(&Arm::default()),
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::Links;

    #[test]
    fn masses_at_the_tips_too() {
        for number in numbers(&Arm::default().with(Links::TipMasses)).unwrap() {
            assert!(number.error() < 1e-13, "{number:?}");
        }
    }
}
