//! One robot of a million joints: time and memory of each step from its family to its accelerations.
//!
//! ```text
//! cargo run --release -p featherbench-dynamics --features measurements --example scale            # a chain of 10⁶ joints, a binary tree of 2²⁰ − 1
//! cargo run --release -p featherbench-dynamics --features measurements --example scale -- 100000  # a chain of 10⁵ joints, a binary tree of 2¹⁷ − 1
//! cargo run --release -p featherbench-dynamics --features measurements --example scale -- --test  # small ones, once
//! ```
//!
//! A time is the smallest of several calls on one workspace. *Resident* is the memory of the process once the step is done, *peak* its largest
//! so far. Both are zero where the system does not tell them.

use featherbench_dynamics::{
    Aba, Crba, Energy, Kinematics, Ltdl, Momentum, ParallelAba, ParallelCrba, ParallelLtdl, ParallelRnea, Refined, Rnea, TreeSparse,
    Twisted,
};
use featherbench_model::Model;
use featherbench_robots::{Family, StateBatch};
use featherbench_spatial::Compensated;
use std::hint::black_box;
use std::time::Instant;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let test = arguments.iter().any(|argument| argument == "--test");
    let n = arguments.iter().find_map(|argument| argument.parse().ok()).unwrap_or(if test { 1000 } else { 1_000_000 });
    let calls = if test { 1 } else { 7 };
    println!("{:<44}{:>12}{:>14}{:>14}", "", "ms", "resident MB", "peak MB");
    chain(n, calls);
    binary_tree((n + 1).next_power_of_two().ilog2(), calls);
    if !test {
        crossover(calls);
    }
}

fn chain(n: usize, calls: usize) {
    let model = build(&format!("chain:n={n},layout=spatial"));
    let t = &model.topology;
    let states = StateBatch::random(&model, 1, 1);
    let (q, v, a, tau) = (states.q(0), states.v(0), states.a(0), states.tau(0));
    let mut out = vec![0.0; t.nv()];
    {
        let mut rnea = Rnea::new(t);
        measure("  inverse dynamics, Rnea", calls, || rnea.run(&model, q, v, a, None, &mut out).expect("it fits"));
    }
    {
        let mut aba = Aba::new(t);
        measure("  forward dynamics, Aba", calls, || aba.run(&model, q, v, tau, None, &mut out).expect("it fits"));
        measure("  M⁻¹ f, Aba::solve", calls, || aba.solve(&model, tau, &mut out).expect("it fits"));
    }
    {
        let mut twisted = Twisted::new(t).expect("a chain");
        measure("  forward dynamics, Twisted", calls, || twisted.run(&model, q, v, tau, None, &mut out).expect("it fits"));
        on_one_thread(|| {
            measure("    the same on one thread", calls, || twisted.run(&model, q, v, tau, None, &mut out).expect("it fits"));
        });
    }
    {
        let mut kinematics = Kinematics::new(t);
        measure("  kinematics", calls, || kinematics.run(&model, q, v, a).expect("it fits"));
    }
    {
        let mut energy = Energy::new(t);
        measure("  energy", calls, || assert!(black_box(energy.run(&model, q, v).expect("it fits")).kinetic > 0.0));
    }
    {
        let mut momentum = Momentum::new(t);
        measure("  momentum", calls, || assert!(black_box(momentum.run(&model, q, v).expect("it fits")).center.mass > 0.0));
    }
    {
        let mut refined = Refined::<Compensated>::new(t, 1);
        measure("  forward dynamics, Refined in one step", calls, || refined.run(&model, q, v, tau, None, &mut out).expect("it fits"));
    }
}

