//! Replays: our kernels on an import result, and the distance of two import results of one robot in inverse dynamics and mass matrix.

use super::comparison::shared_coordinates;
use featherbench_bench::Robot;
use featherbench_bench::measure::{Magnitudes, ratio, worst};
use featherbench_dynamics::{PackedCrba, PackedModel, PackedRnea, TreeSparse};
use featherbench_model::{Description, JointKind, Malformed, Model};
use featherbench_results::ModelOrigin;
use featherbench_robots::StateBatch;

/// Inverse dynamics and mass matrix, state after state.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Answers {
    pub id: Vec<f64>,
    pub mass_matrix: Vec<f64>,
}

/// The distance of an import result from another in its answers: the worst state, in the measures of the agreement study.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effect {
    /// Inverse dynamics.
    pub id: f64,
    /// Mass matrix.
    pub mass_matrix: f64,
}

/// Our kernels on a robot at its states. `None` if the model does not have the states' shape.
pub(super) fn answers(model: &Model<f64>, states: &StateBatch) -> Option<Answers> {
    let packed = PackedModel::new(model);
    let (mut rnea, mut crba) = (PackedRnea::new(&packed), PackedCrba::new(&packed));
    let mut matrix = TreeSparse::new(&model.topology);
    let nv = states.nv;
    let mut answers = Answers { id: vec![0.0; states.count() * nv], mass_matrix: Vec::with_capacity(states.count() * nv * nv) };
    for (k, tau) in answers.id.chunks_exact_mut(nv).enumerate() {
        rnea.run(&packed, states.q(k), states.v(k), states.a(k), None, tau).ok()?;
        crba.run(&packed, states.q(k), &mut matrix).ok()?;
        answers.mass_matrix.extend(matrix.to_dense().iter());
    }
    Some(answers)
}

/// The same states for another import result of the robot: the joints that both have move alike, the others are at rest in their neutral
/// position.
pub(super) fn carried(ours: &Description, states: &StateBatch, theirs: &Description, model: &Model<f64>) -> StateBatch {
    let shared = shared_coordinates(ours, theirs);
    let (count, nq, nv, bodies) = (states.count(), model.topology.nq(), model.topology.nv(), model.described.len());
    let neutral: Vec<f64> = neutral(model);
    let mut batch = StateBatch { nq, nv, bodies, cases: states.cases.clone(), ..StateBatch::default() };
    let copy = |from: &[f64], to: &mut [f64], places: &[[usize; 3]]| {
        for &[a, b, n] in places {
            to[b..b + n].copy_from_slice(&from[a..a + n]);
        }
    };
    for k in 0..count {
        let mut q = neutral.clone();
        copy(states.q(k), &mut q, &shared.coordinates);
        batch.q.extend(q);
        for (from, to) in [(states.v(k), &mut batch.v), (states.a(k), &mut batch.a), (states.tau(k), &mut batch.tau)] {
            let mut x = vec![0.0; nv];
            copy(from, &mut x, &shared.dofs);
            to.extend(x);
        }
    }
    batch.wrench = vec![0.0; count * 6 * bodies];
    batch
}

