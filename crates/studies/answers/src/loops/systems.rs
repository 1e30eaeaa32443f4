//! The robots of the study: descriptions with loops, states on them, motions, and what is known.

use featherbench_bench::{LoopDrive, LoopSpring, LoopStates, LoopSteps, NoAnswer};
use featherbench_constrained::stabilise::Projection;
use featherbench_constrained::systems::{Biped, Bricard, Ladder, Pair, Squeezer, Tie};
use featherbench_constrained::{Mechanism, accelerations};
use featherbench_model::{Description, integrate, neutral};
use featherbench_robots::Random;
use featherbench_spatial::{Sym3, Vec3};
use featherbench_study::known::{failed, largest};

/// States of each robot.
const STATES: usize = 20;
/// How near the flat parallelogram is asked about: angles of 10^−1 to 10^−8 rad beside it.
pub(super) const NEAR: std::ops::RangeInclusive<i32> = 1..=8;
/// An inertia about a rod's own axis, of that about the others. A rod of the crate has none, and MuJoCo takes no such body.
const THICK: f64 = 0.01;

/// A robot with loops.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum System {
    /// N parallelograms in a row.
    Windows(usize),
    Bricard,
    Squeezer,
    Biped,
    /// Two pendulums that are tied by another kind of loop than a hinge.
    Pair(Tie),
}

/// A motion that is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plan {
    pub system: System,
    pub name: &'static str,
    /// Angle and rate of the cranks at the beginning, of a row of parallelograms, or of the first pendulum.
    pub start: (f64, f64),
    pub seconds: f64,
    /// The lengths of steps, s.
    pub steps: &'static [f64],
}

/// All motions. A02 begins upright with 1 m/s at the cranks' ends. Its cranks are horizontal several times in 10 s, and flat is singular.
pub(super) const PLANS: [Plan; 12] = [
    Plan { system: System::Windows(1), name: "four-bar", start: (0.7, 0.0), seconds: 2.0, steps: &[0.02, 0.01, 0.005, 0.0025] },
    Plan { system: System::Windows(1), name: "four-bar, singular", start: (3.0, 1.0), seconds: 3.0, steps: &[0.01, 0.005, 0.0025] },
    Plan { system: System::Bricard, name: "A04", start: (0.0, 0.0), seconds: 10.0, steps: &[0.02, 0.01, 0.005] },
    Plan { system: System::Biped, name: "biped", start: (0.0, 0.0), seconds: 0.5, steps: &[0.01, 0.005, 0.0025] },
    // The time and the start of the test set for IVP solvers.
    Plan { system: System::Squeezer, name: "Andrews' squeezer", start: (0.0, 0.0), seconds: 0.03, steps: &[6e-5, 3e-5, 1.5e-5] },
    Plan { system: System::Pair(Tie::Gear), name: "geared pendulums", start: (0.7, 0.0), seconds: 2.0, steps: &[0.01, 0.005, 0.0025] },
    Plan { system: System::Pair(Tie::Rod), name: "pendulums and a rod", start: (0.7, 0.0), seconds: 2.0, steps: &[0.01, 0.005, 0.0025] },
    Plan { system: System::Windows(1), name: "A02, N = 1", ..UPRIGHT },
    Plan { system: System::Windows(5), name: "A02, N = 5", ..UPRIGHT },
    Plan { system: System::Windows(10), name: "A02, N = 10", ..UPRIGHT },
    Plan { system: System::Windows(20), name: "A02, N = 20", ..UPRIGHT },
    Plan { system: System::Windows(40), name: "A02, N = 40", ..UPRIGHT },
];

const UPRIGHT: Plan = Plan { system: System::Windows(1), name: "", start: (std::f64::consts::PI, 1.0), seconds: 10.0, steps: &[0.01] };

/// The robots whose accelerations are asked for.
pub(super) const ACCELERATED: [System; 10] = [
    System::Windows(1),
    System::Windows(5),
    System::Windows(40),
    System::Bricard,
    System::Squeezer,
    System::Biped,
    System::Pair(Tie::Gear),
    System::Pair(Tie::Cam),
    System::Pair(Tie::Rod),
    System::Pair(Tie::Weld),
];

impl Plan {
    /// The steps of one length; the state is told a hundred times or after every step.
    pub fn of(&self, dt: f64) -> LoopSteps {
        let steps = (self.seconds / dt).round() as usize;
        let every = (steps / 50).max(1);
        LoopSteps { dt, steps: steps / every * every, every }
    }

