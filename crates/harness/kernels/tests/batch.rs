//! The method `batch`: at every state the answers of the usual method, and all states while it is timed.

use featherbench_bench::measure::{ForwardScale, scaled_error};
use featherbench_bench::{BATCH, Engine, Quantity, Robot};
use featherbench_kernels::Featherbench;
use featherbench_results::ModelOrigin;
use featherbench_robots::Family;

const QUANTITIES: [Quantity; 12] = [
    Quantity::InverseDynamics,
    Quantity::Bias,
    Quantity::MassMatrix,
    Quantity::MassMatrixProbe,
    Quantity::ForwardDynamics,
    Quantity::ForwardDynamicsSingle,
    Quantity::Momentum,
    Quantity::BodyAcceleration,
    Quantity::BodyJacobian,
    Quantity::Factorization,
    Quantity::Solve,
    Quantity::MassMatrixInverse,
];
/// The gate of the agreement study, and the same in the units of rounding of single precision.
const TOLERANCES: [(&str, f64); 2] = [("f64", 1e-14), ("f32", 1e-14 * (1_u64 << 29) as f64)];

fn robot(words: &str, states: usize) -> Robot {
    let description = Family::parse(words).unwrap().generate().unwrap();
    Robot::new(&description, "test", ModelOrigin::Generated, states, 3).unwrap()
}

#[test]
fn it_has_the_answers_of_the_usual_method() {
    let engine = Featherbench::new();
    for words in ["chain:n=7,layout=spatial", "humanoid", "joints:kind=mixed,base=free"] {
        let robot = robot(words, 37);
        let at = robot.magnitudes();
        let forward = ForwardScale::all(&robot, &at);
        for quantity in QUANTITIES {
            let ask = |quantity: Quantity, method: &str| {
                let mut prepared = engine.prepare(&robot, quantity, method, &robot.states).unwrap();
                prepared.run(0..37).unwrap();
                prepared.read().to_vec()
            };
            let (usual, size) = (engine.methods(quantity).swap_remove(0), quantity.size(&robot));
            let (due, found) =
                (ask(quantity.in_double(), if quantity.precision() == "f32" { "aba" } else { &usual }), ask(quantity, BATCH));
            assert_eq!(found.len(), 37 * size);
            let (_, tolerance) = TOLERANCES.into_iter().find(|(precision, _)| *precision == quantity.precision()).unwrap();
            for (k, (due, found)) in due.chunks_exact(size).zip(found.chunks_exact(size)).enumerate() {
                let error = match quantity.in_double() {
                    Quantity::ForwardDynamics => forward[k].backward_error(found),
                    // M is well conditioned enough here: κ of D^-½ M D^-½ is below 1e3.
                    Quantity::Solve | Quantity::MassMatrixInverse => scaled_error(&robot, quantity, &at[k], due, found) / 1e3,
                    _ => scaled_error(&robot, quantity, &at[k], due, found),
                };
                assert!(error <= tolerance, "{words} {} at state {k}: {error:e}", quantity.name());
            }
        }
    }
}

/// A state that has no answer is found by the clock wherever it stands, and fails alone otherwise.
#[test]
fn a_timed_range_has_all_its_states() {
    let engine = Featherbench::new();
    for count in [1, 5, 100] {
        for bad in [0, count / 2, count - 1] {
            let mut robot = robot("chain:n=7,layout=spatial", count);
            let count = robot.states.count();
            // Their products are infinite.
            robot.states.v[bad * 7..][..7].fill(1e300);
            let states = robot.states.clone();
            for quantity in [Quantity::InverseDynamics, Quantity::ForwardDynamics, Quantity::ForwardDynamicsSingle] {
                let mut prepared = engine.prepare(&robot, quantity, BATCH, &states).unwrap();
                let together = prepared.together();
                assert!(together > 1);
                for state in 0..count {
                    assert_eq!(prepared.run(state..state + 1).is_err(), state == bad, "{} at {state} of {count}", quantity.name());
                }
                // Every state comes once at least, from any first state on.
                for first in [0, 3, count + 1] {
                    assert!(
                        prepared.clock(first..first + count.next_multiple_of(together)).is_err(),
                        "{} from {first} on",
                        quantity.name()
                    );
                }
            }
        }
    }
}
