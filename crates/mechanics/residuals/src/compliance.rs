//! Compliance of joints and links: springs and dampers beside the motors.
//!
//! r = K (q ⊖ q₀) + D v, per dof. A flexible link is a joint with a spring and no motor. `q ⊖ q₀` is the difference on the configuration space:
//! q − q₀ for joints with a number per dof. On a spherical or free joint it is a rotation vector, and r is the gradient of ½ K |q ⊖ q₀|² if the
//! joint's three stiffnesses are equal.

use crate::error::{demand, expect, finite};
use crate::{Residual, ResidualError, State};
use featherbench_model::Topology;

/// Springs and dampers in the joints.
#[derive(Clone, Debug, PartialEq)]
pub struct SpringDamper {
    topology: Topology,
    stiffness: Vec<f64>,
    damping: Vec<f64>,
    rest: Vec<f64>,
}

impl SpringDamper {
    /// Of a stiffness (N·m/rad or N/m) and a damping per dof, and the configuration of rest q₀.
    ///
    /// # Errors
    /// [`ResidualError`] if a length is not the tree's, a stiffness or damping is negative, or a number is not finite.
    pub fn new(topology: &Topology, stiffness: Vec<f64>, damping: Vec<f64>, rest: Vec<f64>) -> Result<Self, ResidualError> {
        expect("stiffnesses", topology.nv(), stiffness.len())?;
        expect("dampings", topology.nv(), damping.len())?;
        expect("configuration of rest", topology.nq(), rest.len())?;
        demand("stiffness", &stiffness, "it must be finite and not negative", |x| x >= 0.0)?;
        demand("damping", &damping, "it must be finite and not negative", |x| x >= 0.0)?;
        finite("configuration of rest", &rest)?;
        Ok(Self { topology: topology.clone(), stiffness, damping, rest })
    }
}

impl Residual for SpringDamper {
    fn nv(&self) -> usize {
        self.topology.nv()
    }

    fn nq(&self) -> Option<usize> {
        Some(self.topology.nq())
    }

    fn add(&self, state: &State<'_>, r: &mut [f64]) -> Result<(), ResidualError> {
        let mut bent = vec![0.0; self.topology.nv()];
        self.topology.difference(&self.rest, state.q, &mut bent)?;
        for (k, r) in r.iter_mut().enumerate() {
            *r += self.stiffness[k] * bent[k] + self.damping[k] * state.v[k];
        }
        Ok(())
    }
}
