//! Drives that answer late: a lag of first order, and a pure delay.
//!
//! Both put out z where u was commanded: M a + h = z, so r = u − z.

use crate::error::{demand, expect};
use crate::{Residual, ResidualError, State};

/// A lag of first order: T ż = u − z. The inner state is z, the force of each drive.
#[derive(Clone, Debug, PartialEq)]
pub struct Lag {
    time: Vec<f64>,
}

impl Lag {
    /// Of a time constant T per dof, s.
    ///
    /// # Errors
    /// [`ResidualError::Parameter`] if one is not positive and finite.
    pub fn new(time: Vec<f64>) -> Result<Self, ResidualError> {
        demand("time constant", &time, "it must be finite and positive; leave the residual out for none", |x| x > 0.0)?;
        Ok(Self { time })
    }
}

impl Residual for Lag {
    fn nv(&self) -> usize {
        self.time.len()
    }

    fn add(&self, state: &State<'_>, r: &mut [f64]) -> Result<(), ResidualError> {
        for ((r, u), z) in r.iter_mut().zip(state.commanded()?).zip(state.inner) {
            *r += u - z;
        }
        Ok(())
    }

    fn inner(&self) -> usize {
        self.time.len()
    }

    fn inner_rate(&self, state: &State<'_>, rate: &mut [f64]) -> Result<(), ResidualError> {
        let command = state.commanded()?;
        for (k, rate) in rate.iter_mut().enumerate() {
            *rate = (command[k] - state.inner[k]) / self.time[k];
        }
        Ok(())
    }
}

/// A pure delay of a whole number of control periods: z(t) = u(t − N h). The inner state is the last N commands, the oldest first; its
/// time derivative is zero, and [`Delay::advance`] replaces it once a period.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Delay {
    nv: usize,
    periods: usize,
}

impl Delay {
    /// A delay of this many periods, for robots with `nv` dofs.
    pub fn new(nv: usize, periods: usize) -> Self {
        Self { nv, periods }
    }

    /// Ends a control period, in which `command` was commanded: the oldest command is forgotten.
    ///
    /// # Errors
    /// [`ResidualError::Dimension`] when a length does not fit.
    pub fn advance(&self, inner: &mut [f64], command: &[f64]) -> Result<(), ResidualError> {
        expect("inner state of the delay", self.inner(), inner.len())?;
        expect("commanded joint forces", self.nv, command.len())?;
        if self.periods > 0 {
            inner.copy_within(self.nv.., 0);
            let newest = inner.len() - self.nv;
            inner[newest..].copy_from_slice(command);
        }
        Ok(())
    }
}

impl Residual for Delay {
    fn nv(&self) -> usize {
        self.nv
    }

    fn add(&self, state: &State<'_>, r: &mut [f64]) -> Result<(), ResidualError> {
        let command = state.commanded()?;
        // Without periods there is no delay, and z = u.
        for ((r, u), z) in r.iter_mut().zip(command).zip(state.inner) {
            *r += u - z;
        }
        Ok(())
    }

    fn inner(&self) -> usize {
        self.nv * self.periods
    }
}
