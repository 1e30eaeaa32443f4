//! Our own kernels under criterion: the same registry, robots and states as in the agreement and timing studies. And forward dynamics in
//! single precision, which the accuracy study checks and no run times.
//!
//! A group is an algorithm and method. An id is a robot and a regime: `stream` uses a thousand random states in turn, `hot` one. The
//! throughput is in dofs. A time includes everything from raw q, v, a or τ to the result in the kernel's workspace. `factorization` and
//! `solve` start from matrices or factors made before. `cargo bench -p featherbench-registry -- --test` calls each once, as a test.

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use featherbench_bench::{Engine, Quantity, Robot};
use featherbench_engines::{Featherbench, timed};
use featherbench_results::ModelOrigin;
use featherbench_robots::{Family, StateBatch};
use std::collections::BTreeMap;
use std::hint::black_box;
use std::time::Duration;

const ROBOTS: [&str; 7] = [
    "chain:n=10,layout=spatial",
    "chain:n=36,layout=spatial",
    "chain:n=100,layout=spatial",
    "chain:n=1000,layout=spatial",
    "binary_tree:depth=10",
    "humanoid",
    "quadruped",
];
/// States in the stream, fewer if they exceed eight million numbers: more would measure the memory.
const STREAM: usize = 1000;
const MOST_NUMBERS: usize = 8_000_000;
const SEED: u64 = 1;

/// Timed only here: no native oracle computes in single precision.
const SINGLE: [(Quantity, &str); 2] = [(Quantity::ForwardDynamicsSingle, "aba"), (Quantity::ForwardDynamicsSingle, "ltdl")];

fn robot(spec: &str) -> Robot {
    let description = Family::parse(spec).expect("a family").generate().expect("a robot");
    Robot::new(&description, "bench", ModelOrigin::Generated, 1, SEED).expect("a valid robot")
}

/// Whether there is an answer at every state.
fn answers(robot: &Robot, states: &StateBatch, quantity: Quantity, method: &str) -> bool {
    let featherbench = Featherbench::new();
    featherbench.prepare(robot, quantity, method, states).is_ok_and(|mut prepared| prepared.run(0..states.count()).is_ok())
}

fn kernels(criterion: &mut Criterion) {
    let robots: Vec<(Robot, StateBatch)> = ROBOTS
        .into_iter()
        .map(|spec| {
            let robot = robot(spec);
            let numbers = robot.states.nq + 3 * robot.states.nv + 6 * robot.states.bodies;
            let states = StateBatch::random(&robot.model, STREAM.min(1 + MOST_NUMBERS / numbers), SEED);
            (robot, states)
        })
        .collect();
    // Criterion needs one group at a time: the robots of each kernel, in the order of the registry.
    let mut groups: BTreeMap<(usize, Quantity, &str), Vec<usize>> = BTreeMap::new();
    for (index, (robot, states)) in robots.iter().enumerate() {
        for (place, (quantity, method)) in timed(robot).into_iter().chain(SINGLE).enumerate() {
            // In single precision the mass matrix of a long chain cannot be factored: without an answer there is no time.
            if SINGLE.contains(&(quantity, method)) && !answers(robot, states, quantity, method) {
                continue;
            }
            groups.entry((place, quantity, method)).or_default().push(index);
        }
    }
    for ((_, quantity, method), indices) in groups {
        let mut group = criterion.benchmark_group(format!("{}/{method}", quantity.name()));
        for index in indices {
            let (robot, states) = &robots[index];
            group.throughput(Throughput::Elements(robot.states.nv as u64));
            bench(&mut group, robot, states, quantity, method);
        }
        group.finish();
    }
}

fn bench(group: &mut BenchmarkGroup<WallTime>, robot: &Robot, states: &StateBatch, quantity: Quantity, method: &str) {
    let featherbench = Featherbench::new();
    for (regime, count) in [("stream", states.count()), ("hot", 1)] {
        group.bench_function(BenchmarkId::new(&robot.name, regime), |bencher| {
            let mut prepared = featherbench.prepare(robot, quantity, method, states).expect("an own kernel");
            let mut state = 0;
            bencher.iter(|| {
                prepared.run(state..state + 1).expect("an answer");
                black_box(prepared.read());
                state = if state + 1 == count { 0 } else { state + 1 };
            });
        });
    }
}

criterion_group! {
    name = benches;
    // Some hundred and fifty kernels in about a minute.
    config = Criterion::default()
        .warm_up_time(Duration::from_millis(100))
        .measurement_time(Duration::from_millis(300))
        .sample_size(20)
        .without_plots();
    targets = kernels
}
criterion_main!(benches);
