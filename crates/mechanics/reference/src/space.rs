//! Vectors and matrices of 3-D space, over any [`Scalar`]. Cost: at most nine products per vector operation, 27 per matrix product.

use crate::Mp;
use crate::scalar::Scalar;
use std::array::from_fn;

/// A vector of three numbers.
#[derive(Clone, Debug)]
pub(crate) struct Vec3<T>(pub [T; 3]);

impl<T: Scalar> Vec3<T> {
    pub fn zero() -> Self {
        Self(from_fn(|_| T::zero()))
    }

    pub fn constant(v: &Vec3<Mp>) -> Self {
        Self(from_fn(|i| T::constant(&v.0[i])))
    }

    pub fn plus(&self, other: &Self) -> Self {
        Self(from_fn(|i| self.0[i].plus(&other.0[i])))
    }

    pub fn minus(&self, other: &Self) -> Self {
        Self(from_fn(|i| self.0[i].minus(&other.0[i])))
    }

    pub fn times(&self, factor: &T) -> Self {
        Self(from_fn(|i| self.0[i].times(factor)))
    }

    pub fn dot(&self, other: &Self) -> T {
        let [x, y, z] = from_fn(|i| self.0[i].times(&other.0[i]));
        x.plus(&y).plus(&z)
    }

    pub fn cross(&self, other: &Self) -> Self {
        let ([a, b, c], [x, y, z]) = (&self.0, &other.0);
        Self([b.times(z).minus(&c.times(y)), c.times(x).minus(&a.times(z)), a.times(y).minus(&b.times(x))])
    }
}

/// A 3×3 matrix by its rows.
#[derive(Clone, Debug)]
pub(crate) struct Mat3<T>(pub [Vec3<T>; 3]);

impl<T: Scalar> Mat3<T> {
    pub fn constant(m: &Mat3<Mp>) -> Self {
        Self(from_fn(|i| Vec3::constant(&m.0[i])))
    }

    pub fn transposed(&self) -> Self {
        Self(from_fn(|i| self.column(i)))
    }

    pub fn column(&self, j: usize) -> Vec3<T> {
        Vec3(from_fn(|i| self.0[i].0[j].clone()))
    }

    pub fn apply(&self, v: &Vec3<T>) -> Vec3<T> {
        Vec3(from_fn(|i| self.0[i].dot(v)))
    }

    pub fn product(&self, other: &Self) -> Self {
        let columns = other.transposed();
        Self(from_fn(|i| columns.apply(&self.0[i])))
    }

    /// Rotation by an angle about a unit axis: cos·1 + sin·[u]× + (1 − cos)·u uᵀ (Rodrigues).
    pub fn turn(axis: &Vec3<T>, angle: &T, one: &T) -> Self {
        let (sin, cos) = angle.sin_cos();
        let versed = one.minus(&cos);
        let [x, y, z] = &axis.times(&sin).0;
        let zero = T::zero();
        let skew = [[zero.clone(), z.negated(), y.clone()], [z.clone(), zero.clone(), x.negated()], [y.negated(), x.clone(), zero.clone()]];
        Self(from_fn(|i| {
            Vec3(from_fn(|j| {
                let outer = versed.times(&axis.0[i]).times(&axis.0[j]).plus(&skew[i][j]);
                if i == j { outer.plus(&cos) } else { outer }
            }))
        }))
    }
}
