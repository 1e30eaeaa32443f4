//! The Delassus matrix by propagation through articulated bodies, without M.
//!
//! Once per configuration, from the tips to the root, one dof after the other (S one column, the last dof of a joint first):
//!
//! ```text
//! U = Iᴬ S        D = Sᵀ U + armature        Iᴬ ← Iᴬ − U D⁻¹ Uᵀ
//! ```
//!
//! Per row: its wrenches f go to the root, and the accelerations that they cause come back:
//!
//! ```text
//! inward    u = Sᵀ f + c,   f ← f − U D⁻¹ u,   f_p += X* f          (c: the row's number for the dof)
//! outward   q̈ = D⁻¹ (u − Uᵀ a),   a ← a + S q̈                       (a: X a_p before the first dof)
//! ```
//!
//! An entry of G is the power of one row's wrenches in the accelerations of another. Eliminating a joint's dofs one by one gives what the
//! block of the joint gives, so all kinds of joints share this text.
//!
//! Source: P. M. Wensing, R. Featherstone and D. E. Orin, *A reduced-order recursive algorithm for the computation of the operational-space
//! inertia matrix* (ICRA 2012), whose extended force propagator is the inward pass; the book, table 7.1, for Iᴬ, U and D.
//! Frames: compiled body axes at the body's origin. Cost: O(n) per row. `run` does not allocate.

use crate::error::Error;
use crate::laws::Row;
use featherbench_dynamics::{DimensionError, NotPositiveDefinite};
use featherbench_model::{JointKind, Model, Topology};
use featherbench_spatial::{ArticulatedInertia, Force, Lift, Motion, Real, Transform};
use nalgebra::{DMatrix, Scalar};

/// The articulated inertias of a configuration, and the workspace that propagates rows through them.
#[derive(Clone, Debug)]
pub struct Articulated<T> {
    bodies: Vec<Body<T>>,
    dofs: Vec<Dof<T>>,
}

/// What is kept of a body.
#[derive(Clone, Copy, Debug)]
struct Body<T> {
    /// Placement in the parent, and in the world.
    x: Transform<T>,
    world: Transform<T>,
    inertia: ArticulatedInertia<T>,
    /// What a row does to the body, and what it does by it.
    force: Force<T>,
    acceleration: Motion<T>,
}

/// What is kept of a dof.
#[derive(Clone, Copy, Debug)]
struct Dof<T> {
    s: Motion<T>,
    /// U, and U D⁻¹.
    upper_u: Force<T>,
    scaled: Force<T>,
    d: T,
    u: T,
    /// The acceleration of the dof.
    rate: T,
}

impl<T: Real> Articulated<T> {
    /// A workspace for models of this topology.
    pub fn new(topology: &Topology) -> Self {
        let (place, zero) = (Transform::identity(), T::zero());
        let inertia = ArticulatedInertia::zero();
        let body = Body { x: place, world: place, inertia, force: Force::zero(), acceleration: Motion::zero() };
        let dof = Dof { s: Motion::zero(), upper_u: Force::zero(), scaled: Force::zero(), d: zero, u: zero, rate: zero };
        Self { bodies: vec![body; topology.bodies()], dofs: vec![dof; topology.nv()] }
    }

    /// Places all bodies at configuration `q` and forms the articulated inertias.
    ///
    /// # Errors
    /// [`Error`]: an argument does not fit, or a dof meets no inertia.
    pub fn run<P: Real + Lift<T>>(&mut self, model: &Model<P>, q: &[T]) -> Result<(), Error> {
        let topology = &model.topology;
        DimensionError::expect("bodies of the workspace", topology.bodies(), self.bodies.len())?;
        DimensionError::expect("dofs of the workspace", topology.nv(), self.dofs.len())?;
        DimensionError::expect("configuration q", topology.nq(), q.len())?;
        for (i, joint) in topology.joints().iter().enumerate() {
            let x = model.joint_transform(i, q);
            let world = joint.parent.map_or(x, |parent| self.bodies[parent].world.compose(&x));
            let body = &mut self.bodies[i];
            (body.x, body.world, body.inertia) = (x, world, model.inertias[i].lift().to_articulated());
        }
        for (i, joint) in topology.joints().iter().enumerate().rev() {
            let mut inertia = self.bodies[i].inertia;
            for k in (0..joint.kind.nv()).rev() {
                let dof = joint.v + k;
                let s: Motion<T> = joint.kind.column(&model.subspaces[i], k);
                let upper_u = inertia.mul(s);
                let d = s.dot(upper_u) + model.armature[dof].lift();
                let pivot = d.min_lane();
                if pivot.is_nan() || pivot <= 0.0 {
                    return Err(NotPositiveDefinite { dof, pivot }.into());
                }
                let scaled = upper_u * (T::one() / d);
                inertia = inertia.subtract_rank_one(scaled, upper_u);
                self.dofs[dof] = Dof { s, upper_u, scaled, d, ..self.dofs[dof] };
            }
            if let Some(parent) = joint.parent.filter(|_| joint.kind != JointKind::Free) {
                self.bodies[parent].inertia = self.bodies[parent].inertia + inertia.to_parent(&self.bodies[i].x);
            }
        }
        Ok(())
    }