    /// The state at the beginning.
    pub fn begin(&self, mechanism: &Mechanism, seed: u64) -> Result<(Vec<f64>, Vec<f64>), NoAnswer> {
        match self.system {
            System::Windows(windows) => {
                let ladder = ladder(windows);
                Ok((ladder.spread(self.start.0), ladder.spread(self.start.1)))
            }
            System::Pair(tie) => {
                let ((angle, rate), pair) = (self.start, Pair::new(tie));
                Ok((pair.configuration(angle).to_vec(), pair.velocity(angle, rate).to_vec()))
            }
            System::Bricard => Ok((vec![0.0; 5], vec![0.0; 5])),
            System::Squeezer => Ok((Squeezer::start().to_vec(), vec![0.0; 7])),
            // At rest all its bodies would fall alike.
            System::Biped => {
                let mut random = Random::named(seed, self.name);
                let q = neutral(&mechanism.model.topology);
                let mut v: Vec<f64> = (0..mechanism.model.topology.nv()).map(|_| random.uniform(-2.0, 2.0)).collect();
                closing().velocity(&mechanism.model, &mechanism.constraints, &q, &mut v).map_err(failed)?;
                Ok((q, v))
            }
        }
    }
}

fn ladder(windows: usize) -> Ladder {
    Ladder { windows, ..Ladder::default() }
}

fn closing() -> Projection {
    Projection { tolerance: 1e-14, ..Projection::default() }
}

impl System {
    pub fn name(self) -> String {
        match self {
            Self::Windows(1) => "four-bar".into(),
            Self::Windows(windows) => format!("four-bar, {windows} windows"),
            Self::Bricard => "Bricard".into(),
            Self::Squeezer => "Andrews' squeezer".into(),
            Self::Biped => "biped".into(),
            Self::Pair(Tie::Gear) => "pendulums, gear".into(),
            Self::Pair(Tie::Cam) => "pendulums, cam".into(),
            Self::Pair(Tie::Rod) => "pendulums, rod".into(),
            Self::Pair(Tie::Weld) => "pendulums, weld".into(),
        }
    }

    /// The cranks' row, if it is one.
    pub fn ladder(self) -> Option<Ladder> {
        if let Self::Windows(windows) = self { Some(ladder(windows)) } else { None }
    }

    /// The robot that every engine gets, ours too.
    pub fn description(self) -> Result<Description, NoAnswer> {
        let mut description = match self {
            Self::Windows(windows) => ladder(windows).description(),
            Self::Bricard => Bricard::default().description(),
            Self::Squeezer => Squeezer::default().description(),
            Self::Biped => Biped::default().description(),
            Self::Pair(tie) => Pair::new(tie).description(),
        };
        for body in &mut description.bodies {
            let along = Vec3::from_array(body.com);
            let square = along.dot(along);
            let inertia = Sym3::from_array(body.inertia).to_mat3();
            let [xx, .., yy, _, zz] = body.inertia;
            if square == 0.0 || along.dot(inertia * along) > 1e-12 * square * (xx + yy + zz) {
                continue;
            }
            // δ u uᵀ: in a plane through the axis it has no effect.
            let share = THICK * 0.5 * (xx + yy + zz) / square;
            let [x, y, z] = body.com;
            for (entry, product) in body.inertia.iter_mut().zip([x * x, x * y, x * z, y * y, y * z, z * z]) {
                *entry += share * product;
            }
        }
        description.canonical().map_err(failed)
    }

    /// What drives its motion beside gravity.
    pub fn drive(self) -> Option<LoopDrive> {
        if self != Self::Squeezer {
            return None;
        }
        let squeezer = Squeezer::default();
        let [moved, fixed] = squeezer.spring_ends();
        let spring = LoopSpring { bodies: [Some(2), None], points: [moved, fixed], stiffness: squeezer.stiffness, length: squeezer.spring };
        let mut tau = vec![0.0; 7];
        tau[0] = squeezer.torque;
        Some(LoopDrive { tau, springs: vec![spring] })
    }

    pub fn mechanism(self) -> Result<Mechanism, NoAnswer> {
        Mechanism::of(&self.description()?).map_err(failed)
    }

