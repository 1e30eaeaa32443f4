//! The joint-space inertia matrix M(q) by the composite-rigid-body algorithm, into a tree-sparse matrix.
//!
//! Source: the book, table 6.2. The book carries one force `F_k = Iᶜ S_k` at a time from its joint to the root. Here the forces of all dofs
//! that a body supports are carried together, component by component. They are consecutive dofs, so the loops are contiguous.
//! A composite inertia Iᶜ is carried about its own centre of mass, and not at its joint as in the book. Of a curled chain the inertia at the
//! joint is large, while the joint's own axis may feel little of it: M_kk would have the rounding errors of the large numbers.
//! Frames: the inertias Iᶜ and forces F are in the axes of the body that the loop has reached; F is at its origin.
//! Armature is added to the diagonal. Shapes: q has `nq` numbers; M is `nv`×`nv`. Units: SI, angles in radians.
//! Cost: O(n + Σ d_k), d_k the depth of dof k. A call does not allocate.

use crate::error::expect;
use crate::step::{by_kind, expect_bodies};
use crate::tree_sparse::Row;
use crate::{DimensionError, TreeSparse};
use featherbench_model::{Axis, JointKind, Model, Topology};
use featherbench_spatial::{CentralInertia, Force, Lift, Motion, Real, Transform, Vec3};
use std::ops::Range;

/// The workspace of the composite-rigid-body algorithm.
///
/// The plain algorithm of the book, with one force at a time, gives the same numbers but for rounding:
///
/// ```
/// use featherbench_dynamics::mass_matrix;
/// use featherbench_model::{JointKind, Model};
/// use featherbench_robots::Family;
///
/// let model: Model<f64> = Model::build(&Family::parse("chain:n=12,layout=spatial")?.generate()?)?;
/// let (joints, subspaces) = (model.topology.joints(), &model.subspaces);
/// let q: Vec<f64> = (0..model.topology.nq()).map(|k| 0.3 + 0.1 * k as f64).collect();
/// let matrix = mass_matrix(&model, &q)?;
///
/// let mut composites = model.inertias.clone();
/// for (i, joint) in joints.iter().enumerate().rev() {
///     // Iᶜ_i is complete: F = Iᶜ_i S_i goes from joint to joint towards the root, and M_ij = S_jᵀ F
///     let mut force = composites[i].mul(joint.kind.column(&subspaces[i], 0));
///     let mut j = Some(i);
///     while let Some(body) = j {
///         let mut entry = [0.0];
///         joints[body].kind.project(&subspaces[body], force, &mut entry);
///         let expected = entry[0] + if body == i { model.armature[joint.v] } else { 0.0 };
///         assert!((matrix.get(joint.v, joints[body].v) - expected).abs() < 1e-12);
///         force = model.joint_transform(body, &q).force(force);
///         j = joints[body].parent;
///     }
///     if let Some(parent) = joint.parent {
///         composites[parent] = composites[parent] + composites[i].to_parent(&model.joint_transform(i, &q));
///     }
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Crba<T> {
    /// Composite inertia Iᶜ: the body with everything that it supports.
    composites: Vec<CentralInertia<T>>,
    /// Placement of each body in its parent.
    placements: Vec<Transform<T>>,
    forces: Forces<T>,
}

impl<T: Real> Crba<T> {
    /// A workspace for models of this topology.
    pub fn new(topology: &Topology) -> Self {
        Self {
            composites: vec![CentralInertia::zero(); topology.bodies()],
            placements: vec![Transform::identity(); topology.bodies()],
            forces: Forces::new(topology.nv()),
        }
    }

    /// The joint-space inertia matrix `matrix` of configuration `q`.
    ///
    /// # Errors
    /// [`DimensionError`] when an argument or the workspace does not fit the model.
    #[inline(never)]
    pub fn run<P: Real + Lift<T>>(&mut self, model: &Model<P>, q: &[T], matrix: &mut TreeSparse<T>) -> Result<(), DimensionError> {
        self.recurse::<P, false>(model, q, matrix)
    }

