//! Regressors: every column against the algorithms on a robot that has this parameter alone, and ranks that are known.

use crate::common;

use common::{distance, each_robot_and_state, generated, larger, largest, robots, within, wrenches};
use featherbench_dynamics::{
    PARAMETERS, ParameterSensitivity, Regressor, RegressorMatrix, State, energy, forward_dynamics, inertial_parameters, inverse_dynamics,
    mass_matrix, torque_regressor,
};
use featherbench_model::{BodyDescription, Description, JointDescription, JointType, Model, Placement};
use featherbench_robots::StateBatch;
use featherbench_spatial::{Dual, Mat3, Real, RigidBodyInertia, Sym3, Vec3};
use nalgebra::DMatrix;

/// The model without armature, whose only parameter is one of a described body's ten, with this value.
fn with_one_parameter<T: Real>(model: &Model<T>, column: usize, value: T) -> Model<T> {
    let mut alone = model.clone();
    alone.armature.fill(T::zero());
    alone.inertias.fill(RigidBodyInertia::zero());
    add_parameter(&mut alone, column, value);
    alone
}

fn add_parameter<T: Real>(model: &mut Model<T>, column: usize, value: T) {
    let (body, mut ten) = (model.described[column / PARAMETERS], [T::zero(); PARAMETERS]);
    ten[column % PARAMETERS] = value;
    let [mass, x, y, z, rest @ ..] = ten;
    let label = model.labels[body];
    // Bᵀ E B
    let half = label.rotation_to_compiled(Sym3::from_array(rest).to_mat3()).transpose();
    let inertia: Mat3<T> = label.rotation_to_compiled(half);
    let added = RigidBodyInertia { mass, first_moment: label.to_compiled(Vec3::new(x, y, z)), rotational: Sym3::from_upper(inertia) };
    model.inertias[body] += added;
}

#[test]
fn joint_forces_are_the_regressor_times_the_parameters() {
    each_robot_and_state(|name, model, [q, v, a, _], _| {
        let parameters: Vec<f64> = inertial_parameters(model);
        let regressor = torque_regressor(model, q, v, a).unwrap();
        let expected = inverse_dynamics(model, q, v, a).unwrap();
        let mut found = vec![0.0; v.len()];
        regressor.mul(&parameters, &mut found).unwrap();
        // Products of velocities cancel within an entry too: so the largest sum of terms is the scale of all.
        let terms = |dof| (0..regressor.columns()).map(|column| (regressor.get(dof, column) * parameters[column]).abs()).sum::<f64>();
        let scale = (0..v.len()).map(terms).fold(1.0, larger);
        for (dof, tau) in found.iter_mut().enumerate() {
            *tau += model.armature[dof] * a[dof];
        }
        within(&format!("{name}: τ"), distance(&found, &expected) / scale, 1e-14);
    });
}

#[test]
fn every_column_is_what_its_parameter_does() {
    for (name, model) in &robots() {
        let states = StateBatch::random(model, 1, 3);
        let (q, v, a, n) = (states.q(0), states.v(0), states.a(0), model.topology.nv());
        let mut workspace = Regressor::new(&model.topology);
        let (mut torque, mut momentum) = (RegressorMatrix::new(model), RegressorMatrix::new(model));
        workspace.torque(model, q, v, a, &mut torque).unwrap();
        workspace.momentum(model, q, v, &mut momentum).unwrap();
        let columns = PARAMETERS * model.described.len();
        assert_eq!((torque.columns(), torque.rows(), torque.get(n, 0), torque.get(0, columns)), (columns, n, 0.0, 0.0));
        let (mut kinetic, mut potential) = (vec![0.0; columns], vec![0.0; columns]);
        workspace.energy(model, q, v, &mut kinetic, &mut potential).unwrap();
        let mut dense = vec![f64::NAN; n * columns];
        torque.write_dense(&mut dense).unwrap();
        assert_eq!(torque.to_dense(), DMatrix::from_row_slice(n, columns, &dense), "{name}");

        let scale = 1.0 + largest(&dense);
        for column in 0..columns {
            let alone = with_one_parameter(model, column, 1.0);
            let entries = |regressor: &RegressorMatrix<f64>| (0..n).map(|dof| regressor.get(dof, column)).collect::<Vec<_>>();
            let tau = inverse_dynamics(&alone, q, v, a).unwrap();
            // Both sum a dozen products along the path.
            within(&format!("{name}: torque, column {column}"), distance(&entries(&torque), &tau) / scale, 1e-14);
            let mut momenta = vec![0.0; n];
            if column % PARAMETERS == 0 || column % PARAMETERS > 3 {
                mass_matrix(&alone, q).unwrap().mul(v, &mut momenta).unwrap();
            } else {
                // A first moment without mass has no centre: here M v is inverse dynamics without gravity and velocity.
                let mut alone = alone.clone();
                alone.gravity = Vec3::zero();
                momenta = inverse_dynamics(&alone, q, &vec![0.0; n], v).unwrap();
            }
            within(&format!("{name}: momentum, column {column}"), distance(&entries(&momentum), &momenta) / scale, 1e-14);
            let energies = energy(&alone, q, v).unwrap();
            within(&format!("{name}: T, column {column}"), (kinetic[column] - energies.kinetic).abs() / scale, 1e-14);
            within(&format!("{name}: V, column {column}"), (potential[column] - energies.potential).abs() / scale, 1e-14);
        }

        let (mut forces, mut parameters) = (vec![0.0; n], vec![0.0; columns]);
        torque.mul_transposed(a, &mut parameters).unwrap();
        let probe: Vec<f64> = (0..columns).map(|k| (k as f64).sin()).collect();
        torque.mul(&probe, &mut forces).unwrap();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        // Sums of all entries.
        within(&format!("{name}: Yᵀ"), (dot(a, &forces) - dot(&parameters, &probe)).abs() / (scale * columns as f64), 1e-14);
        assert!(torque.mul(&probe[1..], &mut forces).is_err() && torque.mul_transposed(&a[1..], &mut parameters).is_err());
    }
}

