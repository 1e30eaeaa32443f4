//! The limit of stiff rods: the accelerations of the robot's own joints come to those of the rigid tree.
//!
//! A rod that is stiff and does not vibrate is deflected by x with K x the forces that it carries: its acceleration is zero, and x → 0 like
//! 1/K. [`rigid_limit`] computes x by the iteration `x ← x − K⁻¹ r`, where r are the elastic dofs' forces of inverse dynamics with s̈ = (a,
//! 0), and a the accelerations of the rigid tree. Then forward dynamics of the flexible robot at that state gives the robot's
//! accelerations, to be compared with those of the articulated-body algorithm on the rigid tree.
//!
//! The difference has two parts: the deflection, of order 1/K, and rounding. The forces K x are rounded to ε K x, and M⁻¹ of light elements
//! makes accelerations of it. [`RigidLimit::floor`] is that part: `max |M⁻¹| (ε |K x|)` over the robot's dofs. Where it is above a
//! tolerance, the tolerance cannot be held by any algorithm that has M, K and x in doubles.

use crate::tangent::mass_matrix;
use crate::{Assembly, Refused, SolveError, Solver};
use featherbench_dynamics::forward_dynamics;
use featherbench_model::Model;
use featherbench_spatial::largest;
use nalgebra::{DMatrix, DVector};

/// A stiff rod beside a rigid one. Errors are relative to the largest acceleration of the rigid tree.
#[derive(Clone, Debug, PartialEq)]
pub struct RigidLimit {
    /// The robot's accelerations with rigid rods, by ABA.
    pub rigid: Vec<f64>,
    /// The same with stiff rods.
    pub flexible: Vec<f64>,
    /// The largest difference.
    pub difference: f64,
    /// What rounding of K x can do to it.
    pub floor: f64,
    /// The largest elastic coordinate.
    pub deflection: f64,
}

/// The accelerations of a robot with rods of `factor` times their stiffness beside those with rigid rods; it allocates.
///
/// `q`, `v` and `tau` are those of the robot's own joints, in the order of the rigid tree.
///
/// # Errors
/// [`SolveError`]: no joint moves without the rods, or an argument does not fit.
pub fn rigid_limit(assembly: &Assembly, factor: f64, q: &[f64], v: &[f64], tau: &[f64]) -> Result<RigidLimit, SolveError> {
    let malformed = |error: &dyn std::fmt::Display| Refused::new("bodies", crate::Defect::Tree { reason: error.to_string() });
    let model: Model<f64> = Model::build(&assembly.rigid()).map_err(|error| malformed(&error))?;
    let rigid = forward_dynamics(&model, q, v, tau)?;
    let continuum = assembly.clone().build()?.stiffened(factor);
    let topology = continuum.topology();
    let elastic = continuum.elastic_dofs();
    let own: Vec<usize> = (0..topology.nv()).filter(|dof| elastic.binary_search(dof).is_err()).collect();

    // The robot's part of the state; where each number of s is.
    let (mut s, mut own_q, mut elastic_q) = (continuum.rest(), Vec::new(), Vec::new());
    for joint in topology.joints() {
        let (into, numbers) = if elastic.binary_search(&joint.v).is_ok() { (&mut elastic_q, 1) } else { (&mut own_q, joint.kind.nq()) };
        into.extend(joint.q..joint.q + numbers);
    }
    own_q.iter().zip(q).for_each(|(place, q)| s[*place] = *q);
    let spread = |numbers: &[f64]| {
        let mut all = vec![0.0; topology.nv()];
        own.iter().zip(numbers).for_each(|(dof, x)| all[*dof] = *x);
        all
    };
    let (rate, second, forces) = (spread(v), spread(&rigid), spread(tau));

    // x ← x − K⁻¹ r: it converges like 1/K, and eight times leave nothing where the limit is of interest.
    let all = continuum.stiffness_matrix();
    let stiffness = DMatrix::from_fn(elastic.len(), elastic.len(), |i, j| all[(elastic[i], elastic[j])]);
    let singular = || SolveError::NotPositiveDefinite { matrix: "stiffness", eigenvalue: 0.0 };
    let factors = stiffness.cholesky().ok_or_else(singular)?;
    let mut solver = Solver::new(&continuum);
    let mut residual = vec![0.0; topology.nv()];
    for _ in 0..8 {
        solver.inverse(&continuum, &s, &rate, &second, &[], &mut residual)?;
        let r = DVector::from_iterator(elastic.len(), elastic.iter().map(|dof| residual[*dof]));
        let step = factors.solve(&r);
        elastic_q.iter().zip(step.iter()).for_each(|(place, step)| s[*place] -= step);
    }
    let mut flexible = vec![0.0; topology.nv()];
    solver.forward(&continuum, &s, &rate, &forces, &[], &mut flexible)?;

    let size = largest(rigid.iter().copied());
    let x = DVector::from_iterator(elastic.len(), elastic_q.iter().map(|place| s[*place]));
    let carried = DMatrix::from_fn(elastic.len(), elastic.len(), |i, j| all[(elastic[i], elastic[j])].abs()) * x.abs() * f64::EPSILON;
    let inverse =
        mass_matrix(&continuum, &s)?.cholesky().ok_or(SolveError::NotPositiveDefinite { matrix: "mass", eigenvalue: 0.0 })?.inverse();
    let reached = own.iter().map(|i| elastic.iter().zip(carried.iter()).map(|(j, force)| inverse[(*i, *j)].abs() * force).sum::<f64>());
    let floor = largest(reached) / size;
    let flexible: Vec<f64> = own.iter().map(|dof| flexible[*dof]).collect();
    let difference = largest(flexible.iter().zip(&rigid).map(|(a, b)| a - b)) / size;
    Ok(RigidLimit { rigid, flexible, difference, floor, deflection: x.amax() })
}
