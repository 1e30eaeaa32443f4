//! The residuals of a description: its section `residuals` as functions.
//!
//! The coordinates are those of the model: the dofs of the canonical description, depth-first. Dry friction is set-valued at rest. So it is kept
//! apart from the sum of the others, and [`Described::forward`] solves for which dofs stick.

use crate::corrected::forward_under;
use crate::error::expect;
use crate::on_joints::{OnJoints, chosen};
use crate::{
    Delay, DryFriction, Forces, Lag, Linear, Nominal, Payload, PayloadError, Residual, ResidualError, Rigid, SeriesElastic, SmoothCoulomb,
    SpringDamper, State, Stribeck, Sum, Viscous, WellPosed,
};
use featherbench_model::{DescribedResidual, Description, Malformed, Model, ResidualLaw, neutral};
use nalgebra::DMatrix;
use std::ops::Range;
use thiserror::Error;

/// What the section `residuals` of a description says.
///
/// ```
/// use featherbench_model::{DescribedResidual, Description, Model, ResidualLaw};
/// use featherbench_residuals::{Corrected, Described, Rigid};
/// # use featherbench_model::{BodyDescription, JointDescription, JointType};
/// # let joint = JointDescription { kind: JointType::Prismatic { axis: [1.0, 0.0, 0.0] }, ..JointDescription::default() };
/// # let cart = BodyDescription { name: "cart".into(), parent: None, mass: 2.0, com: [0.0; 3], inertia: [0.0; 6], joint };
/// # let mut robot = Description { bodies: vec![cart], ..Description::default() };
/// let law = ResidualLaw::Viscous { coefficient: vec![0.5] };
/// robot.residuals = vec![DescribedResidual { name: "grease".into(), bodies: vec![0], law }];
/// let residual = Described::of(&robot)?;
/// let model = Model::build(&robot)?;
/// let mut corrected = Corrected::new(Rigid::new(&model), residual)?;
/// // 2 kg, 0.5 N·s/m: at 4 m/s an acceleration of 3 m/s² needs 2·3 + 0.5·4 = 8 N.
/// assert_eq!(corrected.inverse(&[0.0], &[4.0], &[3.0])?, [8.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Described {
    names: Vec<String>,
    parts: Vec<Part>,
    /// All but dry friction, in the order of the description: it has the inner states.
    smooth: Sum,
    /// All dry friction together.
    dry: Option<DryFriction>,
    delays: Vec<Delayed>,
    drives: Vec<Drive>,
}

/// A drive: its part of the inner state, its joints, and the stiffness of its springs if it has some.
#[derive(Debug)]
struct Drive {
    inner: Range<usize>,
    coordinates: Vec<usize>,
    dofs: Vec<usize>,
    stiffness: Option<Vec<f64>>,
}

/// The name of a residual, with the least and the greatest r of each dof.
pub type NamedBounds<'a> = (&'a str, Vec<[f64; 2]>);

/// Where the residual of a name is.
#[derive(Clone, Debug)]
enum Part {
    /// In the sum: which, and its part of the inner state.
    Smooth(usize, Range<usize>),
    /// This dry friction.
    Dry(DryFriction),
}

/// A delay: its part of the inner state, and its dofs.
#[derive(Debug)]
struct Delayed {
    inner: Range<usize>,
    dofs: Vec<usize>,
    of: Delay,
}

