//! Placements of frames, which are spatial transforms.

use crate::{Force, Lift, Mat3, Motion, Real, Vec3};

/// A quaternion (x, y, z, w), w the scalar part; it turns child axes to parent axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quaternion<T> {
    /// Vector part.
    pub v: Vec3<T>,
    /// Scalar part.
    pub w: T,
}

impl<T: Real> Quaternion<T> {
    /// The quaternion x·i + y·j + z·k + w.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn from_array([x, y, z, w]: [T; 4]) -> Self {
        Self { v: Vec3::new(x, y, z), w }
    }

    /// The rotation matrix. It is orthonormal up to rounding, also when the quaternion's length is not exactly one:
    /// `R = 1 + 2/|q|² (w·v× + v×v×)`.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn to_rotation(self) -> Mat3<T> {
        let Self { v, w } = self;
        let two = T::from_f64(2.0);
        let scale = two / w.mul_add(w, v.dot(v));
        let (sx, sy, sz) = (v.x * scale, v.y * scale, v.z * scale);
        let (wx, wy, wz) = (w * sx, w * sy, w * sz);
        let (xx, yy, zz) = (v.x * sx, v.y * sy, v.z * sz);
        let (xy, xz, yz) = (v.x * sy, v.x * sz, v.y * sz);
        let one = T::one();
        Mat3::from_array([one - (yy + zz), xy - wz, xz + wy, xy + wz, one - (xx + zz), yz - wx, xz - wy, yz + wx, one - (xx + yy)])
    }

    /// Its rate of change at angular velocity `omega` in body axes: `q̇ = ½ q ⊗ (ω, 0)`.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn derivative(self, omega: Vec3<T>) -> Self {
        let half = omega * T::from_f64(0.5);
        Self { v: self.v.cross_add(half, half * self.w), w: -self.v.dot(half) }
    }
}

/// The placement of a child frame in its parent: `rotation` takes child axes to parent axes, `translation` is the child's origin in
/// parent coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform<T> {
    /// Child axes to parent axes.
    pub rotation: Mat3<T>,
    /// The child's origin in parent coordinates, m.
    pub translation: Vec3<T>,
}

impl<T: Real> Transform<T> {
    /// The placement with this rotation and translation.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn new(rotation: Mat3<T>, translation: Vec3<T>) -> Self {
        Self { rotation, translation }
    }

    /// The identity.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn identity() -> Self {
        Self::new(Mat3::identity(), Vec3::zero())
    }

    /// The rotation by the angle with this sine and cosine about the unit vector `u` (Rodrigues):
    /// `R = c·1 + s·u× + (1−c) u uᵀ`.
    ///
    /// The rotation about an axis of the frame is exact: its entries are 1, c and s, as given. To that end the rounding error of
    /// `versine = 1 − c`, which is exactly `rest = (1 − versine) − c`, is added on the diagonal.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn axis_rotation(u: Vec3<T>, sin: T, cos: T) -> Mat3<T> {
        let versine = T::one() - cos;
        let rest = (T::one() - versine) - cos;
        let (vx, vy, vz) = (u.x * versine, u.y * versine, u.z * versine);
        let (sx, sy, sz) = (u.x * sin, u.y * sin, u.z * sin);
        let diagonal = |v: T, u: T| v.mul_add(u, (u * rest).mul_add(u, cos));
        Mat3::from_array([
            diagonal(vx, u.x),
            vx.mul_add(u.y, -sz),
            vx.mul_add(u.z, sy),
            vx.mul_add(u.y, sz),
            diagonal(vy, u.y),
            vy.mul_add(u.z, -sx),
            vx.mul_add(u.z, -sy),
            vy.mul_add(u.z, sx),
            diagonal(vz, u.z),
        ])
    }

    /// `self ∘ child`: the placement of the child's child in this frame's parent.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn compose(&self, child: &Self) -> Self {
        Self::new(self.rotation * child.rotation, self.point(child.translation))
    }

    /// The placement of the parent in the child.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn inverse(&self) -> Self {
        Self::new(self.rotation.transpose(), -self.rotation.transpose_mul(self.translation))
    }

    /// A point in child coordinates, in parent coordinates.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn point(&self, p: Vec3<T>) -> Vec3<T> {
        self.rotation.mul_vec_add(p, self.translation)
    }

    /// A motion in child coordinates, in parent coordinates at the parent's origin.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn motion(&self, m: Motion<T>) -> Motion<T> {
        let ang = self.rotation * m.ang;
        Motion::new(ang, self.translation.cross_add(ang, self.rotation * m.lin))
    }

    /// A motion in parent coordinates, in child coordinates at the child's origin.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn inverse_motion(&self, m: Motion<T>) -> Motion<T> {
        let lin = m.ang.cross_add(self.translation, m.lin);
        Motion::new(self.rotation.transpose_mul(m.ang), self.rotation.transpose_mul(lin))
    }

    /// A force in child coordinates, in parent coordinates at the parent's origin.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn force(&self, f: Force<T>) -> Force<T> {
        let lin = self.rotation * f.lin;
        Force::new(self.translation.cross_add(lin, self.rotation * f.ang), lin)
    }

    /// A force in parent coordinates, in child coordinates at the child's origin.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn inverse_force(&self, f: Force<T>) -> Force<T> {
        let ang = f.lin.cross_add(self.translation, f.ang);
        Force::new(self.rotation.transpose_mul(ang), self.rotation.transpose_mul(f.lin))
    }

    /// The parameter placement in another scalar.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn lift<S>(self) -> Transform<S>
    where
        T: Lift<S>,
    {
        Transform { rotation: self.rotation.lift(), translation: self.translation.lift() }
    }
}
