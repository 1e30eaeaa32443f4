//! Timing: nanoseconds per call of each native kernel, over a stream of distinct states and `hot` on one.
//!
//! What a time includes: everything from raw q, v, a or τ to the result, sine and cosine, gravity, armature and full inertias among it, and
//! copying the result out. `factorization` and `solve` start from a mass matrix made beforehand. The kernels run one after another, alone,
//! pinned to one core where the system allows it. A call is timed in blocks that last long enough for the clock; the row's value is the
//! median over the blocks, with the tenth and ninetieth percentile beside it.

use crate::row;
use harness::{Cell, Context, Finished, Outcome, Problem, Quantity, Refusal, Study};
use model::StateBatch;
use record::{Kind, Record, Verdict};
use serde_json::json;
use std::hint::black_box;
use std::time::{Duration, Instant};

/// The timing study.
pub struct Timing {
    /// Distinct states in the stream.
    pub states: usize,
    /// Seconds for each kernel and cache regime.
    pub seconds: f64,
    /// The kernels to time on a problem, as (quantity, method).
    pub kernels: fn(&Problem) -> Vec<(Quantity, &'static str)>,
}

/// A block of calls lasts at least this long: a thousand times the clock's resolution.
const BLOCK: Duration = Duration::from_micros(50);
/// No more than this many numbers of states are held at once: more would measure the memory, not the kernel.
const MOST_NUMBERS: usize = 8_000_000;

impl Study for Timing {
    fn name(&self) -> &'static str {
        "timing"
    }

    fn exclusive(&self) -> bool {
        true
    }

    fn plan(&self, context: &Context) -> Vec<Cell> {
        let mut cells = Vec::new();
        let Some(native) = context.subject("native") else { return cells };
        for problem in context.problems.iter().filter(|problem| problem.takes(self.name())) {
            for (quantity, method) in (self.kernels)(problem) {
                for cache in ["stream", "hot"] {
                    let states = if cache == "hot" { 1 } else { self.stream_length(problem) };
                    cells.push(Cell {
                        study: self.name().into(),
                        problem: problem.name.clone(),
                        problem_hash: problem.hash.clone(),
                        params: json!({"algorithm": quantity.name(), "cache": cache, "states": states, "seconds": self.seconds}),
                        subject: native.identity().name.clone(),
                        version: native.identity().version.clone(),
                        method: method.into(),
                        quantity: quantity.name().into(),
                        scalar: "f64".into(),
                    });
                }
            }
        }
        cells
    }

    fn evaluate(&self, context: &Context, cell: &Cell) -> Outcome {
        let lost = || Refusal::Failed("there is no problem, subject or quantity of this cell".into());
        let sample = || {
            let problem = context.problem(&cell.problem).ok_or_else(lost)?;
            let subject = context.subject(&cell.subject).ok_or_else(lost)?;
            let quantity = Quantity::parse(&cell.quantity).ok_or_else(lost)?;
            let count = if cell.params["cache"] == "hot" { 1 } else { self.stream_length(problem) };
            let states = StateBatch::random(&problem.model, count, context.seed);
            let mut prepared = subject.prepare(problem, quantity, &cell.method, &states)?;
            let mut call = |k: usize| {
                prepared.run(k..k + 1)?;
                black_box(prepared.read());
                Ok(())
            };
            self.blocks(count, &mut call)
        };
        sample().into()
    }

    fn compare(&self, _: &Context, problem: &Problem, finished: &[Finished]) -> Vec<Record> {
        let mut rows = Vec::new();
        for (cell, outcome) in finished {
            let blank = Record {
                kind: Kind::Measured,
                unit: "ns".into(),
                case: cell.params["cache"].as_str().unwrap_or_default().into(),
                ..row(cell, problem)
            };
            match outcome {
                Outcome::Reading(_) => {}
                Outcome::Refused(refusal) => rows.push(blank.without_value(Verdict::Error, refusal.to_string())),
                Outcome::Values(blocks) => {
                    let mut sorted = blocks.clone();
                    sorted.sort_unstable_by(f64::total_cmp);
                    for (metric, fraction) in [("ns_per_call", 0.5), ("ns_p10", 0.1), ("ns_p90", 0.9)] {
                        rows.push(Record { metric: metric.into(), ..blank.clone() }.informed(crate::quantile(&sorted, fraction)));
                    }
                }
            }
        }
        rows
    }
}

impl Timing {
    /// The stream's length on a robot: as asked, or fewer where the states would not fit.
    fn stream_length(&self, problem: &Problem) -> usize {
        let numbers = problem.states.nq + 3 * problem.states.nv + 6 * problem.states.bodies;
        self.states.min(1 + MOST_NUMBERS / numbers.max(1))
    }

    /// Nanoseconds per call of each block, after a warm-up of a tenth of the time.
    fn blocks(&self, count: usize, call: &mut dyn FnMut(usize) -> Result<(), Refusal>) -> Result<Vec<f64>, Refusal> {
        let _pinned = Pinned::to_one_core();
        let mut state = 0;
        let mut many = |calls: u32| -> Result<Duration, Refusal> {
            let start = Instant::now();
            for _ in 0..calls {
                call(state)?;
                state = if state + 1 == count { 0 } else { state + 1 };
            }
            Ok(start.elapsed())
        };
        // Warm up, and find how many calls make a block.
        let mut calls = 1;
        while many(calls)? < BLOCK {
            calls *= 2;
        }
        let warm = Instant::now();
        while warm.elapsed().as_secs_f64() < 0.1 * self.seconds {
            many(calls)?;
        }
        let mut samples = Vec::new();
        let start = Instant::now();
        while start.elapsed().as_secs_f64() < self.seconds || samples.len() < 3 {
            samples.push(many(calls)?.as_secs_f64() * 1e9 / f64::from(calls));
        }
        Ok(samples)
    }
}

/// While it lives, this thread stays on one core; where the system refuses, nothing happens.
struct Pinned(Option<rustix::thread::CpuSet>);

impl Pinned {
    fn to_one_core() -> Self {
        let Ok(before) = rustix::thread::sched_getaffinity(None) else { return Self(None) };
        // The last core: the first one serves most interrupts.
        let Some(core) = (0..rustix::thread::CpuSet::MAX_CPU).rev().find(|&core| before.is_set(core)) else { return Self(None) };
        let mut one = rustix::thread::CpuSet::new();
        one.set(core);
        Self(rustix::thread::sched_setaffinity(None, &one).is_ok().then_some(before))
    }
}

impl Drop for Pinned {
    fn drop(&mut self) {
        if let Some(before) = &self.0 {
            // A thread that cannot be freed again is only slower.
            let _ = rustix::thread::sched_setaffinity(None, before);
        }
    }
}
