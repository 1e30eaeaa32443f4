//! Throughput of batches: what single precision and all cores gain, and the share of the operations' limit as the robot grows.
//!
//! ```text
//! cargo run --release -p featherbench-registry --features measurements --example throughput            # about two minutes
//! cargo run --release -p featherbench-registry --features measurements --example throughput -- --test  # small, once
//! ```
//!
//! Two ways are called in turn. A ratio is that of their shortest times; beside it stands the median of the ratios of neighbours. Ten thousand
//! states are in row order, as users have them; for the limit, a thousand are in lane order.
//!
//! The limit is operations per joint over the multiply-adds that one core makes per nanosecond in full vectors: 142 for inverse and 396 for
//! forward dynamics (`guide/studies/timing.md`, "The machine"). The *workspace* is what a batch keeps of each joint, 12 and 26 registers. Where it is larger than
//! the second cache, each call waits for memory.

use featherbench_dynamics::{Batch, BatchError, Number, to_lanes};
use featherbench_model::Model;
use featherbench_robots::{Family, StateBatch};
use featherbench_spatial::peak::multiply_adds_per_ns;
use std::hint::black_box;
use std::time::Instant;

/// A register of doubles.
type Lanes = <f64 as Number>::Lanes;

/// A quantity: its name, the operations per joint, and the registers that a batch keeps of each.
const QUANTITIES: [(&str, f64, usize); 2] = [("inverse dynamics", 142.0, 12), ("forward dynamics", 396.0, 26)];
const ROBOTS: [&str; 4] = ["chain:n=7,layout=spatial", "chain:n=36,layout=spatial", "humanoid", "chain:n=300,layout=spatial"];
const LENGTHS: [usize; 7] = [10, 36, 100, 300, 1000, 3000, 10_000];

/// How much is measured.
struct Size {
    states: usize,
    rounds: usize,
    longest: usize,
}

fn main() {
    let test = std::env::args().any(|argument| argument == "--test");
    let size = if test { Size { states: 100, rounds: 1, longest: 36 } } else { Size { states: 10_000, rounds: 15, longest: 10_000 } };
    println!("{:<30}{:<20}{:>14}{:>10}{:>16}{:>10}", "robot", "", "f64 over f32", "median", "one core over", "median");
    println!("{:<30}{:<20}{:>14}{:>10}{:>13} all{:>10}", "", "", "", "", rayon::current_num_threads(), "");
    for spec in ROBOTS {
        for (quantity, ..) in QUANTITIES {
            gains(spec, quantity, &size);
        }
    }
    let peak = multiply_adds_per_ns();
    let cache = second_cache();
    let told = cache.map_or_else(|| "of unknown size".into(), |bytes| format!("of {} kB", bytes >> 10));
    println!("\none core: {peak:.1} multiply-adds per ns; the second cache is {told}");
    println!("{:<30}{:<20}{:>14}{:>10}{:>16}{:>10}", "chain", "", "workspace kB", "fits", "ns per joint", "of limit");
    for length in LENGTHS.into_iter().filter(|&length| length <= size.longest) {
        for quantity in QUANTITIES {
            share(length, quantity, peak, cache, &size);
        }
    }
}

fn model(spec: &str) -> Model<f64> {
    Model::build(&Family::parse(spec).expect("a family").generate().expect("a robot")).expect("a valid robot")
}

/// One call of a batch: inverse or forward dynamics.
fn call<S: Number>(batch: &mut Batch<'_, S>, quantity: &str, [q, v, last]: [&[S]; 3], out: &mut [S]) -> Result<(), BatchError> {
    if quantity == QUANTITIES[0].0 { batch.inverse_dynamics(q, v, last, None, out) } else { batch.forward_dynamics(q, v, last, None, out) }
}

