//! A scalar that counts its operations, so that O(n) is an integer identity and not a fitted slope.

use super::{Lift, Real};
use std::cell::Cell;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// How many operations of each kind were executed on [`Counted`] scalars.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Operations {
    /// Additions and subtractions (negations are free).
    pub additions: u64,
    /// Multiplications.
    pub multiplications: u64,
    /// Fused multiply-adds.
    pub fused: u64,
    /// Divisions.
    pub divisions: u64,
    /// Square roots.
    pub roots: u64,
    /// Sine-cosine pairs.
    pub sin_cos: u64,
}

impl Operations {
    /// All operations but sine and cosine; a fused multiply-add counts once. These are the instructions of a machine with fused
    /// multiply-add.
    pub fn total(&self) -> u64 {
        self.additions + self.multiplications + self.fused + self.divisions + self.roots
    }

    /// Floating-point operations without sine and cosine; a fused multiply-add counts twice.
    pub fn flops(&self) -> u64 {
        self.total() + self.fused
    }
}

thread_local! {
    static COUNT: Cell<Operations> = const {
        Cell::new(Operations { additions: 0, multiplications: 0, fused: 0, divisions: 0, roots: 0, sin_cos: 0 })
    };
}

/// An `f64` whose operations are counted on this thread; read the counts with [`Counted::count`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Counted(pub f64);

impl Counted {
    /// Runs `work` and returns the operations that it executed on this thread.
    pub fn count(work: impl FnOnce()) -> Operations {
        COUNT.set(Operations::default());
        work();
        COUNT.get()
    }

    fn tally(kind: impl FnOnce(&mut Operations) -> &mut u64) {
        let mut count = COUNT.get();
        *kind(&mut count) += 1;
        COUNT.set(count);
    }
}

impl Real for Counted {
    const COMPACT: bool = true;

    fn from_f64(value: f64) -> Self {
        Self(value)
    }

    fn mul_add(self, factor: Self, addend: Self) -> Self {
        Self::tally(|count| &mut count.fused);
        Self(Real::mul_add(self.0, factor.0, addend.0))
    }

    fn sqrt(self) -> Self {
        Self::tally(|count| &mut count.roots);
        Self(self.0.sqrt())
    }

    fn sin_cos(self) -> (Self, Self) {
        Self::tally(|count| &mut count.sin_cos);
        let (s, c) = self.0.sin_cos();
        (Self(s), Self(c))
    }

    fn reciprocal_or_zero(self) -> Self {
        Self::tally(|count| &mut count.divisions);
        Self(self.0.reciprocal_or_zero())
    }

    fn min_lane(self) -> f64 {
        self.0
    }
}

impl Lift<Counted> for f64 {
    fn lift(self) -> Counted {
        Counted(self)
    }
}

impl Add for Counted {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::tally(|count| &mut count.additions);
        Self(self.0 + other.0)
    }
}

impl Sub for Counted {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::tally(|count| &mut count.additions);
        Self(self.0 - other.0)
    }
}

impl Mul for Counted {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self::tally(|count| &mut count.multiplications);
        Self(self.0 * other.0)
    }
}

impl Div for Counted {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        Self::tally(|count| &mut count.divisions);
        Self(self.0 / other.0)
    }
}

impl Neg for Counted {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl AddAssign for Counted {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for Counted {
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl MulAssign for Counted {
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_each_kind_and_starts_from_zero() {
        let work = || {
            let x = Counted(2.0);
            let y = x.mul_add(x, x) + x * x - x / x;
            let _ = (y.sqrt(), y.sin_cos(), -y);
        };
        let expected = Operations { additions: 2, multiplications: 1, fused: 1, divisions: 1, roots: 1, sin_cos: 1 };
        assert_eq!(Counted::count(work), expected);
        assert_eq!(Counted::count(work), expected);
        assert_eq!((expected.total(), expected.flops()), (6, 7));
    }
}
