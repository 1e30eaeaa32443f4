//! Three-dimensional vectors and matrices, the parts of spatial quantities.

use crate::operators::operators;
use crate::{Lift, Real};
use std::ops::{Add, AddAssign, Mul, Neg, Sub, SubAssign};

/// A vector of three numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vec3<T> {
    /// First component.
    pub x: T,
    /// Second component.
    pub y: T,
    /// Third component.
    pub z: T,
}

impl<T: Real> Vec3<T> {
    /// The vector (x, y, z).
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn new(x: T, y: T, z: T) -> Self {
        Self { x, y, z }
    }

    /// The zero vector.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn zero() -> Self {
        Self::new(T::zero(), T::zero(), T::zero())
    }

    /// The vector with these components.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn from_array([x, y, z]: [T; 3]) -> Self {
        Self::new(x, y, z)
    }

    /// Its components.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn to_array(self) -> [T; 3] {
        [self.x, self.y, self.z]
    }

    /// Inner product.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn dot(self, other: Self) -> T {
        self.x.mul_add(other.x, self.y.mul_add(other.y, self.z * other.z))
    }

    /// `self · other + addend`.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn dot_add(self, other: Self, addend: T) -> T {
        self.x.mul_add(other.x, self.y.mul_add(other.y, self.z.mul_add(other.z, addend)))
    }

    /// Vector product.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn cross(self, other: Self) -> Self {
        Self::new(
            self.y.mul_add(other.z, -(self.z * other.y)),
            self.z.mul_add(other.x, -(self.x * other.z)),
            self.x.mul_add(other.y, -(self.y * other.x)),
        )
    }

    /// `self·factor + addend`.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn scale_add(self, factor: T, addend: Self) -> Self {
        Self::new(self.x.mul_add(factor, addend.x), self.y.mul_add(factor, addend.y), self.z.mul_add(factor, addend.z))
    }

    /// `self × other + addend`.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn cross_add(self, other: Self, addend: Self) -> Self {
        Self::new(
            self.y.mul_add(other.z, (-self.z).mul_add(other.y, addend.x)),
            self.z.mul_add(other.x, (-self.x).mul_add(other.z, addend.y)),
            self.x.mul_add(other.y, (-self.y).mul_add(other.x, addend.z)),
        )
    }

    /// Euclidean length.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn norm(self) -> T {
        self.dot(self).sqrt()
    }

    /// The parameter vector in another scalar.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn lift<S>(self) -> Vec3<S>
    where
        T: Lift<S>,
    {
        Vec3 { x: self.x.lift(), y: self.y.lift(), z: self.z.lift() }
    }
}

operators! {
    #[cfg_attr(not(debug_assertions), inline(always))]
    <T: Real> Vec3<T>;
    Add: add(self, other: Self) -> Self { Self::new(self.x + other.x, self.y + other.y, self.z + other.z) }
    Sub: sub(self, other: Self) -> Self { Self::new(self.x - other.x, self.y - other.y, self.z - other.z) }
    Neg: neg(self) -> Self { Self::new(-self.x, -self.y, -self.z) }
    Mul<T>: mul(self, factor: T) -> Self { Self::new(self.x * factor, self.y * factor, self.z * factor) }
    ; AddAssign add_assign +, SubAssign sub_assign -
}

/// A row of `M R`, R the rotation about z by the angle with this sine and cosine.
#[cfg_attr(not(debug_assertions), inline(always))]
fn turn_row<T: Real>(r: Vec3<T>, sin: T, cos: T) -> Vec3<T> {
    Vec3::new(r.x.mul_add(cos, r.y * sin), r.y.mul_add(cos, -(r.x * sin)), r.z)
}

/// A 3×3 matrix by rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mat3<T> {
    /// First row.
    pub x: Vec3<T>,
    /// Second row.
    pub y: Vec3<T>,
    /// Third row.
    pub z: Vec3<T>,
}

