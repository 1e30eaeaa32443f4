//! Batches beside single states: the same kernels, robots and states, with one state per call and with many.
//!
//! A group is a quantity and a robot. An id is a way: `single` computes state after state in `f64`, `rows` and `lanes` are batches on one
//! core with arrays in row and in lane order, `all_cores` is `rows` on all cores, and `f32` is `rows` in single precision. Each call computes
//! a thousand and some states, and the throughput is in states. `cargo bench -p featherbench-dynamics -- --test` calls each once, as a test.

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main};
use featherbench_dynamics::{Aba, Batch, Crba, Ltdl, Number, Refined, Rnea, to_lanes};
use featherbench_model::Model;
use featherbench_robots::{Family, StateBatch};
use featherbench_spatial::Compensated;
use std::hint::black_box;
use std::time::Duration;

/// The joints of the second one turn as those of a usual arm with seven do, about skew axes.
const ROBOTS: [(&str, &str); 3] =
    [("chain36", "chain:n=36,layout=spatial"), ("arm7", "chain:n=7,layout=spatial"), ("humanoid", "humanoid")];

/// A multiple of every number of lanes, so that both orders hold the same states.
const STATES: usize = 1024;

type Lanes = <f64 as Number>::Lanes;

fn batches(criterion: &mut Criterion) {
    for (name, spec) in ROBOTS {
        let description = Family::parse(spec).expect("a family").generate().expect("a robot");
        let model: Model<f64> = Model::build(&description).expect("a valid robot");
        let states = StateBatch::random(&model, STATES, 1);
        for quantity in ["inverse_dynamics", "forward_dynamics", "refined", "mass_matrix", "solve"] {
            let mut group = criterion.benchmark_group(format!("{quantity}/{name}"));
            group.throughput(Throughput::Elements(STATES as u64));
            single(&mut group, &model, &states, quantity);
            let lanes = |rows: &[f64], each| to_lanes(rows, each).expect("whole vectors");
            let t = &model.topology;
            let (q, v) = (lanes(&states.q, t.nq()), lanes(&states.v, t.nv()));
            let (a, tau) = (lanes(&states.a, t.nv()), lanes(&states.tau, t.nv()));
            let narrow = |rows: &[f64]| -> Vec<f32> { rows.iter().map(|&x| x as f32).collect() };
            let (q32, v32, a32, tau32) = (narrow(&states.q), narrow(&states.v), narrow(&states.a), narrow(&states.tau));
            let model32: Model<f32> = model.lift();
            let results = STATES * if quantity == "mass_matrix" { t.stored() } else { t.nv() };
            macro_rules! batch {
                ($way:literal, $batch:expr, $q:expr, $v:expr, $a:expr, $tau:expr, $out:expr) => {
                    let (mut batch, mut out) = ($batch, $out);
                    group.bench_function($way, |bencher| {
                        bencher.iter(|| {
                            match quantity {
                                "inverse_dynamics" => batch.inverse_dynamics($q, $v, $a, None, &mut out),
                                "forward_dynamics" => batch.forward_dynamics($q, $v, $tau, None, &mut out),
                                "refined" => batch.refined_forward_dynamics($q, $v, $tau, None, 1, &mut out),
                                "mass_matrix" => batch.mass_matrix($q, &mut out),
                                _ => batch.solve($q, $tau, &mut out),
                            }
                            .expect("every state has an answer");
                            black_box(&mut out);
                        });
                    });
                };
            }
            let registers = vec![Lanes::from(0.0); results / f64::LANES];
            batch!("rows", Batch::<f64>::new(&model), &states.q, &states.v, &states.a, &states.tau, vec![0.0; results]);
            batch!("lanes", Batch::<f64>::new(&model), &q, &v, &a, &tau, registers);
            batch!("all_cores", Batch::<f64>::new(&model).on_all_cores(), &states.q, &states.v, &states.a, &states.tau, vec![0.0; results]);
            batch!("f32", Batch::<f32>::new(&model32), &q32, &v32, &a32, &tau32, vec![0.0; results]);
            group.finish();
        }
    }
}

/// State after state, each result written where a batch would.
fn single(group: &mut BenchmarkGroup<WallTime>, model: &Model<f64>, states: &StateBatch, quantity: &str) {
    let t = &model.topology;
    let (mut rnea, mut aba, mut crba, mut ltdl) = (Rnea::new(t), Aba::new(t), Crba::new(t), Ltdl::new(t));
    let mut refined = Refined::<Compensated>::new(t, 1);
    let each = if quantity == "mass_matrix" { t.stored() } else { t.nv() };
    let mut results = vec![0.0; STATES * each];
    group.bench_function("single", |bencher| {
        bencher.iter(|| {
            for (k, out) in results.chunks_exact_mut(each).enumerate() {
                let (q, v, a, tau) = (states.q(k), states.v(k), states.a(k), states.tau(k));
                match quantity {
                    "inverse_dynamics" => rnea.run(model, q, v, a, None, out).expect("an answer"),
                    "forward_dynamics" => aba.run(model, q, v, tau, None, out).expect("an answer"),
                    "refined" => refined.run(model, q, v, tau, None, out).expect("an answer"),
                    "mass_matrix" => {
                        crba.run(model, q, ltdl.matrix_mut()).expect("an answer");
                        out.copy_from_slice(ltdl.factors().values());
                    }
                    _ => {
                        crba.run(model, q, ltdl.matrix_mut()).expect("an answer");
                        ltdl.factor().expect("an answer");
                        out.copy_from_slice(tau);
                        ltdl.solve(out).expect("an answer");
                    }
                }
            }
            black_box(&mut results);
        });
    });
}

criterion_group! {
    name = benches;
    // Sixty times in about a minute.
    config = Criterion::default()
        .warm_up_time(Duration::from_millis(100))
        .measurement_time(Duration::from_millis(500))
        .sample_size(20)
        .without_plots();
    targets = batches
}
criterion_main!(benches);
