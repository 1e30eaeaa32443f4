//! Signed permutations of axes: how the axes of a described body are called in the compiled model.
//!
//! A compiled joint turns about, or slides along, the z axis of its body where that costs no rounding. So the axes of a described body
//! whose joint has another coordinate axis get other names, and some their opposite direction. B takes compiled axes to described axes,
//! with `B e_z` the joint's axis. B is a rotation whose entries are 0, 1 and −1, so nothing is rounded.

use featherbench_spatial::{Force, Mat3, Real, RigidBodyInertia, Sym3, Transform, Vec3};

/// The described axis that a compiled body calls z; it determines the rotation B.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Label {
    /// Compiled axes x, y, z are the described y, z, x.
    X,
    /// Compiled axes x, y, z are the described z, x, y.
    Y,
    /// The compiled axes are the described ones.
    #[default]
    Z,
    /// Compiled axes x, y, z are the described z, y, −x.
    MinusX,
    /// Compiled axes x, y, z are the described x, z, −y.
    MinusY,
    /// Compiled axes x, y, z are the described y, x, −z.
    MinusZ,
}

impl Label {
    /// The label of this axis, or `None` if it is not exactly a coordinate axis or the opposite of one.
    pub fn of_axis(axis: [f64; 3]) -> Option<Self> {
        let labels = [Self::X, Self::Y, Self::Z, Self::MinusX, Self::MinusY, Self::MinusZ];
        labels.into_iter().find(|label| label.to_described(Vec3::new(0.0, 0.0, 1.0)).to_array() == axis)
    }

    /// `B v`: a vector in compiled axes, in described axes.
    #[inline(always)]
    pub fn to_described<T: Real>(self, v: Vec3<T>) -> Vec3<T> {
        match self {
            Self::X => Vec3::new(v.z, v.x, v.y),
            Self::Y => Vec3::new(v.y, v.z, v.x),
            Self::Z => v,
            Self::MinusX => Vec3::new(-v.z, v.y, v.x),
            Self::MinusY => Vec3::new(v.x, -v.z, v.y),
            Self::MinusZ => Vec3::new(v.y, v.x, -v.z),
        }
    }

    /// `Bᵀ v`: a vector in described axes, in compiled axes.
    #[inline(always)]
    pub fn to_compiled<T: Real>(self, v: Vec3<T>) -> Vec3<T> {
        match self {
            Self::X => Vec3::new(v.y, v.z, v.x),
            Self::Y => Vec3::new(v.z, v.x, v.y),
            Self::Z => v,
            Self::MinusX => Vec3::new(v.z, v.y, -v.x),
            Self::MinusY => Vec3::new(v.x, v.z, -v.y),
            Self::MinusZ => Vec3::new(v.y, v.x, -v.z),
        }
    }

    /// A force in described axes, in compiled axes.
    #[inline(always)]
    pub fn force_to_compiled<T: Real>(self, f: Force<T>) -> Force<T> {
        Force::new(self.to_compiled(f.ang), self.to_compiled(f.lin))
    }

    /// `R Bᵀ`: the orientation of the described axes, where `r` is that of the compiled axes.
    #[inline(always)]
    pub fn rotation_to_described<T: Real>(self, r: Mat3<T>) -> Mat3<T> {
        Mat3::from_rows(self.to_described(r.x), self.to_described(r.y), self.to_described(r.z))
    }

    /// `R B`: the orientation of the compiled axes, where `r` is that of the described axes.
    #[inline(always)]
    pub fn rotation_to_compiled<T: Real>(self, r: Mat3<T>) -> Mat3<T> {
        Mat3::from_rows(self.to_compiled(r.x), self.to_compiled(r.y), self.to_compiled(r.z))
    }

    /// The placement of this body in a parent with label `parent`, in compiled axes of both.
    pub(crate) fn placement_to_compiled<T: Real>(self, parent: Self, x: Transform<T>) -> Transform<T> {
        // (Bₚᵀ R) B and Bₚᵀ t
        let rotation = parent.rotation_to_compiled(x.rotation.transpose()).transpose();
        Transform::new(self.rotation_to_compiled(rotation), parent.to_compiled(x.translation))
    }

    /// The inertia of this body in compiled axes.
    pub(crate) fn inertia_to_compiled<T: Real>(self, inertia: RigidBodyInertia<T>) -> RigidBodyInertia<T> {
        let half = self.rotation_to_compiled(inertia.rotational.to_mat3()).transpose();
        RigidBodyInertia {
            mass: inertia.mass,
            first_moment: self.to_compiled(inertia.first_moment),
            rotational: Sym3::from_upper(self.rotation_to_compiled(half)),
        }
    }
}
