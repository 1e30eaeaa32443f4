//! Counted operations of forward dynamics by two ways, and where they cross.
//!
//! The articulated-body algorithm takes O(n). The way by the mass matrix takes O(n) for the bias force, O(Σ d_k) for M and for the solution, and
//! D2 = Σ d_k (d_k − 1)/2 multiply-subtracts for the factorization: on a chain n³/6, on a balanced tree n log² n. So which is less work depends
//! on depth, and not on n alone.
//!
//! The kernels are counted by running their plain text on a scalar that counts. The operations of factorization and solution are the integers
//! of the study, which are gates. Every addition, product and fused multiply-add weighs [`WEIGHT`] one, a division and a square root
//! [`DIVISION`]; sines and cosines are as many on both sides and weigh nothing.

use crate::operations;
use featherbench_bench::Robot;
use featherbench_dynamics::{Aba, Bias, Crba, TreeSparse};
use featherbench_spatial::{Counted, Operations};

/// The weight of a division or a square root: a Zen 5 and a Sapphire Rapids start one every four to five cycles, where they start a sum or
/// product every half.
pub(super) const DIVISION: f64 = 8.0;

/// All operations, with their weights.
pub(super) fn weighted(count: Operations) -> f64 {
    let Operations { additions, multiplications, fused, divisions, roots, .. } = count;
    (additions + multiplications + fused) as f64 + DIVISION * (divisions + roots) as f64
}

/// The weighted operations of forward dynamics by the articulated-body algorithm, and by the mass matrix.
///
/// # Errors
/// A sentence, when M is singular.
pub(super) fn of_forward_dynamics(robot: &Robot) -> Result<[f64; 2], String> {
    let (model, states, topology) = (&robot.model, &robot.states, &robot.model.topology);
    let counted = |values: &[f64]| values.iter().map(|&x| Counted(x)).collect::<Vec<_>>();
    let [q, v, tau] = [states.q(0), states.v(0), states.tau(0)].map(counted);
    let mut out = vec![Counted(0.0); states.nv];
    let (mut aba, mut bias, mut crba) = (Aba::new(topology), Bias::new(topology), Crba::new(topology));
    let mut done = Ok(());
    let articulated = Counted::count(|| done = aba.run(model, &q, &v, &tau, None, &mut out));
    done.map_err(|error| error.to_string())?;
    let mut matrix = TreeSparse::<Counted>::new(topology);
    let mut formed = Ok(());
    let forming = Counted::count(|| {
        formed = crba.run(model, &q, &mut matrix).and_then(|()| bias.run(model, &q, &v, None, &mut out));
    });
    formed.map_err(|error| error.to_string())?;
    let [_, factor_divisions, factor, solve, solve_divisions] = operations::expected(&robot.description);
    let eliminating = factor + solve + DIVISION * (factor_divisions + solve_divisions);
    // τ − h.
    let difference = states.nv as f64;
    Ok([weighted(articulated), weighted(forming) + eliminating + difference])
}

/// The size where a ratio crosses one between two of these (size, ratio), by a power law between them; the first crossing upwards or downwards.
pub(crate) fn crossing(points: &[(f64, f64)]) -> Option<f64> {
    points.windows(2).find_map(|pair| {
        let [(n, a), (m, b)] = [pair[0], pair[1]];
        let (a, b) = (a.ln(), b.ln());
        let crosses = a.is_finite() && b.is_finite() && (a < 0.0) != (b < 0.0);
        crosses.then(|| (n.ln() + (m / n).ln() * a / (a - b)).exp())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use featherbench_bench::alone;

    #[test]
    fn a_crossing_of_power_laws_is_found() {
        let cubic = [(10.0_f64, 0.25_f64), (40.0, 4.0)];
        // ln: −1.386 at 10 and 1.386 at 40, so at √(10·40).
        assert!((crossing(&cubic).unwrap() - 20.0).abs() < 1e-12);
        assert_eq!(crossing(&[(10.0, 0.5), (20.0, 0.9)]), None);
        assert_eq!(crossing(&[(10.0, f64::NAN), (20.0, 2.0)]), None, "no number is on no side");
        assert_eq!(crossing(&[]), None);
    }

    #[test]
    fn the_mass_matrix_is_more_work_the_deeper_the_tree_is() {
        let ratio = |spec: &str| {
            let [articulated, factorizing] = of_forward_dynamics(&alone::robot(spec, 1).unwrap()).unwrap();
            factorizing / articulated
        };
        // A chain's factorization alone takes n³/6 multiply-subtracts.
        let chain = |n: usize| ratio(&format!("chain:n={n},layout=spatial"));
        assert!(chain(300) > 3.0 && chain(3) < chain(30) && chain(30) < chain(300));
        // As many dofs, at depth one: there is nothing to eliminate.
        assert!(ratio("star:n=30") < chain(30));
    }
}
