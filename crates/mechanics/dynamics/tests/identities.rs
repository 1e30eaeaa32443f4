//! Identities that hold for every robot and state, tested on robots with every kind of joint.

use crate::common;

use common::{ROBOTS, build, condition, distance, gap, larger, largest, robot, within, wrenches};
use featherbench_dynamics::{
    Aba, Bias, Crba, Energy, Jacobian, Kinematics, Ltdl, Momentum, Rnea, TreeSparse, bias_force, center_of_mass, centroidal_momentum,
    energy, forward_dynamics, forward_kinematics, inverse_dynamics, jacobian, mass_matrix,
};
use featherbench_model::Model;
use featherbench_robots::StateBatch;
use featherbench_spatial::{Force, Motion, Transform, Vec3};

/// Each robot with ten states: zero, straight, fast, and random ones.
fn each_state(mut check: impl FnMut(&str, &Model<f64>, &[f64], &[f64], &[f64], &[f64])) {
    for (name, recipe) in &ROBOTS {
        let model = build(recipe);
        let states = StateBatch::agreement(&model, 10, 5);
        for k in 0..states.count() {
            let label = format!("{name}, state {k} ({})", states.cases[k].name());
            check(&label, &model, states.q(k), states.v(k), states.a(k), states.tau(k));
        }
    }
}

/// The condition number that tolerances are made of is that of the dense eigenvalues: not above it, and most of it.
#[test]
fn the_condition_number_is_that_of_the_eigenvalues() {
    each_state(|name, model, q, _, _, _| {
        let matrix = mass_matrix(model, q).unwrap();
        let root: Vec<f64> = matrix.diagonal().map(f64::sqrt).collect();
        let scaled = nalgebra::DMatrix::from_fn(root.len(), root.len(), |i, j| matrix.get(i, j) / (root[i] * root[j]));
        let eigenvalues = scaled.symmetric_eigenvalues();
        let (found, due) = (condition(&matrix), eigenvalues.max() / eigenvalues.min());
        assert!(found > 0.5 * due && found < due * (1.0 + 1e-6), "{name}: {found} is not {due}");
    });
}

#[test]
fn forward_dynamics_inverts_inverse_dynamics() {
    each_state(|name, model, q, v, a, _| {
        let tau = inverse_dynamics(model, q, v, a).unwrap();
        let back = forward_dynamics(model, q, v, &tau).unwrap();
        let matrix = mass_matrix(model, q).unwrap();
        let bias = bias_force(model, q, v).unwrap();
        // A relative perturbation ε of the forces moves the acceleration by at most κ ε of (|τ| + |h|)/least inertia.
        let least = matrix.diagonal().fold(f64::INFINITY, |least, d| -larger(-least, -d));
        let scale = largest(a) + (largest(&tau) + largest(&bias)) / least;
        within(&format!("{name}: FD∘ID"), distance(&back, a) / scale, condition(&matrix) * f64::EPSILON);
    });
}

#[test]
fn articulated_bodies_agree_with_the_factorized_mass_matrix() {
    each_state(|name, model, q, v, _, tau| {
        let a = forward_dynamics(model, q, v, tau).unwrap();
        let matrix = mass_matrix(model, q).unwrap();
        let bias = bias_force(model, q, v).unwrap();
        let mut other: Vec<f64> = tau.iter().zip(&bias).map(|(tau, h)| tau - h).collect();
        let kappa = condition(&matrix);
        matrix.into_ltdl().unwrap().solve(&mut other).unwrap();
        // Both are backward stable on forces of the size of the bias.
        within(&format!("{name}: ABA against LTDL"), distance(&a, &other) / (1.0 + largest(&a)), 16.0 * kappa * f64::EPSILON);
    });
}

#[test]
fn equation_of_motion() {
    // τ = M a + h − Σ Jᵀ f
    each_state(|name, model, q, v, a, _| {
        let f = wrenches(model, 3);
        let mut tau = vec![0.0; a.len()];
        Rnea::new(&model.topology).run(model, q, v, a, Some(&f), &mut tau).unwrap();
        let mut expected = vec![0.0; a.len()];
        mass_matrix(model, q).unwrap().mul(a, &mut expected).unwrap();
        let bias = bias_force(model, q, v).unwrap();
        for (e, h) in expected.iter_mut().zip(&bias) {
            *e += h;
        }
        let kinematics = forward_kinematics(model, q, v, a).unwrap();
        for (body, f) in f.iter().enumerate() {
            let rotation = kinematics.body(body).unwrap().placement.rotation;
            let in_world = Force::new(rotation * f.ang, rotation * f.lin);
            for (e, column) in expected.iter_mut().zip(jacobian(model, q, body).unwrap()) {
                *e -= column.dot(in_world);
            }
        }
        // A few hundred terms, each rounded on the scale of the largest force.
        within(&format!("{name}: M a + h − Jᵀf"), distance(&tau, &expected) / (largest(&bias) + 100.0), 1e-14);

        let mut with_wrenches = vec![0.0; a.len()];
        Bias::new(&model.topology).run(model, q, v, Some(&f), &mut with_wrenches).unwrap();
        let mut zero_acceleration = vec![0.0; a.len()];
        Rnea::new(&model.topology).run(model, q, v, &vec![0.0; a.len()], Some(&f), &mut zero_acceleration).unwrap();
        within(&format!("{name}: bias is ID at rest"), distance(&with_wrenches, &zero_acceleration) / (largest(&bias) + 1.0), 1e-15);

        let mut back = vec![0.0; a.len()];
        Aba::new(&model.topology).run(model, q, v, &tau, Some(&f), &mut back).unwrap();
        let kappa = condition(&mass_matrix(model, q).unwrap());
        let least = mass_matrix(model, q).unwrap().diagonal().fold(f64::INFINITY, |least, d| -larger(-least, -d));
        let scale = largest(a) + (largest(&tau) + largest(&bias)) / least;
        within(&format!("{name}: FD∘ID with wrenches"), distance(&back, a) / scale, kappa * f64::EPSILON);
    });
}

