//! The Coriolis matrix C(q, v) with `C v = h − g` and `Ṁ = C + Cᵀ`, the rate Ṁ, and Christoffel symbols.
//!
//! Source: S. Echeandia & P. Wensing, *Numerical methods to compute the Coriolis matrix and Christoffel symbols for rigid-body systems*
//! (2021). For a dof j that supports dof i, with the Coriolis operator B of `sweep.rs`:
//!
//! ```text
//! C_ij = S_i · (Iᶜ_i Φ̇_j + Bᶜ_i S_j)      C_ji = S_j · (Iᶜ_i Φ̇_i + Bᶜ_i S_i)      Φ̇_j = v × S_j
//! ```
//!
//! C is linear in v: `C_ij = Σ_k Γ_ijk v_k`. The matrix `Γ_··k = C(q, e_k)` has the Christoffel symbols of the first kind of dof k. They are
//! those of textbooks, `½ (∂_k M_ij + ∂_j M_ik − ∂_i M_jk)`, for joints with one dof. Velocities of quaternion joints are no rates of
//! coordinates; there C is the same operator, and `Ṁ = C + Cᵀ` holds all the same.
//!
//! Frame: one per tree, see `sweep.rs`. Shapes: q has `nq` numbers, v has `nv`; C is `nv`×`nv`, tree-sparse. Units: SI, angles in radians.
//! Armature adds nothing. Cost: O(n + Σ d_k), d_k the depth of dof k; 15 multiply-adds per stored pair of dofs. A call does not allocate.

use super::columns::{PaddedRow, TwoColumns};
use super::sweep::{Link, Sweep};
use crate::error::expect;
use crate::step::by_kind;
use crate::{DimensionError, State, TreePair, TreeSparse};
use featherbench_model::{JointKind, Model, Topology};
use featherbench_spatial::{Lift, Real};

/// The workspace of the Coriolis matrix.
///
/// ```
/// use featherbench_dynamics::{Coriolis, TreePair, TreeSparse, bias_force};
/// use featherbench_model::Model;
/// use featherbench_robots::{Family, StateBatch};
///
/// let model: Model<f64> = Model::build(&Family::parse("humanoid")?.generate()?)?;
/// let states = StateBatch::random(&model, 1, 7);
/// let (q, v, n) = (states.q(0), states.v(0), model.topology.nv());
/// let mut c = TreePair::new(&model.topology);
/// Coriolis::new(&model.topology).run(&model, q, v, &mut c)?;
///
/// // C v is the bias force without gravity.
/// let mut force = vec![0.0; n];
/// c.mul(v, &mut force)?;
/// let (bias, gravity) = (bias_force(&model, q, v)?, bias_force(&model, q, &vec![0.0; n])?);
/// assert!((0..n).all(|i| (force[i] - (bias[i] - gravity[i])).abs() < 1e-11));
///
/// // Ṁ = C + Cᵀ
/// let mut rate = TreeSparse::new(&model.topology);
/// c.symmetric_sum(&mut rate)?;
/// assert_eq!(rate.get(20, 7), c.get(20, 7) + c.get(7, 20));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Coriolis<T> {
    sweep: Sweep<T>,
    /// S and Φ̇ of the dofs on the path to the root.
    path: TwoColumns<T>,
    /// The velocity e_k of Christoffel symbols.
    unit: Vec<T>,
}

impl<T: Real> Coriolis<T> {
    /// A workspace for models of this topology.
    pub fn new(topology: &Topology) -> Self {
        Self { sweep: Sweep::new(topology), path: TwoColumns::new(topology), unit: vec![T::zero(); topology.nv()] }
    }

