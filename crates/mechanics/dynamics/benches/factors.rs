//! The factorization, a solution, the selected inverse and the inverse, by the text for `f64` and by the text for any scalar.
//!
//! A group is an operation. An id is a text and a robot: `f64` runs in registers, `plain` is the book's text on a scalar that is an `f64` in
//! all but its type. Each call takes another of eight matrices, or of their factors. A factorization includes copying its matrix.
//! `cargo bench -p featherbench-dynamics --bench factors -- --test` calls each once, as a test.

#[path = "plain.rs"]
mod plain;

use criterion::measurement::WallTime;
use criterion::{BatchSize, BenchmarkGroup, BenchmarkId, Criterion, criterion_group, criterion_main};
use featherbench_dynamics::{Ltdl, TreeSparse, mass_matrix};
use featherbench_model::{Model, Topology};
use featherbench_robots::{Family, StateBatch};
use featherbench_spatial::Real;
use plain::Plain;
use std::hint::black_box;
use std::time::Duration;

const ROBOTS: [&str; 11] = [
    "chain:n=6,layout=spatial",
    "chain:n=7,layout=spatial",
    "chain:n=36,layout=spatial",
    "chain:n=200,layout=spatial",
    "humanoid",
    "tree:n=1000",
    "binary_tree:depth=10",
    "binary_tree:depth=4",
    "binary_tree:depth=6",
    "tree:n=100,seed=6,spread=0.3",
    "tree:n=30,seed=6,spread=0.3",
];
const STATES: usize = 8;
const SEED: u64 = 1;

struct Robot {
    name: &'static str,
    topology: Topology,
    matrices: Vec<TreeSparse<f64>>,
    forces: StateBatch,
}

impl Robot {
    fn new(name: &'static str) -> Self {
        let description = Family::parse(name).expect("a family").generate().expect("a robot");
        let model: Model<f64> = Model::build(&description).expect("a valid robot");
        let forces = StateBatch::random(&model, STATES, SEED);
        let matrices = (0..STATES).map(|k| mass_matrix(&model, forces.q(k)).expect("a matrix")).collect();
        Self { name, topology: model.topology, matrices, forces }
    }

    fn matrices<T: Real>(&self) -> Vec<TreeSparse<T>> {
        let lift = |matrix: &TreeSparse<f64>| TreeSparse::from_fn(&self.topology, |i, j| T::from_f64(matrix.get(i, j)));
        self.matrices.iter().map(lift).collect()
    }
}

fn all<T: Real>(group: &mut BenchmarkGroup<WallTime>, robot: &Robot, text: &str, operation: &str) {
    let matrices = robot.matrices::<T>();
    let id = BenchmarkId::new(text, robot.name);
    let mut turn = (0..STATES).cycle();
    let mut next = move || turn.next().expect("a cycle");
    let factors = || matrices.iter().map(|matrix| matrix.clone().into_ltdl().expect("a positive definite matrix"));
    match operation {
        "factor" => {
            let mut ltdl = Ltdl::new(&robot.topology);
            group.bench_function(id, |bencher| bencher.iter(|| ltdl.run(black_box(&matrices[next()])).expect("factors")));
        }
        "solve" => {
            let factors: Vec<_> = factors().collect();
            let forces: Vec<Vec<T>> = (0..STATES).map(|k| robot.forces.tau(k).iter().map(|&force| T::from_f64(force)).collect()).collect();
            let mut x = forces[0].clone();
            group.bench_function(id, |bencher| {
                bencher.iter(|| {
                    let k = next();
                    x.copy_from_slice(&forces[k]);
                    factors[k].solve(black_box(&mut x)).expect("a solution");
                });
            });
        }
        "selected_inverse" => {
            let mut factors: Vec<_> = factors().collect();
            let mut inverse = TreeSparse::new(&robot.topology);
            group.bench_function(id, |bencher| {
                bencher.iter(|| factors[next()].selected_inverse(black_box(&mut inverse)).expect("a selected inverse"));
            });
        }
        _ => {
            let n = robot.topology.nv();
            let factors: Vec<_> = factors().collect();
            let mut inverse = vec![T::zero(); n * n];
            group.bench_function(id, |bencher| {
                bencher.iter_batched(
                    &mut next,
                    |k| factors[k].inverse(black_box(&mut inverse)).expect("an inverse"),
                    BatchSize::SmallInput,
                );
            });
        }
    }
}

fn ltdl(criterion: &mut Criterion) {
    let robots: Vec<Robot> = ROBOTS.into_iter().map(Robot::new).collect();
    for operation in ["factor", "solve", "selected_inverse", "inverse"] {
        let mut group = criterion.benchmark_group(operation);
        for robot in &robots {
            all::<f64>(&mut group, robot, "f64", operation);
            all::<Plain>(&mut group, robot, "plain", operation);
        }
        group.finish();
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .warm_up_time(Duration::from_millis(50))
        .measurement_time(Duration::from_millis(200))
        .sample_size(20)
        .without_plots();
    targets = ltdl
}
criterion_main!(benches);
