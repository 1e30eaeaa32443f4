//! Changes of a description that leave the robot the same, and the answers about the changed robot in terms of the first one.
//!
//! | change | the description | rounds |
//! |---|---|---|
//! | `names` | other names of bodies and joints | nothing |
//! | `order` | children in the opposite order | nothing |
//! | `units` | lengths in units of 2⁻¹⁰ m | nothing: each number is multiplied by a power of two |
//! | `mirror` | all of it in a mirror across x = 0 | nothing: signs change |
//! | `frames` | each body's frame is turned about its joint, and moved along it | every number of the description |

use featherbench_model::{BodyDescription, Description, JointType, Placement};
use featherbench_robots::StateBatch;
use featherbench_spatial::{Quaternion, Sym3, Transform, Vec3};

/// The changes by name, in the order of pages.
pub(super) const CHANGES: [&str; 5] = ["names", "order", "units", "mirror", "frames"];

/// A unit of length of `units`, as a number of those units in a metre.
const UNIT: f64 = 1024.0;

/// The robot as changed.
pub(super) struct Changed {
    pub description: Description,
    /// For each body of ours, its place among the changed ones.
    place: Vec<usize>,
    change: &'static str,
}

/// The change of a robot. `None` if it has a joint for which this module does not say what the coordinates become.
pub(super) fn changed(robot: &Description, change: &str) -> Option<Changed> {
    let known = |body: &BodyDescription| {
        matches!(
            body.joint.kind,
            JointType::Revolute { .. } | JointType::Prismatic { .. } | JointType::Helical { .. } | JointType::Spherical | JointType::Free
        )
    };
    let change = CHANGES.into_iter().find(|&name| name == change)?;
    if !robot.bodies.iter().all(known) || !robot.loops.is_empty() || !robot.residuals.is_empty() {
        return None;
    }
    let mut description = Description { frames: Vec::new(), ..robot.clone() };
    let mut place: Vec<usize> = (0..robot.bodies.len()).collect();
    match change {
        "names" => named(&mut description),
        "order" => place = reversed(&mut description),
        "units" => scaled(&mut description),
        "mirror" => mirrored(&mut description),
        _ => moved(&mut description),
    }
    Some(Changed { description, place, change })
}

/// Names in the opposite order of the alphabet, which no sorting keeps.
fn named(robot: &mut Description) {
    let count = robot.bodies.len();
    for (k, body) in robot.bodies.iter_mut().enumerate() {
        body.name = format!("z{:06}", count - k);
        body.joint.name = format!("y{:06}", count - k);
    }
}

/// Depth-first with the children of each body in the opposite order; the new place of each body.
fn reversed(robot: &mut Description) -> Vec<usize> {
    let mut below: Vec<Vec<usize>> = vec![Vec::new(); robot.bodies.len() + 1];
    for (k, body) in robot.bodies.iter().enumerate() {
        below[body.parent.map_or(0, |parent| parent + 1)].push(k);
    }
    let (mut order, mut ahead) = (Vec::new(), below[0].clone());
    while let Some(k) = ahead.pop() {
        order.push(k);
        ahead.extend(&below[k + 1]);
    }
    let mut place = vec![0; order.len()];
    order.iter().enumerate().for_each(|(new, &old)| place[old] = new);
    let bodies = order.iter().map(|&old| {
        let body = &robot.bodies[old];
        BodyDescription { parent: body.parent.map(|parent| place[parent]), ..body.clone() }
    });
    robot.bodies = bodies.collect();
    place
}

fn scaled(robot: &mut Description) {
    let length = |list: &mut [f64]| list.iter_mut().for_each(|x| *x *= UNIT);
    length(&mut robot.gravity);
    for body in &mut robot.bodies {
        length(&mut body.joint.placement.translation);
        length(&mut body.com);
        body.inertia.iter_mut().for_each(|x| *x *= UNIT * UNIT);
        if let JointType::Helical { pitch, .. } = &mut body.joint.kind {
            *pitch *= UNIT;
        }
        let turns = turning(body.joint.kind);
        body.joint.armature.iter_mut().zip(turns).for_each(|(x, turns)| *x *= if turns { UNIT * UNIT } else { 1.0 });
    }
}

fn mirrored(robot: &mut Description) {
    robot.gravity[0] *= -1.0;
    for body in &mut robot.bodies {
        body.joint.placement.translation[0] *= -1.0;
        body.com[0] *= -1.0;
        // x with y, and x with z.
        for k in [1, 2] {
            body.inertia[k] *= -1.0;
        }
        for k in [1, 2, 3, 6] {
            body.joint.placement.rotation[k] *= -1.0;
        }
        match &mut body.joint.kind {
            // An axis of rotation is a pseudovector, and keeps its part across the mirror.
            JointType::Revolute { axis } => *axis = [axis[0], -axis[1], -axis[2]],
            JointType::Helical { axis, pitch } => (*axis, *pitch) = ([axis[0], -axis[1], -axis[2]], -*pitch),
            JointType::Prismatic { axis } => axis[0] *= -1.0,
            _ => {}
        }
    }
}

/// A frame of a body that has another angle and place for each body, and keeps the meaning of its joint's coordinates.
fn gauge(k: usize, kind: JointType) -> Transform<f64> {
    let angle = 0.7 + 0.31 * k as f64;
    let turn = |axis: [f64; 3], angle: f64| Quaternion::exp(Vec3::from_array(axis) * angle).to_rotation();
    match kind {
        JointType::Revolute { axis } | JointType::Helical { axis, .. } => {
            Transform::new(turn(axis, angle), Vec3::from_array(axis) * (0.1 + 0.01 * k as f64))
        }
        JointType::Prismatic { .. } => Transform::new(turn([0.6, 0.0, 0.8], angle), Vec3::from_array([0.1, -0.2, 0.05 * k as f64])),
        _ => Transform::identity(),
    }
}

