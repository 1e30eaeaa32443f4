//! Second derivatives: the closed recursions against dual numbers through the first derivatives.

use featherbench_bench::measure::scaled_error;
use featherbench_bench::{Engine, Quantity, Robot};
use featherbench_kernels::Featherbench;
use featherbench_results::ModelOrigin;
use featherbench_robots::Family;

const STATES: usize = 5;

/// Relative to the largest entry of each matrix. Those of forward dynamics meet M⁻¹ three times; κ of D^-½ M D^-½ is below 1e3.
const TOLERANCES: [(Quantity, f64); 2] = [(Quantity::InverseDynamicsSecond, 1e-13), (Quantity::ForwardDynamicsSecond, 1e-10)];

#[test]
fn recursions_and_dual_numbers_have_the_same_second_derivatives() {
    let engine = Featherbench::new();
    for words in ["chain:n=7,layout=spatial", "quadruped", "joints:kind=mixed,base=free"] {
        let description = Family::parse(words).unwrap().generate().unwrap();
        let robot = Robot::new(&description, "test", ModelOrigin::Generated, STATES, 3).unwrap();
        let at = robot.magnitudes();
        for (quantity, tolerance) in TOLERANCES {
            assert_eq!(engine.methods(quantity), ["analytic", "dual"]);
            let [found, due] = ["analytic", "dual"].map(|method| {
                let mut prepared = engine.prepare(&robot, quantity, method, &robot.states).unwrap();
                prepared.run(0..STATES).unwrap();
                prepared.read().to_vec()
            });
            let size = quantity.size(&robot);
            assert_eq!(size, 4 * robot.states.nv * robot.states.nv);
            for (k, (found, due)) in found.chunks_exact(size).zip(due.chunks_exact(size)).enumerate() {
                let error = scaled_error(&robot, quantity, &at[k], due, found);
                assert!(error <= tolerance, "{words} {} at state {k}: {error:e}", quantity.name());
            }
        }
    }
}
