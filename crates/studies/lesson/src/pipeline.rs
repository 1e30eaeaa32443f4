//! Problem 5 as a program: truth is generated, and a model of it is built in five stages. Each is judged on a motion that it has not seen.
//!
//! | stage | the model's torque |
//! |---|---|
//! | rigid body | ID(q, v, a) of the nominal robot |
//! | contact | less Jᵀf of the ground under the last link |
//! | identification | Y(q, v, a) θ̂ instead of ID, θ̂ by least squares from a log: inertias, armature, friction, offset |
//! | residual | and r̂ = (I ⊗ [q; v; a; 1]ᵀ) φ̂, by least squares from what is left |
//! | together | θ̂ and φ̂ by one least-squares problem |
//!
//! The lesson's flow ends with the fourth stage. There θ̂ has taken what it could of the residual: it is biased, and r̂ cannot give that back. The
//! fifth does not have this error. What both could explain (a joint's own damper, rotor and constant) is left to θ̂.
//!
//! The true robot has other inertias than the nominal one, armature, friction, a ground, and springs and dampers between its joints, which no
//! robot description has. Noise is added to the torques of the log; held-out torques have none. Errors are ‖τ − τ̂‖/‖τ‖ over all joints and
//! samples. Source of the estimators: `featherbench_identification`; of the residual: `featherbench_residuals`.

use crate::claim::Failure;
use featherbench_dynamics::{forward_kinematics, inverse_dynamics, jacobian};
use featherbench_identification::{Arm, Base, Gravity, Kind, LinearModel, Rows, Samples, Search, Terms, excite, ordinary};
use featherbench_model::{Description, Model};
use featherbench_residuals::{Linear, Residual, State};
use featherbench_robots::Random;
use featherbench_spatial::largest;
use nalgebra::{DMatrix, DVector};

/// The ground: f = λ (−μ tanh(v_x/w), −μ tanh(v_y/w), 1) at the last link's origin, with λ = k max(0, height − z).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ground {
    /// Its height, m.
    pub height: f64,
    /// k, N/m.
    pub stiffness: f64,
    /// μ.
    pub friction: f64,
    /// w, m/s.
    pub width: f64,
}

/// What is generated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// Joints of the arm.
    pub joints: usize,
    /// The seed of the arm, its motions and the noise.
    pub seed: u64,
    /// How far the true masses and inertias are from the nominal ones, at most: a share.
    pub wrong: f64,
    /// Largest spring and damper between joints, N·m/rad and N·m·s/rad.
    pub coupling: f64,
    /// Deviation of the noise of the logged torques, N·m.
    pub noise: f64,
    /// The ground.
    pub ground: Ground,
    /// Samples of each motion.
    pub samples: usize,
}

impl Default for Setting {
    /// Four joints, inertias within 30 %, couplings up to 4, noise of 0.2 N·m, and a soft ground.
    fn default() -> Self {
        let ground = Ground { height: 0.6, stiffness: 400.0, friction: 0.5, width: 0.05 };
        Self { joints: 4, seed: 1, wrong: 0.3, coupling: 1.0, noise: 0.2, ground, samples: 400 }
    }
}

impl Setting {
    fn check(&self) -> Result<(), Failure> {
        if self.joints == 0 {
            return Err(Failure::of("the setting 'joints' is 0; an arm has one at least"));
        }
        if !(0.0..1.0).contains(&self.wrong) {
            return Err(Failure::of(format!("the setting 'wrong' is {}; give a share from 0 to below 1", self.wrong)));
        }
        let Ground { height, stiffness, friction, width } = self.ground;
        let numbers = [
            ("coupling", self.coupling),
            ("noise", self.noise),
            ("height", height),
            ("stiffness", stiffness),
            ("friction", friction),
            ("width", width),
        ];
        match numbers.into_iter().find(|(_, value)| !value.is_finite()) {
            Some((name, value)) => Err(Failure::of(format!("the setting '{name}' is {value}; give a finite number"))),
            None if width <= 0.0 => Err(Failure::of(format!("the setting 'width' is {width}; give a positive speed"))),
            None => Ok(()),
        }
    }
}

/// The names of the stages, in their order.
pub const STAGES: [&str; 5] = ["rigid body", "contact", "identification", "residual", "together"];

