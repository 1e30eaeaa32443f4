//! A robot whose mass matrix is singular: it has no forward dynamics, in whatever engine. That is told once, before engines differ by it.

use featherbench_bench::Robot;
use featherbench_bench::measure::worst;
use featherbench_dynamics::mass_matrix;
use nalgebra::DMatrix;

/// Above this number of dofs one state is tried: the work grows with n³.
const ALL_STATES: usize = 300;

/// What is not compared of a robot whose M is singular at states that are asked: at how many, and which joints move without inertia. `None` if M is
/// regular, or the robot is larger than [`LARGEST`](super::LARGEST).
pub fn singular(robot: &Robot) -> Option<String> {
    let states = &robot.states;
    let tried = if states.nv <= ALL_STATES { states.count() } else { 1 };
    let found: Vec<Vec<usize>> = (0..tried.min(states.count()))
        .filter(|_| states.nv <= super::LARGEST)
        .filter_map(|k| null(&mass_matrix(&robot.model, states.q(k)).ok()?.to_dense()))
        .collect();
    let first = found.first()?;
    let mut names: Vec<&str> = Vec::new();
    let mut dof = 0;
    for body in &robot.description.bodies {
        let own = dof..dof + body.joint.kind.nv();
        dof = own.end;
        if first.iter().any(|k| own.contains(k)) {
            names.push(if body.joint.name.is_empty() { &body.name } else { &body.joint.name });
        }
    }
    let more = if names.len() > 4 { format!(", … ({} in all)", names.len()) } else { String::new() };
    let names = names[..names.len().min(4)].join(", ");
    Some(format!(
        "forward dynamics, as there is none: M is singular at {} of {tried} states, and a motion of the joints {names}{more} has no kinetic energy",
        found.len()
    ))
}

/// The dofs of a motion without kinetic energy, if there is one: Cholesky's factors of D^-½ M D^-½ with the largest pivot first.
///
/// The entries of M are rounded by some units of the last digit of the diagonal, once for each body of the path; so are the pivots, whose
/// rounding adds up over n eliminations: 64 n ε. Two hinges whose axes are 1e-6 rad apart have a pivot of 1e-12, and are regular.
fn null(mass: &DMatrix<f64>) -> Option<Vec<usize>> {
    let n = mass.nrows();
    if let Some(still) = (0..n).find(|&i| mass[(i, i)] <= 0.0) {
        return Some(vec![still]);
    }
    let mut rest = DMatrix::from_fn(n, n, |i, j| mass[(i, j)] / (mass[(i, i)] * mass[(j, j)]).sqrt());
    let mut order: Vec<usize> = (0..n).collect();
    let mut factor = DMatrix::<f64>::zeros(n, n);
    for k in 0..n {
        let pivot = (k..n).max_by(|&a, &b| rest[(order[a], order[a])].total_cmp(&rest[(order[b], order[b])]))?;
        order.swap(k, pivot);
        let at = order[k];
        let size = rest[(at, at)];
        if size <= 64.0 * n as f64 * f64::EPSILON {
            return Some(moving(&factor, &order, k));
        }
        for i in k..n {
            factor[(order[i], k)] = rest[(order[i], at)] / size.sqrt();
        }
        for j in k + 1..n {
            for i in k + 1..n {
                rest[(order[i], order[j])] -= factor[(order[i], k)] * factor[(order[j], k)];
            }
        }
    }
    None
}

/// The dofs that move where the k-th of the order moves by one and the ones before it as M demands.
fn moving(factor: &DMatrix<f64>, order: &[usize], k: usize) -> Vec<usize> {
    // Lᵀ z = −row k of L, by back substitution.
    let mut z = vec![0.0; k + 1];
    z[k] = 1.0;
    for i in (0..k).rev() {
        let known: f64 = (i + 1..=k).map(|j| factor[(order[j], i)] * z[j]).sum();
        z[i] = -known / factor[(order[i], i)];
    }
    let largest = z.iter().map(|x| x.abs()).fold(0.0, worst);
    let mut dofs: Vec<usize> = (0..=k).filter(|&i| z[i].abs() > 1e-3 * largest).map(|i| order[i]).collect();
    dofs.sort_unstable();
    dofs
}
