//! The residual (§1, §2, §7, §8, §11, problem 1): its sign, its power, and what it is in contact.
//!
//! The true arm has other masses than the nominal one and moves by its own forward dynamics. `r = M⋆ q̈ + h⋆ − (M̂ q̈ + ĥ)`.
//! First route: our kernels in f64. Second: the closed form in double-double.

use crate::arm::Arm;
use crate::claim::{Claim, Failure, Holds, Number};
use featherbench_dynamics::{forward_dynamics, inverse_dynamics};
use featherbench_spatial::{DoubleDouble, Real};

type Wide = DoubleDouble;

/// A true arm and a nominal one that differ in their masses.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair {
    pub(crate) nominal: Arm,
    pub(crate) masses: [f64; 2],
}

impl Default for Pair {
    /// The lesson's arm, whose second link truly has 1.2 kg.
    fn default() -> Self {
        Self { nominal: Arm::default(), masses: [2.0, 1.2] }
    }
}

/// What both routes give: accelerations, torques of the nominal model, and the residual.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Both {
    a: [f64; 2],
    nominal: [f64; 2],
    r: [f64; 2],
    a_second: [f64; 2],
    nominal_second: [f64; 2],
    r_second: [f64; 2],
}

fn two<T: Copy>(list: &[T]) -> Result<[T; 2], Failure> {
    list.try_into().map_err(|_| Failure::of("the arm has two joints"))
}

impl Pair {
    fn truth(&self) -> Arm {
        Arm { masses: self.masses, ..self.nominal }
    }

    pub(crate) fn both(&self) -> Result<Both, Failure> {
        let (q, v) = (self.nominal.q, self.nominal.v);
        let (truth, nominal) = (self.truth().body()?, self.nominal.body()?);
        let a = two(&forward_dynamics(&truth, &q, &v, &self.nominal.tau)?)?;
        let told = two(&inverse_dynamics(&nominal, &q, &v, &a)?)?;
        let own = two(&inverse_dynamics(&truth, &q, &v, &a)?)?;
        let wide = self.nominal.accelerations(self.masses.map(Wide::from_f64));
        let told_wide = self.nominal.torques(self.nominal.masses.map(Wide::from_f64), wide);
        let own_wide = self.nominal.torques(self.masses.map(Wide::from_f64), wide);
        let r_wide = [own_wide[0] - told_wide[0], own_wide[1] - told_wide[1]];
        let plain = |wide: [Wide; 2]| wide.map(Wide::to_f64);
        Ok(Both {
            a,
            nominal: told,
            r: [own[0] - told[0], own[1] - told[1]],
            a_second: plain(wide),
            nominal_second: plain(told_wide),
            r_second: plain(r_wide),
        })
    }

    /// The torques by nominal model and residual.
    fn torque(&self) -> Result<Vec<Number>, Failure> {
        let both = self.both()?;
        let mut numbers = Vec::new();
        for k in 0..2 {
            let name = |what: &str| format!("{what} {}", k + 1);
            numbers.push(
                Number::new(name("torque of joint"), "N·m", both.nominal[k] + both.r[k], self.nominal.tau[k])
                    .stated(both.nominal[k] - both.r[k], -2.0 * both.r_second[k]),
            );
            numbers.push(Number::new(name("residual of joint"), "N·m", both.r[k], both.r_second[k]));
            numbers.push(Number::new(name("acceleration of joint"), "rad/s²", both.a[k], both.a_second[k]));
        }
        Ok(numbers)
    }

    /// The torque of the second section's r by the three sections that use one letter or the other.
    fn sections(&self) -> Result<Vec<Number>, Failure> {
        let both = self.both()?;
        let mut numbers = Vec::new();
        for k in 0..2 {
            let right = |section: &str| {
                Number::new(format!("{section}, torque of joint {}", k + 1), "N·m", both.nominal[k] + both.r[k], self.nominal.tau[k])
            };
            let (minus, plus) = (both.nominal[k] - both.r[k], both.nominal[k] + both.r[k]);
            // §1 has d on the right-hand side: τ = M̂q̈ + ĥ − d. §2 and §11 have τ − r and τ − d there.
            numbers.push(right("§1, d = r").stated(minus, -2.0 * both.r_second[k]));
            numbers.push(right("§2").stated(plus, 0.0));
            numbers.push(right("§11, d = r").stated(plus, 0.0));
        }
        Ok(numbers)
    }

    /// True power, what the nominal model makes of the motion, and the difference.
    fn power(&self) -> Result<[f64; 4], Failure> {
        let both = self.both()?;
        let dot = |a: [f64; 2]| a[0] * self.nominal.v[0] + a[1] * self.nominal.v[1];
        Ok([dot(self.nominal.tau), dot(both.nominal), dot(both.r), dot(both.nominal_second)])
    }
}

