//! A robot as one can draw it: its bodies in the world at the neutral configuration.

use serde::{Deserialize, Serialize};

/// A body of a drawing. Lengths are in m, in world axes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DrawnBody {
    /// Its name.
    pub name: String,
    /// The index of the body that it is on; the world, if there is none.
    pub parent: Option<usize>,
    /// Its mass, in kg.
    pub mass: f64,
    /// The origin of its frame.
    pub origin: [f64; 3],
    /// Its centre of mass.
    pub centre: [f64; 3],
    /// The half axes of the solid ellipsoid with its mass and inertia; of length zero if no body can have these.
    pub axes: [[f64; 3]; 3],
}

/// The bodies of a robot; a body comes after the one that it is on.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Drawing(pub Vec<DrawnBody>);
