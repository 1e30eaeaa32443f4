//! The trait [`RodSolver`]: an engine that has elastic rods. Oracles offer it by the operation `rod`.

use crate::NoAnswer;

/// A straight uniform rod along x, clamped at the origin, which bends about z; dead forces along y at its tip.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct RodQuestion {
    /// How many elements.
    pub count: usize,
    /// Length, m.
    pub length: f64,
    /// Bending stiffness EI, N·m².
    pub bending: f64,
    /// Mass per length, kg/m; sections have no rotary inertia, as far as the engine can.
    pub mass_per_length: f64,
    /// The forces, each of its own equilibrium on the branch from rest, N.
    pub forces: Vec<f64>,
}

/// What the engine answers.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct RodAnswer {
    /// Of each force, where the tip is: x and y, m.
    pub tips: Vec<[f64; 2]>,
    /// The smallest angular frequencies of the straight rod, up to three, rad/s.
    pub frequencies: Vec<f64>,
    /// The time of one forward dynamics, ns, by the engine's own clock; calls from Python include their overhead.
    pub nanoseconds: f64,
    /// The time to make the rod and its first forward dynamics, ns: some engines compile there.
    pub preparation: f64,
}

/// An engine that has elastic rods.
pub trait RodSolver {
    /// Its elements, the usual one first.
    fn rod_elements(&self) -> Vec<String>;

    /// Makes a rod of an element, and answers.
    ///
    /// # Errors
    /// [`NoAnswer`] when the engine does not offer the element, or does not find an equilibrium.
    fn rod(&self, question: &RodQuestion, element: &str) -> Result<RodAnswer, NoAnswer>;
}
