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

use super::by_duals::{Linearisation, Linearise};
use super::dense::add_scaled;
use super::directions::{Directions, Input, copy};
use super::dynamics::{Acceleration, Dynamics, Instant, System};
use crate::error::expect;
use crate::{DimensionError, Error, FdDerivatives, FdPartials, Rnea};
use featherbench_model::Model;
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
    plain: Dynamics<S, T>,
    derivatives: FdDerivatives<T>,
    partials: FdPartials<T>,
    /// τ and f at the state.
    tau: Vec<T>,
    wrenches: Vec<Force<T>>,
    directions: Directions<T>,
    changes: Changes<S, T>,
}

/// How the forces change, and what inverse dynamics takes less or more, while q and v are held.
#[derive(Clone, Debug)]
struct Changes<S, T> {
    system: S,
    model: Model<Dual<T>>,
    rnea: Rnea<Dual<T>>,
    /// q, v and a without rates.
    q: Vec<Dual<T>>,
    v: Vec<Dual<T>>,
    a: Vec<Dual<T>>,
    tau: Vec<Dual<T>>,
    wrenches: Vec<Force<Dual<T>>>,
    taken: Vec<Dual<T>>,
    /// The changes, one column per direction.
    columns: Vec<T>,
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
        let topology = &model.topology;
        let nv = topology.nv();
        let zeros = |count| vec![Dual::constant(T::zero()); count];
        let bodies = if system.has_wrenches() { topology.bodies() } else { 0 };
        let directions = Directions::new(topology.clone(), system.controls(), parameters);
        let widest = if directions.inputs() > nv { directions.inputs() } else { nv };
        let mut new = Self {
            plain: Dynamics::new(model, system.clone(), parameters)?,
            derivatives: FdDerivatives::new(topology),
            partials: FdPartials::new(topology),
            tau: vec![T::zero(); nv],
            wrenches: vec![Force::zero(); bodies],
            directions,
            changes: Changes {
                system,
                model: model.lift(),
                rnea: Rnea::new(topology),
                q: zeros(topology.nq()),
                v: zeros(nv),
                a: zeros(nv),
                tau: zeros(nv),
                wrenches: vec![Force::zero(); bodies],
                taken: zeros(nv),
                columns: vec![T::zero(); nv * widest],
            },
        };
        new.set_parameters(parameters)?;
        Ok(new)
    }
}

impl<S: System, T: Angle> Changes<S, T> {
    /// The change of the forces in the direction that the duals have, into column `column` of `width`. `modelled` says whether the model
    /// changes too.
    fn note(&mut self, t: T, at: &Directions<T>, modelled: bool, width: usize, column: usize) -> Result<(), Error> {
        self.tau.fill(Dual::constant(T::zero()));
        self.wrenches.fill(Force::zero());
        let at = Instant { time: Dual::constant(t), q: &at.q, v: &at.v, controls: &at.controls, parameters: &at.parameters };
        self.system.forces(&at, &mut self.tau, &mut self.wrenches);
        if modelled || !self.wrenches.is_empty() {
            // q and v are held here: their own part is in ∂FD.
            let wrenches = if self.wrenches.is_empty() { None } else { Some(self.wrenches.as_slice()) };
            self.rnea.run(&self.model, &self.q, &self.v, &self.a, wrenches, &mut self.taken)?;
            for (tau, taken) in self.tau.iter_mut().zip(&self.taken) {
                *tau -= *taken;
            }
        }
        for (row, tau) in self.tau.iter().enumerate() {
            self.columns[row * width + column] = tau.derivative;
        }
        Ok(())
    }

    /// `matrix += M⁻¹ · changes`, all columns at once.
    fn add_solved(&self, inverse: &[T], matrix: &mut [T], width: usize) {
        if width == 0 {
            return;
        }
        for (row, inverse) in matrix.chunks_exact_mut(width).zip(inverse.chunks_exact(self.v.len())) {
            for (factor, changes) in inverse.iter().zip(self.columns.chunks_exact(width)) {
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
        self.directions.controls.len()
    }

    fn parameters(&self) -> usize {
        self.directions.parameters.len()
    }

    fn set_controls(&mut self, controls: &[T]) -> Result<(), DimensionError> {
        self.plain.set_controls(controls)?;
        copy(&mut self.directions.controls, controls);
        Ok(())
    }

    fn set_parameters(&mut self, parameters: &[T]) -> Result<(), DimensionError> {
        self.plain.set_parameters(parameters)?;
        copy(&mut self.directions.parameters, parameters);
        self.changes.system.adjust(&self.directions.parameters, &mut self.changes.model);
        Ok(())
    }

    fn linearise(&mut self, t: T, q: &[T], v: &[T], a: &mut [T], result: &mut Linearisation<T>) -> Result<(), Error> {
        let Self { plain, derivatives, partials, tau, wrenches, directions, changes, .. } = self;
        let (nv, inputs) = (tau.len(), directions.inputs());
        expect("acceleration a", nv, a.len())?;
        result.expect_size(nv, inputs)?;
        directions.set_state(q, v)?;
        plain.forces(t, q, v, tau, wrenches);
        let wrenches = if wrenches.is_empty() { None } else { Some(wrenches.as_slice()) };
        derivatives.run(plain.model(), q, v, tau, wrenches, partials)?;
        a.copy_from_slice(&partials.acceleration);
        result.by_q.copy_from_slice(&partials.q);
        result.by_v.copy_from_slice(&partials.v);
        result.by_input.fill(T::zero());

        copy(&mut changes.q, q);
        copy(&mut changes.v, v);
        copy(&mut changes.a, a);
        directions.by_q(|at, k| changes.note(t, at, false, nv, k))?;
        changes.add_solved(&partials.tau, &mut result.by_q, nv);
        directions.by_v(|at, k| changes.note(t, at, false, nv, k))?;
        changes.add_solved(&partials.tau, &mut result.by_v, nv);
        directions.by_inputs(|at, input, k| {
            if input == Input::Parameter {
                changes.system.adjust(&at.parameters, &mut changes.model);
            }
            changes.note(t, at, input == Input::Parameter, inputs, k)
        })?;
        changes.add_solved(&partials.tau, &mut result.by_input, inputs);
        changes.system.adjust(&directions.parameters, &mut changes.model);
        Ok(())
    }
}
