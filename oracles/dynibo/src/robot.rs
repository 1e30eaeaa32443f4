//! A robot in dynibo, its states, and the calls that are timed.

use crate::coordinates::{self, Floating, Order};
use crate::urdf;
use dynibo::{FloatingRobot, Frame, LinkId, RobotModel};
use featherbench_interface::{self as interface, Body, Given, Refusal};
use nalgebra::Matrix3;

/// What is answered: quantity and method.
const METHODS: &[(&str, &str)] = &[
    ("id", "rnea"),
    ("bias", "rnea"),
    ("fd", "aba"),
    ("mass_matrix", "crba"),
    ("mass_matrix_sparse", "crba"),
    ("body_placement", "forward_kinematics_all"),
    ("body_jacobian", "jacobian"),
];

/// The robot in dynibo, with its workspace.
enum Engine {
    Fixed(dynibo::Robot),
    Floating(FloatingRobot),
}

/// A robot with its states.
pub struct Robot {
    bodies: usize,
    /// The body of a floating base, which its states need.
    root: Option<Body>,
    nv: usize,
    /// The dof that each dof hangs on, −1 for none.
    dof_parents: Vec<i32>,
    engine: Engine,
    order: Order,
    /// Our world in dynibo's.
    world: Frame,
    /// The links of the bodies, and their places among dynibo's.
    links: Vec<(LinkId, usize)>,
    count: usize,
    /// Of each state the base, if it floats.
    bases: Vec<Floating>,
    /// q, v and a of the joints, state after state.
    joints: [Vec<f64>; 3],
    /// Generalized forces.
    forces: Vec<f64>,
    rest: Vec<f64>,
    /// The body whose Jacobian is asked for.
    body: usize,
    /// The result of the last state, and that state.
    values: Vec<f64>,
    frames: Vec<Frame>,
    last: usize,
}

impl interface::Robot for Robot {
    const ENGINE: &'static str = "dynibo";
    const METHODS: &'static [(&'static str, &'static str)] = METHODS;

    fn new(given: &Given, readback: &mut [f64]) -> Result<Self, Refusal> {
        let &Given { bodies, gravity, sizes: [nq, nv], dof_parents } = given;
        let (pace, world, floats) = (coordinates::pace(gravity)?, coordinates::world(gravity), urdf::floats(bodies));
        if bodies.iter().any(|body| body.armature.iter().any(|&armature| armature != 0.0)) {
            return Err(Refusal::Unsupported("dynibo has no armature".into()));
        }
        if floats && bodies.iter().skip(1).any(|body| body.parent < 0) {
            return Err(Refusal::Unsupported("dynibo has nothing beside a floating base".into()));
        }
        let model = urdf::model(bodies, false)?;
        let links: Vec<LinkId> = (0..bodies.len()).map(|k| model.link_id(&urdf::link(k))).collect::<Result<_, _>>()?;
        let all: Vec<LinkId> = (0..model.link_count()).map(|place| model.link_id_at(place)).collect::<Result<_, _>>()?;
        let place = |link: LinkId| Some((link, all.iter().position(|&other| other == link)?));
        let links: Vec<_> = links.into_iter().map(place).collect::<Option<_>>().ok_or_else(|| lost("a link"))?;
        let first = if floats { 6 } else { 0 };
        let mut joints = Vec::with_capacity(model.joint_count());
        for theirs in 0..model.joint_count() {
            let body: usize = model.joint_name(theirs)?.trim_start_matches('j').parse().map_err(|_| lost("a joint"))?;
            joints.push(if floats { first + body - 1 } else { body });
        }
        if first + joints.len() != nv || nq != nv + usize::from(floats) {
            return Err(Refusal::Failed("dynibo counts other degrees of freedom".into()));
        }
        read_back(&model, bodies, readback)?;
        let engine = if floats {
            // It asks for a mass of the root.
            Engine::Floating(model.floating_robot().map_err(|error| Refusal::Unsupported(format!("dynibo refuses the base: {error}")))?)
        } else {
            let mut robot = model.robot();
            robot.set_base_frame(world)?;
            Engine::Fixed(robot)
        };
        Ok(Self {
            bodies: bodies.len(),
            root: bodies.first().copied().filter(|_| floats),
            nv,
            dof_parents: dof_parents.to_vec(),
            engine,
            order: Order { joints, floats, pace },
            world,
            count: 0,
            bases: Vec::new(),
            joints: Default::default(),
            forces: Vec::new(),
            rest: vec![0.0; nv - first],
            body: 0,
            values: vec![0.0; nv * nv.max(6)],
            frames: vec![Frame::identity(); all.len()],
            links,
            last: 0,
        })
    }

