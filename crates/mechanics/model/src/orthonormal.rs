//! Unit vectors and rotations: what written numbers stand for.
//!
//! Computes: a written axis u stands for u/|u|. A written rotation R stands for the nearest rotation: its orthogonal polar factor, the
//! limit of R ← ½(R + R⁻ᵀ). Both are formed with 32 digits and rounded once. Numbers that can come from rounding a unit vector or a
//! rotation are kept to the bit, so that normalising twice is normalising once.
//! Source: Higham, *Functions of Matrices* (2008), §8.3. Shapes: 3 and 9 numbers, rows first. Cost: O(1); nothing is allocated.

use featherbench_spatial::{DoubleDouble, Mat3, Real, Vec3};
use std::array::from_fn;

/// Largest entry of |uᵀu − 1| and |RRᵀ − 1| after rounding to doubles, δ = 2⁻⁵³.
///
/// Entries become û_i(1 + δ_i) with |δ_i| ≤ δ/(1 + δ). By Cauchy and Schwarz a product of two rows changes by 2δ/(1 + δ) + δ² < 2⁻⁵² at
/// most.
/// The factor leaves room for the rounding of 32-digit arithmetic, some 50·2⁻¹⁰⁶.
const ROUNDED: f64 = f64::EPSILON * (1.0 + 64.0 * f64::EPSILON);

/// Each step squares the error. Validation accepts 1e-6: after the steps it is 1e-12, 1e-24, 1e-48.
const STEPS: usize = 3;

/// Written numbers, and the numbers that they stand for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Normalised<const N: usize> {
    /// The written numbers if rounding can have made them, else the doubles nearest to what they stand for.
    pub rounded: [f64; N],
    /// What `rounded` stands for, to 32 digits.
    pub exact: [DoubleDouble; N],
    /// The deviation of the written numbers: | |u| − 1 | of an axis, half the largest entry of |RRᵀ − 1| of a rotation.
    pub missed: f64,
}

/// The unit vector of an axis. The axis must have a length that validation accepts.
pub(crate) fn unit(axis: [f64; 3]) -> Normalised<3> {
    if is_exact(&axis) {
        return Normalised { rounded: axis, exact: axis.map(DoubleDouble::from_f64), missed: 0.0 };
    }
    let (excess, missed, exact) = divided(axis);
    if excess <= ROUNDED {
        return Normalised { rounded: axis, exact, missed };
    }
    let rounded = exact.map(DoubleDouble::to_f64);
    Normalised { rounded, exact: divided(rounded).2, missed }
}

/// Whether a vector is a coordinate axis or the opposite of one: exactly a unit vector. Most axes and rows of rotations are.
fn is_exact(v: &[f64; 3]) -> bool {
    let count = |magnitude: f64| v.iter().filter(|x| x.abs() == magnitude).count();
    count(1.0) == 1 && count(0.0) == 2
}

/// | |u|² − 1 |, | |u| − 1 | and u/|u|.
fn divided(axis: [f64; 3]) -> (f64, f64, [DoubleDouble; 3]) {
    let u = Vec3::from_array(axis.map(DoubleDouble::from_f64));
    let (square, one) = (u.dot(u), DoubleDouble::one());
    let excess = (square - one).abs().to_f64();
    let length = square.sqrt();
    let exact = if excess == 0.0 { u.to_array() } else { u.to_array().map(|x| x / length) };
    (excess, (length - one).abs().to_f64(), exact)
}

/// By how much a matrix is no rotation (the largest entry of |RRᵀ − 1|, or |det R − 1|), if that is more than 1e-6.
///
/// A rotation with 17 digits is orthonormal to about 1e-15. One typed with 8 digits must be accepted, one with 5 digits must not.
pub(crate) fn not_a_rotation(r: &[f64; 9]) -> Option<f64> {
    let dot = |a: usize, b: usize| (0..3).map(|k| r[3 * a + k] * r[3 * b + k]).sum::<f64>();
    let gram = (0..3).flat_map(|a| (0..3).map(move |b| (a, b))).map(|(a, b)| (dot(a, b) - f64::from(a == b)).abs());
    let det = r[0] * (r[4] * r[8] - r[5] * r[7]) - r[1] * (r[3] * r[8] - r[5] * r[6]) + r[2] * (r[3] * r[7] - r[4] * r[6]);
    let error = gram.fold((det - 1.0).abs(), |worst, x| if x > worst || x.is_nan() { x } else { worst });
    if error <= 1e-6 { None } else { Some(error) }
}

/// The rotation nearest to a matrix. The matrix must be one that validation accepts.
pub(crate) fn rotation(matrix: [f64; 9]) -> Normalised<9> {
    if matrix.as_chunks().0.iter().all(is_exact) && (0..3).all(|k| (0..3).any(|row| matrix[3 * row + k] != 0.0)) {
        return Normalised { rounded: matrix, exact: matrix.map(DoubleDouble::from_f64), missed: 0.0 };
    }
    let written = Mat3::from_array(matrix.map(DoubleDouble::from_f64));
    let excess = excess(&written);
    let (exact, missed) = (nearest_rotation(written), 0.5 * excess);
    if excess <= ROUNDED {
        return Normalised { rounded: matrix, exact: exact.to_array(), missed };
    }
    let rounded = exact.to_array().map(DoubleDouble::to_f64);
    Normalised { rounded, exact: nearest_rotation(Mat3::from_array(rounded.map(DoubleDouble::from_f64))).to_array(), missed }
}

/// Largest entry of |RRᵀ − 1|.
fn excess(r: &Mat3<DoubleDouble>) -> f64 {
    let identity = Mat3::<DoubleDouble>::identity();
    let gram = (*r * r.transpose() - identity).to_array();
    // A NaN stays: no comparison with it holds.
    gram.into_iter().map(|x| x.abs().to_f64()).fold(0.0, |largest, x| if x > largest || x.is_nan() { x } else { largest })
}

/// The orthogonal polar factor of a matrix near it.
pub(crate) fn nearest_rotation(mut r: Mat3<DoubleDouble>) -> Mat3<DoubleDouble> {
    if excess(&r) == 0.0 {
        return r;
    }
    let half = DoubleDouble::from_f64(0.5);
    for _ in 0..STEPS {
        // R⁻ᵀ = cof R / det R
        let Mat3 { x, y, z } = r;
        let cofactors = [y.cross(z), z.cross(x), x.cross(y)];
        let determinant = x.dot(cofactors[0]);
        let mean = |row: Vec3<DoubleDouble>, cofactor: Vec3<DoubleDouble>| {
            let (row, cofactor) = (row.to_array(), cofactor.to_array());
            Vec3::from_array(from_fn(|k| (row[k] + cofactor[k] / determinant) * half))
        };
        r = Mat3::from_rows(mean(x, cofactors[0]), mean(y, cofactors[1]), mean(z, cofactors[2]));
    }
    r
}