    /// The Coriolis matrix of configuration `q` and velocity `v`.
    ///
    /// # Errors
    /// [`DimensionError`] when an argument, the workspace or `matrix` does not fit the model.
    #[inline(never)]
    pub fn run<P: Real + Lift<T>>(&mut self, model: &Model<P>, q: &[T], v: &[T], matrix: &mut TreePair<T>) -> Result<(), DimensionError> {
        matrix.expect_topology(&model.topology)?;
        self.sweep.run::<P, true, false>(model, State { q, v, given: &[], wrenches: None })?;
        let Self { sweep, path, .. } = self;
        for (i, joint) in model.topology.joints().iter().enumerate() {
            by_kind!(T, joint.kind, rows, model, i, &sweep.links[i], path, matrix);
        }
        matrix.clear_padding();
        Ok(())
    }

    /// The Christoffel symbols `Γ_ijk` of dof `k` as a matrix in (i, j): `C_ij = Σ_k Γ_ijk v_k`.
    ///
    /// All symbols are `nv` calls, in the time of as many Coriolis matrices.
    ///
    /// # Errors
    /// [`DimensionError`] when an argument, the workspace or `matrix` does not fit the model, or when there is no dof `k`.
    pub fn christoffel<P: Real + Lift<T>>(
        &mut self,
        model: &Model<P>,
        q: &[T],
        k: usize,
        matrix: &mut TreePair<T>,
    ) -> Result<(), DimensionError> {
        let nv = model.topology.nv();
        expect("dofs of the workspace", nv, self.unit.len())?;
        if k >= nv {
            return Err(DimensionError { what: "dofs, for the one that was named", expected: k + 1, found: nv });
        }
        let mut unit = std::mem::take(&mut self.unit);
        unit[k] = T::one();
        let done = self.run(model, q, &unit, matrix);
        unit[k] = T::zero();
        self.unit = unit;
        done
    }
}

/// The rows of one joint's dofs.
#[inline(always)]
fn rows<T: Real, P: Real + Lift<T>>(
    kind: JointKind,
    model: &Model<P>,
    i: usize,
    link: &Link<T>,
    path: &mut TwoColumns<T>,
    matrix: &mut TreePair<T>,
) {
    let first = model.topology.joints()[i].v;
    let top = model.topology.dof_depth(first) - 1;
    let sum = &link.sum;
    for k in 0..kind.nv() {
        let s = link.in_frame(kind, kind.column(&model.subspaces[i], k));
        let rate = link.v.cross_motion(s);
        let row = PaddedRow::of(matrix.triangles_mut().0, first + k);
        // F = Iᶜ S, Iᶜ Φ̇ + Bᶜ S, and Bᶜᵀ S
        path.write(top + k, [s, rate], [sum.inertia.mul(s), sum.inertia.mul(rate) + sum.coriolis(s.ang)], &row, matrix);
        let (lower, upper) = matrix.triangles_mut();
        path.s.ang.add_dot(sum.coriolis_transposed(s), row.of_matrix(lower));
        row.copy_diagonal(lower, upper);
    }
}

/// The Coriolis matrix in a workspace of the call; it allocates.
///
/// # Errors
/// [`DimensionError`] when an argument does not fit the model.
pub fn coriolis_matrix<T: Real, P: Real + Lift<T>>(model: &Model<P>, q: &[T], v: &[T]) -> Result<TreePair<T>, DimensionError> {
    let mut matrix = TreePair::new(&model.topology);
    Coriolis::new(&model.topology).run(model, q, v, &mut matrix)?;
    Ok(matrix)
}

/// The rate of change Ṁ of the joint-space inertia matrix at velocity `v`, in a workspace of the call; it allocates.
///
/// # Errors
/// [`DimensionError`] when an argument does not fit the model.
pub fn mass_matrix_rate<T: Real, P: Real + Lift<T>>(model: &Model<P>, q: &[T], v: &[T]) -> Result<TreeSparse<T>, DimensionError> {
    let mut rate = TreeSparse::new(&model.topology);
    coriolis_matrix(model, q, v)?.symmetric_sum(&mut rate)?;
    Ok(rate)
}
