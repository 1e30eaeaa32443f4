//! How a row is closed and judged.

use serde_json::Value;

use crate::{Relation, Row, Verdict, canonical_json};

/// Margins are limited to this many decades: the margin of an exact zero is this, and not infinite.
pub const MARGIN_LIMIT: f64 = 16.0;

/// How the unit 1 is written in a CSV file.
pub const RATIO: &str = "ratio";

impl Row {
    /// A parameter that the column `params` has.
    ///
    /// ```
    /// use featherbench_results::Row;
    ///
    /// let row = Row { params: r#"{"states":20}"#.into(), ..Row::default() }.with_param("excess", 1e-9.into());
    /// assert_eq!((row.param("excess"), row.params.as_str()), (Some(1e-9.into()), r#"{"excess":1e-9,"states":20}"#));
    /// assert_eq!(row.param("nothing"), None);
    /// ```
    pub fn param(&self, name: &str) -> Option<Value> {
        let params: Value = serde_json::from_str(&self.params).ok()?;
        params.get(name).cloned()
    }

    /// The row with a parameter more. A row whose parameters are no object stays.
    #[must_use]
    pub fn with_param(mut self, name: &str, value: Value) -> Self {
        if let Ok(Value::Object(mut params)) = serde_json::from_str(&self.params) {
            params.insert(name.into(), value);
            self.params = canonical_json(&Value::Object(params));
        }
        self
    }

    /// Closes the row with a value that is judged: a pass or a failure with its margin.
    ///
    /// A value or a bound that is not finite makes the row an error with that reason; the value is then absent.
    pub fn gated(mut self, value: f64, relation: Relation, bound: f64) -> Self {
        self.relation = Some(relation);
        if !bound.is_finite() {
            return self.without_value(Verdict::Error, format!("the bound is {bound}, not a finite number"));
        }
        self.bound = Some(bound);
        self = self.informed(value);
        if self.value.is_some() {
            self.margin = relation.margin(value, bound);
            self.verdict = if relation.holds(value, bound) { Verdict::Pass } else { Verdict::Fail };
            if self.verdict == Verdict::Fail {
                self.reason = format!("{value:e} is not {} {bound:e}", relation.phrase());
            }
        }
        self
    }

    /// Closes the row with a value that is not judged. One that is not finite makes it an error with that reason.
    pub fn informed(mut self, value: f64) -> Self {
        if !value.is_finite() {
            return self.without_value(Verdict::Error, format!("the value is {value}, not a finite number"));
        }
        if let Some(floor) = self.floor.take_if(|floor| !floor.is_finite()) {
            return self.without_value(Verdict::Error, format!("the floor is {floor}, not a finite number"));
        }
        self.value = Some(value);
        self.margin = None;
        self.verdict = Verdict::Info;
        self.reason.clear();
        self
    }

    /// Closes a measured row with a value and its interval, which is not judged. An end that is not finite makes it an error with that
    /// reason.
    pub fn measured(mut self, value: f64, low: f64, high: f64) -> Self {
        self = self.informed(value);
        if self.value.is_none() {
            return self;
        }
        if let Some(end) = [low, high].into_iter().find(|end| !end.is_finite()) {
            return self.without_value(Verdict::Error, format!("an end of the interval is {end}, not a finite number"));
        }
        (self.ci_low, self.ci_high) = (Some(low), Some(high));
        self
    }

    /// Marks the value as not valid, with the reason.
    pub fn invalid(mut self, reason: impl Into<String>) -> Self {
        (self.valid, self.reason) = (false, reason.into());
        self
    }

    /// Closes the row with no value: a skip or an error, and why.
    pub fn without_value(mut self, verdict: Verdict, reason: impl Into<String>) -> Self {
        (self.value, self.ci_low, self.ci_high) = (None, None, None);
        self.margin = None;
        self.verdict = verdict;
        self.reason = reason.into();
        self
    }

    /// Turns a failure or an error into a known deviation: value and margin do not change, the cause is put before the old reason.
    pub fn deviating(mut self, cause: &str) -> Self {
        self.reason = if self.reason.is_empty() { cause.to_owned() } else { format!("{cause} ({})", self.reason) };
        self.verdict = Verdict::Deviation;
        self
    }

    /// The numbers that must be finite, with their columns.
    pub fn floats(&self) -> [(&'static str, Option<f64>); 6] {
        let (low, high) = (("ci_low", self.ci_low), ("ci_high", self.ci_high));
        [("value", self.value), low, high, ("bound", self.bound), ("floor", self.floor), ("margin", self.margin)]
    }

    /// A contradiction in the row, as column and complaint: it shows that a row was altered by hand.
    pub(crate) fn contradiction(&self) -> Option<(&'static str, String)> {
        if let Some((name, value)) = self.floats().into_iter().find_map(|(name, value)| Some((name, value.filter(|v| !v.is_finite())?))) {
            return Some((name, format!("{value} is not a finite number")));
        }
        if self.verdict != Verdict::Pass {
            return None;
        }
        match (self.value, self.relation, self.bound) {
            (Some(value), Some(relation), Some(bound)) if !relation.holds(value, bound) => {
                Some(("verdict", format!("pass, but {value:e} is not {} {bound:e}", relation.phrase())))
            }
            (None, ..) => Some(("verdict", "pass, but there is no value".into())),
            _ => None,
        }
    }
}

impl Relation {
    /// Whether `value` and `bound` have the relation; a NaN never has.
    pub fn holds(self, value: f64, bound: f64) -> bool {
        match self {
            Self::Le => value <= bound,
            Self::Ge => value >= bound,
            Self::Eq => value == bound,
            Self::Within => value.abs() <= bound,
        }
    }

