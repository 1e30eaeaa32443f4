//! Robots and states to compute with: families of generated robots, batches of random states, and the random generator of both.
//!
//! - [`Family`] is a family of robots with its parameters. It gives a [`Description`](featherbench_model::Description).
//! - [`StateBatch`] holds the states of one model: random ones and special [`Case`]s.
//! - [`Random`] is the counter-based generator. A seed gives the same bits on every platform.

mod families;
mod random;
mod states;

pub use families::{
    BadFamily, Base, BinaryTree, Centipede, Chain, Family, Hand, Humanoid, Joints, Kind, Layout, Mix, Platform, Quadruped, Shape, Snake,
    Star, Tree,
};
pub use random::Random;
pub use states::{BadState, Case, StateBatch, random_configuration};
