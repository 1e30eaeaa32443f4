//! First derivatives of forward dynamics: ∂v̇/∂q, ∂v̇/∂v and ∂v̇/∂τ = M⁻¹.
//!
//! Source: the articulated-body algorithm (the book, table 7.1), differentiated, with the closed forms of S. Singh, R. Russell & P. Wensing,
//! *Efficient analytical derivatives of rigid-body dynamics using spatial vector algebra* (2022). What each dof changes is passed through the
//! articulated inertias, as forces and accelerations of bodies.
//!
//! **Why not −M⁻¹ ∂ID.** That is the same matrix (J. Carpentier & N. Mansard, 2018), but ∂ID is rounded before M⁻¹ meets it. So the result
//! has the condition number of M in its error, however exact the solution is. Here no joint force is formed. Measured errors:
//! `docs/kernels/derivatives.md`.
//!
//! Frames, tangent space and external wrenches: as [`IdDerivatives`](crate::IdDerivatives) has them. Shapes: q has `nq` numbers; v and τ have
//! `nv`. Each result is `nv`×`nv`, row after row; it is dense within each tree that stands on the world. Units: SI, angles in radians.
//! Cost: O(n²), about a hundred multiply-adds per entry of the three matrices together, of several columns at a time. A call does not allocate.

use super::articulated::Articulated;
use super::response::Response;
use crate::error::expect;
use crate::{Error, State};
use featherbench_model::{Model, Topology};
use featherbench_spatial::{Force, Lift, Real};

/// First derivatives of forward dynamics, and the accelerations at which they are.
#[derive(Clone, Debug, PartialEq)]
pub struct FdPartials<T> {
    /// The accelerations v̇.
    pub acceleration: Vec<T>,
    /// ∂v̇/∂q on the tangent space of the configurations, row after row.
    pub q: Vec<T>,
    /// ∂v̇/∂v, row after row.
    pub v: Vec<T>,
    /// ∂v̇/∂τ = M⁻¹, row after row; symmetric to the bit.
    pub tau: Vec<T>,
}

impl<T: Real> FdPartials<T> {
    /// Zero derivatives for models of this topology.
    pub fn new(topology: &Topology) -> Self {
        let n = topology.nv();
        let square = || vec![T::zero(); n * n];
        Self { acceleration: vec![T::zero(); n], q: square(), v: square(), tau: square() }
    }
}

/// The workspace of the derivatives of forward dynamics.
///
/// ```
/// use featherbench_dynamics::{FdDerivatives, FdPartials, forward_dynamics};
/// use featherbench_model::Model;
/// use featherbench_robots::{Family, StateBatch};
///
/// let model: Model<f64> = Model::build(&Family::parse("chain:n=5,layout=spatial")?.generate()?)?;
/// let states = StateBatch::random(&model, 1, 7);
/// let (q, v, tau) = (states.q(0), states.v(0), states.tau(0));
/// let mut partials = FdPartials::new(&model.topology);
/// FdDerivatives::new(&model.topology).run(&model, q, v, tau, None, &mut partials)?;
///
/// // What a step of 1e-6 in v₂ does to the accelerations.
/// let moved = |step: f64| {
///     let mut v = v.to_vec();
///     v[2] += step;
///     forward_dynamics(&model, q, &v, tau)
/// };
/// let (ahead, behind) = (moved(1e-6)?, moved(-1e-6)?);
/// for i in 0..5 {
///     let difference = (ahead[i] - behind[i]) / 2e-6;
///     assert!((partials.v[5 * i + 2] - difference).abs() < 1e-6 * (1.0 + difference.abs()));
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # A Riccati recursion
///
/// The linear-quadratic regulator about a state, `x⁺ = A x + B u` for steps of h: x = (δq, δv), u = δτ. The recursion needs products with Aᵀ
/// and Bᵀ only. So it takes the tree-sparse derivatives of ID and the factors of M: `(∂v̇/∂q)ᵀ y = −(∂ID/∂q)ᵀ M⁻¹ y`.
///
/// ```
/// use featherbench_dynamics::{Error, fd_derivatives, id_derivatives};
/// use featherbench_model::Model;
/// use featherbench_robots::{Family, StateBatch};
/// use nalgebra::{DMatrix, DVector};
///
/// let model: Model<f64> = Model::build(&Family::parse("chain:n=4,layout=spatial")?.generate()?)?;
/// let (states, n, h) = (StateBatch::random(&model, 1, 7), model.topology.nv(), 0.01);
/// let partials = fd_derivatives(&model, states.q(0), states.v(0), states.tau(0))?;
/// let id = id_derivatives(&model, states.q(0), states.v(0), &partials.acceleration)?;
/// let factors = id.a.clone().into_ltdl()?;
///
/// // Aᵀ Y and Bᵀ Y, column by column
/// let transposed = |y: &DMatrix<f64>| -> Result<[DMatrix<f64>; 2], Error> {
///     let (mut a, mut b) = (y.clone(), DMatrix::zeros(n, y.ncols()));
///     let mut product = vec![0.0; n];
///     for c in 0..y.ncols() {
///         let mut z = y.column(c).rows(n, n).iter().copied().collect::<Vec<_>>();
///         factors.solve(&mut z)?;
///         id.q.mul_transposed(&z, &mut product)?;
///         (0..n).for_each(|k| a[(k, c)] -= h * product[k]);
///         id.v.mul_transposed(&z, &mut product)?;
///         (0..n).for_each(|k| a[(n + k, c)] += h * (y[(k, c)] - product[k]));
///         (0..n).for_each(|k| b[(k, c)] = h * z[k]);
///     }
///     Ok([a, b])
/// };
/// // P = Q + AᵀPA − (BᵀPA)ᵀ K,  K = (R + BᵀPB)⁻¹ BᵀPA, with Q = 1 and R = 0.1
/// let (mut p, mut gains) = (DMatrix::identity(2 * n, 2 * n), Vec::new());
/// for _ in 0..50 {
///     let [a_p, b_p] = transposed(&p)?;
///     let [a_p_a, b_p_a] = transposed(&a_p.transpose())?;
///     let [_, b_p_b] = transposed(&b_p.transpose())?;
///     let gain = (b_p_b + DMatrix::identity(n, n) * 0.1).lu().solve(&b_p_a).ok_or("singular")?;
///     p = DMatrix::identity(2 * n, 2 * n) + a_p_a - b_p_a.transpose() * &gain;
///     gains.push(gain);
/// }
///
/// // The cost along the controlled motion is xᵀ P x.
/// let matrix = |rows: &[f64]| DMatrix::from_row_slice(n, n, rows);
/// let (by_q, by_v, by_tau) = (matrix(&partials.q), matrix(&partials.v), matrix(&partials.tau));
/// let start = DVector::from_fn(2 * n, |k, _| 0.1 * (k as f64 + 1.0));
/// let (mut x, mut cost) = (start.clone(), 0.0);
/// for gain in gains.iter().rev() {
///     let u = -(gain * &x);
///     cost += x.dot(&x) + 0.1 * u.dot(&u);
///     let (q, v) = (x.rows(0, n).clone_owned(), x.rows(n, n).clone_owned());
///     x.rows_mut(0, n).axpy(h, &v, 1.0);
///     x.rows_mut(n, n).axpy(h, &(&by_q * q + &by_v * v + &by_tau * u), 1.0);
/// }
/// cost += x.dot(&x);
/// assert!((start.dot(&(&p * &start)) - cost).abs() < 1e-9 * cost);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct FdDerivatives<T> {
    bodies: Articulated<T>,
    response: Response<T>,
}

