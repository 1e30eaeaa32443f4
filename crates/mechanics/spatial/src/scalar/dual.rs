//! Dual numbers: a value and one directional derivative, over any scalar.

use super::{DoubleDouble, Lift, Real};
use crate::operators::operators;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// `value + derivative·ε` with ε² = 0: forward-mode differentiation in one direction.
///
/// Nested duals give higher derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<T> {
    /// The value.
    pub value: T,
    /// Its derivative in the seeded direction.
    pub derivative: T,
}

impl<T: Real> Dual<T> {
    /// A number that moves with the given rate.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn new(value: T, derivative: T) -> Self {
        Self { value, derivative }
    }

    /// A constant: its derivative is zero.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn constant(value: T) -> Self {
        Self::new(value, T::zero())
    }
}

impl<T: Real> Real for Dual<T> {
    // A dual over f64 is timed, others are not.
    const COMPACT: bool = T::COMPACT || size_of::<T>() > size_of::<f64>();

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn from_f64(value: f64) -> Self {
        Self::constant(T::from_f64(value))
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn from_exact(rounded: f64, exact: DoubleDouble) -> Self {
        Self::constant(T::from_exact(rounded, exact))
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        if Self::COMPACT { called::mul_add(self, factor, addend) } else { inlined::mul_add(self, factor, addend) }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        Self::new(root, self.derivative / (root + root))
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn sin_cos(self) -> (Self, Self) {
        let (s, c) = self.value.sin_cos();
        (Self::new(s, c * self.derivative), Self::new(c, -(s * self.derivative)))
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn reciprocal_or_zero(self) -> Self {
        let reciprocal = self.value.reciprocal_or_zero();
        Self::new(reciprocal, -(reciprocal * reciprocal * self.derivative))
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn min_lane(self) -> f64 {
        self.value.min_lane()
    }
}

/// The operations as parts of their callers.
mod inlined {
    use super::{Dual, Real};

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn sum<T: Real>(a: Dual<T>, b: Dual<T>) -> Dual<T> {
        Dual::new(a.value + b.value, a.derivative + b.derivative)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn difference<T: Real>(a: Dual<T>, b: Dual<T>) -> Dual<T> {
        Dual::new(a.value - b.value, a.derivative - b.derivative)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn product<T: Real>(a: Dual<T>, b: Dual<T>) -> Dual<T> {
        Dual::new(a.value * b.value, a.value.mul_add(b.derivative, a.derivative * b.value))
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn quotient<T: Real>(a: Dual<T>, b: Dual<T>) -> Dual<T> {
        let quotient = a.value / b.value;
        Dual::new(quotient, (-quotient).mul_add(b.derivative, a.derivative) / b.value)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn mul_add<T: Real>(a: Dual<T>, b: Dual<T>, c: Dual<T>) -> Dual<T> {
        Dual {
            value: a.value.mul_add(b.value, c.value),
            derivative: a.value.mul_add(b.derivative, a.derivative.mul_add(b.value, c.derivative)),
        }
    }
}

/// The same operations as calls, for scalars that are [`Real::COMPACT`].
mod called {
    use super::{Dual, Real, inlined};

    macro_rules! calls {
        ($($name:ident($($x:ident),+)),+) => {$(
            #[inline(never)]
            pub fn $name<T: Real>($($x: Dual<T>),+) -> Dual<T> {
                inlined::$name($($x),+)
            }
        )+};
    }
    calls!(sum(a, b), difference(a, b), product(a, b), quotient(a, b), mul_add(a, b, c));
}

impl<T: Real> Lift<Dual<T>> for f64 {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn lift(self) -> Dual<T> {
        Dual::from_f64(self)
    }
}

operators! {
    #[cfg_attr(not(debug_assertions), inline(always))]
    <T: Real> Dual<T>;
    Add: add(self, other: Self) -> Self { if Self::COMPACT { called::sum(self, other) } else { inlined::sum(self, other) } }
    Sub: sub(self, other: Self) -> Self { if Self::COMPACT { called::difference(self, other) } else { inlined::difference(self, other) } }
    Mul: mul(self, other: Self) -> Self { if Self::COMPACT { called::product(self, other) } else { inlined::product(self, other) } }
    Div: div(self, other: Self) -> Self { if Self::COMPACT { called::quotient(self, other) } else { inlined::quotient(self, other) } }
    Neg: neg(self) -> Self { Self::new(-self.value, -self.derivative) }
    ; AddAssign add_assign +, SubAssign sub_assign -, MulAssign mul_assign *
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_dual::{Dual64, DualNum};

    /// An expression that uses every operation of the trait, in our dual and in num-dual's.
    #[test]
    fn agrees_with_num_dual() {
        for (x, y) in [(0.7, 1.3), (2.5, 0.1), (1e-3, 40.0)] {
            let (ours_x, ours_y) = (Dual::new(x, 1.0), Dual::new(y, -0.5));
            let (s, c) = ours_x.sin_cos();
            let ours = (s / ours_y).mul_add(c, ours_y.sqrt()) - (-ours_x) * ours_y;

            let (their_x, their_y) = (Dual64::new(x, 1.0), Dual64::new(y, -0.5));
            let theirs = their_x.sin() / their_y * their_x.cos() + their_y.sqrt() + their_x * their_y;

            // Both evaluate about ten operations: 16 ulps of the result cover either order of rounding.
            assert!((ours.value - theirs.re).abs() <= 16.0 * f64::EPSILON * theirs.re.abs());
            assert!((ours.derivative - theirs.eps).abs() <= 16.0 * f64::EPSILON * (1.0 + theirs.eps.abs()));
        }
    }

    #[test]
    fn nested_duals_give_the_second_derivative() {
        let x = Dual::new(Dual::new(0.4_f64, 1.0), Dual::constant(1.0));
        let (s, _) = x.sin_cos();
        assert!((s.derivative.derivative + 0.4_f64.sin()).abs() < f64::EPSILON, "d²sin/dx² = −sin, one rounding");
    }
}
