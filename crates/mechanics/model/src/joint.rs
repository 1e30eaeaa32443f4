//! The primitive joints of the compiled model.

use featherbench_spatial::{Force, Lift, Mat3, Motion, Quaternion, Real, Transform, Vec3};

/// Where the axis of a screw joint points, as far as a kernel can know when it is compiled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Axis {
    /// Exactly along z of the body.
    Z,
    /// Anywhere: as the motion subspace says.
    Skew,
}

/// A primitive joint. The first three are one-dof screws with a constant motion subspace `S`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum JointKind {
    /// Rotation about the unit vector `S.ang`.
    Revolute(Axis),
    /// Translation along the unit vector `S.lin`.
    Prismatic(Axis),
    /// Rotation about the unit vector `S.ang` with translation `S.lin` per radian along it.
    Helical,
    /// Rotation about a point: quaternion (x, y, z, w); velocity in body axes.
    Spherical,
    /// Free motion: position and quaternion; velocity [linear; angular] in body axes.
    Free,
}

impl JointKind {
    /// Length of the joint's part of q.
    #[inline(always)]
    pub fn nq(self) -> usize {
        match self {
            Self::Revolute(_) | Self::Prismatic(_) | Self::Helical => 1,
            Self::Spherical => 4,
            Self::Free => 7,
        }
    }

    /// Degrees of freedom.
    #[inline(always)]
    pub fn nv(self) -> usize {
        match self {
            Self::Revolute(_) | Self::Prismatic(_) | Self::Helical => 1,
            Self::Spherical => 3,
            Self::Free => 6,
        }
    }

    /// The same kind with another axis, for the kinds that have one.
    #[inline(always)]
    pub fn with_axis(self, axis: Axis) -> Self {
        match self {
            Self::Revolute(_) => Self::Revolute(axis),
            Self::Prismatic(_) => Self::Prismatic(axis),
            Self::Helical | Self::Spherical | Self::Free => self,
        }
    }

    /// The placement of the moved body in its parent at configuration `q`: `placement ∘ motion(q)`.
    #[inline(always)]
    pub fn transform<T: Real, P: Lift<T> + Real>(self, placement: &Transform<P>, subspace: &Motion<P>, q: &[T]) -> Transform<T> {
        let fixed = placement.lift();
        match self {
            Self::Revolute(Axis::Z) => {
                let (sin, cos) = q[0].sin_cos();
                Transform::new(fixed.rotation.turn_about_z(sin, cos), fixed.translation)
            }
            Self::Prismatic(Axis::Z) => Transform::new(fixed.rotation, fixed.rotation.column_z().scale_add(q[0], fixed.translation)),
            Self::Revolute(Axis::Skew) => {
                let (sin, cos) = q[0].sin_cos();
                Transform::new(fixed.rotation * Transform::axis_rotation(subspace.ang.lift(), sin, cos), fixed.translation)
            }
            Self::Prismatic(Axis::Skew) => Transform::new(fixed.rotation, fixed.point(subspace.lin.lift() * q[0])),
            Self::Helical => {
                let (sin, cos) = q[0].sin_cos();
                let rotation = fixed.rotation * Transform::axis_rotation(subspace.ang.lift(), sin, cos);
                Transform::new(rotation, fixed.point(subspace.lin.lift() * q[0]))
            }
            Self::Spherical => {
                let turn = Quaternion::from_array([q[0], q[1], q[2], q[3]]).to_rotation();
                Transform::new(fixed.rotation * turn, fixed.translation)
            }
            Self::Free => {
                let turn = Quaternion::from_array([q[3], q[4], q[5], q[6]]).to_rotation();
                Transform::new(fixed.rotation * turn, fixed.point(Vec3::new(q[0], q[1], q[2])))
            }
        }
    }

    /// Writes the part of a placement that changes with q. [`JointKind::recall`] gives the placement back.
    ///
    /// Kernels keep the placements of all bodies. What they keep of lanes fills the caches, so constants stay in the model.
    #[inline(always)]
    pub fn keep<T: Real>(self, x: &Transform<T>, kept: &mut Transform<T>) {
        match self {
            Self::Revolute(Axis::Z) => {
                let (from, to) = (&x.rotation, &mut kept.rotation);
                for (from, to) in [(from.x, &mut to.x), (from.y, &mut to.y), (from.z, &mut to.z)] {
                    (to.x, to.y) = (from.x, from.y);
                }
            }
            Self::Revolute(Axis::Skew) | Self::Spherical => kept.rotation = x.rotation,
            Self::Prismatic(_) => kept.translation = x.translation,
            Self::Helical | Self::Free => *kept = *x,
        }
    }