#[test]
fn columns_of_the_mass_matrix_are_inverse_dynamics_of_unit_accelerations() {
    each_state(|name, model, q, _, _, _| {
        let mut model = model.clone();
        model.gravity = Vec3::zero();
        let n = model.topology.nv();
        let matrix = mass_matrix(&model, q).unwrap();
        let dense = matrix.to_dense();
        assert_eq!(dense, dense.transpose(), "{name}: symmetric to the bit");
        let diagonal: Vec<f64> = matrix.diagonal().collect();
        for j in 0..n {
            let mut unit = vec![0.0; n];
            unit[j] = 1.0;
            let column = inverse_dynamics(&model, q, &vec![0.0; n], &unit).unwrap();
            // Two routes of at most fourteen bodies each, in units of the geometric mean of the diagonal.
            let residual = (0..n).map(|i| (column[i] - dense[(i, j)]).abs() / (diagonal[i] * diagonal[j]).sqrt()).fold(0.0, larger);
            within(&format!("{name}: column {j}"), residual, 1e-14);
        }
    });
}

#[test]
fn kinetic_energy_is_half_of_v_m_v() {
    each_state(|name, model, q, v, _, _| {
        let mut momentum = vec![0.0; v.len()];
        mass_matrix(model, q).unwrap().mul(v, &mut momentum).unwrap();
        let expected = 0.5 * v.iter().zip(&momentum).map(|(v, p)| v * p).sum::<f64>();
        let kinetic = energy(model, q, v).unwrap().kinetic;
        // The terms of vᵀMv cancel by a small factor.
        within(&format!("{name}: kinetic energy"), (kinetic - expected).abs() / (expected + 1.0), 1e-14);
        assert!(kinetic >= 0.0);
    });
}

/// A workspace that had another body gives what a new one gives: no column of the other is left.
#[test]
fn a_jacobian_keeps_nothing_of_another_body() {
    each_state(|name, model, q, _, _, _| {
        let bodies = model.topology.bodies();
        let mut used = Jacobian::new(&model.topology);
        for body in (0..bodies).rev().chain(0..bodies) {
            let expected = jacobian(model, q, body).unwrap();
            assert_eq!(used.run(model, q, body).unwrap(), expected, "{name}, body {body}");
        }
    });
}

#[test]
fn jacobian_times_velocity_is_velocity() {
    each_state(|name, model, q, v, a, _| {
        let kinematics = forward_kinematics(model, q, v, a).unwrap();
        for (body, motion) in kinematics.iter().enumerate() {
            let columns = jacobian(model, q, body).unwrap();
            let product = columns.iter().zip(v).fold(Motion::zero(), |sum, (column, v)| column.scale_add(*v, sum));
            within(&format!("{name}: J v of body {body}"), gap(product, motion.velocity) / (1.0 + largest(v)), 1e-14);
        }
    });
}

#[test]
fn momentum_and_center_of_mass_are_sums_over_bodies() {
    each_state(|name, model, q, v, a, _| {
        let kinematics = forward_kinematics(model, q, v, a).unwrap();
        let result = centroidal_momentum(model, q, v).unwrap();
        let (mut mass, mut moment) = (0.0, Vec3::zero());
        let mut sum = Force::zero();
        for ((inertia, label), body) in model.inertias.iter().zip(&model.labels).zip(kinematics.iter()) {
            let (rotation, position) = (label.rotation_to_compiled(body.placement.rotation), body.placement.translation);
            mass += inertia.mass;
            moment += rotation * inertia.first_moment + position * inertia.mass;
            // momentum of the body about its origin, in world axes, then about the common centre
            let own = Motion::new(rotation.transpose_mul(body.velocity.ang), rotation.transpose_mul(body.velocity.lin));
            let own = inertia.mul(own);
            let (ang, lin) = (rotation * own.ang, rotation * own.lin);
            sum += Force::new(ang + (position - result.center.position).cross(lin), lin);
        }
        let center = moment * (1.0 / mass);
        within(&format!("{name}: centre"), distance(&center.to_array(), &result.center.position.to_array()), 1e-14);
        within(&format!("{name}: mass"), (mass - result.center.mass).abs(), 1e-14);
        assert_eq!(center_of_mass(model, q).unwrap(), result.center);
        let scale = (1.0 + largest(v)) * mass;
        within(&format!("{name}: momentum"), distance(&sum.to_array(), &result.momentum.to_array()) / scale, 1e-14);
    });
}

