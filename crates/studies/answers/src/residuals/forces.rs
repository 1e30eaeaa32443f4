//! The sign, a payload, drives with an inner state, and where the acceleration is not determined.

use super::{Case, arm, count, error, failed, largest, told};
use featherbench_bench::NoAnswer;
use featherbench_dynamics::{forward_dynamics, inverse_dynamics};
use featherbench_model::{BodyDescription, Description, JointDescription, JointType, Model};
use featherbench_residuals::{Corrected, Lag, Linear, Payload, Residual, ResidualError, Rigid, SeriesElastic, State};
use featherbench_robots::{Family, Random, StateBatch};
use nalgebra::{Matrix2, Vector2};
use serde_json::json;

/// Mass of the box, kg.
const BOX: f64 = 2.0;

pub(super) fn cases() -> Vec<Case> {
    let robots = ["chain:n=6", "quadruped", "humanoid", "joints:kind=spherical,base=free"];
    let masses = [1.0, -1.0, -2.0, -2.0 * (1.0 - 1e-13), -3.0];
    let drives = [lag(0.2, 6.0, 0.5), lag(0.01, -2.0, 0.3), series_elastic(50.0, 0.5, 0.7), series_elastic(2000.0, 0.05, 0.2)];
    let sign = [1.2, 0.7].map(sign);
    sign.into_iter().chain(robots.map(payload)).chain(masses.map(well_posed)).chain(drives).collect()
}

/// The forces of the arm in closed form: M and h of two uniform rods, angles from the downward vertical.
///
/// With c = cos q₂: M₁₁ = m₁l₁²/3 + m₂(l₁² + l₂²/3 + l₁l₂c), M₁₂ = m₂(l₂²/3 + l₁l₂c/2), M₂₂ = m₂l₂²/3.
fn closed_form(second_mass: f64, q: [f64; 2], v: [f64; 2], tau: [f64; 2]) -> Option<[f64; 2]> {
    let robot = arm(second_mass);
    let ([m1, m2], [l1, l2], g) = ([robot.masses[0], robot.masses[1]], [robot.lengths[0], robot.lengths[1]], robot.gravity);
    let (sine, cosine) = q[1].sin_cos();
    let coupled = m2 * (l2 * l2 / 3.0 + l1 * l2 * cosine / 2.0);
    let first = m1 * l1 * l1 / 3.0 + m2 * (l1 * l1 + l2 * l2 / 3.0 + l1 * l2 * cosine);
    let mass = Matrix2::new(first, coupled, coupled, m2 * l2 * l2 / 3.0);
    let swing = m2 * l1 * l2 * sine / 2.0;
    let hang = m2 * g * l2 / 2.0 * (q[0] + q[1]).sin();
    let bias =
        Vector2::new(-swing * (2.0 * v[0] * v[1] + v[1] * v[1]) + (m1 / 2.0 + m2) * g * l1 * q[0].sin() + hang, swing * v[0] * v[0] + hang);
    let a = mass.try_inverse()? * (Vector2::from(tau) - bias);
    Some([a.x, a.y])
}