    fn sizes(&self) -> [usize; 2] {
        [self.nv + usize::from(self.order.floats), self.nv]
    }

    fn size(&self, method: usize) -> usize {
        match METHODS[method].0 {
            "mass_matrix" => self.nv * self.nv,
            "mass_matrix_sparse" => (0..self.nv).map(|dof| self.path(dof).count()).sum(),
            "body_placement" => 12 * self.bodies,
            "body_jacobian" => 6 * self.nv,
            _ => self.nv,
        }
    }

    fn convert(&mut self, [q, v, a, tau]: [&[f64]; 4]) -> Result<(), Refusal> {
        let ([nq, nv], pace) = (self.sizes(), self.order.pace);
        self.count = v.len() / nv.max(1);
        (self.bases, self.joints, self.forces, self.last) = (Vec::new(), Default::default(), Vec::new(), 0);
        for k in 0..self.count {
            let [q, v, a, tau] = [&q[k * nq..][..nq], &v[k * nv..][..nv], &a[k * nv..][..nv], &tau[k * nv..][..nv]];
            let base = match &self.root {
                Some(body) => Some(Floating::new(&self.world, body, pace, [q, v, a])?),
                None => None,
            };
            // The configuration of a floating base has one number more than its velocity.
            for (to, (from, factor)) in self.joints.iter_mut().zip([(&q[nq - nv..], 1.0), (v, pace.sqrt()), (a, pace)]) {
                to.extend(self.order.joints_forth(from, factor));
            }
            self.forces.extend(self.order.force_forth(base.as_ref(), tau));
            self.bases.extend(base);
        }
        Ok(())
    }

    fn ready(&mut self, _: usize, body: usize) -> Result<(), Refusal> {
        self.body = body;
        if body < self.links.len() { Ok(()) } else { Err(lost("a body")) }
    }

    fn run(&mut self, method: usize, first: usize, count: usize) -> Result<(), Refusal> {
        let mut k = first % self.count;
        for _ in 0..count {
            self.evaluate(METHODS[method].0, k)?;
            self.last = k;
            k = if k + 1 == self.count { 0 } else { k + 1 };
        }
        Ok(())
    }

    fn read(&mut self, method: usize, value: &mut [f64]) -> Result<(), Refusal> {
        let (n, base) = (self.nv, self.bases.get(self.last));
        match METHODS[method].0 {
            "fd" => self.order.acceleration_back(base, &self.values, value),
            "body_placement" => {
                for (value, &(_, place)) in value.chunks_exact_mut(12).zip(&self.links) {
                    let turned = self.frames[place].rotation;
                    let rotation = (self.world.rotation.inverse() * turned).to_rotation_matrix().into_inner();
                    value[..9].copy_from_slice(rotation.transpose().as_slice());
                    let origin = self.world.rotation.inverse() * self.frames[place].translation.vector;
                    value[9..].copy_from_slice(origin.as_slice());
                }
            }
            "body_jacobian" => {
                let world = self.world.rotation.inverse().to_rotation_matrix().into_inner();
                for (row, value) in value.chunks_exact_mut(n.max(1)).enumerate() {
                    let (first, axis) = (if row < 3 { 0 } else { 3 }, world.row(row % 3));
                    let entry = |column: usize| (0..3).map(|k| axis[k] * self.values[6 * column + first + k]).sum();
                    self.order.back(base, entry, value);
                }
            }
            "mass_matrix" => value.copy_from_slice(&self.mass_matrix()),
            "mass_matrix_sparse" => {
                let dense = self.mass_matrix();
                let mut at = 0;
                for dof in 0..n {
                    let path: Vec<usize> = self.path(dof).collect();
                    for &other in path.iter().rev() {
                        value[at] = dense[dof * n + other];
                        at += 1;
                    }
                }
            }
            _ => {
                self.order.back(base, |theirs| self.values[theirs], value);
                value.iter_mut().for_each(|force| *force /= self.order.pace);
            }
        }
        Ok(())
    }
}

