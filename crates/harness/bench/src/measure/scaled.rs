//! The unit-free error of one quantity at one state.

use super::derivative;
use super::magnitudes::Magnitudes;
use super::ratio::{ratio, worst};
use crate::{Quantity, Robot};
use featherbench_model::JointKind;
use featherbench_results::Measure;

/// The largest difference between `value` and `reference`, each entry over the magnitude of its own terms at the state.
///
/// Forward dynamics has its own measures ([`super::ForwardScale`]); here it is measured against the largest entry only.
/// The result is NaN if an entry is. It is infinite if an entry differs that should be exactly zero, and if a slice does not have
/// [`Quantity::size`] numbers.
pub fn scaled_error(robot: &Robot, quantity: Quantity, at: &Magnitudes, reference: &[f64], value: &[f64]) -> f64 {
    if reference.len() != quantity.size(robot) || value.len() != reference.len() {
        return f64::INFINITY;
    }
    let nv = robot.model.topology.nv();
    let mass = total_mass(robot);
    match quantity.measure() {
        Measure::JointForces => entries(reference, value, &at.joint_force),
        Measure::JointForcesWrench => entries(reference, value, &at.joint_force_wrench),
        Measure::BiasForces => entries(reference, value, &at.bias_force),
        Measure::Matrix => {
            let least = if quantity == Quantity::MassMatrix { &*at.least_root } else { &[] };
            mass_matrix(nv, least, reference, value)
        }
        Measure::SparseMatrix => mass_matrix_sparse(robot, at, reference, value),
        Measure::Factors => mass_matrix_sparse(robot, at, &multiplied(robot, reference), &multiplied(robot, value)),
        Measure::Products => mass_matrix_probe(nv, &at.least_root, &robot.probe(), reference, value),
        Measure::Itself => entries(reference, value, reference),
        Measure::PotentialEnergy => {
            let gravity = robot.model.gravity.norm();
            entries(reference, value, &[mass * gravity * reach_of_mass(robot, at)])
        }
        Measure::CenterOfMass => entries(reference, value, &[reach_of_mass(robot, at); 3]),
        Measure::Momentum => momentum(robot, at, reference, value),
        Measure::Placements => per_body(robot, reference, value, |body| {
            let reach = at.reach[body];
            [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, reach, reach, reach]
        }),
        // The velocity of the whole body counts: its origin may be at rest on the joint's axis while the rest of it rotates.
        Measure::Velocities => per_body(robot, reference, value, |body| {
            halves(at.angular_velocity[body], at.linear_velocity[body] + at.angular_velocity[body] * at.size[body])
        }),
        Measure::Accelerations => {
            // Gravity is a term: engines have it in their accelerations, and subtracting it cancels.
            let gravity = robot.model.gravity.norm();
            per_body(robot, reference, value, |body| {
                let swing = at.angular_acceleration[body] + at.angular_velocity[body] * at.angular_velocity[body];
                halves(at.angular_acceleration[body], at.linear_acceleration[body] + gravity + swing * at.size[body])
            })
        }
        Measure::Jacobian => body_jacobian(robot, at, reference, value),
        Measure::JacobianProducts => entries(reference, value, &jacobian_products(robot, at)),
        Measure::Readback => readback(reference, value),
        Measure::Derivative { .. } => derivative::error(robot, quantity, at, reference, value),
        Measure::Regressor => derivative::regressor_error(robot, at, reference, value),
        Measure::SecondDerivative { forward } => derivative::second_error(robot, forward, at, reference, value),
        // More numbers than ours are fill-in, and no error.
        Measure::LowCount if value >= reference => 0.0,
        Measure::Count | Measure::LowCount => entries(reference, value, &[1.0]),
        Measure::Largest => {
            let largest = reference.iter().fold(0.0_f64, |largest, x| worst(largest, x.abs()));
            entries(reference, value, &vec![largest; reference.len()])
        }
    }
}

fn entries(reference: &[f64], value: &[f64], magnitude: &[f64]) -> f64 {
    if reference.len() != value.len() || reference.len() != magnitude.len() {
        return f64::INFINITY;
    }
    let pairs = reference.iter().zip(value).zip(magnitude);
    pairs.fold(0.0, |error, ((r, v), m)| worst(error, ratio(v - r, *m)))
}

fn halves(angular: f64, linear: f64) -> [f64; 6] {
    [angular, angular, angular, linear, linear, linear]
}

fn per_body<const N: usize>(robot: &Robot, reference: &[f64], value: &[f64], scale: impl Fn(usize) -> [f64; N]) -> f64 {
    let magnitude: Vec<f64> = robot.model.described.iter().flat_map(|&body| scale(body)).collect();
    entries(reference, value, &magnitude)
}

