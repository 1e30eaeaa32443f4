//! Dynamics in reduced coordinates, by the algorithms of the fine tree:
//!
//! ```text
//! inverse dynamics   τ = Bᵀ ID(φ(s), B ṡ, B s̈ + Ḃ ṡ) + K x + D ṡ      x: the elastic coordinates, zero at rest
//! mass matrix        M e_j = Bᵀ ID(φ(s), 0, B e_j), without gravity
//! forward dynamics   s̈ = M⁻¹ (τ − inverse dynamics of s̈ = 0)
//! ```
//!
//! If all coordinates are direct (rigid links, strings), forward dynamics is the articulated-body algorithm: O(n). Else M is factored as
//! LᵀDL in the reduced tree's sparsity: n_s inverse dynamics of O(n), and the factorization.
//!
//! Shapes: s has `nq` numbers of [`Continuum::topology`]; velocities, accelerations and forces have `nv`. Loads: [`Load`]. Calls of
//! [`Solver::inverse`] and [`Solver::forward`] on direct coordinates do not allocate.

use crate::block::Moving;
use crate::{Continuum, Refused};
use featherbench_dynamics::integrate::{Acceleration, IntegrationError, Linearisation, Linearise};
use featherbench_dynamics::{
    Aba, CentroidalMomentum, DimensionError, Energies, Energy, Error, Kinematics, Ltdl, Momentum, Rnea, TreeSparse, mass_matrix,
};
use featherbench_spatial::{Angle, Dual, Force, Lift, Vec3};
use thiserror::Error as Fault;

/// A force and a moment at a point of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load {
    /// The body: its index in the assembly.
    pub body: usize,
    /// The point, in the body's frame, m.
    pub point: [f64; 3],
    /// The force, N.
    pub force: [f64; 3],
    /// The moment, N·m.
    pub moment: [f64; 3],
    /// Whether force and moment turn with the body (a follower load). If not, they are in world axes (a dead load).
    pub follows: bool,
}

impl Load {
    /// A dead force at a point of a body.
    pub fn force(body: usize, point: [f64; 3], force: [f64; 3]) -> Self {
        Self { body, point, force, moment: [0.0; 3], follows: false }
    }

    /// A dead moment on a body.
    pub fn moment(body: usize, moment: [f64; 3]) -> Self {
        Self { body, point: [0.0; 3], force: [0.0; 3], moment, follows: false }
    }

    /// The load times a factor.
    pub fn times(self, factor: f64) -> Self {
        Self { force: self.force.map(|x| x * factor), moment: self.moment.map(|x| x * factor), ..self }
    }
}