fn binary_tree(depth: u32, calls: usize) {
    let model = build(&format!("binary_tree:depth={depth}"));
    let t = &model.topology;
    let states = StateBatch::random(&model, 1, 1);
    let (q, v, a, tau) = (states.q(0), states.v(0), states.a(0), states.tau(0));
    let mut out = vec![0.0; t.nv()];
    {
        let (mut rnea, mut parallel) = (Rnea::new(t), ParallelRnea::new(t));
        measure("  inverse dynamics, Rnea", calls, || rnea.run(&model, q, v, a, None, &mut out).expect("it fits"));
        measure("  inverse dynamics, ParallelRnea", calls, || parallel.run(&model, q, v, a, None, &mut out).expect("it fits"));
        on_one_thread(|| {
            measure("    the same on one thread", calls, || parallel.run(&model, q, v, a, None, &mut out).expect("it fits"));
        });
    }
    {
        let (mut aba, mut parallel) = (Aba::new(t), ParallelAba::new(t));
        measure("  forward dynamics, Aba", calls, || aba.run(&model, q, v, tau, None, &mut out).expect("it fits"));
        measure("  forward dynamics, ParallelAba", calls, || parallel.run(&model, q, v, tau, None, &mut out).expect("it fits"));
        on_one_thread(|| {
            measure("    the same on one thread", calls, || parallel.run(&model, q, v, tau, None, &mut out).expect("it fits"));
        });
    }
    let mut matrix = TreeSparse::new(t);
    {
        let (mut crba, mut parallel) = (Crba::new(t), ParallelCrba::new(t));
        measure("  mass matrix, Crba", calls, || crba.run(&model, q, &mut matrix).expect("it fits"));
        measure("  mass matrix, ParallelCrba", calls, || parallel.run(&model, q, &mut matrix).expect("it fits"));
        on_one_thread(|| {
            measure("    the same on one thread", calls, || parallel.run(&model, q, &mut matrix).expect("it fits"));
        });
    }
    {
        let mut ltdl = Ltdl::new(t);
        measure("  factorization of a copy, Ltdl", calls, || ltdl.run(&matrix).expect("positive definite"));
        measure("  solution, Ltdl", calls, || ltdl.solve(&mut out).expect("it fits"));
    }
    let mut parallel = ParallelLtdl::new(t);
    measure("  factorization of a copy, ParallelLtdl", calls, || parallel.run(&matrix).expect("positive definite"));
    on_one_thread(|| {
        measure("    the same on one thread", calls, || parallel.run(&matrix).expect("positive definite"));
    });
}

/// Runs it in a pool of one thread: what dividing the work costs.
fn on_one_thread(call: impl FnOnce() + Send) {
    rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool").install(call);
}

/// The smallest time of forward dynamics of chains by [`Aba`] and by [`Twisted`], called in turn.
fn crossover(calls: usize) {
    println!("chains: µs by Aba, by Twisted with a share of the bodies on the base side");
    let shares = [0.26, 0.30, 0.34, 0.38_f64];
    println!("{:>12}{:>12}{}", "n", "Aba", shares.map(|share| format!("{share:>12.2}")).concat());
    for n in [30, 100, 300, 1000, 3000, 10_000, 100_000, 1_000_000] {
        let model = model(&format!("chain:n={n},layout=spatial"));
        let states = StateBatch::random(&model, 1, 1);
        let (q, v, tau, mut out) = (states.q(0), states.v(0), states.tau(0), vec![0.0; n]);
        let mut aba = Aba::new(&model.topology);
        let cut = |share: f64| Twisted::with_cut(&model.topology, (share * n as f64) as usize).expect("a chain");
        let mut twisted = shares.map(cut);
        let mut smallest = [f64::INFINITY; 5];
        for _ in 0..calls * (1_000_000 / n).clamp(2, 1000) {
            let mut time = |place: usize, call: &mut dyn FnMut()| {
                let start = Instant::now();
                call();
                smallest[place] = smallest[place].min(start.elapsed().as_secs_f64());
            };
            time(0, &mut || aba.run(&model, q, v, tau, None, &mut out).expect("it fits"));
            for (k, twisted) in twisted.iter_mut().enumerate() {
                time(k + 1, &mut || twisted.run(&model, q, v, tau, None, &mut out).expect("it fits"));
            }
        }
        println!("{n:>12}{}", smallest.map(|time| format!("{:>12.1}", 1e6 * time)).concat());
    }
}

fn model(robot: &str) -> Model<f64> {
    Model::build(&Family::parse(robot).expect("a family").generate().expect("a robot")).expect("a valid robot")
}

fn build(robot: &str) -> Model<f64> {
    println!("{robot}");
    let family = Family::parse(robot).expect("a family");
    let description = measured("  description, Family::generate", || family.generate().expect("a robot"));
    measure("  validation, Description::validate", 1, || description.validate().expect("a valid robot"));
    measured("  model, Model::build", || Model::build(&description).expect("a valid robot"))
}

/// The smallest time of so many calls.
fn measure(step: &str, calls: usize, mut call: impl FnMut()) {
    let times = (0..calls).map(|_| {
        let start = Instant::now();
        call();
        start.elapsed().as_secs_f64()
    });
    report(step, times.fold(f64::INFINITY, f64::min));
}

fn measured<T>(step: &str, call: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = call();
    report(step, start.elapsed().as_secs_f64());
    result
}

fn report(step: &str, seconds: f64) {
    println!("{step:<44}{:>12.2}{:>14.0}{:>14.0}", 1e3 * seconds, status("VmRSS:"), status("VmHWM:"));
}

/// A size of this process in MB, as Linux tells it.
fn status(key: &str) -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix(key));
    let kilobytes = line.and_then(|line| line.trim().strip_suffix(" kB")).and_then(|number| number.parse::<f64>().ok());
    kilobytes.unwrap_or(0.0) * 1024e-6
}
