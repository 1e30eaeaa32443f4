//! Exponential and logarithm of rotations and of placements, and the derivatives of both.
//!
//! With ω a rotation vector, θ = |ω|, W = ω×, and a motion ξ = [ω; ρ] (angular, linear):
//!
//! | | formula |
//! |---|---|
//! | A, B, C | sin θ/θ, (1 − cos θ)/θ², (θ − sin θ)/θ³ |
//! | exp ω, a quaternion | (ω sin(θ/2)/θ, cos(θ/2)) |
//! | J(ω), right Jacobian | 1 − B W + C W²; `exp(ω + δ) = exp(ω) exp(J δ)` to first order |
//! | J⁻¹(ω) | 1 + ½ W + D W², D = −B'/B, where ' is d/dθ² |
//! | exp ξ | rotation exp ω, translation J(−ω) ρ |
//! | Q(ξ) | the derivative of J(ω) along ρ: −B V + C (W V + V W) + 2 (ω·ρ)(−B' W + C' W²), V = ρ× |
//! | J(ξ) on [linear; angular] | `[[J, Q], [0, J]]` |
//!
//! The last row is the rule for functions of a block-triangular matrix: ad ξ = [[W, V], [0, W]] (N. J. Higham, *Functions of Matrices*
//! (2008), theorem 3.6). Source of the others: T. D. Barfoot, *State Estimation for Robotics* (2017), §7.1.
//!
//! **Small angles.** Below θ = 1, series in θ² stand for B, C and their derivatives. There the closed forms would lose digits: C' subtracts
//! equal numbers twice, with an error of ε/θ⁴. At θ = 1 it is a few ε. Fifteen terms leave a rest of 2/32! < 10⁻³⁵, less than a
//! rounding of double-double. The series are also what makes derivatives at θ = 0 right.
//!
//! **Large angles.** Up to 2π the closed forms have no cancellation. J is singular at 2π, and so J⁻¹ has a pole there: it grows like
//! 2π/(2π − θ). Logarithms have θ ≤ π, where D = 1/π². The logarithm takes its angle from atan2. Thus it is as good at π as anywhere.
//!
//! **Sign.** q and −q are the same rotation. The logarithm is that of the one with w ≥ 0: the shortest way. At θ = π both ways are as long,
//! and the vector part decides.
//!
//! Units: radians. Cost: O(1), a sine and cosine, a root, and 30 multiply-adds for the series. Nothing here allocates.

use crate::{Angle, Mat3, Motion, Quaternion, Real, Vec3};
use std::ops::Mul;

/// Terms of each series; see the head of this file.
const TERMS: usize = 15;
/// Below this θ² the series are used.
const SERIES_BELOW: f64 = 1.0;
/// Below this (|v|/w)² the logarithm takes the series of the arc tangent: eleven terms leave 2⁻¹¹⁰/23.
const ARC_SERIES_BELOW: f64 = 1.0 / 1024.0;

/// B, C, and their derivatives, as functions of θ².
struct Coefficients<T> {
    b: T,
    c: T,
    db: T,
    dc: T,
}

/// `Σ (−t)ᵏ (n−1)!/(2k+n−1)!` with its derivative. For n = 3 this is 2B, for n = 4 it is 6C.
#[inline]
fn series<T: Real>(t: T, n: usize) -> (T, T) {
    let (mut sum, mut derivative) = (T::one(), T::zero());
    for k in (0..TERMS).rev() {
        // s_k = 1 − t r s_{k+1}
        let denominator = ((2 * k + n) * (2 * k + n + 1)) as f64;
        let ratio = T::one() / T::from_f64(-denominator);
        (sum, derivative) = ((t * ratio).mul_add(sum, T::one()), ratio * t.mul_add(derivative, sum));
    }
    (sum, derivative)
}

impl<T: Angle> Coefficients<T> {
    fn of(omega: Vec3<T>) -> Self {
        let t = omega.dot(omega);
        let [half, sixth] = [2.0, 6.0].map(|n| T::one() / T::from_f64(n));
        let ((b, db), (c, dc)) = (series(t, 3), series(t, 4));
        let near = Self { b: b * half, c: c * sixth, db: db * half, dc: dc * sixth };

        // 1 − cos θ = 2 sin²(θ/2);  B' = (A − 2B)/2t,  C' = (B − 3C)/2t
        let theta = t.sqrt();
        let (sin, cos) = (theta * half).sin_cos();
        let ratio = sin / theta;
        let (a, b) = (two(ratio * cos), two(ratio * ratio));
        let c = (T::one() - a) / t;
        let far = Self { b, c, db: (a - two(b)) / two(t), dc: (b - c - two(c)) / two(t) };

        let choose = |near: T, far: T| t.where_below(SERIES_BELOW, near, far);
        Self { b: choose(near.b, far.b), c: choose(near.c, far.c), db: choose(near.db, far.db), dc: choose(near.dc, far.dc) }
    }