/// Per dof at unit rate: a rotation moves the body by at most its reach, a slide by one.
fn body_jacobian(robot: &Robot, at: &Magnitudes, reference: &[f64], value: &[f64]) -> f64 {
    let reach = at.reach[robot.model.described[robot.deepest_body()]];
    let dofs = (0..robot.model.topology.bodies()).flat_map(|joint| unit_rates(robot, joint));
    // The angular entries of a slide's column should be zero. They are measured against the rotation that moves the reach as far as the
    // slide.
    let scales = dofs.map(|(turn, slide)| (if turn > 0.0 || reach == 0.0 { turn } else { slide / reach }, turn * reach + slide));
    let (angular, linear): (Vec<f64>, Vec<f64>) = scales.unzip();
    entries(reference, value, &[angular.repeat(3), linear.repeat(3)].concat())
}

/// Per dof of a joint, how fast it turns and slides at unit rate.
fn unit_rates(robot: &Robot, joint: usize) -> Vec<(f64, f64)> {
    let (slide, turn) = ((0.0, 1.0), (1.0, 0.0));
    let subspace = &robot.model.subspaces[joint];
    match robot.model.topology.joints()[joint].kind {
        JointKind::Free => vec![slide, slide, slide, turn, turn, turn],
        JointKind::Spherical => vec![turn; 3],
        _ => vec![(subspace.ang.norm(), subspace.lin.norm())],
    }
}

/// For each body and vector x of the probe, the sums over the dofs on the body's path: of |x_j| times the entries' magnitudes in
/// [`body_jacobian`]. The whole body counts, as for velocities.
fn jacobian_products(robot: &Robot, at: &Magnitudes) -> Vec<f64> {
    let (model, probe) = (&robot.model, robot.probe());
    let joints = model.topology.joints();
    let (nv, each) = (model.topology.nv(), Quantity::BodyJacobians.size(robot) / model.described.len());
    let mut magnitude = vec![0.0; Quantity::BodyJacobians.size(robot)];
    for (x, place) in probe.chunks_exact(nv).zip((0..each).step_by(6)) {
        // Along each path: turns, slides without a turn, and all slides.
        let mut sums: Vec<[f64; 3]> = Vec::with_capacity(joints.len());
        for (i, joint) in joints.iter().enumerate() {
            let mut sum = joint.parent.map_or([0.0; 3], |parent| sums[parent]);
            for ((turn, slide), x) in unit_rates(robot, i).into_iter().zip(&x[joint.v..]) {
                sum[0] += turn * x.abs();
                sum[1] += if turn > 0.0 { 0.0 } else { slide * x.abs() };
                sum[2] += slide * x.abs();
            }
            sums.push(sum);
        }
        for (out, &body) in magnitude.chunks_exact_mut(each).zip(&model.described) {
            let ([turns, pure, slides], reach) = (sums[body], at.reach[body] + at.size[body]);
            let across = if reach > 0.0 { pure / reach } else { 0.0 };
            out[place..place + 6].copy_from_slice(&halves(turns + across, turns * reach + slides));
        }
    }
    magnitude
}

/// √M_ii, and at least the one of [`Magnitudes::least_root`]. A matrix whose entries are other things has no least ones.
fn roots(diagonal: impl Iterator<Item = f64>, least: &[f64]) -> Vec<f64> {
    diagonal.enumerate().map(|(i, x)| worst(x.sqrt(), least.get(i).copied().unwrap_or(0.0))).collect()
}

/// max |ΔM_ij| / √(M_ii·M_jj).
fn mass_matrix(n: usize, least: &[f64], reference: &[f64], value: &[f64]) -> f64 {
    let root = roots((0..n).map(|i| reference[i * n + i]), least);
    let magnitude: Vec<f64> = (0..n * n).map(|entry| root[entry / n] * root[entry % n]).collect();
    entries(reference, value, &magnitude)
}

/// The same over the entries of the tree-sparse layout.
fn mass_matrix_sparse(robot: &Robot, at: &Magnitudes, reference: &[f64], value: &[f64]) -> f64 {
    let topology = &robot.model.topology;
    let root = roots((0..topology.nv()).map(|i| reference[topology.row(i).end - 1]), &at.least_root);
    let pairs = (0..topology.nv()).flat_map(|i| topology.row_dofs(i).iter().map(move |&j| (i, j)));
    let magnitude: Vec<f64> = pairs.map(|(i, j)| root[i] * root[j]).collect();
    entries(reference, value, &magnitude)
}

