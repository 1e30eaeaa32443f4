//! The Jacobian J of a frame on a body and its rate of change J̇: the frame's velocity is `J v`, its acceleration `J v̇ + J̇ v`.
//!
//! Source: the book, body Jacobians; J̇ by differentiating each column. With the column [s_ω; s_p] of dof j in world axes at its body's
//! origin, d the displacement from there to the frame's origin, and ω and ṗ the body's and ṗ_f the frame's velocity:
//!
//! ```text
//! J_j = [s_ω; s_p + s_ω × d]      J̇_j = [ω × s_ω; ω × s_p + (ω × s_ω) × d + s_ω × (ṗ_f − ṗ)]
//! ```
//!
//! Displacements and velocities are differences along the path. So neither the distance from the world's origin nor the speed of the robot
//! as a whole costs a digit.
//! Frame: world axes [ang; lin] at the frame's origin. Shapes: q has `nq` numbers, v has `nv`; J and J̇ have `nv` columns of six.
//! Units: SI. Cost: O(n). A call does not allocate.

use crate::DimensionError;
use crate::error::expect;
use crate::step::expect_bodies;
use featherbench_model::{Model, Topology};
use featherbench_spatial::{Lift, Mat3, Motion, Real, Vec3};

/// The Jacobian of a frame and its rate of change, and their workspace.
///
/// ```
/// use featherbench_dynamics::{JacobianRate, forward_kinematics};
/// use featherbench_model::Model;
/// use featherbench_robots::{Family, StateBatch};
/// use featherbench_spatial::{Motion, Vec3};
///
/// let model: Model<f64> = Model::build(&Family::parse("humanoid")?.generate()?)?;
/// let states = StateBatch::random(&model, 1, 7);
/// let (q, v, a) = (states.q(0), states.v(0), states.a(0));
/// let hand = model.topology.bodies() - 1;
/// let mut workspace = JacobianRate::new(&model.topology);
/// workspace.run(&model, q, v, hand, Vec3::zero())?;
///
/// // The acceleration of a body's own frame is J a + J̇ v.
/// let mut sum: Motion<f64> = Motion::zero();
/// for k in 0..model.topology.nv() {
///     sum = workspace.columns()[k].scale_add(a[k], workspace.rates()[k].scale_add(v[k], sum));
/// }
/// let expected = forward_kinematics(&model, q, v, a)?.body(hand).expect("a body").acceleration;
/// assert!((sum.lin - expected.lin).norm() < 1e-12 && (sum.ang - expected.ang).norm() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct JacobianRate<T> {
    bodies: usize,
    columns: Vec<Motion<T>>,
    rates: Vec<Motion<T>>,
    /// From the body to the root.
    path: Vec<Link<T>>,
}

/// A body on the path.
#[derive(Clone, Copy, Debug)]
struct Link<T> {
    /// Its index.
    body: usize,
    /// Its rotation: in the parent, then in the world.
    rotation: Mat3<T>,
    /// The displacement from the parent's origin: in the parent's axes, then in the world's.
    step: Vec3<T>,
    /// Its angular velocity in world axes.
    omega: Vec3<T>,
    /// The velocity of its origin less that of the parent's origin, in world axes.
    step_rate: Vec3<T>,
}

impl<T: Real> JacobianRate<T> {
    /// A workspace for the frames of models of this topology.
    pub fn new(topology: &Topology) -> Self {
        let bodies = topology.bodies();
        let zeros = vec![Motion::zero(); topology.nv()];
        Self { bodies, columns: zeros.clone(), rates: zeros, path: Vec::with_capacity(bodies) }
    }

    /// J and J̇ at configuration `q` and velocity `v`. The frame's origin is at `offset` in the described axes of compiled body `body`.
    ///
    /// # Errors
    /// [`DimensionError`] when `q`, `v` or the workspace does not fit the model, or when there is no such body.
    #[inline(never)]
    pub fn run<P: Real + Lift<T>>(
        &mut self,
        model: &Model<P>,
        q: &[T],
        v: &[T],
        body: usize,
        offset: Vec3<T>,
    ) -> Result<(), DimensionError> {
        expect_bodies(model, self.bodies)?;
        expect("columns of the workspace", model.topology.nv(), self.columns.len())?;
        expect("configuration q", model.topology.nq(), q.len())?;
        expect("velocity v", model.topology.nv(), v.len())?;
        if body >= self.bodies {
            return Err(DimensionError { what: "bodies, for the one that was named", expected: body + 1, found: self.bodies });
        }

        self.columns.fill(Motion::zero());
        self.rates.fill(Motion::zero());
        self.path.clear();
        let mut ancestor = Some(body);
        while let Some(i) = ancestor {
            let x = model.joint_transform(i, q);
            let (rotation, step) = (x.rotation, x.translation);
            self.path.push(Link { body: i, rotation, step, omega: Vec3::zero(), step_rate: Vec3::zero() });
            ancestor = model.topology.joints()[i].parent;
        }
        // R_i = R_p R,  r = R_p (p_i − p_p),  ω_i = ω_p + R ω_J,  ṙ = ω_p × r + R v_J
        let (mut parent, mut omega) = (Mat3::identity(), Vec3::zero());
        for link in self.path.iter_mut().rev() {
            let joint = &model.topology.joints()[link.body];
            let across = joint.kind.motion(&model.subspaces[link.body], &v[joint.v..]);
            (link.step, link.rotation) = (parent * link.step, parent * link.rotation);
            link.step_rate = omega.cross_add(link.step, link.rotation * across.lin);
            link.omega = omega + link.rotation * across.ang;
            (parent, omega) = (link.rotation, link.omega);
        }
        // d and ḋ (`way`, `way_rate`): from the origin of the joint's body to that of the frame
        let (mut way, mut way_rate) = (parent * model.labels[body].to_compiled(offset), Vec3::zero());
        way_rate += omega.cross(way);
        for link in self.path.iter() {
            let joint = &model.topology.joints()[link.body];
            for k in 0..joint.kind.nv() {
                let column: Motion<T> = joint.kind.column(&model.subspaces[link.body], k);
                let (ang, lin) = (link.rotation * column.ang, link.rotation * column.lin);
                let ang_rate = link.omega.cross(ang);
                self.columns[joint.v + k] = Motion::new(ang, ang.cross_add(way, lin));
                let lin_rate = ang_rate.cross_add(way, ang.cross_add(way_rate, link.omega.cross(lin)));
                self.rates[joint.v + k] = Motion::new(ang_rate, lin_rate);
            }
            way += link.step;
            way_rate += link.step_rate;
        }
        Ok(())
    }

    /// The columns of J of the last run; zero before the first.
    pub fn columns(&self) -> &[Motion<T>] {
        &self.columns
    }

    /// The columns of J̇ of the last run; zero before the first.
    pub fn rates(&self) -> &[Motion<T>] {
        &self.rates
    }
}

/// J and J̇ of the frame of a compiled body, in a workspace of the call; it allocates.
///
/// # Errors
/// [`DimensionError`] when `q` or `v` does not fit the model, or when there is no such body.
pub fn jacobian_rate<T: Real, P: Real + Lift<T>>(
    model: &Model<P>,
    q: &[T],
    v: &[T],
    body: usize,
) -> Result<JacobianRate<T>, DimensionError> {
    let mut workspace = JacobianRate::new(&model.topology);
    workspace.run(model, q, v, body, Vec3::zero())?;
    Ok(workspace)
}
