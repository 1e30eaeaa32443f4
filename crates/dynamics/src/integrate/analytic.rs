//! The right-hand side with its derivatives, by the recursions for forward dynamics and dual numbers for the forces.
//!
//! Computes a(t, q, v, u), and with the joint forces τ and wrenches f of a [`System`]:
//!
//! ```text
//! ∂a/∂x = ∂FD/∂x + M⁻¹ (∂τ/∂x − ∂(ID − Σ Jᵀf)/∂x|ₛ)
//! ```
//!
//! Here ∂FD is [`FdDerivatives`]. The derivative at s is that with q, v and a held: by the wrenches, and by parameters of the model. It is
//! inverse dynamics over duals, and only computed where there are wrenches or parameters. Source: as [`FdDerivatives`].
//! Frames, shapes, units: as in [`super::ByDuals`], whose answers these are.
//! Cost: that of [`FdDerivatives`]. Each of the 2·nv + inputs directions adds the system's forces over duals, a product with M⁻¹, and with
//! wrenches or parameters one inverse dynamics over duals. A call does not allocate.

use super::by_duals::{Linearisation, Linearise, copy};
use super::dense::add_scaled;
use super::dynamics::{Acceleration, Dynamics, Instant, System};
use crate::error::expect;
use crate::{DimensionError, Error, FdDerivatives, FdPartials, Rnea};
use featherbench_model::{Model, Topology};
use featherbench_spatial::{Angle, Dual, Force, Lift};

/// [`Dynamics`] and their derivatives by recursions.
///
/// ```
/// use featherbench_dynamics::integrate::{Analytic, Linearisation, Linearise, Motors};
/// use featherbench_model::Model;
/// use featherbench_robots::{Family, StateBatch};
///
/// let model: Model<f64> = Model::build(&Family::parse("chain:n=3,layout=spatial")?.generate()?)?;
/// let states = StateBatch::random(&model, 1, 7);
/// let mut f = Analytic::new(&model, Motors { dofs: vec![0, 1, 2] }, &[])?;
/// f.set_controls(states.tau(0))?;
/// let (mut a, mut linear) = (vec![0.0; 3], Linearisation::new(3, 3));
/// f.linearise(0.0, states.q(0), states.v(0), &mut a, &mut linear)?;
/// // A motor moves its own dof: the diagonal of M⁻¹ is positive.
/// assert!((0..3).all(|k| linear.by_input[3 * k + k] > 0.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Analytic<S, T> {
    system: S,
    plain: Dynamics<S, T>,
    topology: Topology,
    derivatives: FdDerivatives<T>,
    partials: FdPartials<T>,
    /// τ and f at the state.
    tau: Vec<T>,
    wrenches: Vec<Force<T>>,
    /// The same over duals, with all that they depend on.
    model: Model<Dual<T>>,
    rnea: Rnea<Dual<T>>,
    q: Vec<Dual<T>>,
    v: Vec<Dual<T>>,
    a: Vec<Dual<T>>,
    controls: Vec<Dual<T>>,
    parameters: Vec<Dual<T>>,
    dual_tau: Vec<Dual<T>>,
    dual_wrenches: Vec<Force<Dual<T>>>,
    /// q and v without rates.
    held_q: Vec<Dual<T>>,
    held_v: Vec<Dual<T>>,
    taken: Vec<Dual<T>>,
    /// The changes of the forces, one column per direction.
    changes: Vec<T>,
}

impl<S: System + Clone, T: Angle> Analytic<S, T>
where
    f64: Lift<T>,
{
    /// The dynamics of a model under a system, with these values of its parameters and controls of zero.
    ///
    /// # Errors
    /// [`DimensionError`] when the number of parameters is not the system's.
    pub fn new(model: &Model<f64>, system: S, parameters: &[T]) -> Result<Self, DimensionError>
    where
        f64: Lift<Dual<T>>,
    {
        let topology = model.topology.clone();
        let zeros = |count| vec![Dual::constant(T::zero()); count];
        let inputs = system.controls() + system.parameters();
        let bodies = if system.has_wrenches() { topology.bodies() } else { 0 };
        let mut new = Self {
            plain: Dynamics::new(model, system.clone(), parameters)?,
            derivatives: FdDerivatives::new(&topology),
            partials: FdPartials::new(&topology),
            tau: vec![T::zero(); topology.nv()],
            wrenches: vec![Force::zero(); bodies],
            model: model.lift(),
            rnea: Rnea::new(&topology),
            q: zeros(topology.nq()),
            v: zeros(topology.nv()),
            a: zeros(topology.nv()),
            controls: zeros(system.controls()),
            parameters: zeros(system.parameters()),
            dual_tau: zeros(topology.nv()),
            dual_wrenches: vec![Force::zero(); bodies],
            held_q: zeros(topology.nq()),
            held_v: zeros(topology.nv()),
            taken: zeros(topology.nv()),
            changes: vec![T::zero(); topology.nv() * if inputs > topology.nv() { inputs } else { topology.nv() }],
            topology,
            system,
        };
        new.set_parameters(parameters)?;
        Ok(new)
    }
}

