//! §6 and problem 3: how sensitivities jump at events.
//!
//! The lesson has S⁺ = Δ_x S⁻ + Δ_θ. It leaves out that the time of the event moves: with the guard g(x, θ) = 0
//!
//! ```text
//! S⁺ = Δ_x S⁻ + Δ_θ + (f⁺ − Δ_x f⁻) (g_x S⁻ + g_θ)/(g_x f⁻)
//! ```
//!
//! First route: the saltation matrix and the variational equation of `featherbench_hybrid`. Second: closed forms, by dual numbers.

use crate::claim::{Claim, Failure, Holds, Number};
use featherbench_hybrid::systems::BouncingBall;
use featherbench_hybrid::{Direction, Hybrid, Saltation, Settings, Start, sensitivity, simulate};
use featherbench_spatial::{Dual, Real};

/// Problem 3: ẋ = θ + κ x (or κ θ x) until x rises through x_i, where x⁺ = α x⁻. θ = (θ, x_i, α, κ).
#[derive(Clone, Copy, Debug)]
struct Scaled {
    /// Whether the flow is κ θ x.
    proportional: bool,
}

impl Hybrid for Scaled {
    fn states(&self) -> usize {
        1
    }

    fn parameters(&self) -> usize {
        4
    }

    fn direction(&self, _: usize, _: usize) -> Direction {
        Direction::Rising
    }

    fn flow<T: Real>(&self, _: usize, _: T, x: &[T], theta: &[T], rate: &mut [T]) {
        rate[0] = if self.proportional { theta[3] * theta[0] * x[0] } else { theta[0] + theta[3] * x[0] };
    }

    fn guard<T: Real>(&self, _: usize, _: usize, _: T, x: &[T], theta: &[T]) -> T {
        x[0] - theta[1]
    }

    fn reset<T: Real>(&self, _: usize, _: usize, _: T, x: &[T], theta: &[T], after: &mut [T]) {
        after[0] = theta[2] * x[0];
    }
}

/// The numbers of problem 3.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Threshold {
    pub(crate) theta: f64,
    pub(crate) threshold: f64,
    pub(crate) factor: f64,
    /// When the run ends; it must hold one event.
    pub(crate) end: f64,
}

impl Default for Threshold {
    fn default() -> Self {
        Self { theta: 2.0, threshold: 1.0, factor: 0.5, end: 1.0 }
    }
}

impl Threshold {
    /// The factor of S at the event.
    fn at_event(&self, name: &str, system: Scaled, share: f64) -> Result<Number, Failure> {
        let theta = [self.theta, self.threshold, self.factor, share];
        let found = Saltation::new(&system, &theta, 0, 0, 0, 0.0, &[self.threshold])?.matrix()[(0, 0)];
        let flow = |x: f64| if system.proportional { share * self.theta * x } else { self.theta + share * x };
        let known = flow(self.factor * self.threshold) / flow(self.threshold);
        Ok(Number::new(format!("∂x⁺/∂x⁻ at the event, {name}"), "1", found, known).stated(self.factor, self.factor - known))
    }

    /// ∂x/∂θ at the end, f = θ: x = α x_i + θ (t − x_i/θ) from x = 0.
    fn at_end(&self) -> Result<Number, Failure> {
        let (system, theta) = (Scaled { proportional: false }, [self.theta, self.threshold, self.factor, 0.0]);
        let run = simulate(&system, &theta, &Start { mode: 0, time: 0.0, state: vec![0.0] }, self.end, &Settings::default())?;
        let found = sensitivity(&system, &theta, &run)?.columns[1][0];
        let moving = Dual::new(self.theta, 1.0);
        let [threshold, factor, end] = [self.threshold, self.factor, self.end].map(Dual::constant);
        let known = (factor * threshold + moving * (end - threshold / moving)).derivative;
        let before = self.threshold / self.theta;
        let lesson = self.factor * before + (self.end - before);
        Ok(Number::new(format!("∂x({})/∂θ, f = θ", self.end), "1", found, known).stated(lesson, (self.factor - 1.0) * before))
    }

    pub(crate) fn numbers(&self) -> Result<Vec<Number>, Failure> {
        let (plain, proportional) = (Scaled { proportional: false }, Scaled { proportional: true });
        Ok(vec![
            self.at_event("f = θ", plain, 0.0)?,
            self.at_event("f = θ + x", plain, 1.0)?,
            self.at_event("f = θ x", proportional, 1.0)?,
            self.at_end()?,
        ])
    }
}