/// A second rod of another mass than the nominal 1 kg, as a payload of either sign. With τ = ID + r the acceleration must be the true one
/// of the closed form. With τ = ID − r it must be that of no robot.
fn sign(second_mass: f64) -> Case {
    let (q, v, tau) = ([0.3, -0.5], [0.7, 0.4], [1.0, -0.5]);
    Case {
        name: format!("second rod of {second_mass} kg"),
        quantity: "sign",
        method: "newton".into(),
        params: json!({"second_mass": second_mass, "nominal": 1.0, "q": q, "v": v, "tau": tau}),
        numbers: vec![error("forward_error", "closed form"), error("inverse_error", "closed form"), told("other_sign_error", "1")],
        evaluate: Box::new(move |_| {
            let due = closed_form(second_mass, q, v, tau).ok_or_else(|| NoAnswer::Failed("the closed form is singular".into()))?;
            let [nominal, truth] = [1.0, second_mass].map(|mass| Model::<f64>::build(&arm(mass).describe()));
            let (nominal, truth) = (nominal.map_err(failed)?, truth.map_err(failed)?);
            let known = inverse_dynamics(&nominal, &q, &v, &due).map_err(failed)?;
            let r: Vec<f64> = tau.iter().zip(&known).map(|(tau, known)| tau - known).collect();
            // The residual as a function of the state: the difference of both models, which is linear in the second rod's mass.
            let residual = Difference { truth, nominal: nominal.clone() };
            let mut corrected = Corrected::new(Rigid::new(&nominal), residual).map_err(failed)?;
            let forward = corrected.forward(&q, &v, &tau).map_err(failed)?;
            let inverse = corrected.inverse(&q, &v, &due).map_err(failed)?;
            let wrong: Vec<f64> = known.iter().zip(&r).map(|(known, r)| known - r).collect();
            Ok(vec![apart(&forward, &due), apart(&inverse, &tau), apart(&wrong, &tau)])
        }),
    }
}

/// The true model less the nominal one.
#[derive(Debug)]
struct Difference {
    truth: Model<f64>,
    nominal: Model<f64>,
}

impl Residual for Difference {
    fn nv(&self) -> usize {
        self.nominal.topology.nv()
    }

    fn add(&self, state: &State<'_>, r: &mut [f64]) -> Result<(), ResidualError> {
        let forces = |model: &Model<f64>| inverse_dynamics(model, state.q, state.v, state.a);
        let (truth, nominal) = (forces(&self.truth)?, forces(&self.nominal)?);
        r.iter_mut().zip(truth.iter().zip(&nominal)).for_each(|(r, (truth, nominal))| *r += truth - nominal);
        Ok(())
    }

    fn has_acceleration(&self) -> bool {
        true
    }

    fn add_by_acceleration(&self, state: &State<'_>, matrix: &mut nalgebra::DMatrix<f64>) -> Result<(), ResidualError> {
        let mass = |model: &Model<f64>| featherbench_dynamics::mass_matrix(model, state.q).map(|mass| mass.to_dense());
        *matrix += mass(&self.truth)? - mass(&self.nominal)?;
        Ok(())
    }
}

/// A payload in the last body: r is the difference of the inverse dynamics of two models, and forward dynamics those of the loaded one.
fn payload(robot: &'static str) -> Case {
    const MASS: f64 = 0.7;
    const COM: [f64; 3] = [0.02, -0.03, 0.05];
    Case {
        name: format!("payload on {robot}"),
        quantity: "payload",
        method: "residual".into(),
        params: json!({"robot": robot, "mass": MASS, "com": COM}),
        numbers: vec![error("inverse_error", "loaded model"), error("forward_error", "loaded model")],
        evaluate: Box::new(move |seed| {
            let light = Family::parse(robot).map_err(failed)?.generate().map_err(failed)?;
            let last = light.bodies.len() - 1;
            let payload = Payload::new(&light, last, MASS, COM, [0.0; 6]).map_err(failed)?;
            let mut heavy = light.clone();
            load(&mut heavy.bodies[last], MASS, COM);
            let (light, heavy) = (Model::<f64>::build(&light).map_err(failed)?, Model::<f64>::build(&heavy).map_err(failed)?);
            let states = StateBatch::random(&light, 5, seed);
            let mut corrected = Corrected::new(Rigid::new(&light), payload).map_err(failed)?;
            let (mut inverse, mut forward) = (Vec::new(), Vec::new());
            for k in 0..states.count() {
                let (q, v, a) = (states.q(k), states.v(k), states.a(k));
                let due = inverse_dynamics(&heavy, q, v, a).map_err(failed)?;
                inverse.push(apart(&corrected.inverse(q, v, a).map_err(failed)?, &due));
                let due_a = forward_dynamics(&heavy, q, v, states.tau(k)).map_err(failed)?;
                forward.push(apart(&corrected.forward(q, v, states.tau(k)).map_err(failed)?, &due_a));
            }
            Ok(vec![largest(inverse), largest(forward)])
        }),
    }
}

