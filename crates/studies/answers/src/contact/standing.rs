//! Robots that land and stand: a quadruped on pads, a humanoid on its soles. Contact problems are taken from the running robot, and every
//! solver answers them.
//!
//! The robot meets the ground with all feet at once, moves sideways too, and springs in its joints hold it up. Nonsmooth
//! Gauss–Seidel steps it in time. On one pad with more rows than it has motions the sweeps may gain ever less. Then Newton's method steps it. Its
//! matrix may be singular there; then ADMM does, whose matrix has an inverse whatever the rank, or more sweeps.

use super::{Case, Number, count, error, failed, largest, told};
use featherbench_bench::{ContactSteps, NoAnswer};
use featherbench_contact::{Admm, BlockGaussSeidel, Grounded, Newton, Problem, Solver, Touch, solver};
use featherbench_dynamics::Kinematics;
use featherbench_model::{Description, Model, neutral};
use featherbench_robots::{Family, Random};
use featherbench_spatial::{Transform, Vec3};
use serde_json::json;
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::sync::{Arc, Mutex, PoisonError};

/// μ of the feet on the ground.
pub const FRICTION: f64 = 0.6;
/// The step in s, and how many are made.
const STEP: f64 = 1e-3;
const STEPS: usize = 100;
/// Every so many steps a problem is taken.
const EVERY: usize = 5;
/// The speed with which it meets the ground, m/s: that of a fall from 1 cm.
const FALL: f64 = 0.44;

/// A robot that stands on points of its feet.
#[derive(Clone, Copy)]
pub enum Stand {
    /// The quadruped: each shank ends in a level pad with so many points.
    Quadruped(usize),
    /// The humanoid on the corners of its soles.
    Humanoid,
}

/// A bent leg: parts of names, their angles in rad, and the gains of the springs and dampers in N·m/rad and N·m·s/rad.
type Stance = (&'static [(&'static str, f64)], [f64; 2]);

impl Stand {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::Humanoid, Self::Quadruped(1), Self::Quadruped(2), Self::Quadruped(4), Self::Quadruped(8), Self::Quadruped(16)];

    fn family(self) -> &'static str {
        if matches!(self, Self::Humanoid) { "humanoid" } else { "quadruped" }
    }

    /// The number of contacts.
    pub fn contacts(self) -> usize {
        match self {
            Self::Quadruped(points) => 4 * points,
            Self::Humanoid => 8,
        }
    }

    /// Its name in rows.
    pub fn name(self) -> String {
        format!("{}, {} contacts", self.family(), self.contacts())
    }

    /// The rank of J, by what the feet leave free when they are held.
    ///
    /// - Four points: the 6 of the trunk, since each leg has three joints. The 18 dofs less 6 are 12.
    /// - Pads of two points, one before the other: the trunk swings ahead on four parallel thighs, and aside on legs that turn about the line
    ///   of the pad. The rank is 16.
    /// - Pads of more points: it swings ahead alone. The rank is 17.
    /// - Two soles: 6 rows each, and the legs have six joints: 12.
    pub fn rank(self) -> usize {
        match self {
            Self::Humanoid | Self::Quadruped(1) => 12,
            Self::Quadruped(2) => 16,
            Self::Quadruped(_) => 17,
        }
    }

    fn stance(self) -> Stance {
        match self {
            Self::Quadruped(_) => (&[("thigh", 0.7), ("shank", -1.4)], [150.0, 2.0]),
            Self::Humanoid => (&[("thigh", -0.3), ("shin", 0.6), ("ankle", -0.3)], [400.0, 5.0]),
        }
    }

    /// Points of a foot from its middle, level.
    fn pad(self) -> Vec<[f64; 2]> {
        match self {
            Self::Humanoid => vec![[0.11, 0.045], [-0.11, 0.045], [-0.11, -0.045], [0.11, -0.045]],
            Self::Quadruped(1) => vec![[0.0, 0.0]],
            Self::Quadruped(points) => {
                (0..points).map(|k| TAU * k as f64 / points as f64).map(|angle| [0.02 * angle.cos(), 0.02 * angle.sin()]).collect()
            }
        }
    }

    /// The middle of a foot, by the name of its body: in the body's axes, m.
    fn foot(self, body: &str) -> Option<[f64; 3]> {
        match self {
            Self::Humanoid => body.ends_with("foot").then_some([0.03, 0.0, -0.05]),
            Self::Quadruped(_) => body.ends_with("shank").then_some([0.0, 0.0, -0.22]),
        }
    }

    /// The robot, its stance on the ground, and the points of its feet.
    pub fn make(self) -> Result<Standing, NoAnswer> {
        let description = Family::parse(self.family()).map_err(failed)?.generate().map_err(failed)?.canonical().map_err(failed)?;
        let model: Model<f64> = Model::build(&description).map_err(failed)?;
        let (angles, gains) = self.stance();
        let mut q = neutral(&model.topology);
        for (k, body) in description.bodies.iter().enumerate() {
            if let Some((_, angle)) = angles.iter().find(|(part, _)| body.name.ends_with(part)) {
                q[model.topology.joints()[model.described[k]].q] = *angle;
            }
        }
        let still = vec![0.0; model.topology.nv()];
        let mut kinematics = Kinematics::new(&model.topology);
        kinematics.run(&model, &q, &still, &still).map_err(failed)?;
        let (mut touches, mut heights) = (Vec::new(), Vec::new());
        for (k, body) in description.bodies.iter().enumerate() {
            let (Some(middle), Some(motion)) = (self.foot(&body.name), kinematics.body(model.described[k])) else { continue };
            let Transform { rotation, translation } = motion.placement;
            let middle = rotation * Vec3::from_array(middle);
            heights.push(translation.z + middle.z);
            for (number, [x, y]) in self.pad().into_iter().enumerate() {
                let point = rotation.transpose_mul(middle + Vec3::new(x, y, 0.0)).to_array();
                let name = format!("{} {number}", body.name);
                touches.push(Touch { name, body: model.described[k], point, friction: FRICTION, restitution: 0.0 });
            }
        }
        // The free base is the first body; its position is the first three numbers of q. All feet are equally high in the stance.
        q[2] = -heights.first().copied().unwrap_or_default();
        Ok(Standing { description, model, touches, stance: q, gains })
    }
}

