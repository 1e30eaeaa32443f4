//! Refined forward dynamics: the accelerations to the last digit of `f64`, where every plain algorithm loses digits.
//!
//! A start by the articulated-body algorithm, then iterative refinement (Wilkinson 1963) with the residual in a scalar `R` of one's choice:
//!
//! 1. a ← ABA(τ) in `f64`; its articulated inertias stay for step 3;
//! 2. r ← τ − ID(a) in `R`: with 32 digits this keeps what cancels;
//! 3. δ ← M⁻¹ r by [`Aba::solve`] in `f64`, and a ← a + δ in `R`;
//! 4. each further step: r ← r − M δ in `f64`, and step 3 again.
//!
//! **What it gives.** With `Compensated` or `DoubleDouble` as `R`, one step leaves only the rounding of the result in the 2-norm, with tips up to
//! 10⁶ times as heavy as a link. Two steps do so up to 10⁸. Measured errors and times: `docs/kernels/refined.md`.
//!
//! In the M-norm the rounding of the result is itself not small: 10⁻¹³ on a straight chain of 200, whatever algorithm computed it.
//! [`Refined::accelerations`] are not yet rounded, and right in that norm too.
//!
//! **Why r may be updated in `f64`.** The error of that is 2⁻⁵³ relative to M δ. And δ is as small against a as the error ε of the start.
//! The errors after steps 0, 1, 2, … fall like ε, ε², ε³, … until about 10⁻¹⁵·ε, far below what `f64` can show.
//!
//! **Where the digits are lost.** The loss on heavy tips is in the inward pass. Iᴬ and pᴬ are sums of a heavy part, which cancels in the
//! end, and of a light part, which decides. So U/D and u/D both carry 2⁻⁵³ times the ratio of the masses. The outward pass loses nothing:
//! given both U/D and u/D rounded from exact ones, it is right to the last digits; given only one of them so, it is not.
//! Inverse dynamics has no such sums. So even its `f64` residual recovers nearly everything.
//!
//! **What is solved.** The equations of motion with the numbers of the [`Model`]. Parameters in `f64` are lifted, with first moments and
//! inertias about the bodies' origins as `Model<f64>::build` rounded them. For the robot as its description says it, build and pass a
//! `Model<DoubleDouble>`. Then steps 1, 3 and 4 round its parameters, but step 2 does not, and so the result is the description's.
//! States are exact. A quaternion stands for the rotation of the normalized one; axes and placements stand for the rotations that
//! [`featherbench_model::Description::canonical`] says.
//!
//! **Many states.** With registers as scalars, one state per lane, the residual is in `Compensated` registers. The operations on each lane are
//! those of `Refined<Compensated>`, except sine and cosine in step 1 ([`crate::Batch`]). So the starts differ by a few roundings, and the
//! accelerations before rounding by about the error that is left in them. After rounding they are the same to the bit, unless the exact
//! result lies so near to the middle of two numbers.
//!
//! Frames, shapes and units: as in [`Aba`]. Cost: O(n). A call does not allocate.

use crate::error::expect;
use crate::step::{add_joint, parent_link};
use crate::{Aba, DimensionError, Error, Rnea};
use featherbench_model::{Model, Topology};
use featherbench_spatial::{Compensated, Force, Lift, Motion, Real};