impl Robot {
    /// The dofs from one to the root.
    fn path(&self, dof: usize) -> impl Iterator<Item = usize> + '_ {
        std::iter::successors(Some(dof), |&dof| usize::try_from(self.dof_parents[dof]).ok())
    }

    /// Evaluates a state.
    fn evaluate(&mut self, quantity: &str, k: usize) -> Result<(), Refusal> {
        let (n, link, rest) = (self.order.joints.len(), self.links[self.body].0, &self.rest[..]);
        let [q, v, a] = self.joints.each_ref().map(|numbers| &numbers[k * n..(k + 1) * n]);
        let tau = &self.forces[k * self.nv..(k + 1) * self.nv];
        let (values, nv) = (&mut self.values, self.nv);
        match &mut self.engine {
            Engine::Fixed(robot) => match quantity {
                "id" => robot.inverse_dynamics(q, v, a, &[], &mut values[..nv])?,
                "bias" => robot.inverse_dynamics(q, v, rest, &[], &mut values[..nv])?,
                "fd" => robot.forward_dynamics(q, v, tau, &[], &mut values[..nv])?,
                "body_placement" => robot.forward_kinematics_all(q, &mut self.frames)?,
                "body_jacobian" => robot.jacobian(q, link, &mut values[..6 * nv])?,
                _ => robot.mass_matrix(q, &mut values[..nv * nv])?,
            },
            Engine::Floating(robot) => {
                let base = &self.bases[k];
                match quantity {
                    "id" => robot.inverse_dynamics(&base.state, q, v, a, &[], &mut values[..nv])?,
                    "bias" => robot.inverse_dynamics(&base.unaccelerated, q, v, rest, &[], &mut values[..nv])?,
                    "fd" => robot.forward_dynamics(&base.state, q, v, tau, &[], &mut values[..nv])?,
                    "body_placement" => robot.forward_kinematics_all(&base.state, q, &mut self.frames)?,
                    "body_jacobian" => robot.jacobian(&base.state, q, link, &mut values[..6 * nv])?,
                    _ => robot.mass_matrix(&base.state, q, &mut values[..nv * nv])?,
                }
            }
        }
        Ok(())
    }

    /// M = Tᵀ M_e T: Tᵀ on each column of M_e, then on each row of the result.
    fn mass_matrix(&self) -> Vec<f64> {
        let (n, base) = (self.nv, self.bases.get(self.last));
        let (mut half, mut mass) = (vec![0.0; n * n], vec![0.0; n * n]);
        for (theirs, column) in half.chunks_exact_mut(n.max(1)).enumerate() {
            self.order.back(base, |row| self.values[theirs * n + row], column);
        }
        for (row, value) in mass.chunks_exact_mut(n.max(1)).enumerate() {
            self.order.back(base, |theirs| half[theirs * n + row], value);
        }
        mass
    }
}

/// What dynibo has of each body. The placements are those of a robot whose joints all hang on the world, read from the same numbers: dynibo
/// shows where links are, and along a path that adds up roundings. A floating base has none in the model: its states carry it.
fn read_back(model: &RobotModel, bodies: &[Body], readback: &mut [f64]) -> Result<(), Refusal> {
    let apart = urdf::model(bodies, true)?;
    let mut frames = vec![Frame::identity(); apart.link_count()];
    apart.robot().forward_kinematics_all(&vec![0.0; apart.joint_count()], &mut frames)?;
    let mut placed = vec![Frame::identity(); bodies.len()];
    for (place, frame) in frames.into_iter().enumerate() {
        let name = apart.link_name(apart.link_id_at(place)?)?;
        if let Some(body) = name.strip_prefix('b').and_then(|number| number.parse::<usize>().ok()) {
            placed[body] = frame;
        }
    }
    let floats = urdf::floats(bodies);
    for (k, (value, body)) in readback.chunks_exact_mut(22).zip(bodies).enumerate() {
        let link = model.link_id(&urdf::link(k))?;
        let inertia: Matrix3<f64> = model.link_inertia(link)?;
        value[0] = model.link_mass(link)?;
        value[1..4].copy_from_slice(model.link_center_of_mass(link)?.as_slice());
        value[4..10].copy_from_slice(&[(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].map(|entry| inertia[entry]));
        if k == 0 && floats {
            value[10..19].copy_from_slice(&body.rotation);
            value[19..].copy_from_slice(&body.translation);
        } else {
            value[10..19].copy_from_slice(placed[k].rotation.to_rotation_matrix().into_inner().transpose().as_slice());
            value[19..].copy_from_slice(placed[k].translation.vector.as_slice());
        }
    }
    Ok(())
}

fn lost(what: &str) -> Refusal {
    Refusal::Failed(format!("dynibo lost {what}"))
}