impl<T: Real> FdDerivatives<T> {
    /// A workspace for models of this topology.
    pub fn new(topology: &Topology) -> Self {
        Self { bodies: Articulated::new(topology), response: Response::new(topology) }
    }

    /// The derivatives at configuration `q`, velocity `v`, joint forces `tau` and external wrenches.
    ///
    /// # Errors
    /// [`Error`] when an argument, the workspace or `partials` does not fit the model, or when a joint meets no inertia; `partials` then
    /// means nothing.
    #[inline(never)]
    pub fn run<P: Real + Lift<T>>(
        &mut self,
        model: &Model<P>,
        q: &[T],
        v: &[T],
        tau: &[T],
        wrenches: Option<&[Force<T>]>,
        partials: &mut FdPartials<T>,
    ) -> Result<(), Error> {
        let FdPartials { acceleration, q: by_q, v: by_v, tau: by_tau } = partials;
        self.write(model, q, v, tau, wrenches, [acceleration, by_q, by_v, by_tau])
    }

    /// [`FdDerivatives::run`] with v̇, ∂v̇/∂q, ∂v̇/∂v and ∂v̇/∂τ in slices.
    pub(crate) fn write<P: Real + Lift<T>>(
        &mut self,
        model: &Model<P>,
        q: &[T],
        v: &[T],
        tau: &[T],
        wrenches: Option<&[Force<T>]>,
        [a, by_q, by_v, by_tau]: [&mut [T]; 4],
    ) -> Result<(), Error> {
        let topology = &model.topology;
        let n = topology.nv();
        expect("∂v̇/∂q", n * n, by_q.len())?;
        expect("∂v̇/∂v", n * n, by_v.len())?;
        expect("∂v̇/∂τ", n * n, by_tau.len())?;
        self.response.expect_topology(topology)?;

        // Lanes with a bad pivot do no harm to others: the error comes last.
        let pivots = self.bodies.run(model, State { q, v, given: tau, wrenches }, a)?;
        self.response.run(topology, &self.bodies, by_q, by_v, by_tau);
        Ok(pivots.check()?)
    }
}

/// The derivatives of forward dynamics in a workspace of the call, without external wrenches; it allocates.
///
/// # Errors
/// [`Error`] when an argument does not fit the model, or a joint meets no inertia.
pub fn fd_derivatives<T: Real, P: Real + Lift<T>>(model: &Model<P>, q: &[T], v: &[T], tau: &[T]) -> Result<FdPartials<T>, Error> {
    let mut partials = FdPartials::new(&model.topology);
    FdDerivatives::new(&model.topology).run(model, q, v, tau, None, &mut partials)?;
    Ok(partials)
}