fn moved(robot: &mut Description) {
    let gauges: Vec<Transform<f64>> = robot.bodies.iter().enumerate().map(|(k, body)| gauge(k, body.joint.kind)).collect();
    for (k, body) in robot.bodies.iter_mut().enumerate() {
        let (own, back) = (gauges[k], gauges[k].inverse());
        let above = body.parent.map_or(Transform::identity(), |parent| gauges[parent].inverse());
        body.joint.placement = Placement::from_transform(&above.compose(&body.joint.placement.to_transform()).compose(&own));
        body.com = back.point(Vec3::from_array(body.com)).to_array();
        body.inertia = Sym3::from_array(body.inertia).rotate(back.rotation).to_array();
        if let JointType::Revolute { axis } | JointType::Prismatic { axis } | JointType::Helical { axis, .. } = &mut body.joint.kind {
            *axis = (back.rotation * Vec3::from_array(*axis)).to_array();
        }
    }
}

/// Of each degree of freedom, whether it turns.
fn turning(kind: JointType) -> Vec<bool> {
    match kind {
        JointType::Prismatic { .. } => vec![false],
        JointType::Spherical => vec![true; 3],
        JointType::Free => vec![false, false, false, true, true, true],
        _ => vec![true],
    }
}

/// Of each degree of freedom, the sign that its velocity has in the mirror.
fn signs(kind: JointType) -> Vec<f64> {
    match kind {
        JointType::Spherical => vec![1.0, -1.0, -1.0],
        JointType::Free => vec![-1.0, 1.0, 1.0, 1.0, -1.0, -1.0],
        _ => vec![1.0],
    }
}

impl Changed {
    /// Our states, for the changed robot.
    pub fn states(&self, ours: &Description, states: &StateBatch) -> StateBatch {
        let mut batch = states.clone();
        let (count, nq, nv) = (states.count(), states.nq, states.nv);
        for (kind, from, to) in self.blocks(ours, JointType::nq) {
            let factors = self.coordinates(kind);
            for state in 0..count {
                for (i, factor) in factors.iter().enumerate() {
                    batch.q[state * nq + to + i] = factor * states.q[state * nq + from + i];
                }
            }
        }
        for (kind, from, to) in self.blocks(ours, JointType::nv) {
            let (velocities, forces) = (self.velocities(kind), self.forces(kind));
            for state in 0..count {
                for i in 0..kind.nv() {
                    let (old, new) = (state * nv + from + i, state * nv + to + i);
                    batch.v[new] = velocities[i] * states.v[old];
                    batch.a[new] = velocities[i] * states.a[old];
                    batch.tau[new] = forces[i] * states.tau[old];
                }
            }
        }
        batch.wrench.iter_mut().for_each(|x| *x = 0.0);
        batch
    }

    /// Answers about the changed robot, in our order, units and signs: forces of joints, or accelerations.
    pub fn back(&self, ours: &Description, theirs: &[f64], forces: bool) -> Vec<f64> {
        let nv: usize = ours.bodies.iter().map(|body| body.joint.kind.nv()).sum();
        let mut back = vec![0.0; theirs.len()];
        for (kind, from, to) in self.blocks(ours, JointType::nv) {
            let factors = if forces { self.forces(kind) } else { self.velocities(kind) };
            for (back, theirs) in back.chunks_exact_mut(nv).zip(theirs.chunks_exact(nv)) {
                for (i, factor) in factors.iter().enumerate() {
                    back[from + i] = theirs[to + i] / factor;
                }
            }
        }
        back
    }

    /// Each kind of joint with the beginning of its numbers in ours, and in the changed robot's.
    fn blocks(&self, ours: &Description, size: fn(JointType) -> usize) -> Vec<(JointType, usize, usize)> {
        let starts = |robot: &Description| -> Vec<usize> {
            let sizes = robot.bodies.iter().map(|body| size(body.joint.kind));
            sizes.scan(0, |next, size| Some(std::mem::replace(next, *next + size))).collect()
        };
        let (from, to) = (starts(ours), starts(&self.description));
        ours.bodies.iter().enumerate().map(|(k, body)| (body.joint.kind, from[k], to[self.place[k]])).collect()
    }

    /// The factor of each position of a joint.
    fn coordinates(&self, kind: JointType) -> Vec<f64> {
        let mirror = self.change == "mirror";
        let unit = if self.change == "units" { UNIT } else { 1.0 };
        let turn = if mirror { [1.0, -1.0, -1.0, 1.0] } else { [1.0; 4] };
        match kind {
            JointType::Free => [unit * if mirror { -1.0 } else { 1.0 }, unit, unit].into_iter().chain(turn).collect(),
            JointType::Spherical => turn.to_vec(),
            JointType::Prismatic { .. } => vec![unit],
            _ => vec![1.0],
        }
    }

    /// The factor of each velocity and acceleration of a joint.
    fn velocities(&self, kind: JointType) -> Vec<f64> {
        match self.change {
            "mirror" => signs(kind),
            "units" => turning(kind).into_iter().map(|turns| if turns { 1.0 } else { UNIT }).collect(),
            _ => vec![1.0; kind.nv()],
        }
    }

    /// The factor of each force of a joint.
    fn forces(&self, kind: JointType) -> Vec<f64> {
        match self.change {
            "mirror" => signs(kind),
            "units" => turning(kind).into_iter().map(|turns| if turns { UNIT * UNIT } else { UNIT }).collect(),
            _ => vec![1.0; kind.nv()],
        }
    }
}
