//! Time as a value: whatever hangs on a time asks a [`Clock`] for it, so that a test can say what time it is.

use std::sync::mpsc::{Receiver, RecvTimeoutError, TryRecvError};
use std::time::{Duration, Instant};

/// What tells the time to those who wait for a process.
pub trait Clock: Send + Sync {
    /// The time since some moment of its own; it never goes back.
    fn now(&self) -> Duration;

    /// How long to wait for an event before the clock is looked at again, when `left` remains until the limit. A clock that does not go with
    /// the machine's wants to be looked at often.
    fn look_again(&self, left: Duration) -> Duration {
        left
    }
}

/// The machine's own monotonic clock.
pub struct SystemClock(Instant);

impl Default for SystemClock {
    fn default() -> Self {
        Self(Instant::now())
    }
}

impl Clock for SystemClock {
    fn now(&self) -> Duration {
        self.0.elapsed()
    }
}

/// Waits for an event until the clock says that `limit` has passed.
///
/// # Errors
/// The limit has passed without an event, or no event can come any more.
pub(crate) fn wait<T>(clock: &dyn Clock, events: &Receiver<T>, limit: Duration) -> Result<T, RecvTimeoutError> {
    let start = clock.now();
    loop {
        let left = limit.saturating_sub(clock.now().saturating_sub(start));
        if left.is_zero() {
            return events.try_recv().map_err(|error| match error {
                TryRecvError::Empty => RecvTimeoutError::Timeout,
                TryRecvError::Disconnected => RecvTimeoutError::Disconnected,
            });
        }
        match events.recv_timeout(clock.look_again(left)) {
            Err(RecvTimeoutError::Timeout) => {}
            end => return end,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;
    use std::sync::mpsc::channel;

    /// A clock that goes on by a second whenever it is looked at.
    #[derive(Default)]
    struct Ticking(Mutex<Duration>);

    impl Clock for Ticking {
        fn now(&self) -> Duration {
            let mut now = self.0.lock().unwrap();
            *now += Duration::from_secs(1);
            *now
        }

        fn look_again(&self, _: Duration) -> Duration {
            Duration::ZERO
        }
    }

    #[test]
    fn a_limit_passes_when_the_clock_says_so() {
        let (sender, events) = channel::<u8>();
        let clock = Ticking::default();
        assert_eq!(wait(&clock, &events, Duration::from_secs(3)), Err(RecvTimeoutError::Timeout));
        // The start, and three looks after which none of the three seconds is left.
        assert_eq!(*clock.0.lock().unwrap(), Duration::from_secs(4));
        sender.send(7).unwrap();
        assert_eq!(wait(&clock, &events, Duration::ZERO), Ok(7), "what is there is taken, however late it is");
        drop(sender);
        assert_eq!(wait(&clock, &events, Duration::ZERO), Err(RecvTimeoutError::Disconnected));
        assert_eq!(wait(&SystemClock::default(), &events, Duration::from_secs(3)), Err(RecvTimeoutError::Disconnected));
    }

    #[test]
    fn the_machines_clock_never_goes_back() {
        let clock = SystemClock::default();
        let first = clock.now();
        assert!(clock.now() >= first);
        assert_eq!(clock.look_again(Duration::from_secs(3)), Duration::from_secs(3), "one wait is enough");
    }
}
