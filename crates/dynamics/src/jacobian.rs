//! The Jacobian of a body: its velocity is `J v`.
//!
//! Source: the book, body Jacobians: column j is the motion subspace of dof j if j supports the body, else zero. On the
//! way from the body to the root, columns are formed in the body's frame from relative placements: no offset of the robot enters.
//! Frame: world axes [ang; lin] at the origin of the body's frame. Shapes: q has `nq` numbers; J has `nv` columns of six.
//! Units: SI. Cost: O(n). A call does not allocate.

use crate::DimensionError;
use crate::error::expect;
use crate::step::expect_bodies;
use model::{Model, Topology};
use spatial::{Lift, Motion, Real, Transform};

/// The Jacobian of a body, and the room for it.
#[derive(Clone, Debug)]
pub struct Jacobian<T> {
    bodies: usize,
    columns: Vec<Motion<T>>,
}

impl<T: Real> Jacobian<T> {
    /// Room for the Jacobian of a body of this topology.
    pub fn new(topology: &Topology) -> Self {
        Self { bodies: topology.bodies(), columns: vec![Motion::zero(); topology.nv()] }
    }

    /// The Jacobian of compiled body `body` at configuration `q`: one column per dof.
    ///
    /// # Errors
    /// [`DimensionError`] when `q` or the workspace does not fit the model, or when there is no such body.
    pub fn run<P: Real + Lift<T>>(&mut self, model: &Model<P>, q: &[T], body: usize) -> Result<&[Motion<T>], DimensionError> {
        expect_bodies(model, self.bodies)?;
        expect("columns of the workspace", model.topology.nv(), self.columns.len())?;
        expect("configuration q", model.topology.nq(), q.len())?;
        if body >= self.bodies {
            return Err(DimensionError { what: "bodies, for the one that was named", expected: body + 1, found: self.bodies });
        }

        self.columns.fill(Motion::zero());
        let mut placement = Transform::identity();
        let mut ancestor = Some(body);
        while let Some(i) = ancestor {
            // J_j = X⁻¹ S_j in the body's frame
            let joint = &model.topology.joints()[i];
            for k in 0..joint.kind.nv() {
                self.columns[joint.v + k] = placement.inverse_motion(joint.kind.column(&model.subspaces[i], k));
            }
            placement = model.joint_transform(i, q).compose(&placement);
            ancestor = joint.parent;
        }
        // in world axes
        let r = placement.rotation;
        for column in &mut self.columns {
            *column = Motion::new(r * column.ang, r * column.lin);
        }
        Ok(&self.columns)
    }

    /// The columns of the last run; zero before the first.
    pub fn columns(&self) -> &[Motion<T>] {
        &self.columns
    }
}

/// The Jacobian of a compiled body without a workspace of one's own; it allocates.
///
/// # Errors
/// [`DimensionError`] when `q` does not fit the model, or when there is no such body.
pub fn jacobian<T: Real, P: Real + Lift<T>>(model: &Model<P>, q: &[T], body: usize) -> Result<Vec<Motion<T>>, DimensionError> {
    let mut jacobian = Jacobian::new(&model.topology);
    jacobian.run(model, q, body)?;
    Ok(jacobian.columns)
}
