//! The native subject: the kernels of this workspace, in this process.

pub use crate::kernel::timed;
use crate::kernel::{Kernel, kernel, methods};
use featherbench_bench::{Identity, Prepared, Problem, Quantity, Refusal, Subject};
use featherbench_model::StateBatch;
use featherbench_results::EngineSource;
use std::collections::BTreeMap;
use std::hint::black_box;
use std::ops::Range;
use std::time::{Duration, Instant};

/// Our own kernels.
pub struct Native {
    identity: Identity,
}

impl Native {
    /// The kernels of this build.
    pub fn new() -> Self {
        let name = "native".to_owned();
        Self {
            identity: Identity {
                name,
                version: env!("CARGO_PKG_VERSION").to_owned(),
                source: EngineSource::Native,
                build: BTreeMap::new(),
            },
        }
    }
}

impl Default for Native {
    fn default() -> Self {
        Self::new()
    }
}

impl Subject for Native {
    fn identity(&self) -> &Identity {
        &self.identity
    }

    fn methods(&self, quantity: Quantity) -> Vec<String> {
        methods(quantity).iter().map(|&method| method.to_owned()).collect()
    }

    fn prepare<'a>(
        &'a self,
        problem: &'a Problem,
        quantity: Quantity,
        method: &str,
        states: &'a StateBatch,
    ) -> Result<Box<dyn Prepared + 'a>, Refusal> {
        states.check(&problem.model).map_err(|error| Refusal::Failed(error.to_string()))?;
        let kernel = kernel(problem, quantity, method, states)?;
        Ok(Box::new(Ready { kernel, size: quantity.size(problem), states: states.count(), values: Vec::new() }))
    }
}

/// A kernel with room for its answers; it allocates when a longer range comes than ever before.
struct Ready<'a> {
    kernel: Kernel<'a>,
    size: usize,
    states: usize,
    values: Vec<f64>,
}

impl Prepared for Ready<'_> {
    fn run(&mut self, range: Range<usize>) -> Result<(), Refusal> {
        self.values.resize(range.len() * self.size, 0.0);
        for (k, out) in range.zip(self.values.chunks_exact_mut(self.size)) {
            self.kernel.evaluate(k).map_err(|error| Refusal::Failed(error.to_string()))?;
            self.kernel.read(out);
        }
        Ok(())
    }

    /// Every answer goes to the same place, in the kernel: a stream of answers would measure the memory.
    fn clock(&mut self, range: Range<usize>) -> Result<Duration, Refusal> {
        let mut state = range.start % self.states;
        let start = Instant::now();
        for _ in range {
            self.kernel.evaluate(state).map_err(|error| Refusal::Failed(error.to_string()))?;
            black_box(&mut self.kernel);
            state = if state + 1 == self.states { 0 } else { state + 1 };
        }
        Ok(start.elapsed())
    }

    fn read(&self) -> &[f64] {
        &self.values
    }
}
