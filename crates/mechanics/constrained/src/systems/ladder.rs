//! N parallelograms in a row: N + 1 parallel cranks on the ground, joined by N couplers. One window is the parallelogram four-bar.
//!
//! All cranks have one angle θ, from hanging down. The couplers only translate, so
//!
//! ```text
//! T = ½ ((N+1) m_c a²/3 + N m_k a²) θ̇²        V = −((N+1) m_c/2 + N m_k) g a cos θ
//! θ̈ = −((N+1) m_c/2 + N m_k) g a sin θ / ((N+1) m_c a²/3 + N m_k a²)
//! ```
//!
//! At θ = ±90° all bars are on one line: each loop loses a row, and the mobility is N + 1 instead of 1.
//! Source: IFToMM T.C. for Multibody Dynamics, benchmark A02 (rods of 1 kg and 1 m, ẋ_B0 = 1 m/s from the upright position, 10 s).
//! Frames: motion in the xz-plane about y, gravity along −z. Units: SI.

use super::parts::{about_y, rod};
use crate::mechanism::{BadMechanism, Mechanism};
use featherbench_model::{Description, Loop, LoopEnd, LoopKind, LoopMotion};

/// N parallelograms in a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ladder {
    /// N.
    pub windows: usize,
    /// Length a of the cranks, m.
    pub crank: f64,
    /// Length of the couplers, m.
    pub coupler: f64,
    /// Mass m_c of a crank, kg.
    pub crank_mass: f64,
    /// Mass m_k of a coupler, kg.
    pub coupler_mass: f64,
    /// Gravitational acceleration g, m/s².
    pub gravity: f64,
}

impl Default for Ladder {
    /// One window of rods of 1 kg and 1 m.
    fn default() -> Self {
        Self { windows: 1, crank: 1.0, coupler: 1.0, crank_mass: 1.0, coupler_mass: 1.0, gravity: 9.81 }
    }
}

impl Ladder {
    /// The robot. Its dofs are crank 0, coupler 1, crank 1, coupler 2, …: a coupler hangs on the crank before it, and its far end is the
    /// loop's hinge with its own crank.
    ///
    /// # Errors
    /// [`BadMechanism`] when a mass or length makes no sense.
    pub fn mechanism(&self) -> Result<Mechanism, BadMechanism> {
        Mechanism::of(&self.description())
    }

    /// The robot as a description that has the loops' hinges in its section `loops`.
    pub fn description(&self) -> Description {
        let (axis, tip) = ([0.0, 1.0, 0.0], [0.0, 0.0, -self.crank]);
        let foot = |k: usize| [k as f64 * self.coupler, 0.0, 0.0];
        let end = [self.coupler, 0.0, 0.0];
        let mut bodies = Vec::new();
        let mut loops = Vec::new();
        // Depth first: a crank, then the coupler on it.
        for k in 0..=self.windows {
            bodies.push(rod(&format!("crank {k}"), None, foot(k), axis, tip, self.crank_mass));
            if k < self.windows {
                let coupler = format!("coupler {}", k + 1);
                bodies.push(rod(&coupler, Some(2 * k), tip, axis, end, self.coupler_mass));
                let on = |body: usize, place: [f64; 3]| LoopEnd { body: Some(body), placement: about_y(place) };
                let kind = LoopKind::Joint { ends: [on(2 * k + 2, tip), on(2 * k + 1, end)], motion: LoopMotion::Revolute };
                loops.push(Loop { name: format!("loop {}", k + 1), kind });
            }
        }
        let gravity = [0.0, 0.0, -self.gravity];
        Description { name: format!("ladder-{}", self.windows), gravity, bodies, loops, ..Description::default() }
    }

    /// The configuration with all cranks at angle θ, or their velocities from θ̇: couplers turn back by what the cranks turn.
    pub fn spread(&self, crank: f64) -> Vec<f64> {
        (0..2 * self.windows + 1).map(|dof| if dof % 2 == 0 { crank } else { -crank }).collect()
    }

    /// The closed form of θ̈.
    pub fn acceleration(&self, theta: f64) -> f64 {
        -self.moment() * self.gravity * theta.sin() / self.inertia()
    }

    /// The closed form of the energy, with zero at the height of the ground's hinges.
    pub fn energy(&self, theta: f64, rate: f64) -> f64 {
        0.5 * self.inertia() * rate * rate - self.moment() * self.gravity * theta.cos()
    }

    /// ((N+1) m_c/2 + N m_k) a
    fn moment(&self) -> f64 {
        let windows = self.windows as f64;
        ((windows + 1.0) * 0.5 * self.crank_mass + windows * self.coupler_mass) * self.crank
    }

    /// (N+1) m_c a²/3 + N m_k a²
    fn inertia(&self) -> f64 {
        let windows = self.windows as f64;
        ((windows + 1.0) / 3.0 * self.crank_mass + windows * self.coupler_mass) * self.crank * self.crank
    }
}