/// A robot with its stance.
pub struct Standing {
    description: Description,
    /// The robot.
    pub model: Model<f64>,
    /// Its points that touch the ground.
    pub touches: Vec<Touch>,
    /// The configuration.
    pub stance: Vec<f64>,
    gains: [f64; 2],
}

/// A contact problem and the state from which it is that of a step.
pub struct Taken {
    /// The problem of the step.
    pub problem: Problem,
    q: Vec<f64>,
    v: Vec<f64>,
    tau: Vec<f64>,
}

impl Standing {
    /// The forces of springs and dampers in the joints.
    fn forces(&self, q: &[f64], v: &[f64]) -> Vec<f64> {
        let mut tau = vec![0.0; v.len()];
        for joint in self.model.topology.joints().iter().filter(|joint| joint.kind.nv() == 1) {
            tau[joint.v] = self.gains[0] * (self.stance[joint.q] - q[joint.q]) - self.gains[1] * v[joint.v];
        }
        tau
    }

    /// Where it meets the ground, with a sideways velocity by the seed.
    fn touch_down(&self, seed: u64) -> [Vec<f64>; 2] {
        let mut random = Random::named(seed, "standing");
        let mut v = vec![0.0; self.model.topology.nv()];
        // Base velocity [ṗ; ω] in base axes, which are level here.
        (v[0], v[1], v[2]) = (random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), -FALL);
        [self.stance.clone(), v]
    }

    /// The problem of the first step, which has all contacts.
    pub fn landing(&self, seed: u64) -> Result<Option<Taken>, NoAnswer> {
        let [q, v] = self.touch_down(seed);
        let tau = self.forces(&q, &v);
        let problem = Grounded::new(&self.model, self.touches.clone()).problem(&format!("landing {seed}"), &q, &v, &tau, STEP);
        Ok(problem.map_err(failed)?.map(|problem| Taken { problem, q, v, tau }))
    }

    /// The problems of the running robot. The first has all contacts.
    pub fn run(&self, seed: u64) -> Result<Vec<Taken>, NoAnswer> {
        let robot = Grounded::new(&self.model, self.touches.clone());
        let [mut q, mut v] = self.touch_down(seed);
        let mut problems = Vec::new();
        for number in 0..STEPS {
            let tau = self.forces(&q, &v);
            if number % EVERY == 0 {
                let problem = robot.problem(&format!("step {number}"), &q, &v, &tau, STEP).map_err(failed)?;
                problems.extend(problem.map(|problem| Taken { problem, q: q.clone(), v: v.clone(), tau: tau.clone() }));
            }
            let by = |solver: &dyn Solver| robot.step(&q, &v, &tau, STEP, solver);
            let sweeps = |sweeps| BlockGaussSeidel { sweeps, ..BlockGaussSeidel::default() };
            let stepped = by(&sweeps(2000)).or_else(|_| by(&Newton::default())).or_else(|_| by(&Admm::default()));
            let stepped = stepped.or_else(|_| by(&sweeps(1_000_000))).map_err(failed)?;
            (q, v) = (stepped.q, stepped.v);
        }
        Ok(problems)
    }

    /// The same problems as steps of the robot, for engines whose solvers take no G.
    pub fn steps(&self, taken: &[Taken]) -> Result<ContactSteps, NoAnswer> {
        let described = |touch: &Touch| self.model.described.iter().position(|body| *body == touch.body);
        let bodies: Option<Vec<usize>> = self.touches.iter().map(described).collect();
        let of = |state: fn(&Taken) -> &Vec<f64>| taken.iter().flat_map(|taken| state(taken).iter().copied()).collect();
        Ok(ContactSteps {
            robot: self.description.clone(),
            dt: STEP,
            bodies: bodies.ok_or_else(|| NoAnswer::Failed("a point is on no described body".into()))?,
            points: self.touches.iter().flat_map(|touch| touch.point).collect(),
            friction: self.touches.iter().map(|touch| touch.friction).collect(),
            count: taken.len(),
            q: of(|taken| &taken.q),
            v: of(|taken| &taken.v),
            tau: of(|taken| &taken.tau),
        })
    }
}