/// Adds a point mass to a body: masses add, the centre is their mean, and the inertia about it gains the reduced mass at their distance.
fn load(body: &mut BodyDescription, mass: f64, com: [f64; 3]) {
    let total = body.mass + mass;
    let between: [f64; 3] = std::array::from_fn(|k| body.com[k] - com[k]);
    let (reduced, square) = (body.mass * mass / total, between.iter().map(|x| x * x).sum::<f64>());
    for (k, (i, j)) in [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].into_iter().enumerate() {
        body.inertia[k] += reduced * (if i == j { square } else { 0.0 } - between[i] * between[j]);
    }
    body.com = std::array::from_fn(|k| (body.mass * body.com[k] + mass * com[k]) / total);
    body.mass = total;
}

/// A box that slides along x.
fn sliding_box() -> Result<Model<f64>, NoAnswer> {
    let joint = JointDescription { kind: JointType::Prismatic { axis: [1.0, 0.0, 0.0] }, ..JointDescription::default() };
    let body = BodyDescription { name: "box".into(), parent: None, mass: BOX, com: [0.0; 3], inertia: [0.0; 6], joint };
    Model::build(&Description { bodies: vec![body], ..Description::default() }).map_err(failed)
}

/// m a + α a = τ with m = 2: no answer for α = −m, τ / (m + α) otherwise.
fn well_posed(factor: f64) -> Case {
    // Four digits are left at 10⁻¹²; a factor 10⁻¹³ from −m leaves three.
    let regular = (BOX + factor).abs() / BOX >= featherbench_residuals::WELL_POSED;
    let mut numbers = vec![count("answers", f64::from(u8::from(regular)), "theory")];
    if regular {
        numbers.push(error("forward_error", "closed form"));
    }
    Case {
        name: format!("box with r = {factor} a"),
        quantity: "well_posed",
        method: "newton".into(),
        params: json!({"mass": BOX, "factor": factor}),
        numbers,
        evaluate: Box::new(move |_| {
            let model = sliding_box()?;
            let residual = Linear::new(1, 1, vec![0.0, 0.0, factor, 0.0]).map_err(failed)?;
            let mut corrected = Corrected::new(Rigid::new(&model), residual).map_err(failed)?;
            match corrected.forward(&[0.0], &[0.0], &[3.0]) {
                Ok(a) => Ok(vec![1.0, (a[0] * (BOX + factor) / 3.0 - 1.0).abs()]),
                Err(ResidualError::IllPosed { .. }) => Ok(vec![0.0]),
                Err(other) => Err(failed(other)),
            }
        }),
    }
}

/// Steps of Runge and Kutta's rule per case, and those of the second run.
const STEPS: [usize; 2] = [200, 400];

/// The end of [q, v, inner] of the box under a constant command, by the fourth-order rule.
fn run<R: Residual>(residual: R, start: &[f64], command: f64, time: f64, steps: usize) -> Result<Vec<f64>, NoAnswer> {
    let model = sliding_box()?;
    let mut corrected = Corrected::new(Rigid::new(&model), residual).map_err(failed)?;
    let mut rate = |x: &[f64]| -> Result<Vec<f64>, NoAnswer> {
        let (q, v, inner) = (&x[..1], &x[1..2], &x[2..]);
        let a = corrected.forward_of(q, v, &[command], inner).map_err(failed)?;
        let mut own = vec![0.0; inner.len()];
        let state = State::new(q, v, &a).with_command(std::slice::from_ref(&command)).with_inner(inner);
        corrected.residual().inner_rate(&state, &mut own).map_err(failed)?;
        Ok([v, &a, &own].concat())
    };
    let h = time / steps as f64;
    let mut x = start.to_vec();
    for _ in 0..steps {
        let at = |k: &[f64], part: f64| x.iter().zip(k).map(|(x, k)| x + part * h * k).collect::<Vec<f64>>();
        let k1 = rate(&x)?;
        let k2 = rate(&at(&k1, 0.5))?;
        let k3 = rate(&at(&k2, 0.5))?;
        let k4 = rate(&at(&k3, 1.0))?;
        x = (0..x.len()).map(|i| x[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i])).collect();
    }
    Ok(x)
}

