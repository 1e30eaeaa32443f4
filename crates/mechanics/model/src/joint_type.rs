//! The kinds of described joints: all that is said of a kind stands here.

/// The kind of a described joint. Axes are unit vectors in the joint frame: a written axis stands for the unit vector along it.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub enum JointType {
    /// No motion: the body is merged into its parent.
    #[default]
    Fixed,
    /// Rotation about an axis (continuous joints are revolute joints without limits).
    Revolute {
        /// The axis of rotation.
        axis: [f64; 3],
    },
    /// Translation along an axis.
    Prismatic {
        /// The direction of translation.
        axis: [f64; 3],
    },
    /// Rotation about an axis with a translation along it.
    Helical {
        /// The axis of the screw.
        axis: [f64; 3],
        /// Translation per angle, m/rad.
        pitch: f64,
    },
    /// Rotation about a point; q is a quaternion (x, y, z, w), v the angular velocity in body axes.
    Spherical,
    /// Free motion; q is position and quaternion, v is [linear; angular] in body axes.
    Free,
    /// Translation in the joint frame's xy-plane, then rotation about z.
    Planar,
    /// Rotation about the joint frame's x, then about the moved y.
    Universal,
    /// Translation along the joint frame's x, y and z.
    Translation,
    /// Rotation about an axis and translation along it, independent of each other; q is angle and distance. The two commute.
    /// So their order is that of the numbers alone: the angle first, as in every 6-vector here.
    Cylindrical {
        /// The axis of both.
        axis: [f64; 3],
    },
    /// Rotation about the joint frame's z, then about the moved y, then about the moved x; q is the three angles, v their rates.
    /// At ±90° about y the first and third axis coincide. Then the mass matrix is singular without armature.
    EulerZyx,
}

/// A joint of one degree of freedom in a row that a [`JointType`] stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OneDof {
    /// What its name has after that of the whole.
    pub suffix: &'static str,
    /// Whether it turns about its axis, rather than slides along it.
    pub turns: bool,
    /// Its axis, a unit vector in the joint frame.
    pub axis: [f64; 3],
}

impl JointType {
    /// Every kind, in the order of pages; axis and pitch go where it has them.
    fn all(axis: [f64; 3], pitch: f64) -> [Self; 11] {
        [
            Self::Fixed,
            Self::Revolute { axis },
            Self::Prismatic { axis },
            Self::Helical { axis, pitch },
            Self::Spherical,
            Self::Free,
            Self::Planar,
            Self::Universal,
            Self::Translation,
            Self::Cylindrical { axis },
            Self::EulerZyx,
        ]
    }

    /// The words of all kinds, in the order of pages.
    pub fn names() -> [&'static str; 11] {
        Self::all([0.0; 3], 0.0).map(Self::name)
    }

    /// The kind of a word; axis and pitch go where it has them.
    pub fn named(word: &str, axis: [f64; 3], pitch: f64) -> Option<Self> {
        Self::all(axis, pitch).into_iter().find(|kind| kind.name() == word)
    }

    /// The word for it in a description file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fixed => "fixed",
            Self::Revolute { .. } => "revolute",
            Self::Prismatic { .. } => "prismatic",
            Self::Helical { .. } => "helical",
            Self::Spherical => "spherical",
            Self::Free => "free",
            Self::Planar => "planar",
            Self::Universal => "universal",
            Self::Translation => "translation",
            Self::Cylindrical { .. } => "cylindrical",
            Self::EulerZyx => "euler_zyx",
        }
    }

    /// The joints of one degree of freedom that it stands for, from the parent outwards; none, if it is a joint of its own.
    ///
    /// ```
    /// use featherbench_model::JointType;
    /// let row = JointType::Universal.row();
    /// assert_eq!([row[0].axis, row[1].axis], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    /// ```
    pub fn row(self) -> Vec<OneDof> {
        let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
        let turn = |suffix, axis| OneDof { suffix, turns: true, axis };
        let slide = |suffix, axis| OneDof { suffix, turns: false, axis };
        match self {
            Self::Planar => vec![slide("_x", x), slide("_y", y), turn("_turn", z)],
            Self::Universal => vec![turn("_x", x), turn("_y", y)],
            Self::Translation => vec![slide("_x", x), slide("_y", y), slide("_z", z)],
            Self::Cylindrical { axis } => vec![turn("_turn", axis), slide("_along", axis)],
            Self::EulerZyx => vec![turn("_z", z), turn("_y", y), turn("_x", x)],
            Self::Fixed | Self::Revolute { .. } | Self::Prismatic { .. } | Self::Helical { .. } | Self::Spherical | Self::Free => {
                Vec::new()
            }
        }
    }

    /// Length of the joint's part of q.
    pub fn nq(self) -> usize {
        match self {
            Self::Spherical => 4,
            Self::Free => 7,
            other => other.nv(),
        }
    }

    /// Degrees of freedom: length of the joint's part of v.
    pub fn nv(self) -> usize {
        match self {
            Self::Fixed => 0,
            Self::Revolute { .. } | Self::Prismatic { .. } | Self::Helical { .. } => 1,
            Self::Spherical => 3,
            Self::Free => 6,
            row => row.row().len(),
        }
    }

    /// The axis, for the kinds that have one.
    pub fn axis(mut self) -> Option<[f64; 3]> {
        self.axis_mut().copied()
    }

    /// The axis, to be changed.
    pub(crate) fn axis_mut(&mut self) -> Option<&mut [f64; 3]> {
        match self {
            Self::Revolute { axis } | Self::Prismatic { axis } | Self::Helical { axis, .. } | Self::Cylindrical { axis } => Some(axis),
            _ => None,
        }
    }
}
