//! The trait of all residuals, their sum, and none.

use crate::ResidualError;
use crate::error::{expect, finite};
use nalgebra::DMatrix;
use std::fmt::Debug;

/// What a residual may depend on.
///
/// Shapes: `q` has nq numbers, `v` and `a` have nv. `command`, the joint forces that are asked for, has nv or none. `inner` has what
/// [`Residual::inner`] says.
#[derive(Clone, Copy, Debug)]
pub struct State<'a> {
    /// The configuration.
    pub q: &'a [f64],
    /// The velocity.
    pub v: &'a [f64],
    /// The acceleration.
    pub a: &'a [f64],
    /// The commanded joint forces; empty if they are not known.
    pub command: &'a [f64],
    /// The inner state of the residual, of a sum one after the other.
    pub inner: &'a [f64],
}

impl<'a> State<'a> {
    /// A state without commands and without inner state.
    pub fn new(q: &'a [f64], v: &'a [f64], a: &'a [f64]) -> Self {
        Self { q, v, a, command: &[], inner: &[] }
    }

    /// The same with the commanded joint forces.
    pub fn with_command(self, command: &'a [f64]) -> Self {
        Self { command, ..self }
    }

    /// The same with an inner state.
    pub fn with_inner(self, inner: &'a [f64]) -> Self {
        Self { inner, ..self }
    }

    /// The commanded joint forces, or an error if there are none.
    pub(crate) fn commanded(&self) -> Result<&'a [f64], ResidualError> {
        if self.command.is_empty() { Err(ResidualError::NoCommand) } else { Ok(self.command) }
    }
}

/// A residual: the joint forces r(q, v, a) that the true robot needs beyond the nominal model's, `τ = ID(q, v, a) + r(q, v, a)`.
///
/// Units: N·m or N, those of the dof's joint force. A residual of one's own:
///
/// ```
/// use featherbench_residuals::{Residual, ResidualError, State};
/// /// Air drag of one joint: c v |v|.
/// #[derive(Debug)]
/// struct Drag(f64);
/// impl Residual for Drag {
///     fn nv(&self) -> usize {
///         1
///     }
///     fn add(&self, state: &State<'_>, r: &mut [f64]) -> Result<(), ResidualError> {
///         r[0] += self.0 * state.v[0] * state.v[0].abs();
///         Ok(())
///     }
/// }
/// assert_eq!(Drag(0.5).value(&State::new(&[0.0], &[-2.0], &[0.0]))?, [-2.0]);
/// # Ok::<(), ResidualError>(())
/// ```
pub trait Residual: Debug + Send + Sync {
    /// Degrees of freedom of the robots that it is for.
    fn nv(&self) -> usize;

    /// The length of q, if the residual depends on it.
    fn nq(&self) -> Option<usize> {
        None
    }

    /// Adds r to `r`, which has nv numbers. The state fits: [`Residual::value`] and [`crate::Corrected`] check it before.
    ///
    /// # Errors
    /// [`ResidualError`], where r has no single value or lacks what it depends on.
    fn add(&self, state: &State<'_>, r: &mut [f64]) -> Result<(), ResidualError>;

    /// Whether r depends on the acceleration. If not, [`Residual::add_by_acceleration`] is not asked.
    fn has_acceleration(&self) -> bool {
        false
    }

    /// Adds ∂r/∂a, nv × nv, to `matrix`.
    ///
    /// # Errors
    /// As [`Residual::add`].
    fn add_by_acceleration(&self, _state: &State<'_>, _matrix: &mut DMatrix<f64>) -> Result<(), ResidualError> {
        Ok(())
    }

    /// The length of its inner state.
    fn inner(&self) -> usize {
        0
    }

    /// Writes the time derivative of the inner state. A residual with a history ([`crate::Delay`]) leaves it zero and is advanced by its own
    /// function.
    ///
    /// # Errors
    /// As [`Residual::add`].
    fn inner_rate(&self, _state: &State<'_>, rate: &mut [f64]) -> Result<(), ResidualError> {
        rate.fill(0.0);
        Ok(())
    }

    /// r of a state.
    ///
    /// # Errors
    /// [`ResidualError`] when the state does not fit, a number is not finite, or r has no single value.
    fn value(&self, state: &State<'_>) -> Result<Vec<f64>, ResidualError> {
        check(self, state)?;
        let mut r = vec![0.0; self.nv()];
        self.add(state, &mut r)?;
        finite("the residual r", &r)?;
        Ok(r)
    }

    /// ∂r/∂a of a state, nv × nv.
    ///
    /// # Errors
    /// As [`Residual::value`].
    fn by_acceleration(&self, state: &State<'_>) -> Result<DMatrix<f64>, ResidualError> {
        check(self, state)?;
        let mut matrix = DMatrix::zeros(self.nv(), self.nv());
        if self.has_acceleration() {
            self.add_by_acceleration(state, &mut matrix)?;
        }
        finite("∂r/∂a", matrix.as_slice())?;
        Ok(matrix)
    }
}

/// An error if the state does not fit the residual, or has a number that is not finite.
pub(crate) fn check<R: Residual + ?Sized>(residual: &R, state: &State<'_>) -> Result<(), ResidualError> {
    if let Some(nq) = residual.nq() {
        expect("configuration q", nq, state.q.len())?;
    }
    expect("velocity v", residual.nv(), state.v.len())?;
    expect("acceleration a", residual.nv(), state.a.len())?;
    if !state.command.is_empty() {
        expect("commanded joint forces", residual.nv(), state.command.len())?;
    }
    expect("inner state of the residual", residual.inner(), state.inner.len())?;
    finite("configuration q", state.q)?;
    finite("velocity v", state.v)?;
    finite("acceleration a", state.a)?;
    finite("commanded joint forces", state.command)?;
    finite("inner state of the residual", state.inner)
}

impl<R: Residual + ?Sized> Residual for Box<R> {
    fn nv(&self) -> usize {
        (**self).nv()
    }