    /// The placement of which [`JointKind::keep`] kept a part, with the constants of the placement at q = 0.
    #[inline(always)]
    pub fn recall<T: Real, P: Lift<T> + Real>(self, placement: &Transform<P>, kept: &Transform<T>) -> Transform<T> {
        let fixed: Transform<T> = placement.lift();
        match self {
            Self::Revolute(Axis::Z) => {
                let row = |kept: Vec3<T>, fixed: Vec3<T>| Vec3::new(kept.x, kept.y, fixed.z);
                let (kept, fixed_rotation) = (&kept.rotation, &fixed.rotation);
                let rows = [row(kept.x, fixed_rotation.x), row(kept.y, fixed_rotation.y), row(kept.z, fixed_rotation.z)];
                let [x, y, z] = rows;
                Transform::new(Mat3::from_rows(x, y, z), fixed.translation)
            }
            Self::Revolute(Axis::Skew) | Self::Spherical => Transform::new(kept.rotation, fixed.translation),
            Self::Prismatic(_) => Transform::new(fixed.rotation, kept.translation),
            Self::Helical | Self::Free => *kept,
        }
    }

    /// `S v`: the motion across the joint, in body coordinates.
    #[inline(always)]
    pub fn motion<T: Real, P: Lift<T> + Real>(self, subspace: &Motion<P>, v: &[T]) -> Motion<T> {
        match self {
            Self::Revolute(Axis::Z) => Motion::new(along_z(v[0]), Vec3::zero()),
            Self::Prismatic(Axis::Z) => Motion::new(Vec3::zero(), along_z(v[0])),
            Self::Revolute(Axis::Skew) => Motion::new(subspace.ang.lift() * v[0], Vec3::zero()),
            Self::Prismatic(Axis::Skew) => Motion::new(Vec3::zero(), subspace.lin.lift() * v[0]),
            Self::Helical => subspace.lift() * v[0],
            Self::Spherical => Motion::new(Vec3::new(v[0], v[1], v[2]), Vec3::zero()),
            Self::Free => Motion::new(Vec3::new(v[3], v[4], v[5]), Vec3::new(v[0], v[1], v[2])),
        }
    }

    /// `Sᵀ f` into `tau`: the joint's share of a force in body coordinates.
    #[inline(always)]
    pub fn project<T: Real, P: Lift<T> + Real>(self, subspace: &Motion<P>, f: Force<T>, tau: &mut [T]) {
        match self {
            Self::Revolute(Axis::Z) => tau[0] = f.ang.z,
            Self::Prismatic(Axis::Z) => tau[0] = f.lin.z,
            Self::Revolute(Axis::Skew) => tau[0] = subspace.ang.lift().dot(f.ang),
            Self::Prismatic(Axis::Skew) => tau[0] = subspace.lin.lift().dot(f.lin),
            Self::Helical => tau[0] = subspace.lift().dot(f),
            Self::Spherical => tau[..3].copy_from_slice(&f.ang.to_array()),
            Self::Free => {
                tau[..3].copy_from_slice(&f.lin.to_array());
                tau[3..6].copy_from_slice(&f.ang.to_array());
            }
        }
    }

    /// Column `k` of S in body coordinates.
    #[inline(always)]
    pub fn column<T: Real, P: Lift<T> + Real>(self, subspace: &Motion<P>, k: usize) -> Motion<T> {
        match self {
            Self::Revolute(_) | Self::Prismatic(_) | Self::Helical => subspace.lift(),
            Self::Spherical | Self::Free => {
                let mut unit = [T::zero(); 6];
                unit[k] = T::one();
                self.motion(subspace, &unit[..self.nv()])
            }
        }
    }
}

/// The vector (0, 0, length).
#[inline(always)]
fn along_z<T: Real>(length: T) -> Vec3<T> {
    Vec3::new(T::zero(), T::zero(), length)
}
