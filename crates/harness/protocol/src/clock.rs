//! Time as a value: whatever depends on a time asks a [`Clock`] for it. So a test can set the time.

use std::sync::mpsc::{Receiver, RecvTimeoutError, TryRecvError};
use std::time::{Duration, Instant};

/// The time for those who wait for a process.
pub trait Clock: Send + Sync {
    /// The time since a moment of the clock's own choice; it never decreases.
    fn now(&self) -> Duration;

    /// How long to wait for an event before the clock is read again, when `left` remains until the limit. A clock that does not run with
    /// the machine's clock must be read often.
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

/// Waits for an event until `limit` has passed by the clock.
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

    /// A clock that advances by a second at each reading.
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
        // The start, and three queries, after which nothing is left of the three seconds.
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