/// The workspace of refined forward dynamics of states in `T`, with the residual in `R`.
///
/// ```
/// use featherbench_dynamics::{Refined, refined_forward_dynamics};
/// use featherbench_model::Model;
/// use featherbench_robots::{Family, StateBatch};
/// use featherbench_spatial::Compensated;
/// use wide::f64x4;
///
/// let model: Model<f64> = Model::build(&Family::parse("humanoid")?.generate()?)?;
/// let states = StateBatch::random(&model, 4, 1);
/// let alone = refined_forward_dynamics(&model, states.q(2), states.v(2), states.tau(2), 1)?;
///
/// // Four states at once.
/// let lanes = |state: &dyn Fn(usize, usize) -> f64, count| -> Vec<f64x4> {
///     (0..count).map(|k| f64x4::new([0, 1, 2, 3].map(|lane| state(lane, k)))).collect()
/// };
/// let (nq, nv) = (model.topology.nq(), model.topology.nv());
/// let (q, v) = (lanes(&|lane, k| states.q(lane)[k], nq), lanes(&|lane, k| states.v(lane)[k], nv));
/// let (tau, mut a) = (lanes(&|lane, k| states.tau(lane)[k], nv), vec![f64x4::ZERO; nv]);
/// Refined::<Compensated<f64x4>, f64x4>::new(&model.topology, 1).run(&model, &q, &v, &tau, None, &mut a)?;
/// for (together, alone) in a.iter().zip(&alone) {
///     assert!((together.to_array()[2] - alone).abs() <= f64::EPSILON * alone.abs());
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Refined<R = Compensated, T = f64> {
    steps: usize,
    aba: Aba<T>,
    rnea: Rnea<R>,
    /// The state, the accelerations and the wrenches in `R`, and the joint forces that these accelerations take.
    q: Vec<R>,
    v: Vec<R>,
    a: Vec<R>,
    wrenches: Vec<Force<R>>,
    taken: Vec<R>,
    /// Residual r and correction δ.
    residual: Vec<T>,
    correction: Vec<T>,
    product: MassProduct<T>,
}

impl<R: Real + Lift<T>, T: Real + Lift<R>> Refined<R, T> {
    /// A workspace for models of this topology that refines in `steps` steps. One step is enough where the plain algorithm keeps nine
    /// digits, two where it keeps six. With 0 steps it is the plain algorithm.
    pub fn new(topology: &Topology, steps: usize) -> Self {
        let (nq, nv, bodies) = (topology.nq(), topology.nv(), topology.bodies());
        let zeros = |count| vec![R::zero(); count];
        Self {
            steps,
            aba: Aba::new(topology),
            rnea: Rnea::new(topology),
            q: zeros(nq),
            v: zeros(nv),
            a: zeros(nv),
            wrenches: vec![Force::zero(); bodies],
            taken: zeros(nv),
            residual: vec![T::zero(); nv],
            correction: vec![T::zero(); nv],
            product: MassProduct { motions: vec![Motion::zero(); bodies + 1], forces: vec![Force::zero(); bodies] },
        }
    }

    /// The accelerations `a` at configuration `q`, velocity `v`, joint forces `tau` and external wrenches.
    ///
    /// # Errors
    /// [`Error`] when an argument or the workspace does not fit the model, or when a joint meets no inertia; `a` is not valid then, except
    /// in lanes whose joints meet inertia.
    #[inline(never)]
    pub fn run<P: Real + Lift<T> + Lift<R>>(
        &mut self,
        model: &Model<P>,
        q: &[T],
        v: &[T],
        tau: &[T],
        wrenches: Option<&[Force<T>]>,
        a: &mut [T],
    ) -> Result<(), Error> {
        self.expect_shapes(&model.topology)?;
        let started = self.aba.run(model, q, v, tau, wrenches, a);
        if let Err(Error::Dimension(_)) = started {
            return started;
        }
        lift_into(a, &mut self.a);
        self.correction.fill(T::zero());

        for step in 0..self.steps {
            if step == 0 {
                self.evaluate_residual(model, q, v, tau, wrenches)?;
            } else {
                // r −= M δ
                self.product.subtract(model, &self.aba, &self.correction, &mut self.residual);
            }
            self.aba.solve(model, &self.residual, &mut self.correction)?;
            for (a, correction) in self.a.iter_mut().zip(&self.correction) {
                *a += correction.lift();
            }
        }
        for (a, refined) in a.iter_mut().zip(&self.a) {
            *a = refined.lift();
        }
        started
    }

    /// Refines in so many steps from now on.
    pub(crate) fn set_steps(&mut self, steps: usize) {
        self.steps = steps;
    }

    /// The accelerations of the last run before they were rounded.
    pub fn accelerations(&self) -> &[R] {
        &self.a
    }

