//! The condition number of big robots, against the eigenvalues of the dense matrix: up to 100 dofs it is computed, beyond that iterated.

use featherbench_bench::Robot;
use featherbench_bench::measure::ForwardScale;
use featherbench_results::ModelOrigin;
use featherbench_robots::Family;
use nalgebra::DMatrix;

/// The smallest and the largest eigenvalue of D^-½ M D^-½: as the product iterates or computes them, and the true ones.
struct Eigenvalues {
    least: f64,
    largest: f64,
    true_least: f64,
    true_largest: f64,
}

/// All states of a robot. The product gives κ and the amplification `2·‖D^-½ w‖/(√λ_min·‖a‖_M)`. With w and ‖a‖_M from dense matrices this
/// gives λ_min, and then λ_max.
fn eigenvalues(spec: &str) -> Vec<Eigenvalues> {
    let description = Family::parse(spec).unwrap().generate().unwrap();
    let robot = Robot::new(&description, "test", ModelOrigin::Generated, 2, 1).unwrap();
    let (model, states, at) = (&robot.model, &robot.states, robot.magnitudes());
    let scales = ForwardScale::all(&robot, &at);
    assert_eq!(scales.len(), 2);
    let of_state = |(k, scale): (usize, &ForwardScale)| {
        let mass = featherbench_dynamics::mass_matrix(model, states.q(k)).unwrap().to_dense();
        let n = mass.nrows();
        let root: Vec<f64> = (0..n).map(|i| mass[(i, i)].sqrt()).collect();
        let scaled = DMatrix::from_fn(n, n, |i, j| mass[(i, j)] / (root[i] * root[j])).symmetric_eigenvalues();
        let a = featherbench_dynamics::refined_forward_dynamics(model, states.q(k), states.v(k), states.tau(k), 2).unwrap();
        let (mut weighted, mut energy) = (0.0, 0.0);
        for i in 0..n {
            // Dofs of different branches have M_ij = 0 exactly, and no term.
            let shared = (0..n).filter(|&j| model.topology.row_dofs(i.max(j)).contains(&i.min(j)));
            let terms: f64 = shared.map(|j| root[i] * root[j] * a[j].abs()).sum::<f64>() + at[k].bias_force[i] + states.tau(k)[i].abs();
            weighted += (terms / root[i]).powi(2);
            energy += (0..n).map(|j| a[i] * mass[(i, j)] * a[j]).sum::<f64>();
        }
        let least = 4.0 * weighted / (scale.amplification.powi(2) * energy);
        let (true_least, true_largest) = (scaled.min(), scaled.max());
        Eigenvalues { least, largest: least * scale.condition, true_least, true_largest }
    };
    scales.iter().enumerate().map(of_state).collect()
}

/// λ_min from above and λ_max from below, so that the bounds from them are never too loose; and neither has a large error.
///
/// The growth of a vector under a symmetric positive matrix never falls from step to step. The growths of twelve steps multiply to at least
/// λ¹²·|c|, where c is the component of the start in the eigenvector of λ. So the last one is at least λ·|c|^(1/12).
/// With |c| = 1e-3, small for 120 dofs, that is still 0.56 λ. The test requires half; 0.89 is what is seen.
#[test]
fn iterated_eigenvalues_are_on_the_strict_side_and_near() {
    let specs = ["chain:n=120", "chain:n=120,layout=spatial", "tree:n=120,seed=1,base=free,joints=all,armature=true", "chain:n=101"];
    let mut seen = 0;
    for spec in specs {
        for Eigenvalues { least, largest, true_least, true_largest } in eigenvalues(spec) {
            seen += 1;
            println!(
                "{spec}: λ_min {:.4} and λ_max {:.4} of the true ones, κ {:.1e}",
                least / true_least,
                largest / true_largest,
                true_largest / true_least
            );
            // The dense eigenvalues have errors of about ε·n of the largest one, the energy of a has as much of its terms.
            let rounding = 1e3 * f64::EPSILON * true_largest / true_least;
            assert!(rounding < 0.01, "{spec} is conditioned too badly for this test");
            assert!(least >= true_least * (1.0 - rounding) && least <= 2.0 * true_least, "{spec}: λ_min {least:e}, truly {true_least:e}");
            assert!(
                largest >= 0.5 * true_largest && largest <= true_largest * (1.0 + rounding),
                "{spec}: λ_max {largest:e}, truly {true_largest:e}"
            );
        }
    }
    assert_eq!(seen, 2 * specs.len());
}

/// Up to a hundred dofs they are computed: an iteration of twelve steps would have a larger error.
#[test]
fn a_hundred_dofs_are_computed() {
    for spec in ["chain:n=100", "chain:n=100,layout=spatial"] {
        let all = eigenvalues(spec);
        assert_eq!(all.len(), 2);
        for Eigenvalues { least, largest, true_least, true_largest } in all {
            let rounding = 1e3 * f64::EPSILON * true_largest / true_least;
            assert!((least / true_least - 1.0).abs() <= rounding, "{spec}: λ_min {least:e}, truly {true_least:e}");
            assert!((largest / true_largest - 1.0).abs() <= rounding, "{spec}: λ_max {largest:e}, truly {true_largest:e}");
        }
    }
}