    /// States on the loops, with the driving forces of the squeezer.
    pub fn states(self, mechanism: &Mechanism, seed: u64) -> Result<LoopStates, NoAnswer> {
        let topology = &mechanism.model.topology;
        let mut random = Random::named(seed, &self.name());
        let near = match self {
            Self::Squeezer => Squeezer::start().to_vec(),
            _ => neutral(topology),
        };
        let mut states = LoopStates { count: STATES, ..LoopStates::default() };
        for _ in 0..STATES {
            let mut tau = vec![0.0; topology.nv()];
            let (q, v) = if let Some(ladder) = self.ladder() {
                (ladder.spread(random.uniform(-1.2, 1.2)), ladder.spread(random.uniform(-2.0, 2.0)))
            } else if let Self::Pair(tie) = self {
                let (angle, rate, pair) = (random.uniform(-1.0, 1.0), random.uniform(-2.0, 2.0), Pair::new(tie));
                (pair.configuration(angle).to_vec(), pair.velocity(angle, rate).to_vec())
            } else {
                let mut draw = || (0..topology.nv()).map(|_| random.uniform(-0.2, 0.2)).collect::<Vec<f64>>();
                let mut q = integrate(topology, &near, &draw()).map_err(failed)?;
                let mut v = draw();
                closing().configuration(&mechanism.model, &mechanism.constraints, &mut q).map_err(failed)?;
                closing().velocity(&mechanism.model, &mechanism.constraints, &q, &mut v).map_err(failed)?;
                (q, v)
            };
            if self == Self::Squeezer {
                Squeezer::default().add_forces(&q, &mut tau);
            }
            states.q.extend(q);
            states.v.extend(v);
            states.tau.extend(tau);
        }
        Ok(states)
    }

    /// States that come near the flat parallelogram.
    pub fn nearby() -> LoopStates {
        let ladder = ladder(1);
        let mut states = LoopStates { count: NEAR.count(), ..LoopStates::default() };
        for power in NEAR {
            states.q.extend(ladder.spread(std::f64::consts::FRAC_PI_2 - 10.0_f64.powi(-power)));
            states.v.extend(ladder.spread(1.0));
            states.tau.extend([0.0; 3]);
        }
        states
    }

    /// The accelerations of states: the closed form where there is one, else double-double arithmetic.
    pub fn due(self, mechanism: &Mechanism, states: &LoopStates) -> Result<Vec<f64>, NoAnswer> {
        let (nq, nv) = (states.q.len() / states.count, states.v.len() / states.count);
        let mut due = Vec::with_capacity(states.v.len());
        for k in 0..states.count {
            let (q, v, tau) = (&states.q[k * nq..][..nq], &states.v[k * nv..][..nv], &states.tau[k * nv..][..nv]);
            match (self, self.ladder()) {
                (_, Some(ladder)) => due.extend(ladder.spread(ladder.acceleration(q[0]))),
                (Self::Pair(tie), _) => due.extend(Pair::new(tie).acceleration(q[0], v[0])),
                _ => due.extend(accelerations(&mechanism.model, &mechanism.constraints, q, v, tau).map_err(failed)?),
            }
        }
        Ok(due)
    }
}

/// |a − a*| of each state over |a*| + |v|², the size of the centripetal terms. NaN stays.
pub(super) fn errors(states: &LoopStates, found: &[f64], due: &[f64]) -> Vec<f64> {
    let nv = states.v.len() / states.count;
    let state = |((v, found), due): ((&[f64], &[f64]), &[f64])| {
        let rate = largest(v.iter().copied());
        largest(found.iter().zip(due).map(|(a, b)| a - b)) / (largest(due.iter().copied()) + rate * rate)
    };
    states.v.chunks_exact(nv).zip(found.chunks_exact(nv)).zip(due.chunks_exact(nv)).map(state).collect()
}

/// Angle and rate of a row's cranks after steps of Runge and Kutta's method of order four, of the closed form alone.
pub(super) fn scalar(ladder: &Ladder, (mut q, mut v): (f64, f64), dt: f64, steps: usize) -> (f64, f64) {
    let a = |q: f64| ladder.acceleration(q);
    for _ in 0..steps {
        let (q1, v1) = (v, a(q));
        let (q2, v2) = (v + 0.5 * dt * v1, a(q + 0.5 * dt * q1));
        let (q3, v3) = (v + 0.5 * dt * v2, a(q + 0.5 * dt * q2));
        let (q4, v4) = (v + dt * v3, a(q + dt * q3));
        q += dt / 6.0 * (q1 + 2.0 * q2 + 2.0 * q3 + q4);
        v += dt / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4);
    }
    (q, v)
}
