//! Our engine, `featherbench`: the kernels of this workspace, run in this process.

use crate::kernel::{Failure, Kernel, kernel, not_offered};
use crate::method::{Method, methods};
use featherbench_bench::{Engine, Evaluation, Identity, NoAnswer, OWN, Quantity, Robot};
use featherbench_results::EngineSource;
use featherbench_robots::StateBatch;
use std::collections::BTreeMap;
use std::hint::black_box;
use std::ops::Range;
use std::time::{Duration, Instant};

/// Our own kernels.
pub struct Featherbench {
    identity: Identity,
}

impl Featherbench {
    /// The kernels of this build.
    pub fn new() -> Self {
        let name = OWN.to_owned();
        Self {
            identity: Identity { name, version: env!("CARGO_PKG_VERSION").to_owned(), source: EngineSource::Own, build: BTreeMap::new() },
        }
    }
}

impl Default for Featherbench {
    fn default() -> Self {
        Self::new()
    }
}

impl Engine for Featherbench {
    fn identity(&self) -> &Identity {
        &self.identity
    }

    fn methods(&self, quantity: Quantity) -> Vec<String> {
        methods(quantity).iter().map(|method| method.name().to_owned()).collect()
    }

    fn prepare<'a>(
        &'a self,
        robot: &'a Robot,
        quantity: Quantity,
        method: &str,
        states: &'a StateBatch,
    ) -> Result<Box<dyn Evaluation + 'a>, NoAnswer> {
        states.check(&robot.model).map_err(|error| NoAnswer::Failed(error.to_string()))?;
        let method = Method::parse(method).ok_or_else(|| not_offered(quantity, method))?;
        let kernel = kernel(robot, quantity, method, states)?;
        Ok(Box::new(Ready { kernel, size: quantity.size(robot), states: states.count(), values: Vec::new() }))
    }
}

/// A kernel with memory for its answers. It allocates when a range is longer than any before.
struct Ready<'a> {
    kernel: Kernel<'a>,
    size: usize,
    states: usize,
    values: Vec<f64>,
}

impl Evaluation for Ready<'_> {
    fn run(&mut self, range: Range<usize>) -> Result<(), NoAnswer> {
        self.values.resize(range.len() * self.size, 0.0);
        for (k, out) in range.zip(self.values.chunks_exact_mut(self.size)) {
            self.kernel.evaluate(k).map_err(failed)?;
            self.kernel.read(out);
        }
        Ok(())
    }

    /// Every answer goes to the same place, in the kernel. Storing all answers would measure the memory.
    fn clock(&mut self, range: Range<usize>) -> Result<Duration, NoAnswer> {
        let mut state = range.start % self.states;
        let together = self.kernel.together();
        let stride = together % self.states;
        let start = Instant::now();
        for _ in range.step_by(together) {
            self.kernel.sweep(state).map_err(failed)?;
            black_box(&mut self.kernel);
            state += stride;
            state -= if state >= self.states { self.states } else { 0 };
        }
        Ok(start.elapsed())
    }

    fn together(&self) -> usize {
        self.kernel.together()
    }

    fn read(&self) -> &[f64] {
        &self.values
    }
}

fn failed(failure: Failure) -> NoAnswer {
    NoAnswer::Failed(failure.to_string())
}
