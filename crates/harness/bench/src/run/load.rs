//! What other programs do while a study takes times.

use std::time::Instant;

/// Ticks in a second of `/proc/stat`: the same on every Linux, whatever its kernel's own clock.
const TICKS: f64 = 100.0;

/// The processors' time that was not idle at some moment, and the moment.
pub(super) struct Load {
    busy: f64,
    at: Instant,
}

impl Load {
    /// That of now; `None` where there is no `/proc/stat`.
    pub fn now() -> Option<Self> {
        let text = std::fs::read_to_string("/proc/stat").ok()?;
        Some(Self { busy: busy(text.lines().next()?)?, at: Instant::now() })
    }

    /// Cores that other programs kept busy since then, beside the one that the study does.
    pub fn others(&self) -> Option<f64> {
        let now = Self::now()?;
        let seconds = (now.at - self.at).as_secs_f64();
        // Over less time the ticks are too coarse.
        (seconds >= 1.0).then(|| ((now.busy - self.busy) / seconds - 1.0).max(0.0))
    }
}

/// Seconds that all processors were not idle: user, nice, system, interrupts, and what the host took for others (steal). The field `guest` is part of user.
fn busy(line: &str) -> Option<f64> {
    let mut words = line.split_whitespace();
    (words.next() == Some("cpu")).then_some(())?;
    let ticks: Vec<f64> = words.map(|word| word.parse().ok()).collect::<Option<_>>()?;
    let [user, nice, system, _idle, _waiting, interrupts, soft, steal, ..] = ticks[..] else { return None };
    Some((user + nice + system + interrupts + soft + steal) / TICKS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn busy_is_all_but_idle_and_waiting() {
        assert_eq!(busy("cpu  100 20 3 9999 777 4 5 6 50 0"), Some(1.38));
        for line in ["cpu0 1 2 3 4 5 6 7 8 9 10", "cpu 1 2 3", "cpu a b c d e f g h", ""] {
            assert_eq!(busy(line), None, "{line}");
        }
    }

    #[test]
    fn over_a_moment_nothing_is_known() {
        if let Some(load) = Load::now() {
            assert_eq!(load.others(), None);
            let earlier = Load { busy: load.busy - 30.0, at: load.at - std::time::Duration::from_secs(10) };
            assert!(earlier.others().is_some_and(|cores| (1.9..4.0).contains(&cores)), "30 s in 10 s are three cores, one of them ours");
        }
    }
}