/// A drive whose motion is known, as residual with an inner state: the error after `STEPS[1]` steps, and the order between both.
fn drive<R, F>(name: String, method: &str, params: serde_json::Value, motion: F) -> Case
where
    R: Residual,
    F: Fn() -> Result<(R, Vec<f64>, f64, f64, Vec<f64>), ResidualError> + Send + Sync + 'static,
{
    Case {
        name,
        quantity: "drive",
        method: method.into(),
        params,
        numbers: vec![error("motion_error", "closed form"), error("order_error", "theory")],
        evaluate: Box::new(move |_| {
            let mut errors = [0.0; 2];
            for (wrong, steps) in errors.iter_mut().zip(STEPS) {
                let (residual, start, command, time, due) = motion().map_err(failed)?;
                *wrong = apart(&run(residual, &start, command, time, steps)?, &due);
            }
            Ok(vec![errors[1], ((errors[0] / errors[1]).log2() - 4.0).abs()])
        }),
    }
}

/// T ż = u − z from rest: z = u (1 − e^(−t/T)), v = (u/m)(t − T (1 − e^(−t/T))), q = (u/m)(t²/2 − T t + T² (1 − e^(−t/T))).
fn lag(constant: f64, command: f64, periods: f64) -> Case {
    let params = json!({"time_constant": constant, "command": command, "time": periods});
    drive(format!("lag of {constant} s"), "lag", params, move || {
        // As long as the time constant makes interesting.
        let time = periods * 10.0 * constant;
        let late = 1.0 - (-time / constant).exp();
        let push = command / BOX;
        let due = vec![
            push * (time * time / 2.0 - constant * time + constant * constant * late),
            push * (time - constant * late),
            command * late,
        ];
        Ok((Lag::new(vec![constant])?, vec![0.0; 3], command, time, due))
    })
}

/// A motor and the box on a spring, stretched by 0.1 and let go: they swing about their common centre with ω² = K (1/m + 1/B).
fn series_elastic(stiffness: f64, motor: f64, turns: f64) -> Case {
    let params = json!({"stiffness": stiffness, "motor": motor, "mass": BOX, "turns": turns});
    drive(format!("drive of {stiffness} N/m"), "series_elastic", params, move || {
        let omega = (stiffness * (1.0 / BOX + 1.0 / motor)).sqrt();
        let time = turns * std::f64::consts::TAU / omega;
        let (sine, cosine) = (omega * time).sin_cos();
        let shares = [-motor / (BOX + motor), BOX / (BOX + motor)];
        let centre = 0.1 * motor / (BOX + motor);
        let [q, theta] = shares.map(|share| centre + 0.1 * share * cosine);
        let [v, rate] = shares.map(|share| -0.1 * omega * share * sine);
        let drive = SeriesElastic::new(vec![stiffness], vec![0.0], vec![motor])?;
        Ok((drive, vec![0.0, 0.0, 0.1, 0.0], 0.0, time, vec![q, v, theta, rate]))
    })
}

/// The largest difference, over the largest magnitude of what is due.
pub(super) fn apart(found: &[f64], due: &[f64]) -> f64 {
    largest(found.iter().zip(due).map(|(a, b)| a - b)) / largest(due.iter().copied()).max(f64::MIN_POSITIVE)
}

/// `count` numbers of [−1, 1).
pub(super) fn draw(random: &mut Random, count: usize) -> Vec<f64> {
    (0..count).map(|_| random.uniform(-1.0, 1.0)).collect()
}
