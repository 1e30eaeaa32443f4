//! The gradient of the joint-space inertia matrix times a vector: `∂(M x)/∂q`, and `∂M/∂q_k` times x for every k, without the tensor.
//!
//! Source: the derivatives of inverse dynamics (Singh, Russell & Wensing, 2022) at v = 0 and without gravity, where `ID(q, 0, x) = M x`. For
//! a dof j that supports dof i:
//!
//! ```text
//! ∂(M x)_i/∂q_j = F_i · Ψ̈_j      ∂(M x)_j/∂q_i = S_j · (Iᶜ_i Ψ̈_i + S_i ×* fᶜ_i)      F_i = Iᶜ_i S_i,  Ψ̈_j = a_p × S_j
//! ```
//!
//! a and fᶜ are accelerations and forces of x; the last term is absent within a joint. Column k is `(∂M/∂q_k) x`. So `∂M/∂q·x` as a matrix in
//! (i, k) is this result, and `Σ_k (∂M/∂q_k) y_k x` is its product with y.
//!
//! Frame: one per tree, see `sweep.rs`; q moves on the tangent space of the configurations. Shapes: q has `nq` numbers, x has `nv`; the
//! result is `nv`×`nv`, tree-sparse. Units: SI. Armature adds nothing. Cost: O(n + Σ d_k); 12 multiply-adds per stored pair of dofs. A call
//! does not allocate.

use super::columns::{PaddedRow, TwoColumns};
use super::id::within_joint;
use super::sweep::{Link, State, Sweep};
use crate::step::by_kind;
use crate::{DimensionError, TreePair};
use featherbench_model::{JointKind, Model, Topology};
use featherbench_spatial::{Lift, Real};

/// The workspace of the gradient of the joint-space inertia matrix.
///
/// ```
/// use featherbench_dynamics::{MassGradient, TreePair, mass_matrix};
/// use featherbench_model::Model;
/// use featherbench_robots::{Family, StateBatch};
///
/// let model: Model<f64> = Model::build(&Family::parse("chain:n=5,layout=spatial")?.generate()?)?;
/// let states = StateBatch::random(&model, 1, 7);
/// let (q, x) = (states.q(0), states.a(0));
/// let mut gradient = TreePair::new(&model.topology);
/// MassGradient::new(&model.topology).run(&model, q, x, &mut gradient)?;
///
/// // What a step of 1e-6 in q₂ does to M x.
/// let moved = |step: f64| {
///     let (mut q, mut y) = (q.to_vec(), [0.0; 5]);
///     q[2] += step;
///     mass_matrix(&model, &q)?.mul(x, &mut y).map(|()| y)
/// };
/// let (ahead, behind) = (moved(1e-6)?, moved(-1e-6)?);
/// assert!((0..5).all(|i| (gradient.get(i, 2) - (ahead[i] - behind[i]) / 2e-6).abs() < 1e-7));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct MassGradient<T> {
    sweep: Sweep<T>,
    /// S and Ψ̈ of the dofs on the path to the root.
    path: TwoColumns<T>,
}

impl<T: Real> MassGradient<T> {
    /// A workspace for models of this topology.
    pub fn new(topology: &Topology) -> Self {
        Self { sweep: Sweep::new(topology), path: TwoColumns::new(topology) }
    }

    /// `∂(M x)/∂q` at configuration `q`, for a constant `x`.
    ///
    /// # Errors
    /// [`DimensionError`] when an argument, the workspace or `gradient` does not fit the model.
    #[inline(never)]
    pub fn run<P: Real + Lift<T>>(&mut self, model: &Model<P>, q: &[T], x: &[T], gradient: &mut TreePair<T>) -> Result<(), DimensionError> {
        gradient.expect_topology(&model.topology)?;
        self.sweep.run::<P, false, true>(model, State { q, v: &[], a: x, wrenches: None, gravity: false })?;
        let Self { sweep, path } = self;
        for (i, joint) in model.topology.joints().iter().enumerate() {
            by_kind!(T, joint.kind, rows, model, i, &sweep.links[i], path, gradient);
        }
        gradient.clear_padding();
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
    path: &mut TwoColumns<T>,
    gradient: &mut TreePair<T>,
) {
    let first = model.topology.joints()[i].v;
    let top = model.topology.dof_depth(first) - 1;
    let sum = &link.sum;
    for k in 0..kind.nv() {
        let s = link.in_frame(kind, kind.column(&model.subspaces[i], k));
        let psi = link.parent_a.cross_motion(s);
        let row = PaddedRow::of(gradient.triangles_mut().0, first + k);
        let own = sum.inertia.mul(psi);
        path.write(top + k, [s, psi], [sum.inertia.mul(s), own + s.cross_force(sum.force)], &row, gradient);
        let (lower, upper) = gradient.triangles_mut();
        within_joint(kind, &model.subspaces[i], link, own, k, row.exact(upper));
        row.copy_diagonal(lower, upper);
    }
}

/// `∂(M x)/∂q` in a workspace of the call; it allocates.
///
/// # Errors
/// [`DimensionError`] when an argument does not fit the model.
pub fn mass_gradient<T: Real, P: Real + Lift<T>>(model: &Model<P>, q: &[T], x: &[T]) -> Result<TreePair<T>, DimensionError> {
    let mut gradient = TreePair::new(&model.topology);
    MassGradient::new(&model.topology).run(model, q, x, &mut gradient)?;
    Ok(gradient)
}