    /// [`Crba::run`] as a part of its caller. If `INLINED`, all of it is: so it has the instructions that the caller is compiled for.
    #[inline(always)]
    pub(crate) fn recurse<P: Real + Lift<T>, const INLINED: bool>(
        &mut self,
        model: &Model<P>,
        q: &[T],
        matrix: &mut TreeSparse<T>,
    ) -> Result<(), DimensionError> {
        let Self { composites, placements, forces } = self;
        expect_shapes(model, composites.len(), q, matrix)?;
        expect("dofs of the workspace", model.topology.nv(), forces.len())?;

        for (i, (composite, x)) in composites.iter_mut().zip(placements.iter_mut()).enumerate() {
            *composite = model.inertias[i].lift::<T>().central();
            *x = model.joint_transform(i, q);
        }
        for (i, joint) in model.topology.joints().iter().enumerate().rev() {
            let (kind, subspace, x) = (joint.kind, &model.subspaces[i], &placements[i]);
            // F_k = Iᶜ_i S_k for the joint's own dofs
            for k in 0..kind.nv() {
                forces.set(joint.v + k, column_force(kind, &composites[i], subspace, k));
            }
            // M_kj = S_jᵀ F_k for every dof k that the joint's dof j supports
            for column in 0..kind.nv() {
                let dofs = matrix.supported(joint.v + column);
                let position = matrix.depth(dofs.start) - 1;
                let (rows, values) = matrix.parts_mut();
                let into = Rows { rows: &rows[dofs.clone()], values, start: 0 };
                by_kind!(T, kind, project, forces, dofs.start, subspace, column, position, into);
            }
            if let Some(parent) = joint.parent {
                // Iᶜ_p += X* Iᶜ_i X⁻¹,  F_k = X* F_k
                let moved = composites[i].to_parent(x);
                composites[parent] += moved;
                forces.carry::<INLINED>(x, matrix.supported(joint.v));
            }
        }
        for (k, armature) in model.armature.iter().enumerate() {
            matrix.add_to_diagonal(k, armature.lift());
        }
        Ok(())
    }
}

/// `Iᶜ S_k`: the force that moves a composite body along column `k` of its joint's motion subspace.
#[inline(always)]
pub(crate) fn column_force<T: Real, P: Real + Lift<T>>(
    kind: JointKind,
    composite: &CentralInertia<T>,
    subspace: &Motion<P>,
    k: usize,
) -> Force<T> {
    let CentralInertia { mass, com: c, rotational: i } = *composite;
    let zero = T::zero();
    match kind {
        JointKind::Revolute(Axis::Z) => {
            let f = Vec3::new(-(mass * c.y), mass * c.x, zero);
            let n = Vec3::new((-c.z).mul_add(f.y, i.xz), c.z.mul_add(f.x, i.yz), c.x.mul_add(f.y, (-c.y).mul_add(f.x, i.zz)));
            Force::new(n, f)
        }
        JointKind::Prismatic(Axis::Z) => Force::new(Vec3::new(mass * c.y, -(mass * c.x), zero), Vec3::new(zero, zero, mass)),
        _ => composite.mul(kind.column(subspace, k)),
    }
}

/// One force F_k per dof k, stored component by component. `LANES` unused elements stand before the first dof.
#[derive(Clone, Debug)]
pub(crate) struct Forces<T> {
    ang: [Vec<T>; 3],
    lin: [Vec<T>; 3],
}

impl<T: Real> Forces<T> {
    /// How many scalars fill a register of 64 bytes; at least 1.
    const LANES: usize = if size_of::<T>() < 64 { 64 / size_of::<T>() } else { 1 };

    pub(crate) fn new(dofs: usize) -> Self {
        let zeros = || std::array::from_fn(|_| vec![T::zero(); Self::LANES + dofs]);
        Self { ang: zeros(), lin: zeros() }
    }

    fn len(&self) -> usize {
        self.ang[0].len() - Self::LANES
    }

    #[inline(always)]
    pub(crate) fn set(&mut self, dof: usize, f: Force<T>) {
        let [nx, ny, nz] = self.ang.each_mut().map(|component| &mut component[Self::LANES + dof]);
        let [fx, fy, fz] = self.lin.each_mut().map(|component| &mut component[Self::LANES + dof]);
        (*nx, *ny, *nz) = (f.ang.x, f.ang.y, f.ang.z);
        (*fx, *fy, *fz) = (f.lin.x, f.lin.y, f.lin.z);
    }

    /// `F_k = X* F_k` for every dof of a range. Whole registers are filled, so a few dofs before the range change too: these are not set
    /// yet.
    #[inline(always)]
    pub(crate) fn carry_to_parent(&mut self, x: &Transform<T>, dofs: Range<usize>) {
        self.carry::<false>(x, dofs);
    }

    /// The same. If `INLINED`, all of it is a part of its caller.
    #[inline(always)]
    fn carry<const INLINED: bool>(&mut self, x: &Transform<T>, dofs: Range<usize>) {
        let end = Self::LANES + dofs.end;
        let start = end - dofs.len().next_multiple_of(Self::LANES);
        let [nx, ny, nz] = self.ang.each_mut().map(|component| &mut component[start..end]);
        let [fx, fy, fz] = self.lin.each_mut().map(|component| &mut component[start..end]);
        if INLINED { transform(x, nx, ny, nz, fx, fy, fz) } else { transform_apart(x, nx, ny, nz, fx, fy, fz) }
    }
}

