//! Whether a time counts: the answers of all candidates, against ours, at every state of the stream.

use featherbench_bench::measure::{ForwardScale, Magnitudes, ratio, scaled_error, worst};
use featherbench_bench::{Engine, NoAnswer, Quantity, Robot};
use featherbench_dynamics::{Crba, Rnea, TreeSparse};

/// The unit of rounding of single precision over that of double precision: 2⁻²⁴/2⁻⁵³.
const SINGLE: f64 = (1_u64 << 29) as f64;

/// The largest error of a right answer, for a robot of this depth.
///
/// Each entry is measured against the magnitudes of its terms: so rounding causes 1e-14 and less per joint of the path. The limit is a
/// hundred times that, and far below the error of any wrong model or convention. Factors of M depend on κ(M) entry by entry (1e10 at a
/// thousand links). They are compared by their product, which does not.
///
/// A quantity in single precision has the same limit in its own units of rounding.
pub(super) fn limit(depth: usize, quantity: &str) -> f64 {
    let single = Quantity::parse(quantity).is_some_and(|quantity| quantity.in_double() != quantity);
    1e-12 * depth.max(1) as f64 * if single { SINGLE } else { 1.0 }
}

/// The error of an engine's answer at each state of the robot, against our usual method's.
///
/// Forward dynamics, solving and the inverse of M are checked backwards: the answer goes into inverse dynamics, or is multiplied with M. The
/// result is compared with τ, or with the identity. An error of a derivative of forward dynamics is over κ(D^-½ M D^-½), by which those of
/// ∂ID and M grow in it, as in the study of derivatives. It is done state by state: the answers to a whole stream would not fit the memory.
pub(super) fn errors(
    robot: &Robot,
    featherbench: &dyn Engine,
    engine: &dyn Engine,
    quantity: Quantity,
    method: &str,
) -> Result<Vec<f64>, NoAnswer> {
    let usual =
        featherbench.methods(quantity).into_iter().next().ok_or_else(|| NoAnswer::Failed("there is no featherbench reference".into()))?;
    let mut reference = featherbench.prepare(robot, quantity, &usual, &robot.states)?;
    let mut prepared = engine.prepare(robot, quantity, method, &robot.states)?;
    let due = quantity.size(robot);
    let mut answered = robot.clone();
    // The reference must answer every state; its errors belong to the agreement study.
    let itself = engine.identity() == featherbench.identity() && method == usual;
    (0..robot.states.count())
        .map(|state| {
            prepared.run(state..state + 1)?;
            let value = prepared.read();
            if value.len() != due {
                return Err(NoAnswer::Failed(format!("{} numbers came, {due} are due", value.len())));
            }
            match quantity {
                _ if itself => Ok(0.0),
                Quantity::ForwardDynamics | Quantity::ForwardDynamicsSingle => through_inverse_dynamics(&mut answered, state, value),
                Quantity::Solve => through_mass_matrix(robot, state, value),
                Quantity::MassMatrixInverse => inverse_of_mass_matrix(robot, state, value),
                _ => {
                    reference.run(state..state + 1)?;
                    let at = Magnitudes::new(robot, state);
                    let error = || scaled_error(robot, quantity, &at, reference.read(), value);
                    Ok(match quantity {
                        Quantity::MassMatrixSparse => sparse_mass_matrix(robot, reference.read(), value),
                        Quantity::ForwardDynamicsDq | Quantity::ForwardDynamicsDv => {
                            error() / ForwardScale::new(robot, state, &at).condition
                        }
                        _ => error(),
                    })
                }
            }
        })
        .collect()
}

/// max |τ − ID(q, v, a)|_i over the magnitudes of the terms that were added to form it.
///
/// The answer is used as the state's acceleration.
fn through_inverse_dynamics(robot: &mut Robot, state: usize, a: &[f64]) -> Result<f64, NoAnswer> {
    let nv = robot.states.nv;
    robot.states.a[state * nv..(state + 1) * nv].copy_from_slice(a);
    let (model, states) = (&robot.model, &robot.states);
    let mut tau = vec![f64::NAN; nv];
    Rnea::new(&model.topology).run(model, states.q(state), states.v(state), a, None, &mut tau).map_err(failed)?;
    let magnitudes = Magnitudes::new(robot, state).joint_force;
    Ok(largest(tau.iter().zip(states.tau(state)).zip(magnitudes).map(|((found, given), size)| (found - given, size + given.abs()))))
}