/// What a pipeline gave.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Of each stage the error on the log.
    pub logged: [f64; 5],
    /// Of each stage the error on the motion that no stage has seen.
    pub held_out: [f64; 5],
    /// Shares of the samples that touch the ground, in log and held-out motion.
    pub touching: [f64; 2],
    /// Base parameters that were identified.
    pub identified: usize,
    /// Error of the inertial base parameters over the largest of them: identified before the residual, and together with it.
    pub parameters: [f64; 2],
    /// Rank of the residual's regressor.
    pub rank: usize,
    /// ‖noise‖/‖τ‖ of the log.
    pub noise: f64,
}

/// A motion with its torques, and those of the ground.
struct Motion {
    samples: Samples,
    ground: Vec<f64>,
    touching: f64,
}

/// A deterministic number with mean 0 and variance 1, nearly normal.
fn noise(random: &mut Random) -> f64 {
    (0..12).map(|_| random.unit()).sum::<f64>() - 6.0
}

fn unit(random: &mut Random) -> f64 {
    random.uniform(-1.0, 1.0)
}

/// The true robot: masses and inertias scaled together, so that every body exists, with armature and friction.
fn truth(nominal: &Description, setting: &Setting) -> Description {
    let mut random = Random::named(setting.seed, "pipeline: truth");
    let mut robot = nominal.clone();
    for body in &mut robot.bodies {
        let scale = 1.0 + setting.wrong * unit(&mut random);
        body.mass *= scale;
        body.inertia = body.inertia.map(|entry| entry * scale);
        let mut drawn = |low: f64, high: f64| vec![random.uniform(low, high)];
        (body.joint.armature, body.joint.damping, body.joint.friction) = (drawn(0.02, 0.1), drawn(0.3, 1.0), drawn(0.5, 2.0));
    }
    robot
}

/// Springs and dampers between the joints: a residual that no description has.
fn coupling(setting: &Setting) -> Result<Linear, Failure> {
    let n = setting.joints;
    let mut random = Random::named(setting.seed, "pipeline: couplings");
    // φ = [q; v; a; 1]: nothing of a, and a constant.
    let mut theta = Vec::new();
    for _ in 0..n {
        theta.extend((0..2 * n).map(|_| setting.coupling * unit(&mut random)));
        theta.extend(vec![0.0; n]);
        theta.push(setting.coupling * unit(&mut random));
    }
    Linear::new(n, n, theta).map_err(Failure::of)
}

/// Jᵀf of the ground, and whether it is touched.
fn pushed(model: &Model<f64>, ground: &Ground, q: &[f64], v: &[f64]) -> Result<(Vec<f64>, bool), Failure> {
    let last = model.topology.joints().len() - 1;
    let kinematics = forward_kinematics(model, q, v, &vec![0.0; v.len()])?;
    let tip = kinematics.body(last).ok_or_else(|| Failure::of("the arm has no link; take one joint at least"))?;
    let depth = ground.height - tip.placement.translation.z;
    if depth <= 0.0 {
        return Ok((vec![0.0; v.len()], false));
    }
    let (force, speed) = (ground.stiffness * depth, tip.velocity.lin);
    let drag = |along: f64| -ground.friction * force * (along / ground.width).tanh();
    let (x, y) = (drag(speed.x), drag(speed.y));
    let torques = jacobian(model, q, last)?.iter().map(|column| x * column.lin.x + y * column.lin.y + force * column.lin.z).collect();
    Ok((torques, true))
}

fn motion(linear: &LinearModel, theta: &[f64], setting: &Setting, which: u64) -> Result<Motion, Failure> {
    let base = Base::of_robot(linear, 1).map_err(Failure::of)?;
    let search = Search { draws: 4, changes: 8, frequency: 0.1, harmonics: 10, seed: setting.seed ^ (which << 32), ..Search::default() };
    let found = excite(linear, &base, &search).map_err(Failure::of)?;
    let mut samples = found.trajectory.samples(linear, theta, setting.samples, 1.0).map_err(Failure::of)?;
    let residual = coupling(setting)?;
    let (mut ground, mut touching) = (Vec::new(), 0);
    for k in 0..samples.count() {
        let (q, v, a) = samples.state(linear, k);
        let (torques, touches) = pushed(linear.model(), &setting.ground, q, v)?;
        let r = residual.value(&State::new(q, v, a)).map_err(Failure::of)?;
        let at = ground.len();
        for (dof, (push, r)) in torques.iter().zip(r).enumerate() {
            samples.tau[at + dof] += r - push;
        }
        ground.extend(torques);
        touching += usize::from(touches);
    }
    let touching = touching as f64 / samples.count() as f64;
    Ok(Motion { samples, ground, touching })
}