/// Why the residuals of a description cannot be computed with.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum DescribedError {
    /// The description is malformed.
    #[error(transparent)]
    Malformed(#[from] Malformed),
    /// A residual has numbers that make no sense.
    #[error("residuals[{index}] '{name}': {error}")]
    Residual {
        /// Its name.
        name: String,
        /// Its place in the list, counted from 0.
        index: usize,
        /// What is wrong.
        error: ResidualError,
    },
    /// Together they do not determine the acceleration.
    #[error("residuals, in the neutral configuration: {0}")]
    Together(#[from] ResidualError),
}

impl Described {
    /// The residuals of a description; none is zero.
    ///
    /// # Errors
    /// [`DescribedError`] if the description is malformed, or if M + ∂r/∂a is singular in the neutral configuration. In others it is looked at
    /// when the acceleration is asked.
    pub fn of(robot: &Description) -> Result<Self, DescribedError> {
        let robot = robot.canonical()?;
        let model = Model::<f64>::build(&robot)?;
        let nv = model.topology.nv();
        let (mut names, mut parts, mut smooth, mut delays) = (Vec::new(), Vec::new(), Vec::<Box<dyn Residual>>::new(), Vec::new());
        let (mut limits, mut inner, mut drives) = (None, 0, Vec::new());
        for (index, residual) in robot.residuals.iter().enumerate() {
            let [coordinates, dofs] = places(&robot, &residual.bodies);
            let bad = |error| DescribedError::Residual { name: residual.name.clone(), index, error };
            names.push(residual.name.clone());
            if let ResidualLaw::Dry { force } = &residual.law {
                let own = spread(nv, &dofs, force);
                let limits: &mut Vec<f64> = limits.get_or_insert_with(|| vec![0.0; nv]);
                limits.iter_mut().zip(&own).for_each(|(limit, own)| *limit += own);
                parts.push(Part::Dry(DryFriction::new(own).map_err(bad)?));
                continue;
            }
            let made = made(&robot, &model, residual, coordinates.clone(), dofs.clone()).map_err(|error| match error {
                PayloadError::Malformed(error) => DescribedError::Malformed(error),
                PayloadError::Residual(error) => bad(error),
            })?;
            let own = inner..inner + made.inner();
            inner = own.end;
            if !own.is_empty() {
                let stiffness = match &residual.law {
                    ResidualLaw::SeriesElastic { stiffness, .. } => Some(stiffness.clone()),
                    _ => None,
                };
                drives.push(Drive { inner: own.clone(), coordinates, dofs: dofs.clone(), stiffness });
            }
            if let ResidualLaw::Delay { periods } = residual.law {
                delays.push(Delayed { inner: own.clone(), of: Delay::new(dofs.len(), periods), dofs });
            }
            parts.push(Part::Smooth(smooth.len(), own));
            smooth.push(made);
        }
        let smooth = Sum::new(nv, smooth)?;
        let dry = limits.map(DryFriction::new).transpose()?;
        let described = Self { names, parts, smooth, dry, delays, drives };
        if described.has_acceleration() {
            let (q, still, state) = (neutral(&model.topology), vec![0.0; nv], vec![0.0; inner]);
            let by_acceleration = described.smooth.by_acceleration(&State::new(&q, &still, &still).with_inner(&state))?;
            WellPosed::of(&Rigid::new(&model).mass_matrix(&q)?, &by_acceleration)?;
        }
        Ok(described)
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.names.is_empty()
    }

    /// The name of each, with the least and the greatest r of each dof at a state. They differ for dry friction at rest.
    ///
    /// # Errors
    /// As [`Residual::value`].
    pub fn each(&self, state: &State<'_>) -> Result<Vec<NamedBounds<'_>>, ResidualError> {
        crate::residual::check(self, state)?;
        let bounds = |part: &Part| match part {
            Part::Dry(dry) => dry.interval(state.v, state.a),
            Part::Smooth(index, inner) => {
                let mut r = vec![0.0; self.nv()];
                let own = State { inner: &state.inner[inner.clone()], ..*state };
                self.smooth.part(*index).map_or(Ok(()), |part| part.add(&own, &mut r))?;
                Ok(r.into_iter().map(|r| [r; 2]).collect())
            }
        };
        self.names.iter().zip(&self.parts).map(|(name, part)| Ok((name.as_str(), bounds(part)?))).collect()
    }

    /// The acceleration under joint forces, which are also the command, with an inner state; the dry friction; and which dofs it holds.
    ///
    /// # Errors
    /// [`ResidualError`] when an argument does not fit, or the acceleration is not determined or not found.
    pub fn forward<N: Nominal>(&self, nominal: &mut N, q: &[f64], v: &[f64], tau: &[f64], inner: &[f64]) -> Result<Forces, ResidualError> {
        let n = self.nv();
        expect("dofs of the residual", nominal.nv(), n)?;
        expect("configuration q", nominal.nq(), q.len())?;
        expect("joint forces τ", n, tau.len())?;
        let mut driven = Driven { nominal, residual: &self.smooth, command: tau, inner };
        match &self.dry {
            Some(dry) => dry.forward(&mut driven, q, v, tau),
            None => {
                let mut a = vec![0.0; n];
                driven.forward(q, v, tau, &mut a)?;
                Ok(Forces { a, friction: vec![0.0; n], stuck: Vec::new() })
            }
        }
    }

    /// The least and the greatest joint force of each dof that go with the acceleration of a state. They differ where dry friction holds a dof.
    ///
    /// # Errors
    /// [`ResidualError`] when an argument does not fit or the nominal model does not answer.
    pub fn inverse<N: Nominal>(&self, nominal: &mut N, state: &State<'_>) -> Result<Vec<[f64; 2]>, ResidualError> {
        expect("configuration q", nominal.nq(), state.q.len())?;
        let mut driven = Driven { nominal, residual: &self.smooth, command: state.command, inner: state.inner };
        if let Some(dry) = &self.dry {
            return dry.inverse(&mut driven, state.q, state.v, state.a);
        }
        let mut tau = vec![0.0; self.nv()];
        driven.inverse(state.q, state.v, state.a, &mut tau)?;
        Ok(tau.into_iter().map(|tau| [tau; 2]).collect())
    }

    /// How well M + ∂r/∂a determines the acceleration at a state.
    ///
    /// # Errors
    /// [`ResidualError::IllPosed`] if it does not, and as [`Residual::value`].
    pub fn well_posed<N: Nominal>(&self, nominal: &mut N, state: &State<'_>) -> Result<WellPosed, ResidualError> {
        WellPosed::of(&nominal.mass_matrix(state.q)?, &self.by_acceleration(state)?)
    }

    /// The inner state of drives that put out what is commanded, so that their r is zero.
    ///
    /// Springs are bent by u/K and turn with the joint. The other drives have put out u for long.
    ///
    /// # Errors
    /// [`ResidualError::Dimension`] when a length does not fit.
    pub fn settled(&self, q: &[f64], v: &[f64], command: &[f64]) -> Result<Vec<f64>, ResidualError> {
        if let Some(nq) = self.nq() {
            expect("configuration q", nq, q.len())?;
        }
        expect("velocity v", self.nv(), v.len())?;
        expect("commanded joint forces", self.nv(), command.len())?;
        let mut inner = vec![0.0; self.inner()];
        for Drive { inner: own, coordinates, dofs, stiffness } in &self.drives {
            let (u, count) = (chosen(dofs, command), dofs.len().max(1));
            let own = &mut inner[own.clone()];
            match stiffness {
                Some(stiffness) => {
                    for (k, (q, v)) in chosen(coordinates, q).into_iter().zip(chosen(dofs, v)).enumerate() {
                        (own[k], own[count + k]) = (q + u[k] / stiffness[k], v);
                    }
                }
                None => own.chunks_exact_mut(count).for_each(|commands| commands.copy_from_slice(&u)),
            }
        }
        Ok(inner)
    }

    /// Ends a control period, in which `command` was commanded: what the delays hold moves on by one.
    ///
    /// # Errors
    /// [`ResidualError::Dimension`] when a length does not fit.
    pub fn advance(&self, inner: &mut [f64], command: &[f64]) -> Result<(), ResidualError> {
        expect("inner state of the residual", self.inner(), inner.len())?;
        expect("commanded joint forces", self.nv(), command.len())?;
        self.delays.iter().try_for_each(|delay| delay.of.advance(&mut inner[delay.inner.clone()], &chosen(&delay.dofs, command)))
    }
}

impl Residual for Described {
    fn nv(&self) -> usize {
        self.smooth.nv()
    }

    fn nq(&self) -> Option<usize> {
        self.smooth.nq()
    }

    fn add(&self, state: &State<'_>, r: &mut [f64]) -> Result<(), ResidualError> {
        self.smooth.add(state, r)?;
        self.dry.as_ref().map_or(Ok(()), |dry| dry.add(state, r))
    }

    fn has_acceleration(&self) -> bool {
        self.smooth.has_acceleration()
    }

    fn add_by_acceleration(&self, state: &State<'_>, matrix: &mut DMatrix<f64>) -> Result<(), ResidualError> {
        self.smooth.add_by_acceleration(state, matrix)
    }

    fn inner(&self) -> usize {
        self.smooth.inner()
    }

    fn inner_rate(&self, state: &State<'_>, rate: &mut [f64]) -> Result<(), ResidualError> {
        self.smooth.inner_rate(state, rate)
    }
}

/// The places of the numbers of these bodies' joints, in q and in v, of a canonical description.
fn places(robot: &Description, bodies: &[usize]) -> [Vec<usize>; 2] {
    let starts: Vec<[usize; 2]> = robot
        .bodies
        .iter()
        .scan([0, 0], |next, body| {
            let start = *next;
            *next = [start[0] + body.joint.kind.nq(), start[1] + body.joint.kind.nv()];
            Some(start)
        })
        .collect();
    let of = |which: usize, count: &dyn Fn(usize) -> usize| {
        bodies.iter().flat_map(|&body| starts[body][which]..starts[body][which] + count(body)).collect::<Vec<usize>>()
    };
    [of(0, &|body| robot.bodies[body].joint.kind.nq()), of(1, &|body| robot.bodies[body].joint.kind.nv())]
}

/// A list with these numbers at these places, and zeros elsewhere.
fn spread(length: usize, places: &[usize], numbers: &[f64]) -> Vec<f64> {
    let mut all = vec![0.0; length];
    places.iter().zip(numbers).for_each(|(&place, &number)| all[place] = number);
    all
}

/// A residual other than dry friction, for the whole robot.
fn made(
    robot: &Description,
    model: &Model<f64>,
    DescribedResidual { bodies, law, .. }: &DescribedResidual,
    coordinates: Vec<usize>,
    dofs: Vec<usize>,
) -> Result<Box<dyn Residual>, PayloadError> {
    let (nq, nv) = (model.topology.nq(), model.topology.nv());
    let (own_nq, own_nv) = (coordinates.len(), dofs.len());
    let of: Box<dyn Residual> = match law.clone() {
        // The rigid bodies between the payload and the world move it: it is one of the whole robot.
        ResidualLaw::Payload { mass, com, inertia } => {
            let carrier = bodies.first().copied().unwrap_or(robot.bodies.len());
            return Ok(Box::new(Payload::new(robot, carrier, mass, com, inertia)?));
        }
        // The difference of configurations needs the tree. A joint without stiffness has no spring.
        ResidualLaw::Spring { stiffness, damping, rest } => {
            let mut at = neutral(&model.topology);
            coordinates.iter().zip(&rest).for_each(|(&place, &number)| at[place] = number);
            let [stiffness, damping] = [stiffness, damping].map(|own| spread(nv, &dofs, &own));
            return Ok(Box::new(SpringDamper::new(&model.topology, stiffness, damping, at)?));
        }
        ResidualLaw::Viscous { coefficient } => Box::new(Viscous::new(coefficient)?),
        ResidualLaw::Coulomb { force, width } => Box::new(SmoothCoulomb::new(force, width)?),
        ResidualLaw::Dry { force } => Box::new(DryFriction::new(force)?),
        ResidualLaw::Stribeck { coulomb, stiction, speed, viscous, width } => {
            Box::new(Stribeck { coulomb, stiction, speed, viscous, width }.checked()?)
        }
        ResidualLaw::SeriesElastic { stiffness, damping, motor } => Box::new(SeriesElastic::new(stiffness, damping, motor)?),
        ResidualLaw::Lag { time } => Box::new(Lag::new(time)?),
        ResidualLaw::Delay { periods } => Box::new(Delay::new(own_nv, periods)),
        ResidualLaw::Linear { position, velocity, acceleration, constant } => {
            // θ is the rows [K D A c], dof by dof; an empty list is zeros.
            let row = |list: &[f64], width: usize, k: usize| {
                if list.is_empty() { vec![0.0; width] } else { list[k * width..(k + 1) * width].to_vec() }
            };
            let lists = [(&position, own_nq), (&velocity, own_nv), (&acceleration, own_nv), (&constant, 1)];
            let theta = (0..own_nv).flat_map(|k| lists.into_iter().flat_map(move |(list, width)| row(list, width, k))).collect();
            Box::new(Linear::new(own_nq, own_nv, theta)?)
        }
    };
    Ok(Box::new(OnJoints { nq, nv, coordinates, dofs, of }))
}

/// A nominal model with a residual, a command and an inner state, as the nominal model of dry friction: joint forces less friction are not the
/// command.
struct Driven<'a, N> {
    nominal: &'a mut N,
    residual: &'a Sum,
    command: &'a [f64],
    inner: &'a [f64],
}

impl<N: Nominal> Nominal for Driven<'_, N> {
    fn nq(&self) -> usize {
        self.nominal.nq()
    }

    fn nv(&self) -> usize {
        self.nominal.nv()
    }

    fn inverse(&mut self, q: &[f64], v: &[f64], a: &[f64], tau: &mut [f64]) -> Result<(), ResidualError> {
        let r = self.residual.value(&State::new(q, v, a).with_command(self.command).with_inner(self.inner))?;
        self.nominal.inverse(q, v, a, tau)?;
        crate::add_unless_zero(tau, &r, 1.0);
        Ok(())
    }

    fn forward(&mut self, q: &[f64], v: &[f64], tau: &[f64], a: &mut [f64]) -> Result<(), ResidualError> {
        let state = State::new(q, v, &[]).with_command(self.command).with_inner(self.inner);
        a.copy_from_slice(&forward_under(self.nominal, self.residual, tau, &state)?);
        Ok(())
    }

    fn mass_matrix(&mut self, q: &[f64]) -> Result<DMatrix<f64>, ResidualError> {
        let rest = vec![0.0; self.nominal.nv()];
        let state = State::new(q, &rest, &rest).with_command(self.command).with_inner(self.inner);
        Ok(self.nominal.mass_matrix(q)? + self.residual.by_acceleration(&state)?)
    }
}
