//! Samples per second of a seven-dof arm's forward dynamics, by both routes and both kinds of points, on one thread and on two.
//!
//! `cargo bench -p featherbench-uncertainty --bench samples`. Divide by the samples: that is the time of one forward dynamics, to be put beside
//! the time of one call of an engine in the study `timing`.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use featherbench_model::Model;
use featherbench_robots::{Family, StateBatch};
use featherbench_uncertainty::{Points, Quantity, RobotResponse, Route, Sampling, Space, State, sample, spread};

const SAMPLES: u64 = 1 << 20;

fn samples(criterion: &mut Criterion) {
    let mut arm = Family::parse("chain:n=7,layout=spatial").and_then(|family| family.generate()).expect("a family");
    arm.uncertain = spread(&arm, 0.2).expect("an arm has masses");
    let model: Model<f64> = Model::build(&arm).expect("a robot");
    let states = StateBatch::random(&model, 1, 1);
    let state = State { q: states.q(0).into(), v: states.v(0).into(), drive: states.tau(0).into() };
    let space = Space::of(&arm.uncertain).expect("variables");
    let mut group = criterion.benchmark_group("forward dynamics of 7 dofs");
    group.sample_size(10).throughput(Throughput::Elements(SAMPLES));
    for (name, route) in [("columns", Route::Affine), ("recursion", Route::Recursive)] {
        let response = RobotResponse::new(&arm, &state, Quantity::Acceleration, Some(route)).expect("a state");
        for (points_name, points) in [("random", Points::Random), ("sobol", Points::Sobol)] {
            for threads in [1, 2] {
                let settings = Sampling { points, samples: SAMPLES, threads: Some(threads), ..Sampling::default() };
                group.bench_function(BenchmarkId::new(format!("{name}, {points_name}"), threads), |bencher| {
                    bencher.iter(|| sample(&space, &response, None, &settings, &|_| ()));
                });
            }
        }
    }
    group.finish();
}

criterion_group!(benches, samples);
criterion_main!(benches);