impl<S: System, T: Angle> Analytic<S, T> {
    /// The change of the forces in the direction that the duals now have, into column `column` of `self.changes`, which has `width` columns.
    /// `modelled` says whether the model changes too.
    fn note_change(&mut self, t: T, modelled: bool, width: usize, column: usize) -> Result<(), Error> {
        self.dual_tau.fill(Dual::constant(T::zero()));
        self.dual_wrenches.fill(Force::zero());
        let at = Instant { time: Dual::constant(t), q: &self.q, v: &self.v, controls: &self.controls, parameters: &self.parameters };
        self.system.forces(&at, &mut self.dual_tau, &mut self.dual_wrenches);
        if modelled || !self.dual_wrenches.is_empty() {
            // q and v are held here: their own part is in ∂FD.
            let wrenches = if self.dual_wrenches.is_empty() { None } else { Some(self.dual_wrenches.as_slice()) };
            self.rnea.run(&self.model, &self.held_q, &self.held_v, &self.a, wrenches, &mut self.taken)?;
            for (tau, taken) in self.dual_tau.iter_mut().zip(&self.taken) {
                *tau -= *taken;
            }
        }
        for (row, tau) in self.dual_tau.iter().enumerate() {
            self.changes[row * width + column] = tau.derivative;
        }
        Ok(())
    }

    /// `matrix += M⁻¹ · changes`, all columns at once.
    fn add_solved(&self, matrix: &mut [T], width: usize) {
        if width == 0 {
            return;
        }
        let nv = self.partials.acceleration.len();
        for (row, inverse) in matrix.chunks_exact_mut(width).zip(self.partials.tau.chunks_exact(nv)) {
            for (factor, changes) in inverse.iter().zip(self.changes.chunks_exact(width)) {
                add_scaled(*factor, changes, row);
            }
        }
    }
}

impl<S: System, T: Angle> Acceleration<T> for Analytic<S, T> {
    fn acceleration(&mut self, t: T, q: &[T], v: &[T], a: &mut [T]) -> Result<(), Error> {
        self.plain.acceleration(t, q, v, a)
    }
}

impl<S: System, T: Angle> Linearise<T> for Analytic<S, T> {
    fn controls(&self) -> usize {
        self.controls.len()
    }

    fn parameters(&self) -> usize {
        self.parameters.len()
    }

    fn set_controls(&mut self, controls: &[T]) -> Result<(), DimensionError> {
        self.plain.set_controls(controls)?;
        copy(&mut self.controls, controls);
        Ok(())
    }

    fn set_parameters(&mut self, parameters: &[T]) -> Result<(), DimensionError> {
        self.plain.set_parameters(parameters)?;
        copy(&mut self.parameters, parameters);
        self.system.adjust(&self.parameters, &mut self.model);
        Ok(())
    }

    fn linearise(&mut self, t: T, q: &[T], v: &[T], a: &mut [T], result: &mut Linearisation<T>) -> Result<(), Error> {
        let nv = self.topology.nv();
        let (controls, parameters) = (self.controls.len(), self.parameters.len());
        let inputs = controls + parameters;
        expect("configuration q", self.topology.nq(), q.len())?;
        expect("velocity v", nv, v.len())?;
        expect("acceleration a", nv, a.len())?;
        expect("derivatives by q", nv * nv, result.by_q.len())?;
        expect("derivatives by v", nv * nv, result.by_v.len())?;
        expect("derivatives by inputs", nv * inputs, result.by_input.len())?;
        self.plain.forces(t, q, v, &mut self.tau, &mut self.wrenches);
        let wrenches = if self.wrenches.is_empty() { None } else { Some(self.wrenches.as_slice()) };
        self.derivatives.run(self.plain.model(), q, v, &self.tau, wrenches, &mut self.partials)?;
        a.copy_from_slice(&self.partials.acceleration);
        result.by_q.copy_from_slice(&self.partials.q);
        result.by_v.copy_from_slice(&self.partials.v);
        result.by_input.fill(T::zero());

        copy(&mut self.q, q);
        copy(&mut self.held_q, q);
        copy(&mut self.v, v);
        copy(&mut self.held_v, v);
        copy(&mut self.a, a);
        for joint in 0..self.topology.bodies() {
            let joint = self.topology.joints()[joint];
            for k in 0..joint.kind.nv() {
                let mut direction = [Dual::constant(T::zero()); 6];
                direction[k].derivative = T::one();
                joint.kind.integrate(&self.held_q[joint.q..], &direction, &mut self.q[joint.q..]);
                self.note_change(t, false, nv, joint.v + k)?;
            }
            let numbers = joint.q..joint.q + joint.kind.nq();
            self.q[numbers.clone()].copy_from_slice(&self.held_q[numbers]);
        }
        self.add_solved(&mut result.by_q, nv);
        for dof in 0..nv {
            self.v[dof].derivative = T::one();
            self.note_change(t, false, nv, dof)?;
            self.v[dof].derivative = T::zero();
        }
        self.add_solved(&mut result.by_v, nv);
        for k in 0..controls {
            self.controls[k].derivative = T::one();
            self.note_change(t, false, inputs, k)?;
            self.controls[k].derivative = T::zero();
        }
        for k in 0..parameters {
            self.parameters[k].derivative = T::one();
            self.system.adjust(&self.parameters, &mut self.model);
            self.note_change(t, true, inputs, controls + k)?;
            self.parameters[k].derivative = T::zero();
        }
        self.add_solved(&mut result.by_input, inputs);
        if parameters > 0 {
            self.system.adjust(&self.parameters, &mut self.model);
        }
        Ok(())
    }
}
