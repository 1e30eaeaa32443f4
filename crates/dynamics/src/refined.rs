//! Refined forward dynamics: the accelerations to the last digit of `f64`, where every plain algorithm loses digits.
//!
//! A start by the articulated-body algorithm, then iterative refinement (Wilkinson 1963) with the residual in a scalar `R` of one's choice:
//!
//! 1. a ← ABA(τ) in `f64`; its articulated inertias stay for step 3;
//! 2. r ← τ − ID(a) in `R`: with 32 digits this keeps what cancels;
//! 3. δ ← M⁻¹ r by [`Aba::solve`] in `f64`, and a ← a + δ in `R`;
//! 4. each further step: r ← r − M δ in `f64`, and step 3 again.
//!
//! **What it gives and costs**: the largest relative error in the 2-norm, and the time in calls of [`Aba::run`].
//! The errors are over chains of 10 to 512 links and over humanoids with hands of 1 and 1000 kg.
//! The chains are planar, straight and spatial, with tips 10⁻⁶ to 10⁶ times as heavy as a link, with a base 10⁶ m away, and 10³ times as
//! fast.
//! The times are of the 36-dof humanoid, sines and cosines included, measured in alternation.
//!
//! | | largest error | time |
//! |---|---|---|
//! | [`Aba`] | 2·10⁻¹⁰ | 1 |
//! | `Refined<f64>`, 1 step | 5·10⁻¹⁵ | 1.8 |
//! | `Refined<Compensated>`, 1 step | 1.1·10⁻¹⁶, the rounding of the result | 4.0 |
//! | `Refined<Compensated>`, 2 steps | the same, with tips up to 10⁸ times as heavy | 4.5 |
//! | `Refined<DoubleDouble>`, 1 step | as `Compensated` | 6.3 |
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
//! Frames, shapes and units: as in [`Aba`]. Cost: O(n). A call does not allocate.

use crate::error::expect;
use crate::step::{add_joint, parent_link};
use crate::{Aba, DimensionError, Error, Rnea};
use featherbench_model::{Model, Topology};
use featherbench_spatial::{Compensated, Force, Lift, Motion, Real};

/// The workspace of refined forward dynamics, with the residual in `R`.
#[derive(Clone, Debug)]
pub struct Refined<R = Compensated> {
    steps: usize,
    aba: Aba<f64>,
    rnea: Rnea<R>,
    /// The state, the accelerations and the wrenches in `R`, and the joint forces that these accelerations take.
    q: Vec<R>,
    v: Vec<R>,
    a: Vec<R>,
    wrenches: Vec<Force<R>>,
    taken: Vec<R>,
    /// Residual r and correction δ.
    residual: Vec<f64>,
    correction: Vec<f64>,
    product: MassProduct,
}

impl<R: Real + Lift<f64>> Refined<R>
where
    f64: Lift<R>,
{
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
            residual: vec![0.0; nv],
            correction: vec![0.0; nv],
            product: MassProduct { motions: vec![Motion::zero(); bodies + 1], forces: vec![Force::zero(); bodies] },
        }
    }

    /// The accelerations `a` at configuration `q`, velocity `v`, joint forces `tau` and external wrenches.
    ///
    /// # Errors
    /// [`Error`] when an argument or the workspace does not fit the model, or when a joint meets no inertia; `a` is not valid then.
    pub fn run<P: Real + Lift<f64> + Lift<R>>(
        &mut self,
        model: &Model<P>,
        q: &[f64],
        v: &[f64],
        tau: &[f64],
        wrenches: Option<&[Force<f64>]>,
        a: &mut [f64],
    ) -> Result<(), Error> {
        self.expect_shapes(&model.topology)?;
        self.aba.run(model, q, v, tau, wrenches, a)?;
        lift_into(a, &mut self.a);
        self.correction.fill(0.0);

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
        Ok(())
    }

    /// The accelerations of the last run before they were rounded to `f64`.
    pub fn accelerations(&self) -> &[R] {
        &self.a
    }

    /// The correction δ of the last step of the last run: an estimate of the error before that step, and so a bound on what is left.
    pub fn correction(&self) -> &[f64] {
        &self.correction
    }

    /// r = τ − ID(a).
    fn evaluate_residual<P: Real + Lift<R>>(
        &mut self,
        model: &Model<P>,
        q: &[f64],
        v: &[f64],
        tau: &[f64],
        wrenches: Option<&[Force<f64>]>,
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
struct MassProduct {
    /// Accelerations of the world and the bodies.
    motions: Vec<Motion<f64>>,
    /// Force across each joint.
    forces: Vec<Force<f64>>,
}

impl MassProduct {
    /// `y −= M x` at the configuration of the last run of `aba`.
    fn subtract<P: Real + Lift<f64>>(&mut self, model: &Model<P>, aba: &Aba<f64>, x: &[f64], y: &mut [f64]) {
        let joints = model.topology.joints();
        // outward: a_i = X a_p + S x,  f_i = I a_i
        for (i, joint) in joints.iter().enumerate() {
            let carried = aba.placement(i).inverse_motion(self.motions[parent_link(joint)]);
            let motion = add_joint(joint.kind, carried, joint.kind.motion(&model.subspaces[i], &x[joint.v..]));
            let inertia = model.inertias[i].lift::<f64>();
            (self.motions[i + 1], self.forces[i]) = (motion, inertia.mul(motion));
        }
        // inward: y_i −= Sᵀ f_i,  f_p += X* f_i
        for (i, joint) in joints.iter().enumerate().rev() {
            let (force, mut across) = (self.forces[i], [0.0; 6]);
            joint.kind.project(&model.subspaces[i], force, &mut across);
            for (y, across) in y[joint.v..].iter_mut().zip(&across[..joint.kind.nv()]) {
                *y -= across;
            }
            if let Some(parent) = joint.parent {
                self.forces[parent] += aba.placement(i).force(force);
            }
        }
        for ((y, x), armature) in y.iter_mut().zip(x).zip(&model.armature) {
            let armature: f64 = armature.lift();
            *y = Real::mul_add(-armature, *x, *y);
        }
    }
}

fn lift_into<R>(numbers: &[f64], lifted: &mut [R])
where
    f64: Lift<R>,
{
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
