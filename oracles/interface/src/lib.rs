//! The C interface of `../../native/oracle.h`, for engines in Rust.
//!
//! An engine is a type with the trait [`Robot`], in a library of the kind `cdylib`. [`export!`] gives the library its one symbol. The build
//! script of the engine calls [`build::tell`].

pub mod build;
mod layout;
mod refusal;
mod table;

pub use layout::{Body, Given, JOINTS, RobotData, States};
pub use refusal::Refusal;
pub use table::{Build, Table, Words, table};

/// A robot in an engine, with its states.
///
/// A method is named by its place in [`Robot::METHODS`]. Coordinates, shapes, units and frames are those of `oracles/PROTOCOL.md`.
pub trait Robot: Sized + 'static {
    /// The engine's name in rows.
    const ENGINE: &'static str;
    /// What is answered: quantity and method.
    const METHODS: &'static [(&'static str, &'static str)];

    /// Builds a robot, and reads back what the engine has: 22 numbers per body.
    ///
    /// # Errors
    /// [`Refusal::Unsupported`] for what the engine does not have, else [`Refusal::Failed`].
    fn new(given: &Given, readback: &mut [f64]) -> Result<Self, Refusal>;

    /// nq and nv.
    fn sizes(&self) -> [usize; 2];

    /// The numbers of a value.
    fn size(&self, method: usize) -> usize;

    /// Takes states, as q, v, a and τ, one after the other.
    ///
    /// # Errors
    /// [`Refusal`], with the reason.
    fn convert(&mut self, states: [&[f64]; 4]) -> Result<(), Refusal>;

    /// Prepares a method; `body` is the body of a body Jacobian. It is called before [`Robot::run`], and again after [`Robot::convert`].
    ///
    /// # Errors
    /// [`Refusal`], with the reason.
    fn ready(&mut self, method: usize, body: usize) -> Result<(), Refusal>;

    /// Evaluates `count` states from `first` on, and begins again beyond the last: what is timed.
    ///
    /// # Errors
    /// [`Refusal`], with the reason.
    fn run(&mut self, method: usize, first: usize, count: usize) -> Result<(), Refusal>;

    /// Writes the value of the last state, in neutral coordinates.
    ///
    /// # Errors
    /// [`Refusal`], with the reason.
    fn read(&mut self, method: usize, value: &mut [f64]) -> Result<(), Refusal>;
}