/// Accelerations with a parameter as a dual, through the articulated-body algorithm.
#[test]
fn derivatives_by_parameters_are_those_of_duals() {
    for (name, model) in &robots() {
        let states = StateBatch::random(model, 1, 3);
        let (q, v, tau, n) = (states.q(0), states.v(0), states.tau(0), model.topology.nv());
        let f = wrenches(model, 2);
        let columns = PARAMETERS * model.described.len();
        let (mut a, mut found) = (vec![0.0; n], vec![0.0; n * columns]);
        ParameterSensitivity::new(model).run(model, State { q, v, given: tau, wrenches: Some(&f) }, &mut a, &mut found).unwrap();
        let lifted = model.lift::<Dual<f64>>();
        let duals = |x: &[f64]| x.iter().map(|&x| Dual::constant(x)).collect::<Vec<_>>();
        let lifted_f: Vec<_> = f.iter().map(|f| f.lift::<Dual<f64>>()).collect();
        let scale = largest(&found);
        for column in (0..columns).step_by(7) {
            let mut moving = lifted.clone();
            add_parameter(&mut moving, column, Dual::new(0.0, 1.0));
            let mut out = duals(&a);
            let mut aba = featherbench_dynamics::Aba::new(&model.topology);
            aba.run(&moving, &duals(q), &duals(v), &duals(tau), Some(&lifted_f), &mut out).unwrap();
            let expected: Vec<f64> = out.iter().map(|a| a.derivative).collect();
            let found: Vec<f64> = (0..n).map(|dof| found[dof * columns + column]).collect();
            // The solution by the factors of M: κ of 1e5 on chains of 36, and 1e7 of the planar one.
            within(&format!("{name}: ∂v̇/∂π_{column}"), distance(&found, &expected) / scale, 1e-9);
        }
        assert_eq!(a.len(), forward_dynamics(model, q, v, tau).unwrap().len());
    }
}

/// A chain of revolute joints: axis and displacement of each from the one before.
fn chain(gravity: [f64; 3], links: &[([f64; 3], [f64; 3])]) -> Model<f64> {
    let body = |(i, &(axis, translation)): (usize, &([f64; 3], [f64; 3]))| BodyDescription {
        name: format!("link{i}"),
        parent: i.checked_sub(1),
        mass: 1.0,
        com: [0.1, 0.05, -0.02],
        inertia: [0.01, 0.0, 0.0, 0.02, 0.0, 0.025],
        joint: JointDescription {
            kind: JointType::Revolute { axis },
            placement: Placement { translation, ..Placement::default() },
            ..JointDescription::default()
        },
    };
    let bodies = links.iter().enumerate().map(body).collect();
    Model::build(&Description { gravity, bodies, ..Description::default() }).unwrap()
}

const Y: [f64; 3] = [0.0, 1.0, 0.0];
const Z: [f64; 3] = [0.0, 0.0, 1.0];