    /// Distance to the gate in decades, positive inside: log₁₀(bound/|value|), or its negative for [`Ge`](Self::Ge).
    ///
    /// Limited to ±[`MARGIN_LIMIT`]. A value equal to its bound has margin 0, even if both are zero. `None` for [`Eq`](Self::Eq), which has
    /// no distance, and where value and bound have no ratio because one of them is negative.
    pub fn margin(self, value: f64, bound: f64) -> Option<f64> {
        let (small, large) = match self {
            Self::Le => (value, bound),
            Self::Ge => (bound, value),
            Self::Within => (value.abs(), bound),
            Self::Eq => return None,
        };
        if small < 0.0 || large < 0.0 || small.is_nan() || large.is_nan() {
            return None;
        }
        if small == large {
            return Some(0.0);
        }
        // The difference of logarithms cannot overflow where the ratio could; log10(0) = -∞ is clamped.
        Some((large.log10() - small.log10()).clamp(-MARGIN_LIMIT, MARGIN_LIMIT))
    }

    /// The relation in words, to be put between value and bound.
    pub fn phrase(self) -> &'static str {
        match self {
            Self::Le => "at most",
            Self::Ge => "at least",
            Self::Eq => "equal to",
            Self::Within => "within ±",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn margins_are_decades_positive_inside() {
        assert_eq!(Relation::Le.margin(1e-16, 1e-14), Some(2.0));
        assert_eq!(Relation::Le.margin(1e-12, 1e-14), Some(-2.0));
        assert_eq!(Relation::Ge.margin(100.0, 1.0), Some(2.0));
        assert_eq!(Relation::Within.margin(-1e-3, 1e-2), Some(1.0));
        assert_eq!(Relation::Le.margin(0.0, 1e-14), Some(MARGIN_LIMIT));
        assert_eq!(Relation::Le.margin(1.0, 0.0), Some(-MARGIN_LIMIT));
        assert_eq!(Relation::Le.margin(0.0, 0.0), Some(0.0));
        assert_eq!(Relation::Le.margin(f64::MAX, f64::MIN_POSITIVE), Some(-MARGIN_LIMIT));
        assert_eq!(Relation::Eq.margin(1.0, 1.0), None);
        assert_eq!(Relation::Le.margin(-1.0, 1.0), None);
    }

    #[test]
    fn a_gate_passes_fails_and_catches_what_is_not_a_number() {
        let pass = Row::default().gated(1e-15, Relation::Le, 1e-14);
        assert_eq!((pass.verdict, pass.reason.as_str()), (Verdict::Pass, ""));
        let fail = Row::default().gated(1e-13, Relation::Le, 1e-14);
        assert_eq!((fail.verdict, fail.reason.as_str()), (Verdict::Fail, "1e-13 is not at most 1e-14"));
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let value = Row::default().gated(bad, Relation::Le, 1e-14);
            assert_eq!((value.value, value.bound, value.margin, value.verdict), (None, Some(1e-14), None, Verdict::Error));
            assert!(value.reason.contains("not a finite number"), "{}", value.reason);
            let bound = Row::default().gated(1.0, Relation::Le, bad);
            assert_eq!((bound.value, bound.bound, bound.verdict), (None, None, Verdict::Error));
            let floor = Row { floor: Some(bad), ..Row::default() }.gated(1.0, Relation::Le, 2.0);
            assert_eq!((floor.value, floor.floor, floor.verdict), (None, None, Verdict::Error));
            assert_eq!(Row::default().informed(bad).verdict, Verdict::Error);
        }
    }

    #[test]
    fn a_deviation_keeps_the_value_and_both_reasons() {
        let row = Row::default().gated(1e-13, Relation::Le, 1e-14).deviating("heavy tip");
        assert_eq!(row.value, Some(1e-13));
        assert_eq!((row.verdict, row.reason.as_str()), (Verdict::Deviation, "heavy tip (1e-13 is not at most 1e-14)"));
    }

    #[test]
    fn an_altered_pass_contradicts_itself() {
        let mut row = Row::default().gated(1e-15, Relation::Le, 1e-14);
        assert_eq!(row.contradiction(), None);
        row.value = Some(1e-3);
        assert_eq!(row.contradiction().map(|(column, _)| column), Some("verdict"));
        row.value = None;
        assert_eq!(row.contradiction().map(|(column, _)| column), Some("verdict"));
    }
}