/// Problem 3.
pub(super) const SCALED: Claim = Claim {
    id: "jump_scaled",
    place: "Problem 3",
    title: "A sensitivity at a reset",
    says: "After x⁺ = α x⁻ the sensitivity is α times that before.",
    right: "The state at the event is fixed, and its time moves: the factor is f(αx_i)/f(x_i). It is α only where f(αx_i) = α f(x_i).",
    holds: Holds::InPart,
    numbers: |_| Threshold::default().numbers(),
};

/// A ball's state at a time after one bounce, in closed form.
fn bounced<T: Real>(height: T, speed: T, restitution: T, gravity: f64, time: f64) -> [T; 2] {
    let (g, end) = (T::from_f64(gravity), T::from_f64(time));
    let down = (speed * speed + (g + g) * height).sqrt();
    let rest = end - (speed + down) / g;
    let up = restitution * down;
    [up * rest - T::from_f64(0.5) * g * rest * rest, up - g * rest]
}

/// The ball of §6.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ball {
    pub(crate) height: f64,
    pub(crate) speed: f64,
    pub(crate) restitution: f64,
    pub(crate) gravity: f64,
    pub(crate) end: f64,
}

impl Default for Ball {
    /// From rest at 1 m, e = 0.8, until 0.7 s.
    fn default() -> Self {
        Self { height: 1.0, speed: 0.0, restitution: 0.8, gravity: 9.81, end: 0.7 }
    }
}

impl Ball {
    pub(crate) fn numbers(&self) -> Result<Vec<Number>, Failure> {
        let theta = [self.gravity, self.restitution];
        let start = Start { mode: 0, time: 0.0, state: vec![self.height, self.speed, 0.0] };
        let run = simulate(&BouncingBall, &theta, &start, self.end, &Settings::default())?;
        let columns = sensitivity(&BouncingBall, &theta, &run)?.columns;
        let event = run.events.first().ok_or_else(|| Failure::of("the ball does not bounce before the end"))?;
        let (rest, before, e) = (self.end - event.time, event.before[1], self.restitution);
        // The lesson, column by column: flights [[1, t], [0, 1]] around Δ_x = diag(1, −e), and Δ_e = (0, −v⁻).
        let lesson = [[1.0, 0.0], [event.time - rest * e, -e], [-before * rest, -before]];
        let inputs = [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)];
        let places = [(0, "∂x₀"), (1, "∂v₀"), (4, "∂e")];
        let mut numbers = Vec::new();
        for ((seed, (column, by)), lesson) in inputs.into_iter().zip(places).zip(lesson) {
            let of = |value: f64, rate: f64| Dual::new(value, rate);
            let known = bounced(of(self.height, seed.0), of(self.speed, seed.1), of(e, seed.2), self.gravity, self.end);
            // The time of the event moves by ẋ t′ = −∂x⁻: what the lesson leaves out is Ξ − Δ_x = [[−1 − e, 0], [−(1 + e) g/v⁻, 0]].
            let fallen = [1.0, event.time, 0.0][numbers.len() / 2];
            let missing = [(1.0 + e) * fallen, (1.0 + e) * self.gravity / before * fallen];
            let off_by = [missing[0] + rest * missing[1], missing[1]];
            for (k, of) in ["∂x", "∂v"].into_iter().enumerate() {
                let number = Number::new(format!("{of}/{by}"), "SI", columns[column][k], known[k].derivative);
                numbers.push(number.stated(lesson[k], off_by[k]));
            }
        }
        Ok(numbers)
    }
}

/// §6's law.
pub(super) const LAW: Claim = Claim {
    id: "jump_law",
    place: "§6",
    title: "The jump of sensitivities",
    says: "At an impact ∂x⁺/∂θ = Δ_x ∂x⁻/∂θ + Δ_θ.",
    right: "The time of the impact moves as well: (f⁺ − Δ_x f⁻) times its derivative is missing. It is right for e, which moves no impact.",
    holds: Holds::InPart,
    numbers: |_| Ball::default().numbers(),
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_numbers_agree() {
        let mut random = featherbench_robots::Random::new(4, 0);
        for _ in 0..30 {
            let mut draw = |low: f64, high: f64| random.uniform(low, high);
            let first = Threshold { theta: draw(1.0, 3.0), threshold: draw(0.3, 0.9), factor: draw(0.1, 0.9), end: 0.95 };
            let first = Threshold { end: first.threshold / first.theta + 0.1 * first.threshold / first.theta, ..first };
            let ball = Ball { height: draw(0.5, 1.2), speed: draw(-0.5, 0.2), restitution: draw(0.6, 0.95), ..Ball::default() };
            for number in first.numbers().unwrap().into_iter().chain(ball.numbers().unwrap()) {
                assert!(number.error() < 1e-11, "{number:?}");
                assert!(number.separation_error().unwrap() < 1e-11, "{number:?}");
            }
        }
    }
}