/// §1, §2 and §11 use one residual with two signs.
pub(super) const CONVENTION: Claim = Claim {
    id: "residual_convention",
    place: "§1, §2, §11",
    title: "One residual in three sections",
    says: "§1 adds d to the torques, §2 subtracts r from them, §11 subtracts d. All three are called the residual.",
    right: "§1's d is −r; §11's d is +r. Who fits r and puts it in as §1's d is wrong by 2r.",
    holds: Holds::InPart,
    numbers: |_| Pair::default().sections(),
};

/// The labs in Python and C++.
pub(super) const TORQUE: Claim = Claim {
    id: "residual_torque",
    place: "§7, §8",
    title: "Inverse dynamics with a residual",
    says: "τ = τ_nominal − r, with the r of §2.",
    right: "τ = τ_nominal + r: by its definition r is what the nominal torque lacks. The labs are wrong by 2r.",
    holds: Holds::No,
    numbers: |_| Pair::default().torque(),
};

/// Problem 1, what is to be shown.
pub(super) const POWER: Claim = Claim {
    id: "residual_power",
    place: "Problem 1",
    title: "Power of the residual",
    says: "The power error is q̇ᵀr.",
    right: "It is, where the nominal power is what the nominal model needs for the same motion: P̂ = q̇ᵀ(M̂q̈ + ĥ).",
    holds: Holds::Yes,
    numbers: |_| {
        let [truth, told, of_r, told_second] = Pair::default().power()?;
        Ok(vec![Number::new("P⋆ − P̂", "W", truth - told, truth - told_second).stated(of_r, 0.0), Number::new("P̂", "W", told, told_second)])
    },
};

/// Problem 1, the proof.
pub(super) const PROOF: Claim = Claim {
    id: "residual_power_proof",
    place: "Problem 1",
    title: "Proof of the power balance",
    says: "With P_nom = τᵀSq̇ it follows that P⋆ − P_nom = q̇ᵀr.",
    right: "P⋆ is τᵀSq̇ as well, so this difference is 0 for every robot. The proof needs P̂ of the line above.",
    holds: Holds::No,
    numbers: |_| {
        let pair = Pair::default();
        let [truth, told, of_r, _] = pair.power()?;
        // τ taken back from the true model, against τ itself.
        let both = pair.both()?;
        let back = pair.nominal.torques(pair.masses.map(Wide::from_f64), both.a.map(Wide::from_f64)).map(Wide::to_f64);
        let again = back[0] * pair.nominal.v[0] + back[1] * pair.nominal.v[1];
        let zero = Number::new("P⋆ − P_nom over P⋆", "1", 0.0, if (again - truth).abs() <= 1e-13 * truth.abs() { 0.0 } else { again });
        Ok(vec![zero.stated(of_r / truth, (truth - told) / truth)])
    },
};

/// Problem 1 where the robot touches something.
pub(super) const CONTACT: Claim = Claim {
    id: "residual_contact",
    place: "§2",
    title: "The residual in contact",
    says: "The nominal model has its own Ĵ and λ̂, and the true dynamics are the nominal ones with Jᵀλ − r.",
    right: "So r = τ + Jᵀλ − (M̂q̈ + ĥ): the measured contact force. Ĵᵀλ̂ instead leaves Ĵᵀλ̂ − Jᵀλ in it.",
    holds: Holds::No,
    numbers: |_| Guided::default().numbers(),
};

/// An arm whose tip slides on a smooth vertical guide; the nominal arm has another second length.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Guided {
    pub(crate) truth: Arm,
    pub(crate) length: f64,
}

impl Default for Guided {
    fn default() -> Self {
        Self { truth: Arm::default(), length: 0.55 }
    }
}

/// J and J̇q̇ of the tip's horizontal position l₁ sin q₁ + l₂ sin(q₁ + q₂).
fn guide<T: Real>(arm: &Arm, v: [T; 2]) -> ([T; 2], T) {
    let number = T::from_f64;
    let ([l1, l2], q1, q12) = (arm.lengths.map(number), number(arm.q[0]), number(arm.q[0]) + number(arm.q[1]));
    let ((s1, c1), (s12, c12)) = (q1.sin_cos(), q12.sin_cos());
    let turn = v[0] + v[1];
    ([l1 * c1 + l2 * c12, l2 * c12], -(l1 * s1 * v[0] * v[0]) - l2 * s12 * turn * turn)
}

/// λ of the guide and q̈, from M q̈ + h = τ + Jᵀλ and J q̈ = −J̇q̇.
fn guided<T: Real>(arm: &Arm) -> ([T; 2], [T; 2], T) {
    let ([m11, m12, m22], h) = arm.closed_form(arm.masses.map(T::from_f64));
    let (j, rate) = guide(arm, arm.v.map(T::from_f64));
    let determinant = m11 * m22 - m12 * m12;
    let solve = |x: T, y: T| [(x * m22 - y * m12) / determinant, (y * m11 - x * m12) / determinant];
    let free = solve(T::from_f64(arm.tau[0]) - h[0], T::from_f64(arm.tau[1]) - h[1]);
    let moved = solve(j[0], j[1]);
    let force = -(j[0] * free[0] + j[1] * free[1] + rate) / (j[0] * moved[0] + j[1] * moved[1]);
    ([free[0] + force * moved[0], free[1] + force * moved[1]], j, force)
}