    /// D of the inverse Jacobian.
    fn d(&self) -> T {
        -self.db / self.b
    }
}

#[inline(always)]
fn two<T: Real>(x: T) -> T {
    x + x
}

/// `x + b·(ω × x) + c·(ω × (ω × x))`
#[inline]
fn polynomial<T: Real>(omega: Vec3<T>, b: T, c: T, x: Vec3<T>) -> Vec3<T> {
    let once = omega.cross(x);
    omega.cross(once).scale_add(c, once.scale_add(b, x))
}

/// `1 + b·W + c·W²`
#[inline]
fn matrix<T: Real>(omega: Vec3<T>, b: T, c: T) -> Mat3<T> {
    let w = Mat3::skew(omega);
    Mat3::identity() + scaled(w, b) + scaled(w * w, c)
}

#[inline]
fn scaled<T: Real>(m: Mat3<T>, factor: T) -> Mat3<T> {
    Mat3::from_rows(m.x * factor, m.y * factor, m.z * factor)
}

impl<T: Angle> Quaternion<T> {
    /// The unit quaternion of the rotation vector `omega`.
    ///
    /// ```
    /// use featherbench_spatial::{Quaternion, Vec3};
    /// let quarter = Quaternion::exp(Vec3::new(0.0, 0.0, std::f64::consts::FRAC_PI_2));
    /// assert!((quarter.v.z - 0.5_f64.sqrt()).abs() < 1e-15 && (quarter.w - 0.5_f64.sqrt()).abs() < 1e-15);
    /// assert!((quarter.log().z - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
    /// ```
    pub fn exp(omega: Vec3<T>) -> Self {
        let half = T::from_f64(0.5);
        // of h = θ/2: sin h/h = 1 − h² C(h²) and cos h = 1 − h² B(h²)
        let square = omega.dot(omega) * T::from_f64(0.25);
        let (b, c) = (series(square, 3).0 * half, series(square, 4).0 / T::from_f64(6.0));
        let near = [(-square).mul_add(c, T::one()), (-square).mul_add(b, T::one())];
        let angle = square.sqrt();
        let (sin, cos) = angle.sin_cos();
        let far = [sin / angle, cos];
        let choose = |k: usize| square.where_below(SERIES_BELOW, near[k], far[k]);
        Self { v: omega * (choose(0) * half), w: choose(1) }
    }

    /// The rotation vector of at most π in length, whatever the sign and the length of the quaternion. Zero has none: its logarithm is NaN.
    pub fn log(self) -> Vec3<T> {
        let sign = self.w.where_below(0.0, -T::one(), T::one());
        let (v, w) = (self.v * sign, self.w * sign);
        let square = v.dot(v);
        // 2 atan(x)/x / w with x = |v|/w
        let x = square / (w * w);
        let mut sum = T::zero();
        for k in (0..11).rev() {
            sum = T::one() / T::from_f64((2 * k + 1) as f64) - x * sum;
        }
        let near = sum / w;
        let length = square.sqrt();
        let far = length.atan2(w) / length;
        v * two(x.where_below(ARC_SERIES_BELOW, near, far))
    }

    /// The quaternion of length one with the same rotation and sign. One shorter than 10⁻¹⁸ stands for no rotation: it becomes the identity.
    pub fn normalised(self) -> Self {
        let square = self.w.mul_add(self.w, self.v.dot(self.v));
        let factor = T::one() / square.sqrt();
        let choose = |identity: T, x: T| square.where_below(1e-36, identity, x * factor);
        let Vec3 { x, y, z } = self.v;
        Self { v: Vec3::from_array([x, y, z].map(|x| choose(T::zero(), x))), w: choose(T::one(), self.w) }
    }
}

impl<T: Real> Quaternion<T> {
    /// The identity.
    #[inline]
    pub fn identity() -> Self {
        Self { v: Vec3::zero(), w: T::one() }
    }

    /// The quaternion (−v, w): of a unit quaternion the inverse rotation.
    #[inline]
    pub fn conjugate(self) -> Self {
        Self { v: -self.v, w: self.w }
    }

    /// Its four numbers x, y, z, w.
    #[inline]
    pub fn to_array(self) -> [T; 4] {
        [self.v.x, self.v.y, self.v.z, self.w]
    }
}

/// The rotation of `self` after that of `other`.
impl<T: Real> Mul for Quaternion<T> {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        let v = self.v.cross_add(other.v, other.v.scale_add(self.w, self.v * other.w));
        Self { v, w: self.w.mul_add(other.w, -self.v.dot(other.v)) }
    }
}

