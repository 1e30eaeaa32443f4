//! Inverse dynamics by the recursive Newton–Euler algorithm: `τ = M(q) v̇ + h(q, v) − Σ Jᵀf`.
//!
//! Source: the book, table 5.1, in the three-dimensional form of Luh, Walker & Paul (1980), which needs no linear velocity.
//! Accelerations are classical (see `step.rs`). So `v ×* I v` stands for [ω × Ī ω; ω × (ω × h)] in the comments below.
//! Frames: each body's quantities are in its own axes, as compiled, at its own origin. External wrenches [moment; force], one per compiled
//! body, are in the described axes ([`Model::labels`]).
//! Gravity enters as an acceleration −g of the base. Armature adds `armature_k · v̇_k`.
//! Shapes: q has `nq` numbers; v, a and τ have `nv`. Units: SI, angles in radians. Cost: O(n). A call does not allocate.

use crate::DimensionError;
use crate::error::expect;
use crate::step::{add_joint, by_kind, cross_joint, expect_bodies, expect_wrenches, newton_euler, parent_link};
use featherbench_model::{JointKind, Model, Topology};
use featherbench_spatial::{Force, Lift, Motion, Real, Transform, Vec3};

/// The workspace of inverse dynamics.
#[derive(Clone, Debug)]
pub struct Rnea<T> {
    /// Link 0 is the world; link i + 1 is body i.
    links: Vec<Link<T>>,
}

#[derive(Clone, Copy, Debug)]
struct Link<T> {
    /// Placement in the parent.
    x: Transform<T>,
    /// Angular velocity ω.
    omega: Vec3<T>,
    /// Classical acceleration a.
    a: Motion<T>,
    /// Force f transmitted across the joint.
    f: Force<T>,
}

impl<T: Real> Rnea<T> {
    /// A workspace for models of this topology.
    pub fn new(topology: &Topology) -> Self {
        let rest = Link { x: Transform::identity(), omega: Vec3::zero(), a: Motion::zero(), f: Force::zero() };
        Self { links: vec![rest; topology.bodies() + 1] }
    }

    /// The joint forces `tau` of configuration `q`, velocity `v`, acceleration `a` and external wrenches.
    ///
    /// # Errors
    /// [`DimensionError`] when an argument or the workspace does not fit the model.
    pub fn run<P: Real + Lift<T>>(
        &mut self,
        model: &Model<P>,
        q: &[T],
        v: &[T],
        a: &[T],
        wrenches: Option<&[Force<T>]>,
        tau: &mut [T],
    ) -> Result<(), DimensionError> {
        expect("acceleration a", model.topology.nv(), a.len())?;
        self.recurse::<P, true>(model, q, v, a, wrenches, tau)
    }

    /// Inverse dynamics if `ACCELERATED`; otherwise the bias force, and `a` is not read.
    pub(crate) fn recurse<P: Real + Lift<T>, const ACCELERATED: bool>(
        &mut self,
        model: &Model<P>,
        q: &[T],
        v: &[T],
        a: &[T],
        wrenches: Option<&[Force<T>]>,
        tau: &mut [T],
    ) -> Result<(), DimensionError> {
        expect_bodies(model, self.links.len() - 1)?;
        expect("configuration q", model.topology.nq(), q.len())?;
        expect("velocity v", model.topology.nv(), v.len())?;
        expect("joint forces tau", model.topology.nv(), tau.len())?;
        expect_wrenches(model, wrenches)?;
        let joints = model.topology.joints();

        // X_i: placement of each body in its parent
        self.links[0].a.lin = -model.gravity.lift();

        // outward: v_i = X v_p + S q̇,  a_i = X a_p + S q̈ + c,  f_i = I a_i + v_i ×* I v_i − f_ext
        for (i, joint) in joints.iter().enumerate() {
            let (before, rest) = self.links.split_at_mut(i + 1);
            let (parent, link) = (&before[parent_link(joint)], &mut rest[0]);
            by_kind!(joint.kind, outward::<T, P, ACCELERATED>, model, i, parent, q, v, a, link);
            if let Some(wrenches) = wrenches {
                link.f -= model.labels[i].force_to_compiled(wrenches[i]);
            }
        }

        // inward: τ_i = Sᵀ f_i,  f_p += X* f_i
        let mut passed = None;
        for (i, joint) in joints.iter().enumerate().rev() {
            let Link { x, f, .. } = &self.links[i + 1];
            let f = passed.take().map_or(*f, |passed| *f + passed);
            joint.kind.project(&model.subspaces[i], f, &mut tau[joint.v..]);
            if let Some(parent) = joint.parent {
                let moved = x.force(f);
                if parent + 1 == i {
                    passed = Some(moved);
                } else {
                    self.links[parent + 1].f += moved;
                }
            }
        }
        if ACCELERATED {
            // τ_k += armature_k q̈_k
            for ((tau, a), armature) in tau.iter_mut().zip(a).zip(&model.armature) {
                *tau = a.mul_add(armature.lift(), *tau);
            }
        }
        Ok(())
    }
}

/// The outward step of one body: its placement, ω, a and f.
#[inline(always)]
#[expect(clippy::too_many_arguments, reason = "one body's step reads the model and the inputs, and writes its link")]
fn outward<T: Real, P: Real + Lift<T>, const ACCELERATED: bool>(
    kind: JointKind,
    model: &Model<P>,
    i: usize,
    parent: &Link<T>,
    q: &[T],
    v: &[T],
    a: &[T],
    link: &mut Link<T>,
) {
    let (dof, subspace) = (model.topology.joints()[i].v, &model.subspaces[i]);
    link.x = kind.transform(&model.placements[i], subspace, &q[model.topology.joints()[i].q..]);
    let joint_velocity = kind.motion(subspace, &v[dof..]);
    (link.omega, link.a) = cross_joint(kind, &link.x, parent.omega, Some(parent.a), joint_velocity);
    if ACCELERATED {
        link.a = add_joint(kind, link.a, kind.motion(subspace, &a[dof..]));
    }
    link.f = newton_euler(&model.inertias[i].lift(), link.omega, Some(link.a));
}

/// Inverse dynamics that makes its own workspace, without external wrenches; it allocates.
///
/// # Errors
/// [`DimensionError`] when an argument does not fit the model.
pub fn inverse_dynamics<T: Real, P: Real + Lift<T>>(model: &Model<P>, q: &[T], v: &[T], a: &[T]) -> Result<Vec<T>, DimensionError> {
    let mut tau = vec![T::zero(); model.topology.nv()];
    Rnea::new(&model.topology).run(model, q, v, a, None, &mut tau)?;
    Ok(tau)
}
