//! The Jacobian of a body: its velocity is `J v`.
//!
//! Source: the book, body Jacobians: column j is the motion subspace of dof j if j supports the body, else zero.
//! Rotations are multiplied from the root to the body. Displacements in world axes are added from the body to the root. So each column is
//! rotated once, and the robot's distance from the world's origin does not enter.
//! Frame: world axes [ang; lin] at the origin of the body's frame. Shapes: q has `nq` numbers; J has `nv` columns of six.
//! Units: SI. Cost: O(n). A call does not allocate.

use crate::DimensionError;
use crate::error::expect;
use crate::step::expect_bodies;
use featherbench_model::{Model, Topology};
use featherbench_spatial::{Lift, Mat3, Motion, Real, Transform, Vec3};

/// The Jacobian of a body, and its workspace.
#[derive(Clone, Debug)]
pub struct Jacobian<T> {
    bodies: usize,
    columns: Vec<Motion<T>>,
    /// From the body to the root.
    path: Vec<Link<T>>,
}

/// A body on the path.
#[derive(Clone, Copy, Debug)]
struct Link<T> {
    /// Its index.
    body: usize,
    /// Its first dof, and how many it has.
    dofs: [usize; 2],
    /// Its rotation: in the parent, then in the world.
    rotation: Mat3<T>,
    /// The displacement from the parent's origin: in the parent's axes, then in the world's.
    step: Vec3<T>,
}

impl<T: Real> Jacobian<T> {
    /// A workspace for the Jacobian of a body of this topology.
    pub fn new(topology: &Topology) -> Self {
        let bodies = topology.bodies();
        Self { bodies, columns: vec![Motion::zero(); topology.nv()], path: Vec::with_capacity(bodies) }
    }

    /// The Jacobian of compiled body `body` at configuration `q`: one column per dof.
    ///
    /// # Errors
    /// [`DimensionError`] when `q` or the workspace does not fit the model, or when there is no such body.
    #[inline(never)]
    pub fn run<P: Real + Lift<T>>(&mut self, model: &Model<P>, q: &[T], body: usize) -> Result<&[Motion<T>], DimensionError> {
        expect_bodies(model, self.bodies)?;
        expect("columns of the workspace", model.topology.nv(), self.columns.len())?;
        expect("configuration q", model.topology.nq(), q.len())?;
        if body >= self.bodies {
            return Err(DimensionError { what: "bodies, for the one that was named", expected: body + 1, found: self.bodies });
        }

        // Where this path leaves that of the last run, the columns of that one are zero again.
        let (mut length, mut ancestor) = (0, Some(body));
        while let Some(i) = ancestor {
            let Transform { rotation, translation: step } = model.joint_transform(i, q);
            let joint = &model.topology.joints()[i];
            let link = Link { body: i, dofs: [joint.v, joint.kind.nv()], rotation, step };
            match self.path.get_mut(length) {
                Some(last) if last.dofs == link.dofs => *last = link,
                _ => {
                    self.leave(length);
                    self.path.push(link);
                }
            }
            length += 1;
            ancestor = joint.parent;
        }
        self.leave(length);
        // R_i = R_p R,  r = R_p (p_i − p_p)
        let mut parent = Mat3::identity();
        for link in self.path.iter_mut().rev() {
            (link.step, link.rotation) = (parent * link.step, parent * link.rotation);
            parent = link.rotation;
        }
        // J_j = [R S_ω; R S_p + R S_ω × d], d (`way`) the displacement from the origin of the joint's body to that of the body
        let mut way = Vec3::zero();
        for Link { body, dofs: [first, count], rotation, step } in self.path.iter().copied() {
            let kind = model.topology.joints()[body].kind;
            for k in 0..count {
                let column: Motion<T> = kind.column(&model.subspaces[body], k);
                let ang = rotation * column.ang;
                self.columns[first + k] = Motion::new(ang, ang.cross_add(way, rotation * column.lin));
            }
            way += step;
        }
        Ok(&self.columns)
    }

    /// Takes the links from number `length` on off the path. Their columns are zero then.
    fn leave(&mut self, length: usize) {
        for Link { dofs: [first, count], .. } in self.path.drain(length..) {
            self.columns[first..][..count].fill(Motion::zero());
        }
    }

    /// The columns of the last run; zero before the first.
    pub fn columns(&self) -> &[Motion<T>] {
        &self.columns
    }
}

/// The Jacobian of a compiled body, in a workspace of the call; it allocates.
///
/// # Errors
/// [`DimensionError`] when `q` does not fit the model, or when there is no such body.
pub fn jacobian<T: Real, P: Real + Lift<T>>(model: &Model<P>, q: &[T], body: usize) -> Result<Vec<Motion<T>>, DimensionError> {
    let mut jacobian = Jacobian::new(&model.topology);
    jacobian.run(model, q, body)?;
    Ok(jacobian.columns)
}