/// M = LᵀDL of tree-sparse factors. The factors themselves differ by more, as L grows with κ(M).
fn multiplied(robot: &Robot, factors: &[f64]) -> Vec<f64> {
    let topology = &robot.model.topology;
    let mut product = vec![0.0; factors.len()];
    for k in 0..topology.nv() {
        let mut l = factors[topology.row(k)].to_vec();
        let Some(d) = l.last_mut().map(|last| std::mem::replace(last, 1.0)) else { continue };
        // The row of a dof i on the path to k has the same columns as the beginning of k's row: M_ij += L_ki D_k L_kj.
        for (&i, l_i) in topology.row_dofs(k).iter().zip(&l) {
            for (entry, l_j) in product[topology.row(i)].iter_mut().zip(&l) {
                *entry += l_i * d * l_j;
            }
        }
    }
    product
}

/// Products against Σ_j √(M_ii·M_jj)|x_j|, the diagonal and the last row as entries of M.
fn mass_matrix_probe(n: usize, least: &[f64], probe: &[f64], reference: &[f64], value: &[f64]) -> f64 {
    let root = roots(reference[4 * n..5 * n].iter().copied(), least);
    let last = root.last().copied().unwrap_or(0.0);
    let mut magnitude = Vec::with_capacity(6 * n);
    for x in probe.chunks_exact(n) {
        let weight: f64 = x.iter().zip(&root).map(|(x, r)| x.abs() * r).sum();
        magnitude.extend(root.iter().map(|r| r * weight));
    }
    magnitude.extend(root.iter().map(|r| r * r));
    magnitude.extend(root.iter().map(|r| r * last));
    entries(reference, value, &magnitude)
}

fn total_mass(robot: &Robot) -> f64 {
    robot.model.inertias.iter().map(|inertia| inertia.mass).sum()
}

/// Mass-weighted mean of the lengths of the paths to the bodies' centres of mass.
fn reach_of_mass(robot: &Robot, at: &Magnitudes) -> f64 {
    let bodies = robot.model.inertias.iter().zip(&at.reach).zip(&at.lever);
    let moments = bodies.map(|((inertia, reach), lever)| inertia.mass * reach + lever);
    moments.sum::<f64>() / total_mass(robot)
}

/// Linear part over Σ(m|v| + |h||ω|); angular part over Σ(|Ī||ω| + |h||v| + reach·linear).
fn momentum(robot: &Robot, at: &Magnitudes, reference: &[f64], value: &[f64]) -> f64 {
    let (mut angular, mut linear) = (0.0, 0.0);
    for (i, inertia) in robot.model.inertias.iter().enumerate() {
        let (omega, v, lever) = (at.angular_velocity[i], at.linear_velocity[i], at.lever[i]);
        let rotational = inertia.rotational.xx + inertia.rotational.yy + inertia.rotational.zz;
        let share = inertia.mass * v + lever * omega;
        linear += share;
        angular += rotational * omega + lever * v + at.reach[i] * share;
    }
    entries(reference, value, &halves(angular, linear))
}

/// Mass and lengths relative to their own size, rotation to one, inertia to its trace about the body's origin, where most engines store it.
fn readback(reference: &[f64], value: &[f64]) -> f64 {
    let magnitude: Vec<f64> = reference
        .chunks_exact(22)
        .flat_map(|body| {
            let mut scale = [1.0; 22];
            let length = |xyz: &[f64]| xyz.iter().map(|x| x * x).sum::<f64>().sqrt();
            scale[0] = body[0];
            scale[1..4].fill(length(&body[1..4]));
            scale[4..10].fill(body[4].abs() + body[7].abs() + body[9].abs() + 2.0 * body[0] * length(&body[1..4]).powi(2));
            scale[19..22].fill(length(&body[19..22]));
            scale
        })
        .collect();
    entries(reference, value, &magnitude)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_wrong_entry_of_a_light_joint_is_seen_beside_heavy_ones() {
        let m = [1e6, 0.0, 0.0, 1e-6];
        let mut wrong = m;
        wrong[3] *= 1.0 + 1e-10;
        let error = mass_matrix(2, &[], &m, &wrong);
        assert!((error - 1e-10).abs() < 1e-15, "{error}: relative to its own diagonal, rounding of 1 + 1e-10 aside");
    }

    #[test]
    fn what_should_be_zero_and_is_not_is_infinitely_wrong_and_nan_stays() {
        assert_eq!(entries(&[0.0], &[1e-300], &[0.0]), f64::INFINITY);
        assert_eq!(entries(&[0.0], &[0.0], &[0.0]), 0.0);
        assert!(entries(&[1.0, 1.0], &[f64::NAN, 2.0], &[1.0, 1.0]).is_nan());
        assert_eq!(entries(&[1.0], &[1.0, 2.0], &[1.0]), f64::INFINITY);
        assert_eq!(entries(&[1.0], &[1.0], &[1.0, 2.0]), f64::INFINITY);
    }
}