impl<T: Real> Mat3<T> {
    /// The matrix with these rows.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn from_rows(x: Vec3<T>, y: Vec3<T>, z: Vec3<T>) -> Self {
        Self { x, y, z }
    }

    /// The matrix of nine numbers in row-major order.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn from_array(m: [T; 9]) -> Self {
        Self::from_rows(Vec3::new(m[0], m[1], m[2]), Vec3::new(m[3], m[4], m[5]), Vec3::new(m[6], m[7], m[8]))
    }

    /// Its nine numbers in row-major order.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn to_array(self) -> [T; 9] {
        let Self { x, y, z } = self;
        [x.x, x.y, x.z, y.x, y.y, y.z, z.x, z.y, z.z]
    }

    /// The identity.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn identity() -> Self {
        let (zero, one) = (T::zero(), T::one());
        Self::from_array([one, zero, zero, zero, one, zero, zero, zero, one])
    }

    /// The zero matrix.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn zero() -> Self {
        Self::from_rows(Vec3::zero(), Vec3::zero(), Vec3::zero())
    }

    /// The matrix `v×` with `(v×) u = v × u`.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn skew(v: Vec3<T>) -> Self {
        let zero = T::zero();
        Self::from_array([zero, -v.z, v.y, v.z, zero, -v.x, -v.y, v.x, zero])
    }

    /// The transpose.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn transpose(self) -> Self {
        let Self { x, y, z } = self;
        Self::from_rows(Vec3::new(x.x, y.x, z.x), Vec3::new(x.y, y.y, z.y), Vec3::new(x.z, y.z, z.z))
    }

    /// The third column, `M e_z`.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn column_z(self) -> Vec3<T> {
        Vec3::new(self.x.z, self.y.z, self.z.z)
    }

    /// `M R`, R the rotation about z by the angle with this sine and cosine. The third column stays.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn turn_about_z(self, sin: T, cos: T) -> Self {
        Self::from_rows(turn_row(self.x, sin, cos), turn_row(self.y, sin, cos), turn_row(self.z, sin, cos))
    }

    /// `Mᵀ v`.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn transpose_mul(self, v: Vec3<T>) -> Vec3<T> {
        self.x.scale_add(v.x, self.y.scale_add(v.y, self.z * v.z))
    }

    /// `M v + addend`.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn mul_vec_add(self, v: Vec3<T>, addend: Vec3<T>) -> Vec3<T> {
        Vec3::new(self.x.dot_add(v, addend.x), self.y.dot_add(v, addend.y), self.z.dot_add(v, addend.z))
    }

    /// The parameter matrix in another scalar.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn lift<S>(self) -> Mat3<S>
    where
        T: Lift<S>,
    {
        Mat3 { x: self.x.lift(), y: self.y.lift(), z: self.z.lift() }
    }
}

operators! {
    #[cfg_attr(not(debug_assertions), inline(always))]
    <T: Real> Mat3<T>;
    Mul<Vec3<T>>: mul(self, v: Vec3<T>) -> Vec3<T> { Vec3::new(self.x.dot(v), self.y.dot(v), self.z.dot(v)) }
    Mul: mul(self, other: Self) -> Self {
        Self::from_rows(other.transpose_mul(self.x), other.transpose_mul(self.y), other.transpose_mul(self.z))
    }
    Add: add(self, other: Self) -> Self { Self::from_rows(self.x + other.x, self.y + other.y, self.z + other.z) }
    Sub: sub(self, other: Self) -> Self { Self::from_rows(self.x - other.x, self.y - other.y, self.z - other.z) }
}

/// A symmetric 3×3 matrix, six numbers in the order of the description file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sym3<T> {
    /// Entry (x, x).
    pub xx: T,
    /// Entry (x, y).
    pub xy: T,
    /// Entry (x, z).
    pub xz: T,
    /// Entry (y, y).
    pub yy: T,
    /// Entry (y, z).
    pub yz: T,
    /// Entry (z, z).
    pub zz: T,
}

impl<T: Real> Sym3<T> {
    /// The matrix of (xx, xy, xz, yy, yz, zz).
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn from_array([xx, xy, xz, yy, yz, zz]: [T; 6]) -> Self {
        Self { xx, xy, xz, yy, yz, zz }
    }

    /// Its numbers (xx, xy, xz, yy, yz, zz).
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn to_array(self) -> [T; 6] {
        [self.xx, self.xy, self.xz, self.yy, self.yz, self.zz]
    }

