//! A difference between two import results of one robot: its place, its field, its size, and its cause.

use super::fields::Precision;

/// One difference between our import result of a robot and another one.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// The body, by its name in our import result (in theirs, if we do not have it); empty for the robot as a whole.
    pub body: String,
    /// The field.
    pub field: Field,
    /// The value in our import result, with its unit.
    pub ours: String,
    /// The value in theirs.
    pub theirs: String,
    /// The distance, free of units: relative to the number itself; lengths relative to the robot's reach, inertias to their trace.
    pub size: f64,
    /// The cause, as far as numbers and the parser's notes show it.
    pub cause: Cause,
    /// The edit of the body's links, if it predicts their numbers.
    pub account: Option<String>,
    /// The parser's own note about this body.
    pub note: Option<String>,
}

/// The fields in which two import results can differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Field {
    /// Whether there is such a moving body.
    Body,
    /// Its parent body.
    Parent,
    /// The kind of its joint.
    JointType,
    /// The joint's axis.
    Axis,
    /// The pitch of a helical joint.
    Pitch,
    /// The joint's placement on the parent.
    Placement,
    /// The mass.
    Mass,
    /// The centre of mass.
    Com,
    /// The rotational inertia.
    Inertia,
    /// The joint's armature.
    Armature,
    /// The joint's viscous damping.
    Damping,
    /// The joint's dry friction.
    Friction,
    /// Gravity.
    Gravity,
    /// The order of the degrees of freedom.
    DofOrder,
    /// That the joint follows another one.
    Mimic,
    /// Limits of position.
    Limits,
}

/// The effect of a difference in a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Weight {
    /// It changes the mass matrix or the inverse dynamics.
    Dynamics,
    /// The engine stores it and uses it in its own simulation.
    Carried,
    /// The same robot in another form; or a limit, which enters no compared quantity.
    Information,
}

/// Why two import results differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Cause {
    /// The numbers differ; nothing more is known.
    Number,
    /// The principal moments are the same: the rotation of the inertial frame was lost.
    InertialRotationLost,
    /// The principal moments are the same: a rotation of the inertial frame was applied that the other import result lacks.
    InertialRotationApplied,
    /// The principal moments are the same, about other axes.
    InertiaTurned,
    /// The axis points the other way.
    Flipped,
    /// A factor of a thousand, or of its square or cube: metres for millimetres, kilograms for grams.
    Unit,
    /// Degrees for radians.
    Degrees,
    /// The same joints in another order.
    Order,
    /// The body became part of its parent.
    Merged,
    /// The body was dropped with its mass.
    Dropped,
    /// A body that the other import result does not have.
    Added,
    /// Raised to the smallest mass or inertia that the engine accepts.
    Bounds,
    /// Principal moments that violate the triangle inequality were made equal.
    Balanced,
    /// An inertia that no body can have was replaced.
    Unphysical,
    /// The inertia of a fixed link without mass was left out.
    MasslessLink,
    /// Every mass has the same factor: the mass of the whole robot was set, or not.
    TotalMass,
    /// A link with several joints is between them instead of after them.
    BetweenJoints,
    /// The floating base has the frame of another link that is fixed to the root.
    OtherRoot,
    /// Computed from the shape of the body.
    Geometry,
    /// Replaced by the parser, as its note says.
    Edited,
    /// The joint mimics another one.
    Mimic,
    /// Not imported: the parser does not know the element.
    Unsupported,
    /// The armature of a tendon or an actuator is a part of M in one of the engines only.
    AddedArmature,
    /// The inertia of an actuator's rotor times the gear ratio squared.
    RotorInertia,
    /// A link without an inertial was given the engine's own: one kilogram and one kg·m² about each axis.
    DefaultInertia,
    /// The centre of mass, or one of its coordinates, with the other sign.
    ComSign,
    /// The products of inertia were left out.
    OffDiagonals,
    /// The inertia was taken to be about the link's origin, or about the centre of mass where it is not.
    AboutOrigin,
    /// The transpose of a rotation.
    Transposed,
    /// The plane of a planar joint is normal to z, whatever its axis.
    PlanarAxis,
    /// Euler angles were taken in the default sequence and not in the file's `eulerseq`.
    EulerSequence,
    /// The file's gravity is not read: the engine has its own.
    GravityIgnored,
    /// Only the first body of the world is read, with what it carries.
    FirstTree,
    /// A `<frame>` of an MJCF is skipped with all that is in it.
    FrameSkipped,
    /// The pose of a body that is fixed to the world is not read.
    WorldPose,
    /// The pose of a free body is undone by what is not its inverse: it stands elsewhere at the same coordinates.
    FreePose,
    /// `inertiagrouprange` is not read: geoms of all groups count.
    InertiaGroups,
    /// The `ref` of joints is not read.
    JointRef,
    /// `shellinertia` is not read: the solid is taken.
    Shell,
    /// Default classes, or some of their attributes, are not read.
    Classes,
    /// Inertials are not read: geoms give the mass.
    InertialIgnored,
    /// Only the first geom of a body has mass.
    FirstGeoms,
    /// A body without `pos` stands where its inertial or its first geom is.
    InertialFrame,
    /// `<freejoint>` is not read: the body is fixed.
    FreejointIgnored,
    /// Geoms that collide with nothing have no mass.
    UnseenGeoms,
    /// Only the first `<compiler>` is read.
    FirstCompiler,
    /// The axis of an `axisangle` is not made a unit vector.
    AxisLength,
    /// The engine holds a matrix that is no rotation.
    NotARotation,
    /// The engine holds mass properties that no body has.
    NotAMass,
}

