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
use crate::step::{add_joint, by_kind, cross_joint, expect_workspace, expect_wrenches, newton_euler};
use featherbench_model::{JointKind, Model, Topology};
use featherbench_spatial::{Force, Lift, Motion, Real, Transform, Vec3};

/// The workspace of inverse dynamics.
#[derive(Clone, Debug)]
pub struct Rnea<T> {
    /// Of each body.
    pub(crate) links: Vec<Link<T>>,
    /// Of the bodies on the path that the outward recursion is on, by path slot ([`Joint::slot`](featherbench_model::Joint::slot)).
    pub(crate) path: Vec<Moving<T>>,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Link<T> {
    /// Placement in the parent: what [`JointKind::keep`] keeps of it.
    pub(crate) x: Transform<T>,
    /// Force f transmitted across the joint.
    pub(crate) f: Force<T>,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Moving<T> {
    /// Angular velocity ω.
    pub(crate) omega: Vec3<T>,
    /// Classical acceleration a.
    pub(crate) a: Motion<T>,
}

/// What the recursions read; `a` is not read where the bodies are not accelerated.
pub(crate) struct Inputs<'a, P, T> {
    pub(crate) model: &'a Model<P>,
    pub(crate) q: &'a [T],
    pub(crate) v: &'a [T],
    pub(crate) a: &'a [T],
    pub(crate) wrenches: Option<&'a [Force<T>]>,
}

impl<T: Real> Moving<T> {
    pub(crate) fn at_rest() -> Self {
        Self { omega: Vec3::zero(), a: Motion::zero() }
    }
}

impl<T: Real> Rnea<T> {
    /// A workspace for models of this topology.
    pub fn new(topology: &Topology) -> Self {
        let link = Link { x: Transform::identity(), f: Force::zero() };
        Self { links: vec![link; topology.bodies()], path: vec![Moving::at_rest(); topology.slots()] }
    }

    /// The joint forces `tau` of configuration `q`, velocity `v`, acceleration `a` and external wrenches.
    ///
    /// # Errors
    /// [`DimensionError`] when an argument or the workspace does not fit the model.
    #[inline(never)]
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
    #[inline(always)]
    pub(crate) fn recurse<P: Real + Lift<T>, const ACCELERATED: bool>(
        &mut self,
        model: &Model<P>,
        q: &[T],
        v: &[T],
        a: &[T],
        wrenches: Option<&[Force<T>]>,
        tau: &mut [T],
    ) -> Result<(), DimensionError> {
        let Self { links, path } = self;
        expect_workspace(model, links.len(), path.len())?;
        let inputs = Inputs { model, q, v, a, wrenches };
        inputs.expect_shapes(tau)?;
        let joints = model.topology.joints();

        path[0].a.lin = -model.gravity.lift();

        for (i, link) in links.iter_mut().enumerate() {
            inputs.outward::<ACCELERATED>(i, path, link);
        }

        // inward: τ_i = Sᵀ f_i,  f_p += X* f_i
        let mut passed = None;
        for (i, joint) in joints.iter().enumerate().rev() {
            by_kind!(T, joint.kind, inward, model, i, links, tau, &mut passed);
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

impl<P: Real + Lift<T>, T: Real> Inputs<'_, P, T> {
    /// An error if an argument but the acceleration does not fit the model.
    pub(crate) fn expect_shapes(&self, tau: &[T]) -> Result<(), DimensionError> {
        let topology = &self.model.topology;
        expect("configuration q", topology.nq(), self.q.len())?;
        expect("velocity v", topology.nv(), self.v.len())?;
        expect("joint forces tau", topology.nv(), tau.len())?;
        expect_wrenches(topology, self.wrenches)
    }

    /// The outward step of one body: `v_i = X v_p + S q̇,  a_i = X a_p + S q̈ + c,  f_i = I a_i + v_i ×* I v_i − f_ext`.
    #[inline(always)]
    pub(crate) fn outward<const ACCELERATED: bool>(&self, i: usize, path: &mut [Moving<T>], link: &mut Link<T>) {
        by_kind!(T, self.model.topology.joints()[i].kind, outward::<T, P, ACCELERATED>, self, i, path, link);
        if let Some(wrenches) = self.wrenches {
            link.f -= self.model.labels[i].force_to_compiled(wrenches[i]);
        }
    }
}

/// The same without external wrenches.
#[inline(always)]
fn outward<T: Real, P: Real + Lift<T>, const ACCELERATED: bool>(
    kind: JointKind,
    inputs: &Inputs<'_, P, T>,
    i: usize,
    path: &mut [Moving<T>],
    link: &mut Link<T>,
) {
    let Inputs { model, q, v, a, .. } = *inputs;
    let (joint, subspace) = (&model.topology.joints()[i], &model.subspaces[i]);
    let (parent, dof) = (&path[joint.parent_slot], joint.v);
    let x = kind.transform(&model.placements[i], subspace, &q[joint.q..]);
    kind.keep(&x, &mut link.x);
    let joint_velocity = kind.motion(subspace, &v[dof..]);
    let (omega, mut acceleration) = cross_joint(kind, &x, parent.omega, Some(parent.a), joint_velocity);
    if ACCELERATED {
        acceleration = add_joint(kind, acceleration, kind.motion(subspace, &a[dof..]));
    }
    path[joint.slot] = Moving { omega, a: acceleration };
    link.f = newton_euler(&model.inertias[i].lift(), omega, Some(acceleration));
}

/// The inward step of one body: τ, and what its parent's force gets. `passed` is what a body gives to the one before it.
#[inline(always)]
fn inward<T: Real, P: Real + Lift<T>>(
    kind: JointKind,
    model: &Model<P>,
    i: usize,
    links: &mut [Link<T>],
    tau: &mut [T],
    passed: &mut Option<Force<T>>,
) {
    let (joint, Link { x, f }) = (&model.topology.joints()[i], &links[i]);
    let f = passed.take().map_or(*f, |passed| *f + passed);
    kind.project(&model.subspaces[i], f, &mut tau[joint.v..]);
    if let Some(parent) = joint.parent {
        let moved = kind.recall(&model.placements[i], x).force(f);
        if parent + 1 == i {
            *passed = Some(moved);
        } else {
            links[parent].f += moved;
        }
    }
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
