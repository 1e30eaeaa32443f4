//! A robot as a user describes it: plain numbers, no scalar, no compiled order.

use crate::{Continuum, DescribedResidual, JointType, Loop, Uncertain};

/// A robot: bodies, each with the joint that carries it, and gravity.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Description {
    /// The robot's name.
    pub name: String,
    /// Gravitational acceleration in world axes, m/s².
    pub gravity: [f64; 3],
    /// The bodies, in any order in which each has one joint to its parent.
    pub bodies: Vec<BodyDescription>,
    /// Named frames fixed to bodies, such as the merged links of a file.
    pub frames: Vec<Frame>,
    /// What ties bodies beside the tree. The dynamics of the tree alone do not know of it.
    pub loops: Vec<Loop>,
    /// Bodies that deform. A [`Model`](crate::Model) refuses them.
    pub continua: Vec<Continuum>,
    /// What the true robot needs beyond the rigid bodies. A [`Model`](crate::Model) does not know of it.
    pub residuals: Vec<DescribedResidual>,
    /// Which numbers are uncertain, and how. The written numbers are the nominal ones.
    pub uncertain: Uncertain,
    /// Where the numbers come from, if they are not generated.
    pub provenance: Option<Provenance>,
}

/// A rigid body and the joint that connects it to its parent.
///
/// The body's frame is the joint's moving frame.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyDescription {
    /// The body's name, unique in the description.
    pub name: String,
    /// Index of the parent body, or `None` for the world.
    pub parent: Option<usize>,
    /// Mass, kg.
    pub mass: f64,
    /// Centre of mass in the body's frame, m.
    pub com: [f64; 3],
    /// Rotational inertia about the centre of mass in body axes (xx, xy, xz, yy, yz, zz), kg·m².
    pub inertia: [f64; 6],
    /// The joint to the parent.
    pub joint: JointDescription,
}

/// A joint: its kind, its placement on the parent, and its per-dof properties.
///
/// The vectors hold one number per degree of freedom, or none at all for "zero" (armature, damping, friction) and "unlimited".
#[derive(Clone, Debug, PartialEq, Default)]
pub struct JointDescription {
    /// The joint's name.
    pub name: String,
    /// The kind of motion.
    pub kind: JointType,
    /// The joint frame in the parent's frame.
    pub placement: Placement,
    /// Armature (reflected rotor inertia), added to the diagonal of the mass matrix, kg·m² or kg.
    pub armature: Vec<f64>,
    /// Viscous damping. It is stored, and never part of inverse dynamics.
    pub damping: Vec<f64>,
    /// Dry friction. It is stored, and never part of inverse dynamics.
    pub friction: Vec<f64>,
    /// Lower position limits, rad or m.
    pub lower: Vec<f64>,
    /// Upper position limits, rad or m.
    pub upper: Vec<f64>,
    /// Speed limits, rad/s or m/s.
    pub velocity: Vec<f64>,
    /// Effort limits, N·m or N.
    pub effort: Vec<f64>,
}

/// A constant rigid placement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Child axes to parent axes, row-major: a written matrix stands for the nearest rotation.
    pub rotation: [f64; 9],
    /// The child's origin in the parent's frame, m.
    pub translation: [f64; 3],
}

/// A named frame fixed to a body.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// The frame's name.
    pub name: String,
    /// The body it is fixed to, or `None` for the world.
    pub body: Option<usize>,
    /// Its placement on that body.
    pub placement: Placement,
}

/// Where a robot's numbers come from, with the text that allows their use.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Provenance {
    /// Package, version and file.
    pub source: String,
    /// SPDX identifier of the licence.
    pub licence: String,
    /// What the file's own header says, quoted, or that it says nothing.
    pub header: String,
    /// What the description folder's README or licence file says, quoted.
    pub readme: String,
    /// What was changed (merged links, dropped elements).
    pub notes: Vec<String>,
}

impl Default for Placement {
    fn default() -> Self {
        Self { rotation: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0], translation: [0.0; 3] }
    }
}

impl Description {
    /// Length of the configuration vector q.
    pub fn nq(&self) -> usize {
        self.bodies.iter().map(|body| body.joint.kind.nq()).sum()
    }

    /// Degrees of freedom.
    pub fn nv(&self) -> usize {
        self.bodies.iter().map(|body| body.joint.kind.nv()).sum()
    }

    /// The largest number of bodies on a path from the world, of a canonical description.
    pub fn depth(&self) -> usize {
        let mut depth = vec![0; self.bodies.len()];
        for (i, body) in self.bodies.iter().enumerate() {
            depth[i] = 1 + body.parent.map_or(0, |parent| depth[parent]);
        }
        depth.into_iter().max().unwrap_or(0)
    }
}
