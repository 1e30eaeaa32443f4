//! First derivatives of inverse dynamics: ∂τ/∂q, ∂τ/∂v and ∂τ/∂a = M.
//!
//! Sources: J. Carpentier & N. Mansard, *Analytical derivatives of rigid body dynamics algorithms* (2018); S. Singh, R. Russell &
//! P. Wensing, *Efficient analytical derivatives of rigid-body dynamics using spatial vector algebra* (2022), whose closed form this is.
//! The Coriolis operator B has twelve numbers here in place of 36 (see `sweep.rs`).
//!
//! For a dof j that supports dof i, of the same joint or of one nearer to the root:
//!
//! ```text
//! ∂τ_i/∂q_j = S_i · (2 Bᶜ_i Ψ̇_j + Iᶜ_i Ψ̈_j)
//! ∂τ_j/∂q_i = S_j · (2 Bᶜ_i Ψ̇_i + Iᶜ_i Ψ̈_i + S_i ×* fᶜ_i)        without the last term within a joint
//! ∂τ_i/∂v_j = S_i · (2 Bᶜ_i S_j + Iᶜ_i (Ψ̇_j + Φ̇_j))
//! ∂τ_j/∂v_i = S_j · (2 Bᶜ_i S_i + Iᶜ_i (Ψ̇_i + Φ̇_i))
//! M_ij = S_j · Iᶜ_i S_i
//!
//! Ψ̇_j = v_p × S_j      Ψ̈_j = a_p × S_j + v_p × Ψ̇_j      Φ̇_j = v × S_j
//! ```
//!
//! v and a are the velocity and acceleration of the body of dof j, v_p and a_p of its parent; Iᶜ, Bᶜ and fᶜ are sums over the sub-tree.
//! External wrenches are constant in body axes, as [`Rnea`](crate::Rnea) has them: they turn with their bodies, and are a part of fᶜ.
//!
//! Frames: one per tree, see `sweep.rs`; q moves on the tangent space of the configurations, as `v = e_j` moves it.
//! Shapes: q has `nq` numbers; v and a have `nv`. Each result is `nv`×`nv`, tree-sparse. Units: SI, angles in radians.
//! Cost: O(n + Σ d_k), d_k the depth of dof k; 36 multiply-adds per stored pair of dofs. A call does not allocate.

use super::columns::{Columns, Components, PaddedRow, deepest};
use super::sweep::{Link, Sweep};
use crate::step::by_kind;
use crate::{DimensionError, State, TreePair, TreeSparse};
use featherbench_model::{JointKind, Model, Topology};
use featherbench_spatial::{Force, Lift, Motion, Real};

/// First derivatives of inverse dynamics.
#[derive(Clone, Debug, PartialEq)]
pub struct IdPartials<T> {
    /// ∂τ/∂q on the tangent space of the configurations.
    pub q: TreePair<T>,
    /// ∂τ/∂v.
    pub v: TreePair<T>,
    /// ∂τ/∂a = M, armature included.
    pub a: TreeSparse<T>,
}

impl<T: Real> IdPartials<T> {
    /// Zero derivatives for models of this topology.
    pub fn new(topology: &Topology) -> Self {
        Self { q: TreePair::new(topology), v: TreePair::new(topology), a: TreeSparse::new(topology) }
    }
}