/// max |M x − τ|_i / (Σ_j |M_ij||x_j| + |τ_i|).
fn through_mass_matrix(robot: &Robot, state: usize, x: &[f64]) -> Result<f64, NoAnswer> {
    let topology = &robot.model.topology;
    let mut matrix = TreeSparse::new(topology);
    Crba::new(topology).run(&robot.model, robot.states.q(state), &mut matrix).map_err(failed)?;
    let tau = robot.states.tau(state);
    let mut product: Vec<f64> = tau.iter().map(|tau| -tau).collect();
    let mut size: Vec<f64> = tau.iter().map(|tau| tau.abs()).collect();
    for i in 0..x.len() {
        for (&j, &m) in topology.row_dofs(i).iter().zip(&matrix.values()[topology.row(i)]) {
            product[i] += m * x[j];
            size[i] += (m * x[j]).abs();
            if i != j {
                product[j] += m * x[i];
                size[j] += (m * x[i]).abs();
            }
        }
    }
    Ok(largest(product.into_iter().zip(size)))
}

/// max |M N − 1|_ik / Σ_j √(M_ii·M_jj·N_jj·N_kk): what is left if each entry of N has an error of ε relative to its own two axes.
fn inverse_of_mass_matrix(robot: &Robot, state: usize, inverse: &[f64]) -> Result<f64, NoAnswer> {
    let topology = &robot.model.topology;
    let n = topology.nv();
    let mut matrix = TreeSparse::new(topology);
    Crba::new(topology).run(&robot.model, robot.states.q(state), &mut matrix).map_err(failed)?;
    let (root_m, root_n): (Vec<f64>, Vec<f64>) = matrix.diagonal().enumerate().map(|(i, m)| (m.sqrt(), inverse[i * n + i].sqrt())).unzip();
    let weight: f64 = root_m.iter().zip(&root_n).map(|(m, n)| m * n).sum();
    let mut column = vec![0.0; n];
    let mut product = vec![f64::NAN; n];
    let mut error = 0.0;
    for k in 0..n {
        column.iter_mut().enumerate().for_each(|(j, x)| *x = inverse[j * n + k]);
        matrix.mul(&column, &mut product).map_err(failed)?;
        product[k] -= 1.0;
        error = worst(error, largest(product.iter().zip(&root_m).map(|(left, m)| (*left, m * weight * root_n[k]))));
    }
    Ok(error)
}

/// max |ΔM_ij| / √(M_ii·M_jj) over the stored entries.
fn sparse_mass_matrix(robot: &Robot, reference: &[f64], value: &[f64]) -> f64 {
    let topology = &robot.model.topology;
    let diagonal = |i: usize| {
        let at = topology.row_dofs(i).iter().position(|&j| j == i);
        at.map_or(f64::NAN, |at| reference[topology.row(i)][at].sqrt())
    };
    let root: Vec<f64> = (0..topology.nv()).map(diagonal).collect();
    largest((0..topology.nv()).flat_map(|i| {
        let row = topology.row(i);
        let pairs = value[row.clone()].iter().zip(&reference[row]).zip(topology.row_dofs(i));
        let entries: Vec<(f64, f64)> = pairs.map(|((v, r), &j)| (v - r, root[i] * root[j])).collect();
        entries
    }))
}

/// The largest difference over its magnitude.
fn largest(pairs: impl Iterator<Item = (f64, f64)>) -> f64 {
    pairs.fold(0.0, |error, (difference, size)| worst(error, ratio(difference, size)))
}

fn failed(error: impl std::fmt::Display) -> NoAnswer {
    NoAnswer::Failed(error.to_string())
}