fn neutral(model: &Model<f64>) -> Vec<f64> {
    let of_joint = |kind: JointKind| match kind {
        JointKind::Spherical => vec![0.0, 0.0, 0.0, 1.0],
        JointKind::Free => vec![0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
        JointKind::Revolute(_) | JointKind::Prismatic(_) | JointKind::Helical => vec![0.0],
    };
    model.topology.joints().iter().flat_map(|joint| of_joint(joint.kind)).collect()
}

/// The magnitudes for errors at a state: those of the agreement study, with a smallest size.
///
/// An engine has a file's robot in its own frames. Some numbers are exactly zero in ours: a torque about an axis through the centre of
/// mass, or the inertia of a body without any. In theirs they are differences of larger numbers. So torques and inertias of a dof count at
/// least as a thousandth of the robot's largest: torques in the kinetic-energy norm, inertias by what the dof carries.
struct Sizes {
    torque: Vec<f64>,
    inertia: Vec<f64>,
}

/// The smallest size, as a fraction of the largest: three of the nine decades between rounding and an edit by a parser.
const LEAST: f64 = 1e-3;

impl Sizes {
    fn new(at: &Magnitudes, mass: &[f64]) -> Self {
        let nv = at.joint_force.len();
        let largest = |list: &mut dyn Iterator<Item = f64>| list.filter(|x| x.is_finite()).fold(0.0, worst);
        let diagonal: Vec<f64> = (0..nv).map(|i| mass[i * nv + i].abs().sqrt()).collect();
        let heaviest = largest(&mut diagonal.iter().copied());
        let least = diagonal.iter().zip(&at.least_root).map(|(root, least)| worst(*root, *least));
        let inertia: Vec<f64> = least.map(|root| if root > 0.0 { root } else { LEAST * heaviest }).collect();
        let strongest = largest(&mut at.joint_force.iter().zip(&inertia).map(|(force, root)| force / root));
        let torque = at.joint_force.iter().zip(&inertia).map(|(&force, root)| force.max(LEAST * strongest * root)).collect();
        Self { torque, inertia }
    }

    fn torque(&self, i: usize, difference: f64) -> f64 {
        // If no force acts in ours (no gravity, at rest), any force in theirs is a complete difference.
        if self.torque[i] == 0.0 && difference.is_finite() && difference != 0.0 { 1.0 } else { ratio(difference, self.torque[i]) }
    }

    fn entry(&self, i: usize, j: usize, difference: f64) -> f64 {
        ratio(difference, self.inertia[i] * self.inertia[j])
    }
}

/// A robot with its answers, with which other import results of it are compared.
pub(super) struct Reference {
    robot: Robot,
    at: Vec<Magnitudes>,
    answers: Answers,
}

impl Reference {
    /// Our robot at these states.
    pub fn new(description: &Description, states: StateBatch) -> Option<Self> {
        let robot = bare(description).ok()?.at(states);
        let answers = answers(&robot.model, &robot.states)?;
        Some(Self { at: robot.magnitudes(), robot, answers })
    }

    /// The distance of the answers about another import result from ours, on the dofs that both have. The states were carried over to it.
    pub fn effect(&self, theirs: &Description, nv: usize, answers: &Answers) -> Effect {
        let shared = shared_coordinates(&self.robot.description, theirs).dofs;
        let dofs: Vec<(usize, usize)> = shared.iter().flat_map(|&[a, b, n]| (0..n).map(move |k| (a + k, b + k))).collect();
        let own = self.robot.states.nv;
        let mut worst_of = Effect { id: 0.0, mass_matrix: 0.0 };
        for (k, at) in self.at.iter().enumerate() {
            let (id, mass) = (&self.answers.id[k * own..(k + 1) * own], &self.answers.mass_matrix[k * own * own..(k + 1) * own * own]);
            let (their_id, their_mass) = (&answers.id[k * nv..(k + 1) * nv], &answers.mass_matrix[k * nv * nv..(k + 1) * nv * nv]);
            // Numbers that only one of them has are not compared: ours is used on both sides.
            let (mut id_here, mut mass_here) = (id.to_vec(), mass.to_vec());
            for &(i, j) in &dofs {
                id_here[i] = their_id[j];
                for &(m, n) in &dofs {
                    mass_here[i * own + m] = their_mass[j * nv + n];
                }
            }
            let sizes = Sizes::new(at, mass);
            for i in 0..own {
                worst_of.id = worst(worst_of.id, sizes.torque(i, id_here[i] - id[i]));
                for j in 0..own {
                    worst_of.mass_matrix = worst(worst_of.mass_matrix, sizes.entry(i, j, mass_here[i * own + j] - mass[i * own + j]));
                }
            }
        }
        worst_of
    }

    /// The distance of another import result from ours, if our own kernels answer for both.
    pub fn effect_of(&self, theirs: &Description) -> Option<Effect> {
        let model = Model::<f64>::build(theirs).ok()?;
        let states = carried(&self.robot.description, &self.robot.states, theirs, &model);
        Some(self.effect(theirs, states.nv, &answers(&model, &states)?))
    }
}

/// A robot without states of its own.
fn bare(description: &Description) -> Result<Robot, Malformed> {
    Robot::new(description, "import", ModelOrigin::Robot, 0, 0)
}

/// The errors of our kernels on their import result, against their engine's own answers. It has the worst error of each quantity. For the
/// worst state it also has the error per dof, and per pair of dofs for the mass matrix.
pub(super) struct Replay {
    pub effect: Effect,
    /// Per dof, the error of its torque.
    pub torque: Vec<f64>,
    /// Per pair of dofs, the error of the entry of the mass matrix; row-major.
    pub entry: Vec<f64>,
}

/// Replays their answers.
pub(super) fn replay(robot: &Robot, engine: &Answers) -> Option<Replay> {
    let ours = answers(&robot.model, &robot.states)?;
    let nv = robot.states.nv;
    if engine.id.len() != ours.id.len() || engine.mass_matrix.len() != ours.mass_matrix.len() {
        return None;
    }
    let (mut torque, mut entry) = (vec![0.0; nv], vec![0.0; nv * nv]);
    for (k, at) in robot.magnitudes().iter().enumerate() {
        let here = k * nv * nv..(k + 1) * nv * nv;
        let (mass, their_mass) = (&ours.mass_matrix[here.clone()], &engine.mass_matrix[here]);
        let sizes = Sizes::new(at, mass);
        for i in 0..nv {
            torque[i] = worst(torque[i], sizes.torque(i, engine.id[k * nv + i] - ours.id[k * nv + i]));
            for j in 0..nv {
                entry[i * nv + j] = worst(entry[i * nv + j], sizes.entry(i, j, their_mass[i * nv + j] - mass[i * nv + j]));
            }
        }
    }
    let largest = |list: &[f64]| list.iter().copied().fold(0.0, worst);
    Some(Replay { effect: Effect { id: largest(&torque), mass_matrix: largest(&entry) }, torque, entry })
}