/// The workspace of the derivatives of inverse dynamics.
///
/// ```
/// use featherbench_dynamics::{IdDerivatives, IdPartials, inverse_dynamics};
/// use featherbench_model::Model;
/// use featherbench_robots::{Family, StateBatch};
///
/// let model: Model<f64> = Model::build(&Family::parse("chain:n=5,layout=spatial")?.generate()?)?;
/// let states = StateBatch::random(&model, 1, 7);
/// let (q, v, a) = (states.q(0), states.v(0), states.a(0));
/// let mut partials = IdPartials::new(&model.topology);
/// IdDerivatives::new(&model.topology).run(&model, q, v, a, None, &mut partials)?;
///
/// // What a step of 1e-6 in q₂ does to the joint forces.
/// let moved = |step: f64| {
///     let mut q = q.to_vec();
///     q[2] += step;
///     inverse_dynamics(&model, &q, v, a)
/// };
/// let (ahead, behind) = (moved(1e-6)?, moved(-1e-6)?);
/// for i in 0..5 {
///     assert!((partials.q.get(i, 2) - (ahead[i] - behind[i]) / 2e-6).abs() < 1e-6);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Cost
///
/// Operations per revolute joint about z of its body, and per stored pair of dofs, counted with [`Counted`](featherbench_spatial::Counted). Rows
/// are computed in whole registers: for `f64`, a row of d pairs counts as d rounded up to a multiple of eight.
///
/// | | per joint: sums, products, multiply-adds | per pair: products, multiply-adds |
/// |---|---|---|
/// | derivatives of ID | 100, 176, 299 | 5, 31 |
/// | [`Coriolis`](crate::Coriolis) | 57, 101, 191 | 2, 13 |
/// | [`IdHessian`](crate::IdHessian) | 229, 341, 599 | 6, 45 |
/// | [`Regressor::torque`](crate::Regressor::torque) | 75, 152, 335 | 10, 32 |
///
/// ```
/// use featherbench_dynamics::id_derivatives;
/// use featherbench_model::Model;
/// use featherbench_robots::{Family, StateBatch};
/// use featherbench_spatial::Counted;
///
/// let count = |n: usize| {
///     let model: Model<f64> = Model::build(&Family::parse(&format!("chain:n={n},layout=spatial"))?.generate()?)?;
///     let states = StateBatch::random(&model, 1, 1);
///     let [q, v, a] = [states.q(0), states.v(0), states.a(0)].map(|x| x.iter().map(|&x| Counted(x)).collect::<Vec<_>>());
///     let counts = Counted::count(|| drop(id_derivatives(&model, &q, &v, &a).expect("the sizes are the model's")));
///     Ok::<_, Box<dyn std::error::Error>>([counts.additions, counts.multiplications, counts.fused].map(|count| count as usize))
/// };
/// let pairs = |n: usize| (1..=n).map(|d| d.next_multiple_of(8)).sum::<usize>();
/// let ([sums, products, fused], more) = (count(32)?, count(64)?);
/// assert_eq!(more, [sums + 32 * 100, products + 32 * 176 + 5 * (pairs(64) - pairs(32)), fused + 32 * 299 + 31 * (pairs(64) - pairs(32))]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct IdDerivatives<T> {
    sweep: Sweep<T>,
    path: Path<T>,
}

/// Columns of the dofs on the path to the root.
#[derive(Clone, Debug)]
struct Path<T> {
    /// S.
    s: Columns<T>,
    /// The angular part of Ψ̇.
    psi_rate: Components<T>,
    /// Ψ̇ + Φ̇.
    v: Columns<T>,
    /// Ψ̈.
    a: Columns<T>,
}

impl<T: Real> IdDerivatives<T> {
    /// A workspace for models of this topology.
    pub fn new(topology: &Topology) -> Self {
        let deepest = deepest(topology);
        let columns = || Columns::new(deepest);
        let path = Path { s: columns(), psi_rate: Components::new(deepest), v: columns(), a: columns() };
        Self { sweep: Sweep::new(topology), path }
    }

    /// The derivatives at configuration `q`, velocity `v`, acceleration `a` and external wrenches.
    ///
    /// # Errors
    /// [`DimensionError`] when an argument, the workspace or `partials` does not fit the model.
    #[inline(never)]
    pub fn run<P: Real + Lift<T>>(
        &mut self,
        model: &Model<P>,
        q: &[T],
        v: &[T],
        a: &[T],
        wrenches: Option<&[Force<T>]>,
        partials: &mut IdPartials<T>,
    ) -> Result<(), DimensionError> {
        partials.q.expect_topology(&model.topology)?;
        partials.v.expect_topology(&model.topology)?;
        partials.a.expect_topology(&model.topology)?;
        self.sweep.run::<P, true, true>(model, State { q, v, given: a, wrenches })?;

        for (i, joint) in model.topology.joints().iter().enumerate() {
            by_kind!(T, joint.kind, rows, model, i, &self.sweep.links[i], &mut self.path, partials);
        }
        for (k, armature) in model.armature.iter().enumerate() {
            partials.a.add_to_diagonal(k, armature.lift());
        }
        partials.q.clear_padding();
        partials.v.clear_padding();
        partials.a.clear_padding();
        Ok(())
    }
}