#[test]
fn floating_base_block_is_the_composite_inertia() {
    let (_, recipe) = ROBOTS[7];
    let model = build(&recipe);
    let states = StateBatch::random(&model, 4, 9);
    for k in 0..states.count() {
        let q = states.q(k);
        let n = model.topology.nv();
        let dense = mass_matrix(&model, q).unwrap().to_dense();
        // Direct sum of the bodies in the base's frame, from world placements.
        let kinematics = forward_kinematics(&model, q, &vec![0.0; n], &vec![0.0; n]).unwrap();
        let base = kinematics.body(0).unwrap().placement.inverse();
        let composite = model
            .inertias
            .iter()
            .zip(kinematics.iter().zip(&model.labels))
            .map(|(inertia, (body, label))| {
                (inertia, Transform { rotation: label.rotation_to_compiled(body.placement.rotation), ..body.placement })
            })
            .map(|(inertia, placement)| inertia.to_parent(&base.compose(&placement)))
            .fold(featherbench_spatial::RigidBodyInertia::zero(), |sum, moved| sum + moved);
        for j in 0..6 {
            let mut unit = [0.0; 6];
            unit[(j + 3) % 6] = 1.0;
            let column = composite.mul(Motion::from_array(unit)).to_array();
            for i in 0..6 {
                // v of a free joint is [linear; angular]. Fourteen bodies of a few kilogrammes within a few metres.
                within("M_bb", (dense[(i, j)] - column[(i + 3) % 6]).abs(), 5e-14);
            }
        }
        // The joints as they move while the base is free: S = M_jj − M_jb M_bb⁻¹ M_bj is the inverse of the joint block of M⁻¹.
        let (bb, bj) = (dense.view((0, 0), (6, 6)).into_owned(), dense.view((0, 6), (6, n - 6)).into_owned());
        let schur = dense.view((6, 6), (n - 6, n - 6)) - bj.transpose() * bb.cholesky().unwrap().solve(&bj);
        let inverse = dense.clone().cholesky().unwrap().inverse();
        let block = inverse.view((6, 6), (n - 6, n - 6)).into_owned();
        let identity = schur * block;
        let residual = (&identity - nalgebra::DMatrix::identity(n - 6, n - 6)).amax();
        within("Schur complement of the base", residual, condition(&mass_matrix(&model, q).unwrap()) * 64.0 * f64::EPSILON);
    }
}

/// Results are the same to the bit after the workspace has served another robot in another state.
#[test]
fn used_workspaces_change_nothing() {
    for (name, recipe) in &ROBOTS {
        let (model, other) = (build(recipe), Model::build(&robot(recipe, 12)).unwrap());
        assert_eq!(other.topology, model.topology, "{name}: another robot of the same tree");
        let states = StateBatch::random(&model, 3, 5);
        let f = wrenches(&model, 8);
        let n = model.topology.nv();
        let t = &model.topology;
        let (mut rnea, mut bias, mut aba, mut crba) = (Rnea::new(t), Bias::new(t), Aba::new(t), Crba::new(t));
        let (mut kinematics, mut energy, mut momentum, mut jacobian) =
            (Kinematics::new(t), Energy::new(t), Momentum::new(t), Jacobian::new(t));
        let (mut matrix, mut ltdl) = (TreeSparse::new(t), Ltdl::new(t));
        let mut all = |model: &Model<f64>, k: usize| {
            let (q, v, a, tau) = (states.q(k), states.v(k), states.a(k), states.tau(k));
            let mut out = vec![vec![0.0; n]; 5];
            rnea.run(model, q, v, a, Some(&f), &mut out[0]).unwrap();
            bias.run(model, q, v, Some(&f), &mut out[1]).unwrap();
            aba.run(model, q, v, tau, Some(&f), &mut out[2]).unwrap();
            crba.run(model, q, &mut matrix).unwrap();
            ltdl.run(&matrix).unwrap();
            out[3].copy_from_slice(tau);
            ltdl.solve(&mut out[3]).unwrap();
            kinematics.run(model, q, v, a).unwrap();
            for body in kinematics.iter() {
                out[4].extend(body.acceleration.to_array());
            }
            out.push(matrix.values().to_vec());
            out.push(momentum.run(model, q, v).unwrap().momentum.to_array().to_vec());
            let energies = energy.run(model, q, v).unwrap();
            out.push(vec![energies.kinetic, energies.potential]);
            out.push(jacobian.run(model, q, t.bodies() - 1).unwrap().iter().flat_map(|column| column.to_array()).collect());
            out
        };
        let first = all(&model, 0);
        assert_ne!(first, all(&other, 1), "{name}");
        assert_eq!(first, all(&model, 0), "{name}");
    }
}
