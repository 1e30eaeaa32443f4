//! The structures of `oracle.h`, and how they are read.

use std::ffi::c_char;

/// `struct fb_body`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Body {
    /// Index of the parent body, −1 for the world.
    pub parent: i32,
    /// A joint type: the place in [`JOINTS`].
    pub joint: i32,
    /// In kg.
    pub mass: f64,
    /// Centre of mass, in m, body axes.
    pub com: [f64; 3],
    /// xx, xy, xz, yy, yz, zz about the centre of mass, in kg m², body axes.
    pub inertia: [f64; 6],
    /// Unit vector of revolute, prismatic and helical joints.
    pub axis: [f64; 3],
    /// In m/rad, of helical joints.
    pub pitch: f64,
    /// Joint axes to parent axes, row-major.
    pub rotation: [f64; 9],
    /// The joint's origin in the parent's frame, in m.
    pub translation: [f64; 3],
    /// Per degree of freedom of the joint.
    pub armature: [f64; 6],
}

/// The joint types, in the order of their numbers.
pub const JOINTS: [&str; 7] = ["revolute", "prismatic", "helical", "spherical", "free", "planar", "universal"];

/// A robot as it is given.
#[derive(Clone, Copy, Debug)]
pub struct Given<'a> {
    /// In depth-first order.
    pub bodies: &'a [Body],
    /// In m/s², world axes.
    pub gravity: [f64; 3],
    /// Numbers of q and of v.
    pub sizes: [usize; 2],
    /// The dof that each dof hangs on, −1 for none.
    pub dof_parents: &'a [i32],
}

/// `struct fb_robot`.
#[repr(C)]
pub struct RobotData {
    pub(crate) bodies: usize,
    pub(crate) nq: usize,
    pub(crate) nv: usize,
    pub(crate) body: *const Body,
    pub(crate) gravity: [f64; 3],
    pub(crate) dof_parent: *const i32,
}

/// `struct fb_states`.
#[repr(C)]
pub struct States {
    pub(crate) count: usize,
    pub(crate) q: *const f64,
    pub(crate) v: *const f64,
    pub(crate) a: *const f64,
    pub(crate) tau: *const f64,
}

/// `struct fb_method`.
#[repr(C)]
pub(crate) struct Method {
    pub(crate) quantity: *const c_char,
    pub(crate) name: *const c_char,
}
