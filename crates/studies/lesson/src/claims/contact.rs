//! §3: existence and uniqueness, and what complementarity of positions leaves open.

use crate::claim::{Claim, Failure, Holds, Number};
use featherbench_contact::solver;
use featherbench_contact::systems::{Answers, PainleveRod};

/// How many forces enumeration finds.
fn found(rod: &PainleveRod) -> Result<usize, Failure> {
    let problem = rod.problem().map_err(Failure::of)?;
    let all = solver::all();
    let enumeration = all.iter().find(|solver| solver.name() == "enumeration").ok_or_else(|| Failure::of("there is no enumeration"))?;
    Ok(enumeration.solve(&problem).map_err(Failure::of)?.points().len())
}

/// Multiple or no solutions.
pub(super) const EXISTENCE: Claim = Claim {
    id: "contact_existence",
    place: "§3",
    title: "Existence and uniqueness of contact forces",
    says: "Even in low dimensions there may be several solutions or none.",
    right: "So it is, with one rod: p = 1 + 3cosθ(cosθ − μ sinθ) and b = θ̇²sinθ − g decide. p > 0: one; p < 0: none (b < 0) or two (b > 0).",
    holds: Holds::Yes,
    numbers: |_| {
        let mut numbers = Vec::new();
        for (friction, rate) in [(1.0, 0.0), (1.0, 4.0), (1.5, 0.0), (1.5, 4.0)] {
            let rod = PainleveRod { friction, rate, ..PainleveRod::default() };
            let known = match rod.answers() {
                Answers::Contact | Answers::LiftOff => 1,
                Answers::None => 0,
                Answers::Two => 2,
            };
            let name = format!("forces of the sliding rod, μ = {friction}, θ̇ = {rate}");
            numbers.push(Number::count(name, found(&rod)?, known).stated(known as f64, 0.0));
        }
        Ok(numbers)
    },
};

/// A mass on the ground: candidates for its force, and for its velocity after an impact.
pub(super) const LEVELS: Claim = Claim {
    id: "contact_levels",
    place: "§3",
    title: "Complementarity of positions",
    says: "φ ≥ 0, λ ≥ 0, λφ = 0 is the law of a contact.",
    right: "At φ = 0 any λ ≥ 0 obeys it. The force follows from φ̈ ≥ 0 ⊥ λ ≥ 0, and the velocity after an impact from a law with a name.",
    holds: Holds::No,
    numbers: |_| {
        let (mass, gravity) = (2.0, 9.81);
        let weight = mass * gravity;
        let candidates = [0.0, 0.5 * weight, weight, 2.0 * weight];
        let complementary = |gap: f64, force: f64| gap >= 0.0 && force >= 0.0 && gap * force == 0.0;
        let by_position = candidates.iter().filter(|force| complementary(0.0, **force)).count();
        let by_acceleration: Vec<f64> = candidates.into_iter().filter(|force| complementary((force - weight) / mass, *force)).collect();
        // An impact at −3 m/s: velocities that do not penetrate, and the one of Newton's law.
        let (before, restitution) = (-3.0, 0.5);
        let after = [0.0, 1.5, 3.0];
        let by_position_after = after.iter().filter(|velocity| **velocity >= 0.0).count();
        let by_law = after.iter().filter(|velocity| **velocity == -restitution * before).count();
        let force = by_acceleration.first().copied().unwrap_or(f64::NAN);
        Ok(vec![
            Number::count("of four forces of a resting mass, allowed", by_acceleration.len(), 1).stated(by_position as f64, 3.0),
            Number::new("its force", "N", force, weight),
            Number::count("of three velocities after an impact, allowed", by_law, 1).stated(by_position_after as f64, 2.0),
        ])
    },
};
