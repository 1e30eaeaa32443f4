//! Scenes with known answers. The numbers of each are the fields of its struct; `Default` has those of the suite.
//!
//! | scene | exact answer |
//! |---|---|
//! | [`Incline`] sliding, at a heading | a = g (sin θ − μ cos θ), whatever the heading |
//! | [`Incline`] sticking | it stays |
//! | [`Sliding`] sphere | it rolls with 5/7 of its speed after 2v/(7 μ g) |
//! | [`BoxOnBalls`] | a = F/(M + 7 n m/20) |
//! | [`Stack`] of balls | each contact carries the weight above it |
//! | [`BoxStack`] | the same, and it rests: no box sinks, drifts or gains energy |
//! | [`Standing`] quadruped and humanoid, joints locked | the contacts carry the weight and hold the push; no moment about the centre of mass |
//! | [`Rod`], Painlevé's, where no force obeys the laws | an impact without collision: the tip stops at once |
//! | [`Block`] that rocks | an impact leaves r² of the energy, r = 1 − (m/I_O) 2 b² |
//! | [`Table`] on four legs | the legs carry W about its centre; their single forces are not unique |
//! | [`Bounce`] | Newton's law: e of the speed |

mod bodies;
mod boxes;
mod loads;
mod standing;

pub use bodies::{Block, Bounce, Incline, Rod, Sliding};
pub use boxes::BoxStack;
pub use loads::{BoxOnBalls, Stack, Table};
pub use standing::{Foot, Locked, Standing};

use crate::motion::Motion;
use crate::scene::{Body, Scene};

/// A number of a motion that has an exact value in rigid mechanics.
pub struct Measure {
    /// What it is: the column `quantity` of rows.
    pub quantity: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Its exact value.
    pub exact: f64,
    /// What an error is divided by.
    pub scale: f64,
    of: Box<dyn Fn(&Motion) -> f64 + Send + Sync>,
}

impl Measure {
    fn new(
        quantity: &'static str,
        unit: &'static str,
        exact: f64,
        scale: f64,
        of: impl Fn(&Motion) -> f64 + Send + Sync + 'static,
    ) -> Self {
        Self { quantity, unit, exact, scale, of: Box::new(of) }
    }

    /// The number of a motion; NaN if the motion does not have it.
    pub fn of(&self, motion: &Motion) -> f64 {
        if motion.is_finite() { (self.of)(motion) } else { f64::NAN }
    }

    /// |value − exact| / scale; NaN of NaN.
    pub fn error(&self, value: f64) -> f64 {
        (value - self.exact).abs() / self.scale
    }
}

/// A scene, how long it runs, and what is asked of its motion.
pub struct Question {
    /// The scene.
    pub scene: Scene,
    /// s.
    pub duration: f64,
    /// The steps at which an answer is asked, s, the finest last.
    pub dts: [f64; 3],
    /// What is measured.
    pub measures: Vec<Measure>,
    /// The scene's parameters, for rows.
    pub params: serde_json::Value,
}

impl Question {
    /// The finest step, s.
    pub fn finest(&self) -> f64 {
        self.dts[self.dts.len() - 1]
    }

    /// How many steps of dt the duration has.
    pub fn steps(&self, dt: f64) -> usize {
        (self.duration / dt).round() as usize
    }
}

/// A scene under vertical gravity, m/s², without restitution.
fn level(name: impl Into<String>, gravity: f64, friction: f64, bodies: Vec<Body>) -> Scene {
    Scene { name: name.into(), gravity: [0.0, 0.0, -gravity], friction, restitution: 0.0, bodies }
}

/// The usual steps, s.
const STEPS: [f64; 3] = [4e-3, 2e-3, 1e-3];
/// Those of a short scene with an impact, s: it falls on any part of a step, and what that changes must be small beside the scene.
const SHORT_STEPS: [f64; 3] = [1e-3, 5e-4, 2e-4];

/// Headings of sliding inclines, as parts of a right angle: 24ths.
const HEADINGS: [u8; 7] = [0, 4, 8, 12, 16, 20, 24];

/// Every scene of the suite.
pub fn all() -> Vec<Question> {
    let incline = |part: u8| Incline { heading: f64::from(part) / 24.0 * std::f64::consts::FRAC_PI_2, ..Incline::sliding() };
    let mut all: Vec<Question> = HEADINGS.into_iter().map(|part| incline(part).question()).collect();
    all.extend([
        Incline::sticking().question(),
        Sliding::default().question(),
        BoxOnBalls::default().question(),
        Stack::default().question(),
        Stack { top: 1000.0, ..Stack::default() }.question(),
        BoxStack { boxes: 2, ..BoxStack::default() }.question(),
        BoxStack::default().question(),
        BoxStack { boxes: 10, ..BoxStack::default() }.question(),
        BoxStack { top: 100.0, ..BoxStack::default() }.question(),
        Standing::quadruped().question(),
        Standing::humanoid().question(),
        Rod::default().question(),
        Block::default().question(),
        Table::default().question(),
        Bounce::default().question(),
    ]);
    all
}