/// What the solver can refuse.
#[derive(Clone, Debug, PartialEq, Fault)]
pub enum SolveError {
    /// A load acts on no body, or on the world.
    #[error(transparent)]
    Refused(#[from] Refused),
    /// An argument does not fit, or M is not positive definite.
    #[error(transparent)]
    Dynamics(#[from] Error),
    /// An integration failed.
    #[error(transparent)]
    Integration(#[from] IntegrationError),
    /// The matrices are no eigenproblem of vibrations.
    #[error(
        "the {matrix} matrix is not positive definite: its smallest eigenvalue is {eigenvalue:e}; clamp the robot, or give its dofs mass"
    )]
    NotPositiveDefinite {
        /// Which matrix.
        matrix: &'static str,
        /// Its smallest eigenvalue.
        eigenvalue: f64,
    },
}

impl From<DimensionError> for SolveError {
    fn from(error: DimensionError) -> Self {
        Self::Dynamics(error.into())
    }
}

/// The workspace of a continuum's dynamics in a scalar.
#[derive(Clone, Debug)]
pub struct Solver<T> {
    pub(crate) q: Vec<T>,
    pub(crate) v: Vec<T>,
    pub(crate) a: Vec<T>,
    tau: Vec<T>,
    rnea: Rnea<T>,
    aba: Aba<T>,
    kinematics: Kinematics<T>,
    wrenches: Vec<Force<T>>,
    /// Velocity of the mass matrix's columns, and acceleration of forward dynamics: zero.
    zeros: Vec<T>,
    still: Vec<T>,
    force: Vec<T>,
    mass: Ltdl<T>,
}

impl<T: Angle> Solver<T>
where
    f64: Lift<T>,
{
    /// A workspace for a continuum.
    pub fn new(continuum: &Continuum) -> Self {
        let (fine, reduced) = (&continuum.model().topology, continuum.topology());
        let zeros = |count| vec![T::zero(); count];
        // Ltdl has room for M. Where ABA serves, none is needed.
        let sparse = if continuum.is_direct() { TreeSparse::of_parents(&[]) } else { TreeSparse::of_parents(reduced.dof_parents()) };
        let mass = sparse.map_or_else(|_| Ltdl::new(reduced), Ltdl::from_unfactored);
        Self {
            q: featherbench_model::neutral(fine),
            v: zeros(fine.nv()),
            a: zeros(fine.nv()),
            tau: zeros(fine.nv()),
            rnea: Rnea::new(fine),
            aba: Aba::new(fine),
            kinematics: Kinematics::new(fine),
            wrenches: vec![Force::zero(); fine.bodies()],
            zeros: zeros(reduced.nv()),
            still: zeros(reduced.nv()),
            force: zeros(reduced.nv()),
            mass,
        }
    }

    /// The fine state of a reduced one, in `q`, `v`, `a`.
    pub(crate) fn embed(&mut self, continuum: &Continuum, s: &[T], rate: &[T], second: &[T]) -> Result<(), DimensionError> {
        let topology = continuum.topology();
        DimensionError::expect("configuration s", topology.nq(), s.len())?;
        DimensionError::expect("velocity of s", topology.nv(), rate.len())?;
        DimensionError::expect("acceleration of s", topology.nv(), second.len())?;
        let mut fine = Moving { q: &mut self.q[..], v: &mut self.v[..], a: &mut self.a[..] };
        for block in continuum.blocks() {
            block.embed(&Moving { q: s, v: rate, a: second }, &mut fine);
        }
        Ok(())
    }

    /// The wrenches of loads at the fine configuration: in each body's described axes at its origin.
    fn load(&mut self, continuum: &Continuum, loads: &[Load]) -> Result<(), SolveError> {
        self.wrenches.fill(Force::zero());
        if loads.iter().any(|load| !load.follows) {
            self.kinematics.run(continuum.model(), &self.q, &self.v, &self.a)?;
        }
        for load in loads {
            let (body, on_body) = continuum.compiled(load.body)?;
            let on_body = on_body.to_transform();
            let point: Vec3<T> = on_body.point(Vec3::from_array(load.point)).lift();
            let (mut force, mut moment) = (Vec3::from_array(load.force), Vec3::from_array(load.moment));
            if load.follows {
                (force, moment) = (on_body.rotation * force, on_body.rotation * moment);
            }
            let (mut force, mut moment): (Vec3<T>, Vec3<T>) = (force.lift(), moment.lift());
            if let (false, Some(motion)) = (load.follows, self.kinematics.body(body)) {
                let turn = motion.placement.rotation;
                (force, moment) = (turn.transpose_mul(force), turn.transpose_mul(moment));
            }
            self.wrenches[body] += Force::new(moment + point.cross(force), force);
        }
        Ok(())
    }

    /// The generalized forces `tau` of a state: what the robot's motors and, at the elastic dofs, outer forces must give beside the loads.
    ///
    /// # Errors
    /// [`SolveError`] when an argument does not fit, or a load acts on no body.
    #[inline(never)]
    pub fn inverse(
        &mut self,
        continuum: &Continuum,
        s: &[T],
        rate: &[T],
        second: &[T],
        loads: &[Load],
        tau: &mut [T],
    ) -> Result<(), SolveError> {
        DimensionError::expect("forces tau", continuum.topology().nv(), tau.len())?;
        self.embed(continuum, s, rate, second)?;
        self.load(continuum, loads)?;
        let wrenches = if loads.is_empty() { None } else { Some(&self.wrenches[..]) };
        self.rnea.run(continuum.model(), &self.q, &self.v, &self.a, wrenches, &mut self.tau)?;
        self.project(continuum, s, tau);
        continuum.add_resistance(s, rate, tau);
        Ok(())
    }

    /// `M second` at the configuration `s`.
    ///
    /// # Errors
    /// [`DimensionError`] when an argument does not fit.
    #[inline(never)]
    pub fn mass_times(&mut self, continuum: &Continuum, s: &[T], second: &[T], product: &mut [T]) -> Result<(), DimensionError> {
        DimensionError::expect("product with M", continuum.topology().nv(), product.len())?;
        let zeros = std::mem::take(&mut self.zeros);
        let embedded = self.embed(continuum, s, &zeros, second);
        self.zeros = zeros;
        embedded?;
        self.rnea.run(continuum.weightless(), &self.q, &self.v, &self.a, None, &mut self.tau)?;
        self.project(continuum, s, product);
        Ok(())
    }

    fn project(&self, continuum: &Continuum, s: &[T], tau: &mut [T]) {
        for block in continuum.blocks() {
            block.columns(s).project(&self.tau, tau);
        }
    }

    /// The mass matrix in the reduced tree's sparsity: by the composite-rigid-body algorithm if all coordinates are direct, else column by
    /// column. It allocates.
    ///
    /// # Errors
    /// [`DimensionError`] when `s` does not fit.
    #[inline(never)]
    pub fn mass(&mut self, continuum: &Continuum, s: &[T]) -> Result<TreeSparse<T>, DimensionError> {
        let nv = continuum.topology().nv();
        if continuum.is_direct() {
            return mass_matrix(continuum.model(), s);
        }
        let zeros = std::mem::take(&mut self.zeros);
        let embedded = self.embed(continuum, s, &zeros, &zeros);
        self.zeros = zeros;
        embedded?;
        let blocks: Vec<_> = continuum.blocks().iter().map(|block| block.columns(s)).collect();
        let mut columns = vec![T::zero(); nv * nv];
        for block in &blocks {
            for (j, dof) in block.dofs().enumerate() {
                block.spread(j, T::one(), &mut self.a);
                self.rnea.run(continuum.weightless(), &self.q, &self.v, &self.a, None, &mut self.tau)?;
                block.spread(j, T::zero(), &mut self.a);
                blocks.iter().for_each(|block| block.project(&self.tau, &mut columns[dof * nv..(dof + 1) * nv]));
            }
        }
        // Entry (i, j) and (j, i) differ by rounding: their mean is symmetric.
        let half = T::from_f64(0.5);
        Ok(TreeSparse::from_fn(continuum.topology(), |i, j| (columns[j * nv + i] + columns[i * nv + j]) * half))
    }

    /// The accelerations that the forces `tau` and the loads cause.
    ///
    /// # Errors
    /// [`SolveError`] when an argument does not fit, a load acts on no body, or M is not positive definite.
    #[inline(never)]
    pub fn forward(
        &mut self,
        continuum: &Continuum,
        s: &[T],
        rate: &[T],
        tau: &[T],
        loads: &[Load],
        second: &mut [T],
    ) -> Result<(), SolveError> {
        let nv = continuum.topology().nv();
        DimensionError::expect("forces tau", nv, tau.len())?;
        DimensionError::expect("accelerations", nv, second.len())?;
        let still = std::mem::take(&mut self.still);
        let mut force = std::mem::take(&mut self.force);
        let done = self.accelerate(continuum, &Moving { q: s, v: rate, a: &still[..] }, tau, loads, (&mut force, second));
        (self.still, self.force) = (still, force);
        done
    }

    /// The accelerations, and the forces of the state in a workspace.
    fn accelerate(
        &mut self,
        continuum: &Continuum,
        state: &Moving<&[T]>,
        tau: &[T],
        loads: &[Load],
        (force, second): (&mut [T], &mut [T]),
    ) -> Result<(), SolveError> {
        if !continuum.is_direct() {
            let mass = self.mass(continuum, state.q)?;
            self.mass.run(&mass)?;
            self.inverse(continuum, state.q, state.v, state.a, loads, force)?;
            second.iter_mut().zip(tau).zip(force).for_each(|((second, tau), force)| *second = *tau - *force);
            return Ok(self.mass.solve(second)?);
        }
        self.embed(continuum, state.q, state.v, state.a)?;
        self.load(continuum, loads)?;
        force.fill(T::zero());
        continuum.add_resistance(state.q, state.v, force);
        force.iter_mut().zip(tau).for_each(|(force, tau)| *force = *tau - *force);
        let wrenches = if loads.is_empty() { None } else { Some(&self.wrenches[..]) };
        Ok(self.aba.run(continuum.model(), state.q, state.v, force, wrenches, second)?)
    }
}

/// The dynamics that are compiled here, once, as addresses: for motions whose loads others choose.
#[doc(hidden)]
#[inline(never)]
pub fn instances() -> [*const (); 2] {
    [Solver::<f64>::forward as *const (), Solver::<Dual<f64>>::forward as *const ()]
}

/// Kinetic and gravitational energy of a reduced state, with the elastic energy in the potential; it allocates.
///
/// # Errors
/// [`DimensionError`] when an argument does not fit.
pub fn energies(continuum: &Continuum, s: &[f64], rate: &[f64]) -> Result<Energies<f64>, DimensionError> {
    let mut solver = Solver::new(continuum);
    let zeros = vec![0.0; continuum.topology().nv()];
    solver.embed(continuum, s, rate, &zeros)?;
    let rigid = Energy::new(&continuum.model().topology).run(continuum.model(), &solver.q, &solver.v)?;
    Ok(Energies { potential: rigid.potential + continuum.elastic_energy(s)?, ..rigid })
}

/// Centroidal momentum of a reduced state; it allocates.
///
/// # Errors
/// [`DimensionError`] when an argument does not fit.
pub fn momentum(continuum: &Continuum, s: &[f64], rate: &[f64]) -> Result<CentroidalMomentum<f64>, DimensionError> {
    let mut solver = Solver::new(continuum);
    let zeros = vec![0.0; continuum.topology().nv()];
    solver.embed(continuum, s, rate, &zeros)?;
    Momentum::new(&continuum.model().topology).run(continuum.model(), &solver.q, &solver.v)
}

/// A continuum as the right-hand side of integrators, with loads that may depend on time. Its derivatives come from dual numbers.
///
/// Stiff rods: [`ImplicitMidpoint::step_by_newton`](featherbench_dynamics::integrate::ImplicitMidpoint::step_by_newton).
pub struct Motion<'a, L> {
    continuum: &'a Continuum,
    loads: L,
    plain: Solver<f64>,
    dual: Solver<Dual<f64>>,
    tau: Vec<f64>,
    dual_tau: Vec<Dual<f64>>,
}

