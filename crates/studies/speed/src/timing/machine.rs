//! The machine: one core for all candidates, its peak performance, and the cost of a measurement.

use featherbench_bench::{Evaluation, NoAnswer};
use featherbench_spatial::peak::{self, LANES};
use std::time::{Duration, Instant};

/// The machine's peak performance, and the cost of a measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Machine {
    /// Fused multiply-adds of doubles per nanosecond, by full vector registers.
    pub peak: f64,
    /// The same by single doubles.
    pub scalar: f64,
    /// Nanoseconds between two different values of the clock.
    pub resolution: f64,
    /// Nanoseconds of a call that computes nothing.
    pub empty: f64,
}

impl Machine {
    /// Measures it; `empty` is an engine's evaluation that computes nothing.
    pub fn measure(empty: &mut dyn Evaluation) -> Result<Self, NoAnswer> {
        let (peak, scalar) = (peak::multiply_adds_per_ns(), peak::single_multiply_adds_per_ns());
        Ok(Self { peak, scalar, resolution: resolution(), empty: empty_call(empty)? })
    }

    /// As the outcome of a cell.
    pub fn to_values(self) -> Vec<f64> {
        vec![self.peak, self.scalar, self.resolution, self.empty]
    }

    /// The machine from the outcome of a cell.
    pub fn from_values(values: &[f64]) -> Option<Self> {
        let &[peak, scalar, resolution, empty] = values else { return None };
        Some(Self { peak, scalar, resolution, empty })
    }

    /// Why the peak is not valid, if the loop over single doubles shows that: the compiler did not use vectors, or the machine was busy.
    pub fn complaint(&self) -> Option<String> {
        let (times, due) = (self.peak / self.scalar, least_gain(LANES));
        let good = times >= due;
        let vectors = format!("vectors of {LANES} doubles make {times:.2} times the multiply-adds of single doubles");
        (!good).then(|| format!("{vectors}, {due:.2} times are due: the peak is measured too low"))
    }
}

/// The least ratio of the multiply-adds by vectors of this number of lanes to those by single doubles.
///
/// With more than two lanes it is half of the lanes less a tenth: some processors with AVX-512 have one wide unit and two narrow ones, and
/// a lower frequency. With two lanes it is 1.2. It must be more than one, the ratio without vector instructions.
fn least_gain(lanes: usize) -> f64 {
    if lanes > 2 { 0.45 * lanes as f64 } else { 1.2 }
}

/// The shortest step of the clock, in nanoseconds.
fn resolution() -> f64 {
    let step = |_| {
        let start = Instant::now();
        loop {
            let passed = start.elapsed();
            if passed > Duration::ZERO {
                return passed;
            }
        }
    };
    (0..1000).map(step).min().unwrap_or_default().as_nanos() as f64
}

/// Nanoseconds of a call that computes nothing: the smallest of some blocks.
fn empty_call(empty: &mut dyn Evaluation) -> Result<f64, NoAnswer> {
    const CALLS: usize = 100_000;
    let mut least = Duration::MAX;
    for _ in 0..20 {
        least = least.min(empty.clock(0..CALLS)?);
    }
    Ok(least.as_nanos() as f64 / CALLS as f64)
}

/// While it exists, this thread and every child process stay on one core. If the system refuses, it has no effect.
pub(crate) struct Pinned(Option<rustix::thread::CpuSet>);

impl Pinned {
    /// The last core that this thread may use: the first one serves most interrupts.
    pub fn to_one_core() -> Self {
        let Ok(before) = rustix::thread::sched_getaffinity(None) else { return Self(None) };
        let Some(core) = (0..rustix::thread::CpuSet::MAX_CPU).rev().find(|&core| before.is_set(core)) else { return Self(None) };
        let mut one = rustix::thread::CpuSet::new();
        one.set(core);
        Self(move_to(&one).then_some(before))
    }
}

impl Drop for Pinned {
    fn drop(&mut self) {
        if let Some(before) = &self.0 {
            // A failure to restore the cores only costs time.
            move_to(before);
        }
    }
}

/// Moves this thread and every thread of every child process; returns whether at least this thread was moved.
fn move_to(cores: &rustix::thread::CpuSet) -> bool {
    for child in children() {
        let _ = rustix::thread::sched_setaffinity(Some(child), cores);
    }
    rustix::thread::sched_setaffinity(None, cores).is_ok()
}

/// The threads of the processes that this one started; empty if the system does not report them.
fn children() -> Vec<rustix::thread::Pid> {
    let numbers = |path: &str| -> Vec<i32> {
        let text = std::fs::read_to_string(path).unwrap_or_default();
        text.split_whitespace().filter_map(|word| word.parse().ok()).collect()
    };
    let tasks = |process: &str| -> Vec<i32> {
        let folder = std::fs::read_dir(format!("/proc/{process}/task"));
        let names = folder.into_iter().flatten().filter_map(Result::ok).filter_map(|entry| entry.file_name().into_string().ok());
        names.filter_map(|name| name.parse().ok()).collect()
    };
    let started = tasks("self").into_iter().flat_map(|task| numbers(&format!("/proc/self/task/{task}/children")));
    let threads = started.flat_map(|process| tasks(&process.to_string()));
    threads.filter_map(rustix::thread::Pid::from_raw).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::process::{Command, Stdio};

    #[test]
    fn children_are_pinned_with_their_parent_and_freed_with_it() {
        let mut child = Command::new("sleep").arg("60").stdout(Stdio::null()).spawn().unwrap();
        let pid = rustix::thread::Pid::from_raw(i32::try_from(child.id()).unwrap());
        let cores = |pid| rustix::thread::sched_getaffinity(pid).unwrap().count();
        let before = (cores(None), cores(pid));
        let pinned = Pinned::to_one_core();
        assert_eq!((cores(None), cores(pid)), (1, 1));
        let same = rustix::thread::sched_getaffinity(None).unwrap() == rustix::thread::sched_getaffinity(pid).unwrap();
        drop(pinned);
        let after = (cores(None), cores(pid));
        child.kill().unwrap();
        child.wait().unwrap();
        assert!(same);
        assert_eq!(before, after);
    }

    /// Measured when the compiler did not use vectors: 2.6 multiply-adds per nanosecond, where single doubles make 6.5.
    #[test]
    fn a_peak_below_what_single_doubles_make_is_none() {
        let machine = |peak| Machine { peak, scalar: 6.5, resolution: 20.0, empty: 1.0 };
        assert!(machine(2.6).complaint().is_some_and(|reason| reason.contains("0.40 times")));
        assert!(machine(6.5).complaint().is_some(), "one lane of each");
        assert!(machine(f64::NAN).complaint().is_some());
        assert_eq!(machine(6.5 * LANES as f64).complaint(), None);
        let due = 6.5 * least_gain(LANES);
        assert!(machine(0.99 * due).complaint().is_some() && machine(1.01 * due).complaint().is_none());
        assert_eq!([2, 4, 8].map(least_gain), [1.2, 1.8, 3.6]);
        assert_eq!(Machine::from_values(&[1.0, 2.0, 3.0, 4.0]).unwrap().to_values(), [1.0, 2.0, 3.0, 4.0]);
        assert_eq!(Machine::from_values(&[1.0, 2.0, 3.0]), None);
    }
}
