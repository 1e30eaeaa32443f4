//! Second derivatives of forward dynamics, weighted: those of `λ·FD(q, v, τ)` by (q,q), (q,v), (v,v) and (q,τ), for constant weights λ.
//!
//! Source: S. Singh, R. Russell & P. Wensing, *On second-order derivatives of rigid-body dynamics: theory and implementation* (2023). The
//! equation `ID(q, v, FD(q, v, τ)) = τ` is differentiated twice. With μ = −M⁻¹ λ, the second derivatives H of μ·ID at the solution
//! ([`IdHessian`]), and K = H_qa:
//!
//! ```text
//! (q,q)  H_qq + K ∂v̇/∂q + (K ∂v̇/∂q)ᵀ      (q,v)  H_qv + K ∂v̇/∂v      (v,v)  H_vv      (q,τ)  K M⁻¹
//! ```
//!
//! ID is linear in v̇, and its derivatives by v do not depend on v̇. So those by (v,τ) and (τ,τ) are zero.
//!
//! Frames, tangent space and external wrenches: as [`IdDerivatives`](crate::IdDerivatives) has them. Shapes: q has `nq` numbers; v, τ and λ
//! have `nv`. Each result is `nv`×`nv`, row after row. Units: SI. Cost: O(n + Σ d_k·n), d_k the depth of dof k. A call does not allocate.

use crate::error::expect;
use crate::{Error, FdDerivatives, FdPartials, IdHessian, IdSecondPartials, State};
use featherbench_model::{Model, Topology};
use featherbench_spatial::{Lift, Real};

/// Second derivatives of weighted forward dynamics, `λ·FD(q, v, τ)`, row after row. Those by (v,τ) and (τ,τ) are zero.
#[derive(Clone, Debug, PartialEq)]
pub struct FdSecondPartials<T> {
    /// By q twice: entry (j, k) is the derivative along dof k of that along dof j. As [`IdSecondPartials::qq`] it is symmetric, but for pairs
    /// within a quaternion joint.
    pub qq: Vec<T>,
    /// By q_j and v_k, in entry (j, k).
    pub qv: Vec<T>,
    /// By v twice; symmetric.
    pub vv: Vec<T>,
    /// By q_j and τ_k, in entry (j, k).
    pub qtau: Vec<T>,
}

impl<T: Real> FdSecondPartials<T> {
    /// Zero derivatives for models of this topology.
    pub fn new(topology: &Topology) -> Self {
        let square = || vec![T::zero(); topology.nv() * topology.nv()];
        Self { qq: square(), qv: square(), vv: square(), qtau: square() }
    }
}

/// The workspace of weighted second derivatives of forward dynamics.
///
/// ```
/// use featherbench_dynamics::{FdHessian, FdPartials, FdSecondPartials, State, fd_derivatives};
/// use featherbench_model::Model;
/// use featherbench_robots::{Family, StateBatch};
///
/// let model: Model<f64> = Model::build(&Family::parse("chain:n=4,layout=spatial")?.generate()?)?;
/// let states = StateBatch::random(&model, 1, 7);
/// let (q, v, tau, weights) = (states.q(0), states.v(0), states.tau(0), states.a(0));
/// let (mut first, mut second) = (FdPartials::new(&model.topology), FdSecondPartials::new(&model.topology));
/// let state = State { q, v, given: tau, wrenches: None };
/// FdHessian::new(&model.topology).run(&model, state, weights, &mut first, &mut second)?;
///
/// // What a step of 1e-6 in v₂ does to the weighted derivatives by q.
/// let moved = |step: f64| {
///     let mut v = v.to_vec();
///     v[2] += step;
///     let rows = fd_derivatives(&model, q, &v, tau)?.q;
///     Ok::<_, featherbench_dynamics::Error>([0, 1, 2, 3].map(|j| (0..4).map(|i| weights[i] * rows[4 * i + j]).sum::<f64>()))
/// };
/// let (ahead, behind) = (moved(1e-6)?, moved(-1e-6)?);
/// for j in 0..4 {
///     let difference = (ahead[j] - behind[j]) / 2e-6;
///     assert!((second.qv[4 * j + 2] - difference).abs() < 1e-5 * (1.0 + difference.abs()));
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct FdHessian<T> {
    first: FdDerivatives<T>,
    id: IdHessian<T>,
    /// Those of μ·ID.
    partials: IdSecondPartials<T>,
    /// μ = −M⁻¹ λ.
    weights: Vec<T>,
}