fn norm(list: impl IntoIterator<Item = f64>) -> f64 {
    list.into_iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// The largest error of the inertial base parameters over the largest of them.
fn missed(linear: &LinearModel, base: &Base, theta: &[f64], found: &[f64]) -> f64 {
    let due = base.values(theta);
    let inertial = base.independent.iter().map(|unknown| matches!(linear.unknowns()[*unknown].kind, Kind::Inertial(_)));
    let kept: Vec<(f64, f64)> =
        due.into_iter().zip(found).zip(inertial).filter(|(_, kept)| *kept).map(|((due, found), _)| (due, *found)).collect();
    largest(kept.iter().map(|(due, found)| found - due)) / largest(kept.iter().map(|(due, _)| *due))
}

/// θ̂ and φ̂ of one least-squares problem.
struct Together {
    /// Which unknowns of the robot stand for base parameters, and their values.
    independent: Vec<usize>,
    beta: Vec<f64>,
    /// Which entries of φ̂ are fitted, and their values.
    own: Vec<usize>,
    phi: Vec<f64>,
}

impl Together {
    fn of(linear: &LinearModel, samples: &Samples, base: &Base) -> Result<Self, Failure> {
        let n = linear.dofs().len();
        let own = (0..Linear::parameters(n, n)).collect();
        let mut both = Self { independent: base.independent.clone(), beta: Vec::new(), own, phi: Vec::new() };
        let robot = both.independent.len();
        let mut columns = both.columns(linear, samples)?;
        if columns.nrows() < columns.ncols() {
            return Err(Failure::of(format!("{} equations for {} unknowns; take more samples", columns.nrows(), columns.ncols())));
        }
        // Columns of length one, so that units do not count.
        let mut lengths: Vec<f64> = columns.column_iter().map(|column| column.norm()).collect();
        columns.column_iter_mut().zip(&lengths).for_each(|(mut column, length)| column /= *length);
        // What stands on the columns before it by less than this is theirs: rounding leaves 1e-15, and the least other one here is above 1e-3.
        let pivots = columns.clone().qr().r().diagonal();
        let kept: Vec<usize> = (0..lengths.len()).filter(|k| *k < robot || pivots[*k].abs() > 1e-8).collect();
        (both.own, lengths) = (kept[robot..].iter().map(|k| k - robot).collect(), kept.iter().map(|k| lengths[*k]).collect());
        let factors = columns.select_columns(&kept).qr();
        let mut right = DVector::from_column_slice(&samples.tau);
        factors.q_tr_mul(&mut right);
        let found = factors.r().solve_upper_triangular(&right.rows(0, kept.len()).into_owned());
        let found =
            found.ok_or_else(|| Failure::of("the log does not tell the robot's parameters apart; take more samples or a richer motion"))?;
        let mut values = found.iter().zip(&lengths).map(|(x, length)| x / length);
        both.beta = values.by_ref().take(robot).collect();
        both.phi = values.collect();
        Ok(both)
    }

    /// The columns of both, a block of rows per sample.
    fn columns(&self, linear: &LinearModel, samples: &Samples) -> Result<DMatrix<f64>, Failure> {
        let (n, robot) = (linear.dofs().len(), self.independent.len());
        let mut columns = DMatrix::zeros(n * samples.count(), robot + self.own.len());
        let mut rows = Rows::new(linear);
        for k in 0..samples.count() {
            let (q, v, a) = samples.state(linear, k);
            let block = rows.at(linear, q, v, a).map_err(Failure::of)?;
            let residual = Linear::regressor(&State::new(q, v, a));
            for dof in 0..n {
                let row = n * k + dof;
                self.independent.iter().enumerate().for_each(|(column, unknown)| columns[(row, column)] = block[(dof, *unknown)]);
                self.own.iter().enumerate().for_each(|(column, entry)| columns[(row, robot + column)] = residual[(dof, *entry)]);
            }
        }
        Ok(columns)
    }

    /// The torques of samples.
    fn torques(&self, linear: &LinearModel, samples: &Samples) -> Result<Vec<f64>, Failure> {
        let values = DVector::from_iterator(self.beta.len() + self.phi.len(), self.beta.iter().chain(&self.phi).copied());
        Ok((self.columns(linear, samples)? * values).as_slice().to_vec())
    }
}

/// Builds a model in stages, and judges each on the log and on a motion that none has seen.
///
/// ```
/// use featherbench_lesson::pipeline::{Setting, run};
/// let outcome = run(&Setting::default())?;
/// assert!(outcome.held_out.windows(2).all(|pair| pair[1] < pair[0]), "{outcome:?}");
/// // Without noise and without couplings least squares finds the robot; with them it needs the residual beside it.
/// let known = run(&Setting { noise: 0.0, coupling: 0.0, ..Setting::default() })?;
/// assert!(known.held_out[2] < 1e-10);
/// let clean = run(&Setting { noise: 0.0, ..Setting::default() })?;
/// assert!(clean.held_out[3] > 1e-3 && clean.held_out[4] < 1e-10);
/// # Ok::<(), featherbench_lesson::Failure>(())
/// ```
///
/// # Errors
/// [`Failure`] when there is no arm of that size, no motion within its limits, or a setting is not finite.
pub fn run(setting: &Setting) -> Result<Outcome, Failure> {
    setting.check()?;
    let nominal = Arm::general(setting.joints, setting.seed).describe(Gravity::Parallel, setting.seed);
    let linear = LinearModel::new(&nominal, Terms::ALL).map_err(Failure::of)?;
    let theta = LinearModel::new(&truth(&nominal, setting), Terms::ALL).map_err(Failure::of)?.nominal();
    let mut log = motion(&linear, &theta, setting, 1)?;
    let unseen = motion(&linear, &theta, setting, 2)?;
    let mut random = Random::named(setting.seed, "pipeline: noise");
    let added: Vec<f64> = log.samples.tau.iter().map(|_| setting.noise * noise(&mut random)).collect();
    log.samples.tau.iter_mut().zip(&added).for_each(|(tau, added)| *tau += added);

    // Rigid body: the nominal robot alone.
    let rigid = |motion: &Motion| -> Result<Vec<f64>, Failure> {
        let mut torques = Vec::new();
        for k in 0..motion.samples.count() {
            let (q, v, a) = motion.samples.state(&linear, k);
            torques.extend(inverse_dynamics(linear.model(), q, v, a)?);
        }
        Ok(torques)
    };
    let less = |torques: &[f64], ground: &[f64]| -> Vec<f64> { torques.iter().zip(ground).map(|(tau, push)| tau - push).collect() };

    // Identification: of the log without the ground.
    let plus: Vec<f64> = log.samples.tau.iter().zip(&log.ground).map(|(tau, push)| tau + push).collect();
    let free = Samples { tau: plus, ..log.samples.clone() };
    let estimate = ordinary(&linear, &free).map_err(Failure::of)?;
    let both = Together::of(&linear, &free, &estimate.base)?;
    let parameters = [&estimate.beta[..], &both.beta].map(|found| missed(&linear, &estimate.base, &theta, found));
    let by_parameters = |motion: &Motion| linear.torques(&motion.samples, &estimate.theta).map_err(Failure::of);

    // Residual: of what identification leaves of the log.
    let told = by_parameters(&log)?;
    let left: Vec<f64> = free.tau.iter().zip(&told).map(|(tau, told)| tau - told).collect();
    let states = (0..free.count()).map(|k| {
        let (q, v, a) = free.state(&linear, k);
        (State::new(q, v, a), left[setting.joints * k..][..setting.joints].to_vec())
    });
    let (residual, rank) = Linear::fit(&states.collect::<Vec<_>>()).map_err(Failure::of)?;

    let judged = |motion: &Motion| -> Result<[f64; 5], Failure> {
        let rigid = rigid(motion)?;
        let contact = less(&rigid, &motion.ground);
        let identified = less(&by_parameters(motion)?, &motion.ground);
        let mut whole = identified.clone();
        for k in 0..motion.samples.count() {
            let (q, v, a) = motion.samples.state(&linear, k);
            let r = residual.value(&State::new(q, v, a)).map_err(Failure::of)?;
            whole[setting.joints * k..].iter_mut().zip(r).for_each(|(tau, r)| *tau += r);
        }
        let size = norm(motion.samples.tau.iter().copied());
        let together = less(&both.torques(&linear, &motion.samples)?, &motion.ground);
        Ok([rigid, contact, identified, whole, together]
            .map(|told| norm(motion.samples.tau.iter().zip(told).map(|(tau, told)| tau - told)) / size))
    };
    let noise = norm(added) / norm(log.samples.tau.iter().copied());
    let touching = [log.touching, unseen.touching];
    Ok(Outcome { logged: judged(&log)?, held_out: judged(&unseen)?, touching, identified: estimate.base.rank(), parameters, rank, noise })
}