    fn nq(&self) -> Option<usize> {
        (**self).nq()
    }

    fn add(&self, state: &State<'_>, r: &mut [f64]) -> Result<(), ResidualError> {
        (**self).add(state, r)
    }

    fn has_acceleration(&self) -> bool {
        (**self).has_acceleration()
    }

    fn add_by_acceleration(&self, state: &State<'_>, matrix: &mut DMatrix<f64>) -> Result<(), ResidualError> {
        (**self).add_by_acceleration(state, matrix)
    }

    fn inner(&self) -> usize {
        (**self).inner()
    }

    fn inner_rate(&self, state: &State<'_>, rate: &mut [f64]) -> Result<(), ResidualError> {
        (**self).inner_rate(state, rate)
    }
}

/// No residual: the nominal model is the true one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Zero {
    nv: usize,
}

impl Zero {
    /// For robots with this many dofs.
    pub fn new(nv: usize) -> Self {
        Self { nv }
    }
}

impl Residual for Zero {
    fn nv(&self) -> usize {
        self.nv
    }

    fn add(&self, _: &State<'_>, _: &mut [f64]) -> Result<(), ResidualError> {
        Ok(())
    }
}

/// The sum of residuals. Their inner states stand one after the other.
#[derive(Debug)]
pub struct Sum {
    nv: usize,
    nq: Option<usize>,
    parts: Vec<Box<dyn Residual>>,
}

impl Sum {
    /// The sum of these, for robots with `nv` dofs.
    ///
    /// # Errors
    /// [`ResidualError::Dimension`] if one is for robots with another nv or nq.
    pub fn new(nv: usize, parts: Vec<Box<dyn Residual>>) -> Result<Self, ResidualError> {
        let mut nq = None;
        for part in &parts {
            expect("dofs of a residual of the sum", nv, part.nv())?;
            if let (Some(first), Some(other)) = (nq, part.nq()) {
                expect("length of q of a residual of the sum", first, other)?;
            }
            nq = nq.or(part.nq());
        }
        Ok(Self { nv, nq, parts })
    }

    /// The residual of this place in the sum.
    pub(crate) fn part(&self, index: usize) -> Option<&dyn Residual> {
        self.parts.get(index).map(AsRef::as_ref)
    }

    /// The residuals, each with its part of the inner state.
    fn each<'a>(&'a self, state: &State<'a>) -> impl Iterator<Item = (&'a dyn Residual, State<'a>)> {
        let mut rest = state.inner;
        let state = *state;
        self.parts.iter().map(move |part| {
            let (own, behind) = rest.split_at(part.inner().min(rest.len()));
            rest = behind;
            (part.as_ref(), State { inner: own, ..state })
        })
    }
}

impl Residual for Sum {
    fn nv(&self) -> usize {
        self.nv
    }

    fn nq(&self) -> Option<usize> {
        self.nq
    }

    fn add(&self, state: &State<'_>, r: &mut [f64]) -> Result<(), ResidualError> {
        self.each(state).try_for_each(|(part, state)| part.add(&state, r))
    }

    fn has_acceleration(&self) -> bool {
        self.parts.iter().any(|part| part.has_acceleration())
    }

    fn add_by_acceleration(&self, state: &State<'_>, matrix: &mut DMatrix<f64>) -> Result<(), ResidualError> {
        self.each(state).try_for_each(|(part, state)| part.add_by_acceleration(&state, matrix))
    }

    fn inner(&self) -> usize {
        self.parts.iter().map(|part| part.inner()).sum()
    }

    fn inner_rate(&self, state: &State<'_>, rate: &mut [f64]) -> Result<(), ResidualError> {
        let mut rest = rate;
        for (part, state) in self.each(state) {
            let (own, behind) = rest.split_at_mut(part.inner());
            part.inner_rate(&state, own)?;
            rest = behind;
        }
        Ok(())
    }
}