    /// The accelerations that a row's wrenches and forces cause at v = 0 without gravity: `M⁻¹ Jᵀ e`.
    fn respond<P>(&mut self, model: &Model<P>, row: &Row<T>) {
        let joints = model.topology.joints();
        self.bodies.iter_mut().for_each(|body| body.force = Force::zero());
        self.dofs.iter_mut().for_each(|dof| dof.u = T::zero());
        for (body, wrench) in row.wrenches.into_iter().flatten() {
            let body = &mut self.bodies[body];
            let turn = body.world.rotation;
            body.force += Force::new(turn.transpose_mul(wrench.ang), turn.transpose_mul(wrench.lin));
        }
        row.dofs.iter().for_each(|(dof, number)| self.dofs[*dof].u += *number);

        for (i, joint) in joints.iter().enumerate().rev() {
            let mut force = self.bodies[i].force;
            for dof in self.dofs[joint.v..][..joint.kind.nv()].iter_mut().rev() {
                dof.u += dof.s.dot(force);
                force = dof.scaled.scale_add(-dof.u, force);
            }
            if let Some(parent) = joint.parent.filter(|_| joint.kind != JointKind::Free) {
                let onward = self.bodies[i].x.force(force);
                self.bodies[parent].force += onward;
            }
        }
        for (i, joint) in joints.iter().enumerate() {
            let before = joint.parent.map_or(Motion::zero(), |parent| self.bodies[parent].acceleration);
            let mut acceleration = self.bodies[i].x.inverse_motion(before);
            for dof in &mut self.dofs[joint.v..][..joint.kind.nv()] {
                dof.rate = (dof.u - acceleration.dot(dof.upper_u)) / dof.d;
                acceleration = dof.s.scale_add(dof.rate, acceleration);
            }
            self.bodies[i].acceleration = acceleration;
        }
    }

    /// What a row makes of the accelerations of the last response.
    fn felt(&self, row: &Row<T>) -> T {
        let by_bodies = row.wrenches.into_iter().flatten().fold(T::zero(), |sum, (body, wrench)| {
            let Body { world, acceleration, .. } = self.bodies[body];
            let turned = Motion::new(world.rotation * acceleration.ang, world.rotation * acceleration.lin);
            sum + turned.dot(wrench)
        });
        row.dofs.iter().fold(by_bodies, |sum, (dof, number)| number.mul_add(self.dofs[*dof].rate, sum))
    }

    /// G of rows at the configuration of the last run; it allocates the matrix.
    ///
    /// # Errors
    /// [`Error::Dimension`] when the model is not that of the run.
    pub fn delassus<P>(&mut self, model: &Model<P>, rows: &[Row<T>]) -> Result<DMatrix<T>, Error>
    where
        T: Scalar,
    {
        DimensionError::expect("bodies of the workspace", model.topology.bodies(), self.bodies.len())?;
        let mut g = DMatrix::from_element(rows.len(), rows.len(), T::zero());
        for (a, row) in rows.iter().enumerate() {
            self.respond(model, row);
            for (b, other) in rows[..=a].iter().enumerate() {
                let felt = self.felt(other);
                (g[(a, b)], g[(b, a)]) = (felt, felt);
            }
        }
        Ok(g)
    }
}

/// G of rows at a configuration, in a workspace of the call; it allocates.
///
/// # Errors
/// [`Error`]: an argument does not fit, or a dof meets no inertia.
pub fn by_propagation<T: Real + Scalar, P: Real + Lift<T>>(model: &Model<P>, q: &[T], rows: &[Row<T>]) -> Result<DMatrix<T>, Error> {
    let mut articulated = Articulated::new(&model.topology);
    articulated.run(model, q)?;
    articulated.delassus(model, rows)
}