/// A linear map of rotation vectors or of the velocities of a free joint, [linear; angular]: `[[diagonal, coupling], [0, diagonal]]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TangentBlock<T> {
    /// From linear to linear, and from angular to angular.
    pub diagonal: Mat3<T>,
    /// From angular to linear.
    pub coupling: Mat3<T>,
}

impl<T: Angle> Vec3<T> {
    /// The right Jacobian J of the exponential at this rotation vector: `exp(ω + δ) = exp(ω) exp(J δ)` to first order in δ.
    pub fn right_jacobian(self) -> Mat3<T> {
        let f = Coefficients::of(self);
        matrix(self, -f.b, f.c)
    }

    /// The inverse of [`Vec3::right_jacobian`]; it has a pole at the length 2π.
    pub fn inverse_right_jacobian(self) -> Mat3<T> {
        matrix(self, T::from_f64(0.5), Coefficients::of(self).d())
    }

    /// `J⁻¹ x`, without the matrix.
    pub fn inverse_right_jacobian_mul(self, x: Vec3<T>) -> Vec3<T> {
        polynomial(self, T::from_f64(0.5), Coefficients::of(self).d(), x)
    }
}

impl<T: Angle> Motion<T> {
    /// The exponential: the rotation, and the translation in axes before it, that this velocity in body axes makes in a unit of time.
    pub fn exp(self) -> (Quaternion<T>, Vec3<T>) {
        let f = Coefficients::of(self.ang);
        (Quaternion::exp(self.ang), polynomial(self.ang, f.b, f.c, self.lin))
    }

    /// The motion whose exponential is this rotation and translation, by the shortest way.
    ///
    /// ```
    /// use featherbench_spatial::{Motion, Vec3};
    /// let screw = Motion::new(Vec3::new(0.3, -1.0, 2.0), Vec3::new(4.0, 5.0, 6.0));
    /// let (rotation, translation) = screw.exp();
    /// let back = Motion::log(rotation, translation);
    /// assert!((back - screw).to_array().iter().all(|x: &f64| x.abs() < 1e-14));
    /// ```
    pub fn log(rotation: Quaternion<T>, translation: Vec3<T>) -> Self {
        let ang = rotation.log();
        let d = Coefficients::of(ang).d();
        Self::new(ang, polynomial(ang, T::from_f64(-0.5), d, translation))
    }

    /// The right Jacobian J(ξ) of the exponential: `exp(ξ + δ) = exp(ξ) exp(J δ)` to first order in δ.
    pub fn right_jacobian(self) -> TangentBlock<T> {
        let f = Coefficients::of(self.ang);
        let (w, v) = (Mat3::skew(self.ang), Mat3::skew(self.lin));
        let rate = two(self.ang.dot(self.lin));
        let coupling = scaled(v, -f.b) + scaled(w * v + v * w, f.c) + scaled(w, -(rate * f.db)) + scaled(w * w, rate * f.dc);
        TangentBlock { diagonal: matrix(self.ang, -f.b, f.c), coupling }
    }

    /// The inverse of [`Motion::right_jacobian`]: `[[J⁻¹, −J⁻¹ Q J⁻¹], [0, J⁻¹]]`.
    pub fn inverse_right_jacobian(self) -> TangentBlock<T> {
        let inverse = self.ang.inverse_right_jacobian();
        let coupling = inverse * self.right_jacobian().coupling * inverse;
        TangentBlock { diagonal: inverse, coupling: scaled(coupling, -T::one()) }
    }

    /// `J(ξ)⁻¹ x`.
    pub fn inverse_right_jacobian_mul(self, x: Self) -> Self {
        let ang = self.ang.inverse_right_jacobian_mul(x.ang);
        let lin = x.lin - self.right_jacobian().coupling * ang;
        Self::new(ang, self.ang.inverse_right_jacobian_mul(lin))
    }

    /// The map that takes a small motion before this one to the same motion after it: `exp(δ) exp(ξ) = exp(ξ) exp(map δ)`.
    pub fn carried(self) -> TangentBlock<T> {
        let (rotation, translation) = self.exp();
        let turned = rotation.to_rotation().transpose();
        TangentBlock { diagonal: turned, coupling: turned * Mat3::skew(-translation) }
    }
}

impl<T: Real> TangentBlock<T> {
    /// The six by six numbers, row after row, on [linear; angular].
    pub fn to_array(&self) -> [T; 36] {
        let (diagonal, coupling) = (self.diagonal.to_array(), self.coupling.to_array());
        let mut all = [T::zero(); 36];
        for (row, column) in (0..3).flat_map(|row| (0..3).map(move |column| (row, column))) {
            all[6 * row + column] = diagonal[3 * row + column];
            all[6 * row + column + 3] = coupling[3 * row + column];
            all[6 * (row + 3) + column + 3] = diagonal[3 * row + column];
        }
        all
    }
}