impl<T: Real> FdHessian<T> {
    /// A workspace for models of this topology.
    pub fn new(topology: &Topology) -> Self {
        Self {
            first: FdDerivatives::new(topology),
            id: IdHessian::new(topology),
            partials: IdSecondPartials::new(topology),
            weights: vec![T::zero(); topology.nv()],
        }
    }

    /// The first and second derivatives at a state with joint forces; `weights` is λ.
    ///
    /// # Errors
    /// [`Error`] when an argument, the workspace or a result does not fit the model, or when a joint meets no inertia; the results then mean
    /// nothing.
    #[inline(never)]
    pub fn run<P: Real + Lift<T>>(
        &mut self,
        model: &Model<P>,
        state: State<'_, T>,
        weights: &[T],
        first: &mut FdPartials<T>,
        second: &mut FdSecondPartials<T>,
    ) -> Result<(), Error> {
        let n = model.topology.nv();
        expect("weights", n, weights.len())?;
        expect("weights of the workspace", n, self.weights.len())?;
        for square in [&second.qq, &second.qv, &second.vv, &second.qtau] {
            expect("second derivatives", n * n, square.len())?;
        }
        let State { q, v, given: tau, wrenches } = state;
        self.first.run(model, q, v, tau, wrenches, first)?;

        for (row, mu) in self.weights.iter_mut().enumerate() {
            let inverse = first.tau[row * n..][..n].iter().zip(weights);
            *mu = inverse.fold(T::zero(), |sum, (entry, lambda)| (-*entry).mul_add(*lambda, sum));
        }
        self.id.run(model, State { given: &first.acceleration, ..state }, &self.weights, &mut self.partials)?;
        let IdSecondPartials { qq, vv, qv, qa: k } = &self.partials;

        // second.qv serves as the place of K ∂v̇/∂q
        k.mul_rows(&first.q, &mut second.qv)?;
        qq.write_dense(&mut second.qq)?;
        for i in 0..n {
            for j in 0..n {
                second.qq[i * n + j] += second.qv[i * n + j] + second.qv[j * n + i];
            }
        }
        // second.qtau serves as the place of K ∂v̇/∂v
        qv.write_dense(&mut second.qv)?;
        k.mul_rows(&first.v, &mut second.qtau)?;
        for (sum, share) in second.qv.iter_mut().zip(&second.qtau) {
            *sum += *share;
        }
        for (i, row) in second.vv.chunks_exact_mut(n).enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                *entry = vv.get(i, j);
            }
        }
        k.mul_rows(&first.tau, &mut second.qtau)?;
        Ok(())
    }
}

/// The second derivatives of `λ·FD` in a workspace of the call, without external wrenches; it allocates.
///
/// # Errors
/// [`Error`] when an argument does not fit the model, or a joint meets no inertia.
pub fn fd_hessian<T: Real, P: Real + Lift<T>>(
    model: &Model<P>,
    q: &[T],
    v: &[T],
    tau: &[T],
    weights: &[T],
) -> Result<FdSecondPartials<T>, Error> {
    let (mut first, mut second) = (FdPartials::new(&model.topology), FdSecondPartials::new(&model.topology));
    FdHessian::new(&model.topology).run(model, State { q, v, given: tau, wrenches: None }, weights, &mut first, &mut second)?;
    Ok(second)
}