impl Guided {
    pub(crate) fn numbers(&self) -> Result<Vec<Number>, Failure> {
        // The tip moves along the guide: q̇₂ follows from q̇₁.
        let (j, _) = guide(&self.truth, self.truth.v);
        let truth = Arm { v: [self.truth.v[0], -j[0] / j[1] * self.truth.v[0]], ..self.truth };
        let nominal = Arm { lengths: [truth.lengths[0], self.length], ..truth };
        let (a, j, force) = guided::<f64>(&truth);
        let (a_wide, j_wide, force_wide) = guided::<Wide>(&truth);
        let (_, j_nominal, force_nominal) = guided::<f64>(&nominal);
        let (_, j_nominal_wide, force_nominal_wide) = guided::<Wide>(&nominal);
        let told = inverse_dynamics(&nominal.body()?, &truth.q, &truth.v, &a)?;
        let masses = truth.masses.map(Wide::from_f64);
        let (own_wide, told_wide) = (truth.torques(masses, a_wide), nominal.torques(masses, a_wide));
        let mut numbers = vec![Number::new("contact force", "N", force, force_wide.to_f64())];
        for k in 0..2 {
            let right = truth.tau[k] + j[k] * force - told[k];
            let second = (own_wide[k] - told_wide[k]).to_f64();
            let stated = truth.tau[k] + j_nominal[k] * force_nominal - told[k];
            let off_by = (j_nominal_wide[k] * force_nominal_wide - j_wide[k] * force_wide).to_f64();
            numbers.push(Number::new(format!("residual of joint {}", k + 1), "N·m", right, second).stated(stated, off_by));
        }
        Ok(numbers)
    }
}

/// §1: d may depend on q̈.
pub(super) const IMPLICIT: Claim = Claim {
    id: "residual_implicit",
    place: "§1",
    title: "A residual that depends on the acceleration",
    says: "The dynamics are M q̈ + h = τ + d(q, q̇, q̈), for any d.",
    right: "q̈ is on both sides. It is determined where M − ∂d/∂q̈ is nonsingular: m a = τ + κ a has no solution at κ = m.",
    holds: Holds::InPart,
    numbers: |_| {
        let (mass, force) = (1.0, 1.0);
        let count = |share: f64| usize::from(mass - share != 0.0);
        let half = 0.5 * mass;
        // Second route: the geometric series of the fixed point a ← (τ + κ a)/m.
        let by_series = (0..60).rev().fold(0.0, |sum, _| (force + half * sum) / mass);
        let [large, small] = [2.0 * mass, force / (mass - 2.0 * mass)];
        let residual = mass * small - (force + large * small);
        Ok(vec![
            Number::count("solutions, κ = m/2", count(half), 1).stated(1.0, 0.0),
            Number::count("solutions, κ = m", count(mass), 0).stated(1.0, 1.0),
            Number::new("acceleration, κ = m/2", "m/s²", force / (mass - half), by_series),
            // The fixed point diverges, and there is one solution all the same.
            Number::new("acceleration, κ = 2m", "m/s²", small, small + residual),
        ])
    },
};

#[cfg(test)]
mod tests {
    use super::*;

    /// Other masses, states and lengths: both routes agree, and the separations are those of the formulas.
    #[test]
    fn other_numbers_agree() {
        let mut random = featherbench_robots::Random::new(5, 0);
        for _ in 0..40 {
            let mut draw = |low: f64, high: f64| random.uniform(low, high);
            let nominal = Arm {
                masses: [draw(0.5, 4.0), draw(0.5, 4.0)],
                lengths: [draw(0.3, 1.5), draw(0.3, 1.5)],
                q: [draw(-3.0, 3.0), draw(0.2, 1.2)],
                v: [draw(-2.0, 2.0), draw(-2.0, 2.0)],
                tau: [draw(-5.0, 5.0), draw(-5.0, 5.0)],
                ..Arm::default()
            };
            let pair = Pair { nominal, masses: [draw(0.5, 4.0), draw(0.5, 4.0)] };
            let guided = Guided { truth: Arm { q: [draw(-0.3, 0.3), draw(0.2, 0.6)], ..nominal }, length: draw(0.4, 1.2) };
            let numbers = [pair.torque().unwrap(), pair.sections().unwrap(), guided.numbers().unwrap()].concat();
            for number in numbers {
                // Torques up to 10² with small differences.
                let scale = 1.0 / number.corrected.abs().min(1.0);
                assert!(number.error() < 1e-12 * scale, "{number:?}");
                assert!(number.separation_error().is_none_or(|error| error < 1e-12 * scale), "{number:?}");
            }
        }
    }
}
