//! Engines compared: with each other, with the truth, and with the file that they read.
//!
//! - [`agreement`]: do the engines agree on the same model, and how large is our error compared with the best engine's?
//! - [`import`]: do they import the same file alike, and if not, where and why do they differ?
//! - [`accuracy`]: how far is each from the truth, and which engine is right?
//! - [`sweep`]: what errors do drawn robots have, by depth, mass ratio, offset, speed and kind of joint?
//! - [`conditioning`]: how does κ(M) grow, and does it matter?
//! - [`derivatives`]: which engine's derivatives are right, on which joint, and what does the step of finite differences cost?
//! - [`invariance`]: what must not change an answer, and does?
//! - [`single`]: is single precision good enough for a robot?
//! - [`steps`]: how does the acceleration of a step approach the true one, and how do steps change the energy?
//! - [`reproductions`]: do the engines' known deviations still exist, and in their known size?
//! - [`repeatability`]: does the same question have the same answer?

pub mod accuracy;
pub mod agreement;
pub mod conditioning;
pub mod derivatives;
pub mod import;
pub mod invariance;
pub mod repeatability;
pub mod reproductions;
pub mod single;
pub mod steps;
pub mod sweep;

pub use accuracy::Accuracy;
pub use agreement::Agreement;
pub use conditioning::Conditioning;
pub use derivatives::Derivatives;
pub use import::Import;
pub use invariance::Invariance;
pub use repeatability::Repeatability;
pub use reproductions::Reproductions;
pub use single::Single;
pub use steps::Steps;