impl Field {
    /// The word for it in rows.
    pub fn name(self) -> &'static str {
        match self {
            Self::Body => "body",
            Self::Parent => "parent",
            Self::JointType => "joint_type",
            Self::Axis => "axis",
            Self::Pitch => "pitch",
            Self::Placement => "placement",
            Self::Mass => "mass",
            Self::Com => "com",
            Self::Inertia => "inertia",
            Self::Armature => "armature",
            Self::Damping => "damping",
            Self::Friction => "friction",
            Self::Gravity => "gravity",
            Self::DofOrder => "dof_order",
            Self::Mimic => "mimic",
            Self::Limits => "limits",
        }
    }

    /// The effect of a difference in it.
    pub fn weight(self) -> Weight {
        match self {
            Self::Damping | Self::Friction => Weight::Carried,
            Self::DofOrder | Self::Limits => Weight::Information,
            _ => Weight::Dynamics,
        }
    }
}

/// The effect of a difference on the answers, which decides the result of a comparison.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Class {
    /// The mass matrix or the inverse dynamics change by more than rounding, or it is another robot.
    Physics,
    /// A body stands elsewhere in the world, and neither changes: the whole robot is displaced, or its coordinates begin elsewhere.
    Pose,
    /// A field that they depend on differs by more than rounding, and this robot's M and inverse dynamics do not show it.
    Unfelt,
    /// A field that they depend on differs by no more than the rounding of its own number.
    Rounding,
    /// No compared quantity depends on it: damping, friction, limits, an order.
    NotRead,
}

impl Class {
    /// The most that rounding moves a number, relative to its scale: 1024 ε, or 2.3e-13. Each link that is merged and each turn of a frame
    /// rounds by some ε, and robots whose frames move along have hundreds of those on a path. An edit by a parser, or a displacement of
    /// 1e-12 of the reach, is larger.
    pub const ULPS: f64 = 1024.0 * f64::EPSILON;

    /// The class of a difference of a size. `effect` is the larger change of M and inverse dynamics by it alone, if that can be computed.
    /// [`bound`](super::bound) is the change that rounding may cause.
    pub fn of(field: Field, size: f64, effect: Option<f64>, depth: usize, precision: Precision) -> Self {
        let (bound, ulps) = (super::bound(depth, precision), precision.factor() * Self::ULPS);
        match (field.weight(), effect) {
            (Weight::Dynamics, Some(effect)) if effect <= bound && size <= ulps => Self::Rounding,
            (Weight::Dynamics, Some(effect)) if effect <= bound && matches!(field, Field::Placement | Field::Axis) => Self::Pose,
            (Weight::Dynamics, Some(effect)) if effect <= bound => Self::Unfelt,
            (Weight::Dynamics, _) => Self::Physics,
            (Weight::Carried | Weight::Information, _) => Self::NotRead,
        }
    }

    /// The word for it in rows.
    pub fn name(self) -> &'static str {
        match self {
            Self::Physics => "physics",
            Self::Pose => "pose",
            Self::Unfelt => "unfelt",
            Self::Rounding => "rounding",
            Self::NotRead => "not_read",
        }
    }
}

impl Weight {
    /// The word for it in rows.
    pub fn name(self) -> &'static str {
        match self {
            Self::Dynamics => "dynamics",
            Self::Carried => "carried",
            Self::Information => "information",
        }
    }
}

impl Cause {
    /// The word for it in rows.
    pub fn name(self) -> &'static str {
        match self {
            Self::Number => "number",
            Self::InertialRotationLost => "inertial_rotation_lost",
            Self::InertialRotationApplied => "inertial_rotation_applied",
            Self::InertiaTurned => "inertia_turned",
            Self::Flipped => "flipped",
            Self::Unit => "unit",
            Self::Degrees => "degrees",
            Self::Order => "order",
            Self::Merged => "merged",
            Self::Dropped => "dropped",
            Self::Added => "added",
            Self::Bounds => "bounds",
            Self::Balanced => "balanced",
            Self::Unphysical => "unphysical",
            Self::MasslessLink => "massless_link",
            Self::TotalMass => "total_mass",
            Self::BetweenJoints => "between_joints",
            Self::OtherRoot => "other_root",
            Self::Geometry => "geometry",
            Self::Edited => "edited",
            Self::Mimic => "mimic",
            Self::Unsupported => "unsupported",
            Self::AddedArmature => "added_armature",
            Self::RotorInertia => "rotor_inertia",
            Self::DefaultInertia => "default_inertia",
            Self::ComSign => "com_sign",
            Self::OffDiagonals => "off_diagonals",
            Self::AboutOrigin => "about_origin",
            Self::Transposed => "transposed",
            Self::PlanarAxis => "planar_axis",
            Self::EulerSequence => "euler_sequence",
            Self::GravityIgnored => "gravity_ignored",
            Self::FirstTree => "first_tree",
            Self::FrameSkipped => "frame_skipped",
            Self::WorldPose => "world_pose",
            Self::FreePose => "free_pose",
            Self::InertiaGroups => "inertia_groups",
            Self::JointRef => "joint_ref",
            Self::Shell => "shell",
            Self::Classes => "classes",
            Self::InertialIgnored => "inertial_ignored",
            Self::FirstGeoms => "first_geoms",
            Self::InertialFrame => "inertial_frame",
            Self::FreejointIgnored => "freejoint_ignored",
            Self::UnseenGeoms => "unseen_geoms",
            Self::FirstCompiler => "first_compiler",
            Self::AxisLength => "axis_length",
            Self::NotARotation => "not_a_rotation",
            Self::NotAMass => "not_a_mass",
        }
    }
}
