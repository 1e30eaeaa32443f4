//! Properties of a robot: what known deviations and lacks of engines are told by, in the place of its name.

use serde::{Deserialize, Serialize};

use crate::names::words;

words! {
    /// A property that a robot, or its file, has or does not have.
    Feature {
        /// A free joint moves a body on another body, and not on the world.
        FreeJointOnBody = "free_joint_on_body",
        /// MJCF: several bodies that move are on the world.
        SeveralRoots = "several_roots",
        /// A revolute joint with armature has an axis other than +x, +y and +z.
        SkewArmature = "skew_armature",
        /// A body without mass and inertia is only a joint before its one child, whose joint frame has the same axes.
        JointChain = "joint_chain",
        /// A moving body has no mass, and is no part of a joint chain; or no mass distribution has its inertia.
        ImpossibleBody = "impossible_body",
        /// M is singular: nothing that a joint moves has mass or inertia about it, and the joint has no armature.
        SingularMass = "singular_mass",
        /// At rest at the neutral configuration the robot does not fall: its accelerations are exactly zero.
        Balanced = "balanced",
        /// κ(M) at the neutral configuration is beyond 2²⁴, which is more than single precision holds. Up to 256 degrees of freedom.
        BeyondSingle = "beyond_single",
        /// URDF: the inertia of a link has a negative principal moment.
        NegativeMoment = "negative_moment",
        /// URDF: a fixed joint mimics another.
        FixedMimic = "fixed_mimic",
        /// URDF: a joint mimics one that is not in the file.
        UnknownMimic = "unknown_mimic",
        /// MJCF: the file gives its model no name.
        Unnamed = "unnamed",
        /// MJCF: a site is in the world body itself.
        WorldSite = "world_site",
        /// MJCF: there is a height field.
        HeightField = "height_field",
        /// MJCF: a body with a mesh has no inertial element.
        MeshWithoutInertial = "mesh_without_inertial",
        /// MJCF: a mesh is a file of another format than OBJ, glTF, VTK and SDF.
        MeshFormat = "mesh_format",
    }
}

words! {
    /// How the first body is attached.
    Base {
        /// By a joint with limited freedom, or none.
        Fixed = "fixed",
        /// By a free joint.
        Free = "free",
    }
}

/// The properties of one robot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Properties {
    /// The kinds of its joints, sorted.
    pub joints: Vec<String>,
    /// The kinds of its joints that have armature, sorted.
    pub armature: Vec<String>,
    /// How its first body is attached.
    pub base: Base,
    /// Degrees of freedom.
    pub dofs: u64,
    /// The distance of its first body's joint from the origin of the world, m.
    pub offset: f64,
    /// The largest mass of a body over the smallest that is not zero.
    pub mass_ratio: f64,
    /// The features that it has, in the order of declaration.
    pub features: Vec<Feature>,
}