pub(super) fn cases() -> Vec<Case> {
    let of = |stand| {
        let runs = Arc::new(Runs { stand, taken: Mutex::default() });
        (0..solver::all().len()).map(move |which| case(stand, which, runs.clone()))
    };
    Stand::ALL.into_iter().flat_map(of).collect()
}

/// The problems of a run, or why there are none.
type Run = Result<Arc<[Taken]>, NoAnswer>;

/// The problems of a robot's runs, by seed. All solvers are asked for the same.
struct Runs {
    stand: Stand,
    taken: Mutex<BTreeMap<u64, Run>>,
}

impl Runs {
    fn of(&self, seed: u64) -> Run {
        let mut taken = self.taken.lock().unwrap_or_else(PoisonError::into_inner);
        taken.entry(seed).or_insert_with(|| Ok(self.stand.make()?.run(seed)?.into())).clone()
    }
}

/// The problems of a run by one solver: how many it answers, and the worst residual and the iterations of its answers.
fn case(stand: Stand, which: usize, runs: Arc<Runs>) -> Case {
    let name = solver::all()[which].name();
    let direct = name == "newton";
    let first_order = ["gauss_seidel", "block_gauss_seidel", "admm"].contains(&name);
    let residual = match (direct, first_order) {
        (true, _) => error("residual", "laws"),
        (_, true) => error("first_order_residual", "laws"),
        _ => Number { reference: "laws", ..told("residual", "1") },
    };
    Case {
        name: stand.name(),
        quantity: "standing",
        method: name.into(),
        params: json!({"step": STEP, "steps": STEPS, "every": EVERY, "friction": FRICTION, "fall": FALL}),
        numbers: vec![
            count("rank", stand.rank() as f64, "theory"),
            told("problems", "1"),
            if direct && stand.contacts() <= 16 { count("unanswered", 0.0, "theory") } else { told("unanswered", "1") },
            told("iterations", "1"),
            residual,
        ],
        evaluate: Box::new(move |seed| {
            let solver = &solver::all()[which];
            let problems = runs.of(seed)?;
            let all = problems.first().map(|taken| &taken.problem).filter(|problem| problem.contacts().len() == stand.contacts());
            let Some(mechanism) = all.and_then(|problem| problem.mechanism()) else {
                return Err(NoAnswer::Failed("the robot does not meet the ground with all its feet".into()));
            };
            let rank = mechanism.jacobian.rank(1e-8);
            let (mut unanswered, mut iterations, mut residual) = (0, 0, 0.0);
            for problem in problems.iter().map(|taken| &taken.problem) {
                let solution = solver.solve(problem).map_err(|unsupported| NoAnswer::NotOffered(unsupported.to_string()))?;
                match solution.point() {
                    Some(point) => residual = largest([residual, point.residuals.largest()]),
                    None => unanswered += 1,
                }
                if solution.iterations > iterations {
                    iterations = solution.iterations;
                }
            }
            Ok(vec![rank as f64, problems.len() as f64, f64::from(unanswered), iterations as f64, residual])
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every step of a run has an answer, whatever the seed.
    #[test]
    fn runs_do_not_depend_on_the_seed() {
        for seed in (8..=47).step_by(crate::share::one_of(20)) {
            for stand in Stand::ALL {
                let problems = stand.make().unwrap().run(seed).unwrap_or_else(|error| panic!("{}, seed {seed}: {error}", stand.name()));
                assert_eq!(problems[0].problem.contacts().len(), stand.contacts());
            }
        }
    }
}