    /// The correction δ of the last step of the last run: an estimate of the error before that step, and so a bound on what is left.
    pub fn correction(&self) -> &[T] {
        &self.correction
    }

    /// r = τ − ID(a).
    fn evaluate_residual<P: Real + Lift<R>>(
        &mut self,
        model: &Model<P>,
        q: &[T],
        v: &[T],
        tau: &[T],
        wrenches: Option<&[Force<T>]>,
    ) -> Result<(), DimensionError> {
        lift_into(q, &mut self.q);
        lift_into(v, &mut self.v);
        let wrenches = wrenches.map(|wrenches| {
            for (lifted, wrench) in self.wrenches.iter_mut().zip(wrenches) {
                *lifted = wrench.lift();
            }
            &self.wrenches[..]
        });
        self.rnea.run(model, &self.q, &self.v, &self.a, wrenches, &mut self.taken)?;
        for ((residual, tau), taken) in self.residual.iter_mut().zip(tau).zip(&self.taken) {
            let difference: R = tau.lift() - *taken;
            *residual = difference.lift();
        }
        Ok(())
    }

    fn expect_shapes(&self, topology: &Topology) -> Result<(), DimensionError> {
        expect("configuration numbers of the workspace", topology.nq(), self.q.len())?;
        expect("dofs of the workspace", topology.nv(), self.a.len())
    }
}

/// The product M x by inverse dynamics at rest without gravity.
#[derive(Clone, Debug)]
struct MassProduct<T> {
    /// Accelerations of the world and the bodies.
    motions: Vec<Motion<T>>,
    /// Force across each joint.
    forces: Vec<Force<T>>,
}

impl<T: Real> MassProduct<T> {
    /// `y −= M x` at the configuration of the last run of `aba`.
    fn subtract<P: Real + Lift<T>>(&mut self, model: &Model<P>, aba: &Aba<T>, x: &[T], y: &mut [T]) {
        let joints = model.topology.joints();
        // outward: a_i = X a_p + S x,  f_i = I a_i
        for (i, joint) in joints.iter().enumerate() {
            let carried = aba.placement(model, i).inverse_motion(self.motions[parent_link(joint)]);
            let motion = add_joint(joint.kind, carried, joint.kind.motion(&model.subspaces[i], &x[joint.v..]));
            let inertia = model.inertias[i].lift::<T>();
            (self.motions[i + 1], self.forces[i]) = (motion, inertia.mul(motion));
        }
        // inward: y_i −= Sᵀ f_i,  f_p += X* f_i
        for (i, joint) in joints.iter().enumerate().rev() {
            let (force, mut across) = (self.forces[i], [T::zero(); 6]);
            joint.kind.project(&model.subspaces[i], force, &mut across);
            for (y, across) in y[joint.v..].iter_mut().zip(&across[..joint.kind.nv()]) {
                *y -= *across;
            }
            if let Some(parent) = joint.parent {
                self.forces[parent] += aba.placement(model, i).force(force);
            }
        }
        for ((y, x), armature) in y.iter_mut().zip(x).zip(&model.armature) {
            let armature: T = armature.lift();
            *y = (-armature).mul_add(*x, *y);
        }
    }
}

fn lift_into<T: Lift<R>, R>(numbers: &[T], lifted: &mut [R]) {
    for (lifted, number) in lifted.iter_mut().zip(numbers) {
        *lifted = number.lift();
    }
}

/// Forward dynamics refined by a residual of 32 digits, in a workspace of the call and without external wrenches; it allocates.
///
/// # Errors
/// [`Error`] when an argument does not fit the model, or a joint meets no inertia.
pub fn refined_forward_dynamics<P: Real + Lift<f64> + Lift<Compensated>>(
    model: &Model<P>,
    q: &[f64],
    v: &[f64],
    tau: &[f64],
    steps: usize,
) -> Result<Vec<f64>, Error> {
    let mut a = vec![0.0; model.topology.nv()];
    Refined::<Compensated>::new(&model.topology, steps).run(model, q, v, tau, None, &mut a)?;
    Ok(a)
}