    /// The zero matrix.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn zero() -> Self {
        Self::scalar(T::zero())
    }

    /// `value·1`.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn scalar(value: T) -> Self {
        let zero = T::zero();
        Self { xx: value, xy: zero, xz: zero, yy: value, yz: zero, zz: value }
    }

    /// The upper triangle of a matrix known to be symmetric.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn from_upper(m: Mat3<T>) -> Self {
        Self { xx: m.x.x, xy: m.x.y, xz: m.x.z, yy: m.y.y, yz: m.y.z, zz: m.z.z }
    }

    /// `m (|c|²·1 − c cᵀ)`: the inertia of a point mass at `c`.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn point_mass(mass: T, c: Vec3<T>) -> Self {
        Self::minus_cross_cross(c, c * mass)
    }

    /// The upper triangle of `−u× w× = (u·w) 1 − w uᵀ`.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn minus_cross_cross(u: Vec3<T>, w: Vec3<T>) -> Self {
        Self {
            xx: u.y.mul_add(w.y, u.z * w.z),
            xy: -(w.x * u.y),
            xz: -(w.x * u.z),
            yy: u.x.mul_add(w.x, u.z * w.z),
            yz: -(w.y * u.z),
            zz: u.x.mul_add(w.x, u.y * w.y),
        }
    }

    /// `w·u uᵀ`.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn rank_one(weight: T, u: Vec3<T>) -> Self {
        let wu = u * weight;
        Self { xx: wu.x * u.x, xy: wu.x * u.y, xz: wu.x * u.z, yy: wu.y * u.y, yz: wu.y * u.z, zz: wu.z * u.z }
    }

    /// `self + (w u) uᵀ`, where `wu` is w u.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn add_outer(self, wu: Vec3<T>, u: Vec3<T>) -> Self {
        Self {
            xx: wu.x.mul_add(u.x, self.xx),
            xy: wu.x.mul_add(u.y, self.xy),
            xz: wu.x.mul_add(u.z, self.xz),
            yy: wu.y.mul_add(u.y, self.yy),
            yz: wu.y.mul_add(u.z, self.yz),
            zz: wu.z.mul_add(u.z, self.zz),
        }
    }

    /// The full matrix.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn to_mat3(self) -> Mat3<T> {
        Mat3::from_array([self.xx, self.xy, self.xz, self.xy, self.yy, self.yz, self.xz, self.yz, self.zz])
    }

    /// `R S Rᵀ`: the same tensor, in the axes to which `R` transforms.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn rotate(self, r: Mat3<T>) -> Self {
        // Rows of R S, then only the upper triangle of (R S) Rᵀ.
        let Mat3 { x, y, z } = r * self.to_mat3();
        Self { xx: x.dot(r.x), xy: x.dot(r.y), xz: x.dot(r.z), yy: y.dot(r.y), yz: y.dot(r.z), zz: z.dot(r.z) }
    }

    /// The factors of `S = L D Lᵀ`, without pivoting; the pivots are not checked.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn factor(self) -> Ldl3<T> {
        let d1 = self.xx;
        let (l21, l31) = (self.xy / d1, self.xz / d1);
        let d2 = (-l21).mul_add(self.xy, self.yy);
        let m32 = (-l21).mul_add(self.xz, self.yz);
        let l32 = m32 / d2;
        let d3 = (-l32).mul_add(m32, (-l31).mul_add(self.xz, self.zz));
        Ldl3 { l21, l31, l32, pivots: Vec3::new(d1, d2, d3) }
    }

    /// The parameter matrix in another scalar.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn lift<S>(self) -> Sym3<S>
    where
        T: Lift<S>,
    {
        Sym3 { xx: self.xx.lift(), xy: self.xy.lift(), xz: self.xz.lift(), yy: self.yy.lift(), yz: self.yz.lift(), zz: self.zz.lift() }
    }
}

operators! {
    #[cfg_attr(not(debug_assertions), inline(always))]
    <T: Real> Sym3<T>;
    Mul<Vec3<T>>: mul(self, v: Vec3<T>) -> Vec3<T> {
        Vec3::new(
            self.xx.mul_add(v.x, self.xy.mul_add(v.y, self.xz * v.z)),
            self.xy.mul_add(v.x, self.yy.mul_add(v.y, self.yz * v.z)),
            self.xz.mul_add(v.x, self.yz.mul_add(v.y, self.zz * v.z)),
        )
    }
    Add: add(self, o: Self) -> Self {
        Self { xx: self.xx + o.xx, xy: self.xy + o.xy, xz: self.xz + o.xz, yy: self.yy + o.yy, yz: self.yz + o.yz, zz: self.zz + o.zz }
    }
    Sub: sub(self, o: Self) -> Self {
        Self { xx: self.xx - o.xx, xy: self.xy - o.xy, xz: self.xz - o.xz, yy: self.yy - o.yy, yz: self.yz - o.yz, zz: self.zz - o.zz }
    }
}

/// The factors `S = L D Lᵀ` of a symmetric positive definite 3×3 matrix.
#[derive(Clone, Copy, Debug)]
pub struct Ldl3<T> {
    l21: T,
    l31: T,
    l32: T,
    /// The pivots: all positive exactly when the matrix is positive definite.
    pub pivots: Vec3<T>,
}

impl<T: Real> Ldl3<T> {
    /// `S⁻¹ b`.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn solve(&self, b: Vec3<T>) -> Vec3<T> {
        let y2 = (-self.l21).mul_add(b.x, b.y);
        let y3 = (-self.l32).mul_add(y2, (-self.l31).mul_add(b.x, b.z));
        let z = y3 / self.pivots.z;
        let y = (-self.l32).mul_add(z, y2 / self.pivots.y);
        let x = (-self.l31).mul_add(z, (-self.l21).mul_add(y, b.x / self.pivots.x));
        Vec3::new(x, y, z)
    }
}
