//! How much a row that does not pass matters: the one place where that is decided.

use serde::{Deserialize, Serialize};

use crate::names::words;
use crate::{Relation, Row, Verdict};

/// The unit of an error that is relative to a size of its own.
const UNIT_FREE: &str = "1";
/// An error within this factor of what rounding accounts for is still rounding: one digit. Another seed, compiler or processor moves an error
/// by a factor of two to three.
const ONE_DIGIT: f64 = 10.0;

words! {
    /// The consequence of a row that does not pass, from the gravest.
    ///
    /// With e the unit-free error of the row, r = max(bound, floor, u) what rounding accounts for in it, and u = 2⁻⁵² (2⁻²³ in single
    /// precision):
    ///
    /// | level | condition |
    /// |---|---|
    /// | physics differs | r < 1 and e > 10 √r: more than half of the digits that rounding leaves are wrong. Methods that lose digits (normal equations, one-sided differences) keep half of them |
    /// | method loses digits | neither of the two others |
    /// | not offered | there is no value |
    /// | rounding | e ≤ 10 r and e ≤ √u |
    ///
    /// A number that is no unit-free error (a count, a time, a number of standard errors) says less. A count that must be equal and is not is
    /// `physics differs`, every other miss is `method loses digits`.
    Severity {
        /// The engine computes something else.
        PhysicsDiffers = "physics differs",
        /// The engine computes the same, with fewer digits than rounding leaves.
        MethodLosesDigits = "method loses digits",
        /// There is no answer.
        NotOffered = "not offered",
        /// The error is about what rounding makes.
        Rounding = "rounding",
    }
}

impl Severity {
    /// The level of a row; `None` if it passes or is not judged.
    pub fn of(row: &Row) -> Option<Self> {
        if matches!(row.verdict, Verdict::Pass | Verdict::Info) {
            return None;
        }
        if row.value.is_none() {
            return Some(Self::NotOffered);
        }
        if row.relation == Some(Relation::Eq) {
            return Some(Self::PhysicsDiffers);
        }
        let Some((error, rounding)) = row.unit_free_error() else { return Some(Self::MethodLosesDigits) };
        Some(if rounding < 1.0 && error > ONE_DIGIT * rounding.sqrt() {
            Self::PhysicsDiffers
        } else if error <= ONE_DIGIT * rounding && error <= row.roundoff().sqrt() {
            Self::Rounding
        } else {
            Self::MethodLosesDigits
        })
    }

    /// What the level says, for a legend.
    pub const fn meaning(self) -> &'static str {
        match self {
            Self::PhysicsDiffers => "more than half of the digits that rounding leaves are wrong: the engine computes something else",
            Self::MethodLosesDigits => "fewer digits than rounding leaves, and at least half of them",
            Self::NotOffered => "no answer",
            Self::Rounding => "within one digit of what rounding accounts for",
        }
    }
}

impl Row {
    /// The unit-free error of the row, and what rounding accounts for in it: the largest of bound, floor and unit roundoff.
    ///
    /// `None` if the value is no such error: it has a unit, no upper bound, or a bound of one and more, as ratios and numbers of standard
    /// errors have.
    pub fn unit_free_error(&self) -> Option<(f64, f64)> {
        let bounded = matches!(self.relation, Some(Relation::Le | Relation::Within));
        let (value, bound) = (self.value?, self.bound?);
        if self.unit != UNIT_FREE || !bounded || bound >= 1.0 {
            return None;
        }
        // The three are finite: a row with another bound or floor has no value.
        Some((value.abs(), bound.max(self.floor.unwrap_or(0.0)).max(self.roundoff())))
    }

    /// The distance from one to the next number of the row's precision.
    pub fn roundoff(&self) -> f64 {
        if self.precision == "f32" { f64::from(f32::EPSILON) } else { f64::EPSILON }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(value: f64, bound: f64) -> Row {
        Row { unit: UNIT_FREE.into(), ..Row::default() }.gated(value, Relation::Le, bound)
    }

    #[test]
    fn levels_follow_the_digits_that_are_left() {
        use Severity::{MethodLosesDigits, PhysicsDiffers, Rounding};
        for (value, bound, due) in [
            (0.78, 1e-14, PhysicsDiffers),
            (1.01e-6, 1e-14, PhysicsDiffers),
            (0.99e-6, 1e-14, MethodLosesDigits),
            (1.01e-13, 1e-14, MethodLosesDigits),
            (0.99e-13, 1e-14, Rounding),
            // A state that amplifies rounding leaves fewer digits, and half of those.
            (5e-6, 1e-6, MethodLosesDigits),
            (1.1e-2, 1e-6, PhysicsDiffers),
            // Half of the digits of a double are no rounding, whatever is allowed.
            (2e-8, 1e-8, MethodLosesDigits),
        ] {
            assert_eq!(Severity::of(&error(value, bound)), Some(due), "{value:e} where {bound:e} is allowed");
        }
        assert_eq!(Severity::of(&error(1e-15, 1e-14)), None, "a pass");
    }

    #[test]
    fn the_floor_and_the_precision_count_as_rounding() {
        let with_floor = Row { floor: Some(1e-10), ..error(1e-11, 1e-14) };
        assert_eq!(Severity::of(&with_floor), Some(Severity::Rounding));
        let single = Row { precision: "f32".into(), ..error(2e-7, 1e-8) };
        assert_eq!(Severity::of(&single), Some(Severity::Rounding));
        assert_eq!(Severity::of(&error(2e-7, 1e-8)), Some(Severity::MethodLosesDigits));
    }

    #[test]
    fn what_is_no_unit_free_error_says_less() {
        let of = |row: Row| Severity::of(&row);
        let counts = Row { unit: UNIT_FREE.into(), ..Row::default() }.gated(3.0, Relation::Eq, 4.0);
        assert_eq!(of(counts), Some(Severity::PhysicsDiffers));
        assert_eq!(of(error(300.0, 3.0)), Some(Severity::MethodLosesDigits), "a ratio of errors");
        assert_eq!(of(Row { unit: "rad".into(), ..error(1.0, 1e-6) }), Some(Severity::MethodLosesDigits));
        for verdict in [Verdict::Skip, Verdict::Error, Verdict::Deviation] {
            assert_eq!(of(error(1.0, 1e-14).without_value(verdict, "none")), Some(Severity::NotOffered));
        }
        assert_eq!(of(error(0.5, 1e-14).deviating("known")), Some(Severity::PhysicsDiffers), "a known cause changes no level");
        assert_eq!(of(Row::default().informed(1.0)), None);
    }

    #[test]
    fn the_gravest_comes_first() {
        assert!(Severity::ALL.is_sorted() && Severity::ALL[0] == Severity::PhysicsDiffers && Severity::ALL[3] == Severity::Rounding);
    }
}