/// [`transform`] as a function of its own: so the compiler knows that the slices do not overlap, and takes several numbers at a time.
#[inline(never)]
fn transform_apart<T: Real>(x: &Transform<T>, nx: &mut [T], ny: &mut [T], nz: &mut [T], fx: &mut [T], fy: &mut [T], fz: &mut [T]) {
    transform(x, nx, ny, nz, fx, fy, fz);
}

/// `F = X* F`, component by component.
#[inline(always)]
fn transform<T: Real>(x: &Transform<T>, nx: &mut [T], ny: &mut [T], nz: &mut [T], fx: &mut [T], fy: &mut [T], fz: &mut [T]) {
    let x = *x;
    for (((nx, ny), nz), ((fx, fy), fz)) in nx.iter_mut().zip(ny).zip(nz).zip(fx.iter_mut().zip(fy).zip(fz)) {
        let f = x.force(Force::new(Vec3::new(*nx, *ny, *nz), Vec3::new(*fx, *fy, *fz)));
        (*nx, *ny, *nz) = (f.ang.x, f.ang.y, f.ang.z);
        (*fx, *fy, *fz) = (f.lin.x, f.lin.y, f.lin.z);
    }
}

/// Some rows of the matrix. `values` is the flat array from number `start` on.
pub(crate) struct Rows<'a, T> {
    pub(crate) rows: &'a [Row],
    pub(crate) values: &'a mut [T],
    pub(crate) start: usize,
}

/// `M_kj = S_jᵀ F_k` for every supported dof k, whose forces begin at `first`. Dof j is column `column` of its joint's motion subspace, and
/// stands at `position` in each of the rows.
#[inline(always)]
pub(crate) fn project<T: Real, P: Real + Lift<T>>(
    kind: JointKind,
    forces: &Forces<T>,
    first: usize,
    subspace: &Motion<P>,
    column: usize,
    position: usize,
    into: Rows<'_, T>,
) {
    let Rows { rows, values, start } = into;
    let (first, last) = (Forces::<T>::LANES + first, Forces::<T>::LANES + first + rows.len());
    let [nx, ny, nz] = forces.ang.each_ref().map(|component| &component[first..last]);
    let [fx, fy, fz] = forces.lin.each_ref().map(|component| &component[first..last]);
    let (ang, lin) = (nx.iter().zip(ny).zip(nz), fx.iter().zip(fy).zip(fz));
    // Without rows the part may end before the position.
    let values = values.get_mut(position..).unwrap_or_default();
    for (row, (((nx, ny), nz), ((fx, fy), fz))) in rows.iter().zip(ang.zip(lin)) {
        let f = Force::new(Vec3::new(*nx, *ny, *nz), Vec3::new(*fx, *fy, *fz));
        values[row.start - start] = match kind {
            JointKind::Revolute(Axis::Z) => f.ang.z,
            JointKind::Prismatic(Axis::Z) => f.lin.z,
            JointKind::Revolute(Axis::Skew) => subspace.ang.lift().dot(f.ang),
            JointKind::Prismatic(Axis::Skew) => subspace.lin.lift().dot(f.lin),
            JointKind::Helical => subspace.lift().dot(f),
            JointKind::Spherical => f.ang.to_array()[column],
            JointKind::Free if column < 3 => f.lin.to_array()[column],
            JointKind::Free => f.ang.to_array()[column - 3],
        };
    }
}

/// An error if an argument or the workspace does not fit the model.
pub(crate) fn expect_shapes<P, T: Real>(model: &Model<P>, workspace: usize, q: &[T], matrix: &TreeSparse<T>) -> Result<(), DimensionError> {
    expect_bodies(model, workspace)?;
    expect("configuration q", model.topology.nq(), q.len())?;
    matrix.expect_topology(&model.topology)
}

/// The joint-space inertia matrix without a workspace of one's own; it allocates.
///
/// # Errors
/// [`DimensionError`] when `q` does not fit the model.
pub fn mass_matrix<T: Real, P: Real + Lift<T>>(model: &Model<P>, q: &[T]) -> Result<TreeSparse<T>, DimensionError> {
    let mut matrix = TreeSparse::new(&model.topology);
    Crba::new(&model.topology).run(model, q, &mut matrix)?;
    Ok(matrix)
}