impl<'a, L: FnMut(f64) -> Vec<Load>> Motion<'a, L> {
    /// The motion under the loads of each time.
    pub fn new(continuum: &'a Continuum, loads: L) -> Self {
        let nv = continuum.topology().nv();
        Self {
            continuum,
            loads,
            plain: Solver::new(continuum),
            dual: Solver::new(continuum),
            tau: vec![0.0; nv],
            dual_tau: vec![Dual::constant(0.0); nv],
        }
    }
}

/// The error of the dynamics; loads were checked before.
fn of_dynamics(error: SolveError) -> Error {
    match error {
        SolveError::Dynamics(error) => error,
        _ => DimensionError { what: "loads on bodies that move", expected: 1, found: 0 }.into(),
    }
}

impl<L: FnMut(f64) -> Vec<Load>> Acceleration<f64> for Motion<'_, L> {
    fn acceleration(&mut self, t: f64, q: &[f64], v: &[f64], a: &mut [f64]) -> Result<(), Error> {
        let loads = (self.loads)(t);
        self.plain.forward(self.continuum, q, v, &self.tau, &loads, a).map_err(of_dynamics)
    }
}

impl<L: FnMut(f64) -> Vec<Load>> Linearise<f64> for Motion<'_, L> {
    fn controls(&self) -> usize {
        0
    }

    fn parameters(&self) -> usize {
        0
    }

    fn set_controls(&mut self, controls: &[f64]) -> Result<(), DimensionError> {
        DimensionError::expect("controls", 0, controls.len())
    }

    fn set_parameters(&mut self, parameters: &[f64]) -> Result<(), DimensionError> {
        DimensionError::expect("parameters", 0, parameters.len())
    }

    fn linearise(&mut self, t: f64, q: &[f64], v: &[f64], a: &mut [f64], result: &mut Linearisation<f64>) -> Result<(), Error> {
        self.acceleration(t, q, v, a)?;
        let square = self.tau.len() * self.tau.len();
        DimensionError::expect("derivatives by q", square, result.by_q.len())?;
        DimensionError::expect("derivatives by v", square, result.by_v.len())?;
        let (loads, topology) = ((self.loads)(t), self.continuum.topology());
        let nv = topology.nv();
        let constant = |x: &[f64]| x.iter().map(|x| Dual::constant(*x)).collect::<Vec<_>>();
        let (base_q, base_v) = (constant(q), constant(v));
        let (mut moved, mut direction, mut out) = (base_q.clone(), constant(&vec![0.0; nv]), constant(&vec![0.0; nv]));
        for j in 0..nv {
            direction[j] = Dual::new(0.0, 1.0);
            topology.integrate(&base_q, &direction, &mut moved)?;
            direction[j] = Dual::constant(0.0);
            self.dual.forward(self.continuum, &moved, &base_v, &self.dual_tau, &loads, &mut out).map_err(of_dynamics)?;
            out.iter().enumerate().for_each(|(i, out)| result.by_q[i * nv + j] = out.derivative);
            let mut faster = base_v.clone();
            faster[j].derivative = 1.0;
            self.dual.forward(self.continuum, &base_q, &faster, &self.dual_tau, &loads, &mut out).map_err(of_dynamics)?;
            out.iter().enumerate().for_each(|(i, out)| result.by_v[i * nv + j] = out.derivative);
        }
        Ok(())
    }
}
