//! Two pendulums that are tied to each other: one degree of freedom, by each kind of loop that is no hinge.
//!
//! The second angle is a polynomial of the first, θ₂ = p(θ₁). Angles are from hanging down, so
//!
//! ```text
//! T = ½ (I₁ + p'² I₂) θ̇₁²        V = −c₁ cos θ₁ − c₂ cos p        I_k = (m_k/3 + b_k) l_k²        c_k = (m_k/2 + b_k) g l_k
//! (I₁ + p'² I₂) θ̈₁ = −I₂ p' p'' θ̇₁² − c₁ sin θ₁ − p' c₂ sin p
//! ```
//!
//! | [`Tie`] | p(θ) | rows |
//! |---|---|---|
//! | `Gear` | offset + ratio θ | one, linear |
//! | `Cam` | offset + ratio θ + square θ² | one, a mimicked joint |
//! | `Rod` | θ: a rod without mass between the ends of cranks of one length | one distance |
//! | `Weld` | θ: both hang on one hinge, and are welded | six of rank one |
//!
//! Each pendulum is a rod of mass m with a point mass b at its end. Rods of one length without it fall alike, and a tie of one angle to the
//! other would carry no force.
//!
//! Source: Lagrange's equation of one coordinate. Frames: motion in the xz-plane about y, gravity along −z. Units: SI.

use super::parts::{at, body, closed};
use crate::mechanism::{BadMechanism, Mechanism};
use featherbench_model::{Description, Loop, LoopEnd, LoopKind, LoopMotion};

/// What ties the pendulums.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tie {
    /// A gear.
    Gear,
    /// A joint that follows the other by a polynomial of degree two.
    Cam,
    /// A rod without mass.
    Rod,
    /// A weld.
    Weld,
}

impl Tie {
    /// All ties.
    pub const ALL: [Self; 4] = [Self::Gear, Self::Cam, Self::Rod, Self::Weld];
}

/// Two pendulums that are tied to each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// What ties them.
    pub tie: Tie,
    /// Masses of the rods, kg.
    pub mass: [f64; 2],
    /// Point masses at their ends, kg.
    pub bob: [f64; 2],
    /// Lengths, m. Those of [`Tie::Rod`] are equal.
    pub length: [f64; 2],
    /// θ₂ where θ₁ is zero, of a gear or a cam, rad.
    pub offset: f64,
    /// Ratio of a gear or a cam.
    pub ratio: f64,
    /// Coefficient of the square, of a cam, 1/rad.
    pub square: f64,
    /// Distance of the hinges, m, but of [`Tie::Weld`].
    pub apart: f64,
    /// Gravitational acceleration g, m/s².
    pub gravity: f64,
}

impl Pair {
    /// Rods of 1 m with 1 kg and 2.5 kg; the second has 1.5 kg at its end.
    pub fn new(tie: Tie) -> Self {
        Self { tie, mass: [1.0, 2.5], bob: [0.0, 1.5], length: [1.0; 2], offset: 0.3, ratio: -1.5, square: 0.4, apart: 1.5, gravity: 9.81 }
    }

    /// The robot.
    ///
    /// # Errors
    /// [`BadMechanism`] when a mass or length makes no sense.
    ///
    /// ```
    /// use featherbench_constrained::systems::{Pair, Tie};
    /// let pair = Pair::new(Tie::Rod);
    /// assert_eq!(pair.mechanism()?.model.topology.nv(), 2);
    /// assert_eq!(pair.configuration(0.2), [0.2, 0.2]);
    /// # Ok::<(), featherbench_constrained::BadMechanism>(())
    /// ```
    pub fn mechanism(&self) -> Result<Mechanism, BadMechanism> {
        Mechanism::of(&self.description())
    }

    /// The robot as a description with its section `loops`. Its dofs are θ₁ and θ₂.
    pub fn description(&self) -> Description {
        let apart = if self.tie == Tie::Weld { 0.0 } else { self.apart };
        let tips = self.length.map(|length| [0.0, 0.0, -length]);
        let pendulum = |k: usize, place: f64| {
            let (rod, bob, length) = (self.mass[k], self.bob[k], self.length[k]);
            let mass = rod + bob;
            let com = (0.5 * rod + bob) * length / mass;
            // About the common centre of mass: that of the rod, and both masses at their distances.
            let across = rod * (length * length / 12.0 + (com - 0.5 * length).powi(2)) + bob * (length - com).powi(2);
            let inertia = [across, 0.0, 0.0, across, 0.0, 0.0];
            body(&format!("pendulum {}", k + 1), None, [place, 0.0, 0.0], [0.0, 1.0, 0.0], mass, [0.0, 0.0, -com], inertia)
        };
        let on = |k: usize| LoopEnd { body: Some(k), placement: at(tips[k]) };
        let tie = match self.tie {
            Tie::Gear => {
                Loop { name: "gear".into(), kind: LoopKind::Gear { terms: vec![(1, 1.0), (0, -self.ratio)], offset: self.offset } }
            }
            Tie::Cam => {
                let polynomial = [self.offset, self.ratio, self.square, 0.0, 0.0];
                Loop { name: "cam".into(), kind: LoopKind::Mimic { follower: 1, leader: 0, polynomial } }
            }
            Tie::Rod => Loop { name: "rod".into(), kind: LoopKind::Distance { ends: [on(0), on(1)], length: apart } },
            Tie::Weld => closed("weld".into(), [(Some(0), at([0.0; 3])), (Some(1), at([0.0; 3]))], LoopMotion::Fixed),
        };
        Description {
            name: tie.name.clone(),
            gravity: [0.0, 0.0, -self.gravity],
            bodies: vec![pendulum(0, 0.0), pendulum(1, apart)],
            loops: vec![tie],
            ..Description::default()
        }
    }

    /// p, p' and p'' at θ₁.
    fn follower(&self, theta: f64) -> [f64; 3] {
        let Self { offset, ratio, square, .. } = *self;
        match self.tie {
            Tie::Gear => [offset + ratio * theta, ratio, 0.0],
            Tie::Cam => [offset + theta * (ratio + square * theta), ratio + 2.0 * square * theta, 2.0 * square],
            Tie::Rod | Tie::Weld => [theta, 1.0, 0.0],
        }
    }

    /// The configuration where the first angle is θ₁.
    pub fn configuration(&self, theta: f64) -> [f64; 2] {
        [theta, self.follower(theta)[0]]
    }

    /// The velocities where the first is θ̇₁.
    pub fn velocity(&self, theta: f64, rate: f64) -> [f64; 2] {
        [rate, self.follower(theta)[1] * rate]
    }

    /// The closed form of both accelerations.
    pub fn acceleration(&self, theta: f64, rate: f64) -> [f64; 2] {
        let [p, slope, bend] = self.follower(theta);
        let inertia = |k: usize| (self.mass[k] / 3.0 + self.bob[k]) * self.length[k] * self.length[k];
        let moment = |k: usize| (0.5 * self.mass[k] + self.bob[k]) * self.gravity * self.length[k];
        let pull = inertia(1) * slope * bend * rate * rate + moment(0) * theta.sin() + slope * moment(1) * p.sin();
        let first = -pull / (inertia(0) + slope * slope * inertia(1));
        [first, slope * first + bend * rate * rate]
    }
}
