//! The machine: one core for everything that is timed, what it can do at best, and what a measurement costs.

use harness::{Prepared, Refusal};
use std::hint::black_box;
use std::time::{Duration, Instant};

/// Doubles in a vector register of this build.
pub(super) const LANES: usize = if cfg!(target_feature = "avx512f") {
    8
} else if cfg!(target_feature = "avx") {
    4
} else {
    2
};

/// What the machine does at best, and what a measurement costs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Machine {
    /// Fused multiply-adds of doubles per nanosecond, in full vectors.
    pub peak: f64,
    /// Nanoseconds between two readings of the clock that differ.
    pub resolution: f64,
    /// Nanoseconds of a call that computes nothing.
    pub empty: f64,
}

impl Machine {
    /// Measures it; `empty` is a subject's evaluation that computes nothing.
    pub fn measure(empty: &mut dyn Prepared) -> Result<Self, Refusal> {
        Ok(Self { peak: peak(), resolution: resolution(), empty: empty_call(empty)? })
    }

    /// As the outcome of a cell.
    pub fn to_values(self) -> Vec<f64> {
        vec![self.peak, self.resolution, self.empty]
    }

    /// Read back.
    pub fn from_values(values: &[f64]) -> Option<Self> {
        let &[peak, resolution, empty] = values else { return None };
        Some(Self { peak, resolution, empty })
    }
}

/// Vectors in flight: more than the latency of a multiply-add times the number of units that make them.
const CHAINS: usize = 12;
/// Blocks of which the best counts: a limit is what the machine can do, not what it usually does.
const BLOCKS: usize = 200;
/// Multiply-adds in each chain of a block.
const STEPS: usize = 20_000;

/// Multiply-adds per nanosecond of independent chains of full vectors.
fn peak() -> f64 {
    let best = (0..BLOCKS).map(|_| {
        let start = Instant::now();
        black_box(chains(black_box(1.0), black_box(1e-9)));
        start.elapsed()
    });
    (STEPS * CHAINS * LANES) as f64 / best.min().unwrap_or_default().as_nanos() as f64
}

/// x ← x·m + c in every lane of every chain; a slow start of the first chain delays the others by nothing.
#[inline(never)]
fn chains(m: f64, c: f64) -> [[f64; LANES]; CHAINS] {
    let mut x = [[1.0_f64; LANES]; CHAINS];
    for _ in 0..STEPS {
        for chain in &mut x {
            for lane in chain {
                *lane = spatial::Real::mul_add(*lane, m, c);
            }
        }
    }
    x
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

/// Nanoseconds of a call that computes nothing: the least of some blocks.
fn empty_call(empty: &mut dyn Prepared) -> Result<f64, Refusal> {
    const CALLS: usize = 100_000;
    let mut least = Duration::MAX;
    for _ in 0..20 {
        least = least.min(empty.clock(0..CALLS)?);
    }
    Ok(least.as_nanos() as f64 / CALLS as f64)
}

/// While it lives, this thread and every child process stay on one core; where the system refuses, nothing happens.
pub(super) struct Pinned(Option<rustix::thread::CpuSet>);

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
            // What cannot be freed again is only slower.
            move_to(before);
        }
    }
}

/// Moves this thread and every thread of every child process; whether at least this thread went.
fn move_to(cores: &rustix::thread::CpuSet) -> bool {
    for child in children() {
        let _ = rustix::thread::sched_setaffinity(Some(child), cores);
    }
    rustix::thread::sched_setaffinity(None, cores).is_ok()
}

/// The threads of the processes that this one started; none where the system does not tell.
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

    #[test]
    fn the_chains_compute_what_they_say() {
        // x ← x + c, many times.
        let x = chains(1.0, 0.5);
        assert!(x.iter().flatten().all(|&lane| lane == 1.0 + 0.5 * STEPS as f64));
        assert_eq!(Machine::from_values(&[1.0, 2.0, 3.0]).unwrap().to_values(), [1.0, 2.0, 3.0]);
        assert_eq!(Machine::from_values(&[1.0]), None);
    }
}