/// The rows of one joint's dofs.
#[inline(always)]
fn rows<T: Real, P: Real + Lift<T>>(
    kind: JointKind,
    model: &Model<P>,
    i: usize,
    link: &Link<T>,
    path: &mut Path<T>,
    partials: &mut IdPartials<T>,
) {
    let two = T::from_f64(2.0);
    let first = model.topology.joints()[i].v;
    let top = model.topology.dof_depth(first) - 1;
    for k in 0..kind.nv() {
        let (dof, position) = (first + k, top + k);
        let s = link.in_frame(kind, kind.column(&model.subspaces[i], k));
        let psi = link.parent_v.cross_motion(s);
        // Φ̇ = Ψ̇ where one column spans the joint
        let sum = if kind.nv() == 1 { psi * two } else { psi + link.v.cross_motion(s) };
        let psi_dot = link.parent_a.cross_motion(s) + link.parent_v.cross_motion(psi);
        path.s.set(position, s);
        path.psi_rate.set(position, psi.ang);
        path.v.set(position, sum);
        path.a.set(position, psi_dot);

        let body = &link.sum;
        // F = Iᶜ S,  2 Bᶜᵀ S
        let f = body.inertia.mul(s);
        let b = body.coriolis_transposed(s) * two;
        // 2 Bᶜ Ψ̇ + Iᶜ Ψ̈, and S ×* fᶜ
        let by_q = body.coriolis(psi.ang) * two + body.inertia.mul(psi_dot);
        let carried = s.cross_force(body.force);
        // 2 Bᶜ S + Iᶜ (Ψ̇ + Φ̇)
        let by_v = body.coriolis(s.ang) * two + body.inertia.mul(sum);

        let row = PaddedRow::of(&partials.a, dof);
        let IdPartials { q, v, a } = partials;
        path.s.dot(f, row.of_matrix(a));
        let (lower, upper) = q.triangles_mut();
        path.a.dot(f, row.of_matrix(lower));
        path.psi_rate.add_dot(b, row.of_matrix(lower));
        path.s.dot(by_q + carried, row.of_matrix(upper));
        within_joint(kind, &model.subspaces[i], link, by_q, k, row.exact(upper));
        row.copy_diagonal(lower, upper);
        let (lower, upper) = v.triangles_mut();
        path.v.dot(f, row.of_matrix(lower));
        path.s.ang.add_dot(b, row.of_matrix(lower));
        path.s.dot(by_v, row.of_matrix(upper));
        row.copy_diagonal(lower, upper);
    }
}

/// Within a joint the columns are constant in body axes: `∂τ_j/∂q_i` is without `S_i ×* fᶜ_i`.
#[inline(always)]
pub(super) fn within_joint<T: Real, P: Real + Lift<T>>(
    kind: JointKind,
    subspace: &Motion<P>,
    link: &Link<T>,
    by_q: Force<T>,
    dofs: usize,
    row: &mut [T],
) {
    let top = row.len() - 1 - dofs;
    for (k, entry) in row[top..].iter_mut().enumerate().take(dofs) {
        *entry = link.in_frame(kind, kind.column(subspace, k)).dot(by_q);
    }
}

/// The derivatives of inverse dynamics in a workspace of the call, without external wrenches; it allocates.
///
/// # Errors
/// [`DimensionError`] when an argument does not fit the model.
pub fn id_derivatives<T: Real, P: Real + Lift<T>>(model: &Model<P>, q: &[T], v: &[T], a: &[T]) -> Result<IdPartials<T>, DimensionError> {
    let mut partials = IdPartials::new(&model.topology);
    IdDerivatives::new(&model.topology).run(model, q, v, a, None, &mut partials)?;
    Ok(partials)
}
