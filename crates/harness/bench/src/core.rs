//! Whether a core is alone.

use crate::statistics::CROWDED;
use std::sync::{Mutex, PoisonError};

/// A core, and how crowded it was at its quietest since the program began.
pub struct Core {
    measure: fn() -> f64,
    /// The three least numbers, in order. One or two may be accidents.
    least: Mutex<[f64; 3]>,
}

impl Core {
    /// A core of which nothing is known yet; `measure` is [`featherbench_spatial::contention`].
    pub const fn new(measure: fn() -> f64) -> Self {
        Self { measure, least: Mutex::new([f64::INFINITY; 3]) }
    }

    /// How crowded it is, and whether it is alone by all that is known so far.
    pub fn contention(&self) -> (f64, bool) {
        let now = (self.measure)();
        let mut least = self.least.lock().unwrap_or_else(PoisonError::into_inner);
        if now < least[2] {
            least[2] = now;
            least.sort_unstable_by(f64::total_cmp);
        }
        (now, now <= CROWDED * least[2])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    #[test]
    fn a_core_is_alone_by_its_quietest_moments() {
        thread_local!(static NOW: Cell<f64> = const { Cell::new(0.0) });
        let core = Core::new(|| NOW.get());
        let alone = |now: f64| {
            NOW.set(now);
            let (told, alone) = core.contention();
            assert_eq!(told, now);
            alone
        };
        // Crowded from the beginning: nothing else is known. Then it is alone, and what was usual is not.
        assert!((0..10).all(|_| alone(1.3)));
        for _ in 0..3 {
            alone(1.0);
        }
        assert!(!alone(1.3) && alone(1.07) && !alone(1.09));
        // One number, or two, that are too small change nothing.
        alone(0.2);
        alone(0.3);
        assert!(alone(1.04));
    }
}
