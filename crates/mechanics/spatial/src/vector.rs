//! Spatial motion and force vectors.

use crate::operators::operators;
use crate::{Lift, Real, Vec3};
use std::ops::{Add, AddAssign, Mul, Neg, Sub, SubAssign};

/// A spatial motion vector at a frame's origin: the angular part, and the linear part of the point at that origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion<T> {
    /// Angular part, rad/s for a velocity.
    pub ang: Vec3<T>,
    /// Linear part, m/s for a velocity.
    pub lin: Vec3<T>,
}

/// A spatial force vector at a frame's origin: moment about that origin, and force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Force<T> {
    /// Moment about the origin, N·m.
    pub ang: Vec3<T>,
    /// Force, N.
    pub lin: Vec3<T>,
}

impl<T: Real> Motion<T> {
    /// The product `v × m` of two motions (the book's crm, equation 2.31).
    #[inline(always)]
    pub fn cross_motion(self, m: Self) -> Self {
        Self { ang: self.ang.cross(m.ang), lin: self.ang.cross_add(m.lin, self.lin.cross(m.ang)) }
    }

    /// The product `v ×* f` of a motion and a force (the book's crf, equation 2.32).
    #[inline(always)]
    pub fn cross_force(self, f: Force<T>) -> Force<T> {
        Force { ang: self.ang.cross_add(f.ang, self.lin.cross(f.lin)), lin: self.ang.cross(f.lin) }
    }

    /// The scalar product of a motion and a force: a power, for a velocity.
    #[inline(always)]
    pub fn dot(self, f: Force<T>) -> T {
        let (a, l) = (self.ang, self.lin);
        let linear = l.x.mul_add(f.lin.x, l.y.mul_add(f.lin.y, l.z * f.lin.z));
        a.x.mul_add(f.ang.x, a.y.mul_add(f.ang.y, a.z.mul_add(f.ang.z, linear)))
    }
}

macro_rules! spatial_vector {
    ($name:ident) => {
        impl<T: Real> $name<T> {
            /// The vector with these parts.
            #[inline(always)]
            pub fn new(ang: Vec3<T>, lin: Vec3<T>) -> Self {
                Self { ang, lin }
            }

            /// The zero vector.
            #[inline(always)]
            pub fn zero() -> Self {
                Self::new(Vec3::zero(), Vec3::zero())
            }

            /// The vector of six numbers, angular part first.
            #[inline(always)]
            pub fn from_array([a, b, c, d, e, f]: [T; 6]) -> Self {
                Self::new(Vec3::new(a, b, c), Vec3::new(d, e, f))
            }

            /// Its six numbers, angular part first.
            #[inline(always)]
            pub fn to_array(self) -> [T; 6] {
                [self.ang.x, self.ang.y, self.ang.z, self.lin.x, self.lin.y, self.lin.z]
            }

            /// `self·factor + addend`.
            #[inline(always)]
            pub fn scale_add(self, factor: T, addend: Self) -> Self {
                Self::new(self.ang.scale_add(factor, addend.ang), self.lin.scale_add(factor, addend.lin))
            }

            /// The parameter vector in another scalar.
            #[inline(always)]
            pub fn lift<S>(self) -> $name<S>
            where
                T: Lift<S>,
            {
                $name { ang: self.ang.lift(), lin: self.lin.lift() }
            }
        }

        operators! {
            #[inline(always)]
            <T: Real> $name<T>;
            Add: add(self, other: Self) -> Self { Self::new(self.ang + other.ang, self.lin + other.lin) }
            Sub: sub(self, other: Self) -> Self { Self::new(self.ang - other.ang, self.lin - other.lin) }
            Neg: neg(self) -> Self { Self::new(-self.ang, -self.lin) }
            Mul<T>: mul(self, factor: T) -> Self { Self::new(self.ang * factor, self.lin * factor) }
            ; AddAssign add_assign +, SubAssign sub_assign -
        }
    };
}

spatial_vector!(Motion);
spatial_vector!(Force);
