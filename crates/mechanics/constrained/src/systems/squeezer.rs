//! Andrews' squeezing mechanism: seven bodies in a plane, three loops through one point, driven by a constant torque.
//!
//! Bodies K1 … K7 in the notation of the source; the dofs here are β (K1), Θ (K2 on K1), γ (K3), δ (K5), Φ (K4 on K5), ε (K7), Ω (K6 on
//! K7). K2, K3, K4 and K6 meet in point E. A spring pulls point D of K3 to point C of the ground. Motion is in the xy-plane about z,
//! without gravity.
//! Source: W. Schiehlen (ed.), *Multibody Systems Handbook* (1990); E. Hairer and G. Wanner, *Solving Ordinary Differential Equations II*,
//! section VII.7, with the numbers of the test set for IVP solvers (problem *Andrews' squeezing mechanism*). Units: SI.

use super::parts::{at, body, closed};
use crate::mechanism::{BadMechanism, Mechanism};
use featherbench_model::Description;
use featherbench_model::LoopMotion;

/// Andrews' squeezing mechanism.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Squeezer {
    /// Masses of K1 … K7, kg.
    pub mass: [f64; 7],
    /// Inertias of K1 … K7 about their centres, kg·m².
    pub inertia: [f64; 7],
    /// Hinge of K5 and K7 on the ground, m.
    pub a: [f64; 2],
    /// Hinge of K3 on the ground, m.
    pub b: [f64; 2],
    /// The spring's end on the ground, m.
    pub c: [f64; 2],
    /// The spring's stiffness, N/m.
    pub stiffness: f64,
    /// The spring's length without force, m.
    pub spring: f64,
    /// The driving torque on K1, N·m.
    pub torque: f64,
    /// K1: length, and distance of its centre: rr, ra.
    pub k1: [f64; 2],
    /// K2: d, da.
    pub k2: [f64; 2],
    /// K3: distances ss, sa, sb, sc and sd.
    pub k3: [f64; 5],
    /// K4: e, ea.
    pub k4: [f64; 2],
    /// K5: zt, ta, tb.
    pub k5: [f64; 3],
    /// K6: zf, fa.
    pub k6: [f64; 2],
    /// K7: u, ua, ub.
    pub k7: [f64; 3],
}

impl Default for Squeezer {
    /// The numbers of the test set.
    fn default() -> Self {
        Self {
            mass: [0.04325, 0.00365, 0.02373, 0.00706, 0.07050, 0.00706, 0.05498],
            inertia: [2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5],
            a: [-0.06934, -0.00227],
            b: [-0.03635, 0.03273],
            c: [0.014, 0.072],
            stiffness: 4530.0,
            spring: 0.07785,
            torque: 0.033,
            k1: [0.007, 0.00092],
            k2: [0.028, 0.0115],
            k3: [0.035, 0.01874, 0.01043, 0.018, 0.02],
            k4: [0.02, 0.01421],
            k5: [0.04, 0.02308, 0.00916],
            k6: [0.02, 0.01421],
            k7: [0.04, 0.01228, 0.00449],
        }
    }
}

impl Squeezer {
    /// The robot. Its three loops are hinges: 15 rows of rank 6.
    ///
    /// # Errors
    /// [`BadMechanism`] when a mass or length makes no sense.
    pub fn mechanism(&self) -> Result<Mechanism, BadMechanism> {
        Mechanism::of(&self.description())
    }

    /// The robot as a description that has the loops' joints in its section `loops`.
    pub fn description(&self) -> Description {
        let z = [0.0, 0.0, 1.0];
        let ground = |[x, y]: [f64; 2]| [x, y, 0.0];
        let link = |k: usize, parent, place, com| {
            let inertia = self.inertia[k - 1];
            // A body that moves in the plane: only its zz counts, and a flat one has xx = yy = zz/2.
            let flat = [0.5 * inertia, 0.0, 0.0, 0.5 * inertia, 0.0, inertia];
            body(&format!("K{k}"), parent, place, z, self.mass[k - 1], com, flat)
        };
        let [ss, sa, sb, ..] = self.k3;
        let bodies = vec![
            link(1, None, [0.0; 3], [self.k1[1], 0.0, 0.0]),
            link(2, Some(0), [self.k1[0], 0.0, 0.0], [-self.k2[1], 0.0, 0.0]),
            link(3, None, ground(self.b), [sb, -sa, 0.0]),
            link(5, None, ground(self.a), [self.k5[1], self.k5[2], 0.0]),
            link(4, Some(3), [self.k5[0], 0.0, 0.0], [0.0, self.k4[1] - self.k4[0], 0.0]),
            link(7, None, ground(self.a), [self.k7[1], self.k7[2], 0.0]),
            link(6, Some(5), [0.0, -self.k7[0], 0.0], [self.k6[0] - self.k6[1], 0.0, 0.0]),
        ];
        let meets = |name: &str, body, point| {
            let on_k2 = (Some(1), at([-self.k2[0], 0.0, 0.0]));
            closed(format!("E of {name}"), [on_k2, (Some(body), at(point))], LoopMotion::Revolute)
        };
        let loops = vec![meets("K3", 2, [0.0, -ss, 0.0]), meets("K4", 4, [0.0, -self.k4[0], 0.0]), meets("K6", 6, [self.k6[0], 0.0, 0.0])];
        Description { name: "squeezer".into(), bodies, loops, ..Description::default() }
    }

    /// The consistent configuration at t = 0 of the test set, for its own numbers: β, Θ, γ, δ, Φ, ε, Ω.
    pub fn start() -> [f64; 7] {
        [
            -0.061_713_890_014_276_45,
            0.0,
            0.455_279_819_163_070_37,
            0.487_364_979_543_842_56,
            0.222_668_390_165_885_88,
            1.230_547_444_549_821_2,
            -0.222_668_390_165_885_88,
        ]
    }

    /// The spring's ends: D in the axes of K3, the third body of the description, and C on the ground, m.
    pub fn spring_ends(&self) -> [[f64; 3]; 2] {
        let [.., sc, sd] = self.k3;
        [[sd, -sc, 0.0], [self.c[0], self.c[1], 0.0]]
    }

    /// Adds the driving torque and the spring's moment about B to the joint forces of this configuration.
    pub fn add_forces(&self, q: &[f64], tau: &mut [f64]) {
        let [.., sc, sd] = self.k3;
        let (sin, cos) = q[2].sin_cos();
        // From B to D, and from C to D.
        let arm = [sd * cos + sc * sin, sd * sin - sc * cos];
        let way = [self.b[0] + arm[0] - self.c[0], self.b[1] + arm[1] - self.c[1]];
        let length = way[0].hypot(way[1]);
        let pull = -self.stiffness * (length - self.spring) / length;
        tau[0] += self.torque;
        tau[2] += pull * (arm[0] * way[1] - arm[1] * way[0]);
    }
}
