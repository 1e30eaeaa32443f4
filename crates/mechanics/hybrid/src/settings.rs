//! What a run may err by, when it calls an end, and how far it may go.

use crate::error::HybridError;

/// The tolerances and caps of a run. Each says what it decides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// κ of the integrator: its order is 2κ. 2 to 12.
    pub columns: usize,
    /// The estimated error per step that is allowed, absolute in the units of each state. The estimate is of order 2κ − 2, and the result
    /// is of order 2κ: its error is smaller.
    pub absolute: f64,
    /// The same, relative to the state.
    pub relative: f64,
    /// The error of the dense output per step, by its defect h(ṗ − f(p)), absolute and relative to the state. It decides which crossings
    /// are seen, not where they are located. At most a tenth of [`Settings::grazing_value`].
    pub dense: f64,
    /// The longest step in seconds.
    pub longest_step: f64,
    /// Cap: steps, rejected ones included.
    pub steps: usize,
    /// Cap: events.
    pub events: usize,
    /// Cap: events at one instant.
    pub chain: usize,
    /// Event times are located until a Newton correction is below this, in seconds; one more correction follows. Near grazing the rounding
    /// of g may be more than |ġ| times this; then the correction ends there, and [`crate::Event::correction`] says where. Events that are
    /// not further apart are simultaneous.
    pub time: f64,
    /// Grazing: an extremum of g whose magnitude is at most this, in the unit of the guard.
    pub grazing_value: f64,
    /// Grazing: a crossing of g = 0 with |ġ| of at most this, in the unit of the guard per second.
    pub grazing_rate: f64,
    /// The outcomes of simultaneous events agree if no state differs by more than this, absolute and relative.
    pub order: f64,
    /// How Zeno's tail is recognised; `None` goes on to the cap of events.
    pub zeno: Option<Zeno>,
}

/// When a sequence of events of one guard counts as the tail of infinitely many in finite time.
///
/// One more event than intervals is needed before the events graze: with the restitution e and the first speed V that is
/// V e^intervals > [`Settings::grazing_rate`]. Else the run ends as grazing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Zeno {
    /// The number of the last intervals that are looked at; 4 or more.
    pub intervals: usize,
    /// Their ratios differ by at most this.
    pub spread: f64,
    /// Their ratio is at most this, which is below 1.
    pub ratio: f64,
}

impl Default for Zeno {
    /// 6 intervals with ratios equal to 10⁻⁸ and at most 0.99.
    fn default() -> Self {
        Self { intervals: 6, spread: 1e-8, ratio: 0.99 }
    }
}

impl Default for Settings {
    /// For `f64`: order 8, 10⁻¹⁴ per step, times to 10⁻¹² s.
    fn default() -> Self {
        Self {
            columns: 4,
            absolute: 1e-14,
            relative: 1e-14,
            dense: 1e-11,
            longest_step: f64::INFINITY,
            steps: 1_000_000,
            events: 10_000,
            chain: 100,
            time: 1e-12,
            grazing_value: 1e-10,
            grazing_rate: 1e-6,
            order: 1e-9,
            zeno: Some(Zeno::default()),
        }
    }
}

impl Settings {
    /// For [`featherbench_spatial::DoubleDouble`]: order 16, 10⁻²⁷ per step, times to 10⁻²⁰ s before the last correction.
    pub fn extended() -> Self {
        Self { columns: 8, absolute: 1e-27, relative: 1e-27, time: 1e-20, ..Self::default() }
    }

    /// An error that names the first setting out of its range.
    pub(crate) fn check(&self) -> Result<(), HybridError> {
        let (positive, above) = (|value: f64| value > 0.0 && value < f64::INFINITY, "positive and finite");
        let columns = self.columns as f64;
        let mut checks = vec![
            ("columns", columns, (2.0..=12.0).contains(&columns), "from 2 to 12"),
            ("absolute", self.absolute, positive(self.absolute), above),
            ("relative", self.relative, (0.0..1.0).contains(&self.relative), "at least 0 and below 1"),
            ("time", self.time, positive(self.time), above),
            ("grazing_value", self.grazing_value, positive(self.grazing_value), above),
            ("grazing_rate", self.grazing_rate, positive(self.grazing_rate), above),
            ("order", self.order, positive(self.order), above),
            (
                "dense",
                self.dense,
                self.dense > 0.0 && self.dense <= 0.1 * self.grazing_value,
                "positive, and at most a tenth of grazing_value",
            ),
            ("longest_step", self.longest_step, self.longest_step > 0.0, "positive; infinite for none"),
        ];
        if let Some(Zeno { intervals, spread, ratio }) = self.zeno {
            checks.extend([
                ("zeno.intervals", intervals as f64, intervals >= 4, "at least 4"),
                ("zeno.spread", spread, positive(spread), above),
                ("zeno.ratio", ratio, ratio > 0.0 && ratio < 1.0, "between 0 and 1"),
            ]);
        }
        match checks.into_iter().find(|(_, _, fits, _)| !fits) {
            Some((field, value, _, range)) => Err(HybridError::Setting { field, value, range }),
            None => Ok(()),
        }
    }
}