fn gains(spec: &str, quantity: &str, size: &Size) {
    let model = model(spec);
    let states = StateBatch::random(&model, size.states, 1);
    let last = if quantity == QUANTITIES[0].0 { &states.a } else { &states.tau };
    let narrow = |numbers: &[f64]| numbers.iter().map(|&x| x as f32).collect::<Vec<_>>();
    let [q, v, last32] = [&states.q, &states.v, last].map(|numbers| narrow(numbers));
    let single = model.lift::<f32>();
    let (mut one, mut all, mut narrow) = (Batch::<f64>::new(&model), Batch::<f64>::new(&model).on_all_cores(), Batch::<f32>::new(&single));
    let (mut out, mut out32) = (vec![0.0; states.v.len()], vec![0.0; states.v.len()]);
    let doubles = [&states.q[..], &states.v, last];
    let (by_singles, by_doubles) = compare(
        size.rounds,
        || call(&mut narrow, quantity, [&q, &v, &last32], black_box(&mut out32)).expect("every state has an answer"),
        || call(&mut one, quantity, doubles, black_box(&mut out)).expect("every state has an answer"),
    );
    let mut again = Batch::<f64>::new(&model);
    let mut other = out.clone();
    let (by_all, by_one) = compare(
        size.rounds,
        || call(&mut all, quantity, doubles, black_box(&mut out)).expect("every state has an answer"),
        || call(&mut again, quantity, doubles, black_box(&mut other)).expect("every state has an answer"),
    );
    let [of_precision, of_cores] =
        [(by_doubles, by_singles), (by_one, by_all)].map(|(slow, fast)| (least(&slow) / least(&fast), median(&slow, &fast)));
    println!("{spec:<30}{quantity:<20}{:>14.2}{:>10.2}{:>16.2}{:>10.2}", of_precision.0, of_precision.1, of_cores.0, of_cores.1);
}

/// The times of two ways in turn, after one call of each that does not count.
fn compare(rounds: usize, mut one: impl FnMut(), mut other: impl FnMut()) -> (Vec<f64>, Vec<f64>) {
    one();
    other();
    (0..rounds).map(|_| (time(&mut one), time(&mut other))).unzip()
}

fn time(call: &mut impl FnMut()) -> f64 {
    let start = Instant::now();
    call();
    start.elapsed().as_secs_f64()
}

fn least(times: &[f64]) -> f64 {
    times.iter().copied().min_by(f64::total_cmp).expect("a round")
}

/// The median of the ratios of neighbours.
fn median(slow: &[f64], fast: &[f64]) -> f64 {
    let mut ratios: Vec<f64> = slow.iter().zip(fast).map(|(slow, fast)| slow / fast).collect();
    ratios.sort_by(f64::total_cmp);
    ratios[ratios.len() / 2]
}

fn share(length: usize, (quantity, operations, registers): (&str, f64, usize), peak: f64, cache: Option<usize>, size: &Size) {
    let model = model(&format!("chain:n={length},layout=spatial"));
    let t = &model.topology;
    let groups = (1000 / length).clamp(1, 128);
    let count = groups * f64::LANES;
    let states = StateBatch::random(&model, count, 1);
    let last = if quantity == QUANTITIES[0].0 { &states.a } else { &states.tau };
    let lanes = |rows: &[f64], each| to_lanes(rows, each).expect("whole vectors");
    let (q, v, last) = (lanes(&states.q, t.nq()), lanes(&states.v, t.nv()), lanes(last, t.nv()));
    let (mut batch, mut out) = (Batch::<f64>::new(&model), vec![Lanes::from(0.0); groups * t.nv()]);
    let calls = 1 + 100_000 / (groups * length);
    let mut run = || {
        for _ in 0..calls {
            let done = if quantity == QUANTITIES[0].0 {
                batch.inverse_dynamics(&q, &v, &last, None, &mut out)
            } else {
                batch.forward_dynamics(&q, &v, &last, None, &mut out)
            };
            done.expect("every state has an answer");
            black_box(&mut out);
        }
    };
    run();
    let times: Vec<f64> = (0..size.rounds).map(|_| time(&mut run)).collect();
    let ns = least(&times) * 1e9 / (calls * count * length) as f64;
    let bytes = length * registers * size_of::<Lanes>();
    let fits = cache.map_or("?", |cache| if bytes <= cache { "yes" } else { "no" });
    println!("{length:<30}{quantity:<20}{:>14}{fits:>10}{ns:>16.2}{:>10.2}", bytes >> 10, operations / peak / ns);
}

/// The bytes of the second cache of the first core, if the system tells them.
fn second_cache() -> Option<usize> {
    let text = std::fs::read_to_string("/sys/devices/system/cpu/cpu0/cache/index2/size").ok()?;
    let digits = text.trim().trim_end_matches('K');
    digits.parse::<usize>().ok().map(|kilobytes| kilobytes << 10)
}