/// Six joints as of a UR5: a shoulder and three parallel axes, then two.
const SIX: [([f64; 3], [f64; 3]); 6] = [
    (Z, [0.0, 0.0, 0.09]),
    (Y, [0.0, 0.14, 0.0]),
    (Y, [0.0, -0.12, 0.43]),
    (Y, [0.0, 0.0, 0.39]),
    (Z, [0.0, 0.09, 0.0]),
    (Y, [0.0, 0.0, 0.1]),
];

/// Seven joints as of a Panda: crossing axes in pairs, with small offsets.
const SEVEN: [([f64; 3], [f64; 3]); 7] = [
    (Z, [0.0, 0.0, 0.33]),
    (Y, [0.0, 0.0, 0.0]),
    (Z, [0.0, 0.0, 0.32]),
    ([0.0, -1.0, 0.0], [0.08, 0.0, 0.0]),
    (Z, [-0.08, 0.0, 0.38]),
    ([0.0, -1.0, 0.0], [0.0, 0.0, 0.0]),
    ([0.0, 0.0, -1.0], [0.09, 0.0, 0.0]),
];

/// The rank of the torque regressor over random states, at rest or moving. The singular values must have a gap of a million behind it.
fn rank(model: &Model<f64>, moving: bool) -> usize {
    let (n, columns) = (model.topology.nv(), PARAMETERS * model.described.len());
    let count = 4 * columns / n + 8;
    let states = StateBatch::random(model, count, 17);
    let rest = vec![0.0; n];
    let mut stacked = DMatrix::zeros(count * n, columns);
    for k in 0..count {
        let (v, a) = if moving { (states.v(k), states.a(k)) } else { (&rest[..], &rest[..]) };
        let y = torque_regressor(model, states.q(k), v, a).unwrap().to_dense();
        stacked.rows_mut(k * n, n).copy_from(&y);
    }
    // Columns of one length: units do not count.
    for mut column in stacked.column_iter_mut() {
        let norm = column.norm();
        if norm > 1e-9 {
            column /= norm;
        }
    }
    // Singular values from YᵀY: those that are zero have errors of √ε.
    let mut values: Vec<f64> = (stacked.transpose() * &stacked).symmetric_eigenvalues().iter().map(|x| x.abs().sqrt()).collect();
    values.sort_by(|a, b| b.total_cmp(a));
    let floor = values[0] * 1e-7;
    let rank = values.iter().take_while(|&&value| value > floor).count();
    let gap = if rank < values.len() { values[rank - 1] / values[rank].max(f64::MIN_POSITIVE) } else { f64::INFINITY };
    println!("rank {rank}: {:e} before {:e}", values[rank - 1], values.get(rank).copied().unwrap_or(0.0));
    assert!(gap >= 1e6, "rank {rank}: gap {gap:e}");
    rank
}

/// How many numbers joint forces can tell: one of the first link if its axis is along gravity, seven of each further one; fewer in a plane.
#[test]
fn ranks_of_the_torque_regressor() {
    let (vertical, oblique, none) = ([0.0, 0.0, -9.81], [3.0, -4.0, -8.0], [0.0; 3]);
    for (name, links, ranks, at_rest) in
        [("six joints", &SIX[..], [36, 38, 34], [10, 12]), ("seven joints", &SEVEN[..], [43, 45, 39], [12, 14])]
    {
        let n = links.len();
        assert_eq!((ranks[0], ranks[1]), (7 * n - 6, 7 * n - 4), "{name}: the law");
        for (gravity, expected) in [vertical, oblique, none].into_iter().zip(ranks) {
            assert_eq!(rank(&chain(gravity, links), true), expected, "{name}, gravity {gravity:?}");
        }
        for (gravity, expected) in [vertical, oblique].into_iter().zip(at_rest) {
            assert_eq!(rank(&chain(gravity, links), false), expected, "{name} at rest, gravity {gravity:?}");
        }
    }
    for n in [2, 3, 6] {
        let links: Vec<_> = (0..n).map(|i| (Y, if i == 0 { [0.0; 3] } else { [0.4, 0.0, 0.0] })).collect();
        assert_eq!(rank(&chain(vertical, &links), true), 3 * n, "planar, {n} joints");
        assert_eq!(rank(&chain([0.0, -9.81, 0.0], &links), true), 3 * n - 2, "planar, {n} joints, gravity along the axes");
        assert_eq!(rank(&chain(none, &links), true), 3 * n - 2, "planar, {n} joints, no gravity");
    }
    // A floating base: ten for the base as well, and its rows alone tell as much.
    for family in ["quadruped", "chain:n=6,layout=spatial,base=free"] {
        let model = generated(family);
        assert_eq!(rank(&model, true), 7 * (model.topology.nv() - 6) + 10, "{family}");
    }
}
