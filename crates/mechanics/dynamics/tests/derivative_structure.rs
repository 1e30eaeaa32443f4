//! Structure of the derivatives: Coriolis matrix, Christoffel symbols, rates of Jacobians and momentum.
//! The truth comes from duals over double-double numbers through the plain algorithms.

use crate::common;

use common::{constant, distance, each_robot_and_state, flow, largest, lifted, over_inertias, robots, unit, within};
use featherbench_dynamics::{
    Coriolis, JacobianRate, TreePair, TreeSparse, bias_force, centroidal_momentum, coriolis_matrix, jacobian, jacobian_rate, mass_matrix,
    mass_matrix_rate, momentum_matrix,
};
use featherbench_model::{BodyDescription, Description, JointDescription, JointType, Model, Placement};
use featherbench_robots::StateBatch;
use featherbench_spatial::{DoubleDouble, Dual, Force, Motion, Vec3};
use nalgebra::{DMatrix, DVector};

type Truth = Dual<DoubleDouble>;

/// The state's q as it moves with a velocity.
fn moving(model: &Model<f64>, q: &[f64], v: &[f64]) -> Vec<Truth> {
    flow(model, &lifted(q), &lifted(v))
}

fn derivative(x: Truth) -> f64 {
    x.derivative.to_f64()
}

/// The largest magnitude in a matrix, NaN if any entry is.
fn extent(matrix: &DMatrix<f64>) -> f64 {
    largest(matrix.as_slice())
}

/// The true rate of M along a velocity.
fn rate_of_mass_matrix(model: &Model<f64>, q: &[f64], v: &[f64]) -> DMatrix<f64> {
    let matrix = mass_matrix(model, &moving(model, q, v)).unwrap();
    DMatrix::from_fn(v.len(), v.len(), |i, j| derivative(matrix.get(i, j)))
}

#[test]
fn rate_of_the_mass_matrix_is_the_coriolis_matrix_and_its_transpose() {
    each_robot_and_state(|name, model, [q, v, ..], _| {
        let n = v.len();
        let c = coriolis_matrix(model, q, v).unwrap();
        let mass = mass_matrix(model, q).unwrap();
        let truth = rate_of_mass_matrix(model, q, v);
        let sum = c.to_dense() + c.to_dense().transpose();
        // Roundings of some dozens of terms; measured 9e-14.
        within(&format!("{name}: C + Cᵀ − Ṁ"), over_inertias(&mass, &truth, &sum), 2e-13);
        let rate = mass_matrix_rate(model, q, v).unwrap();
        assert_eq!(rate.to_dense(), sum, "{name}");

        let mut force = vec![0.0; n];
        c.mul(v, &mut force).unwrap();
        let (bias, gravity) = (bias_force(model, q, v).unwrap(), bias_force(model, q, &vec![0.0; n]).unwrap());
        let expected: Vec<f64> = bias.iter().zip(&gravity).map(|(h, g)| h - g).collect();
        within(&format!("{name}: C v"), distance(&force, &expected) / (1.0 + largest(&bias) + largest(&gravity)), 5e-14);
    });
}

/// Three matrices with the same C v, of two links with the masses at their ends. Only one has Ṁ = C + Cᵀ; the power v·(Ṁ − 2C)v is zero
/// for all of them.
#[test]
fn the_power_does_not_tell_which_coriolis_matrix_is_consistent() {
    let (masses, lengths, q, v) = ([2.0, 1.0], [1.0, 0.5], [0.3, -0.5], [0.7, 0.4]);
    let body = |i: usize| BodyDescription {
        name: format!("link{i}"),
        parent: i.checked_sub(1),
        mass: masses[i],
        com: [0.0, 0.0, lengths[i]],
        inertia: [0.0; 6],
        joint: JointDescription {
            kind: JointType::Revolute { axis: [0.0, 1.0, 0.0] },
            placement: Placement { translation: [0.0, 0.0, if i == 0 { 0.0 } else { lengths[0] }], ..Placement::default() },
            ..JointDescription::default()
        },
    };
    let description = Description { gravity: [0.0, 0.0, -9.81], bodies: vec![body(0), body(1)], ..Description::default() };
    let model: Model<f64> = Model::build(&description).unwrap();
    let consistent = coriolis_matrix(&model, &q, &v).unwrap().to_dense();
    let rate = mass_matrix_rate(&model, &q, &v).unwrap().to_dense();

    // The closed form: h = −m₂ l₁ l₂ sin q₂, from M₁₁ = … + 2 m₂ l₁ l₂ cos q₂, M₁₂ = … + m₂ l₁ l₂ cos q₂.
    let h = -masses[1] * lengths[0] * lengths[1] * f64::sin(q[1]);
    let closed = DMatrix::from_row_slice(2, 2, &[h * v[1], h * (v[0] + v[1]), -h * v[0], 0.0]);
    within("C of two links", extent(&(&consistent - &closed)), 1e-15);
    within("Ṁ of two links", extent(&(&rate - DMatrix::from_row_slice(2, 2, &[2.0 * h * v[1], h * v[1], h * v[1], 0.0]))), 1e-15);

    // All products of velocities in the second column; and Ṁ − ½ ∂(Mv)ᵀ/∂q, of which C v is the usual derivation.
    let lumped = DMatrix::from_row_slice(2, 2, &[0.0, h * (2.0 * v[0] + v[1]), -h * v[0], 0.0]);
    let gradients: Vec<DVector<f64>> =
        (0..2).map(|k| rate_of_mass_matrix(&model, &q, &unit(2, k)) * DVector::from_column_slice(&v)).collect();
    let lagrangian = &rate - DMatrix::from_fn(2, 2, |i, j| 0.5 * gradients[i][j]);

    let v = DVector::from_column_slice(&v);
    for (matrix, violation) in [(&consistent, 0.0), (&lumped, 2.0 * h * v[1]), (&lagrangian, 2.0 * h * v[1])] {
        within("C v", largest((matrix * &v - &consistent * &v).as_slice()), 1e-15);
        within("v·(Ṁ − 2C)v", ((&rate - matrix * 2.0) * &v).dot(&v).abs(), 1e-15);
        within("C + Cᵀ − Ṁ", (extent(&(matrix + matrix.transpose() - &rate)) - violation).abs(), 1e-15);
    }
    // 0.4 sin 0.5
    within("how far", (2.0 * h * v[1] - 0.4 * f64::sin(0.5)).abs(), 1e-16);
}

#[test]
fn christoffel_symbols() {
    for (name, model) in &robots() {
        let n = model.topology.nv();
        let states = StateBatch::random(model, 1, 6);
        let (q, v) = (states.q(0), states.v(0));
        let (mut coriolis, mut symbols) = (Coriolis::new(&model.topology), TreePair::new(&model.topology));
        let one_dof = model.topology.joints().iter().all(|joint| joint.kind.nv() == 1);
        let gradients: Vec<_> = (0..n).map(|k| rate_of_mass_matrix(model, q, &unit(n, k))).collect();
        let scale = 1.0 + gradients.iter().fold(0.0, |largest, gradient| common::larger(largest, extent(gradient)));
        let mut sum = DMatrix::zeros(n, n);
        for k in 0..n {
            coriolis.christoffel(model, q, k, &mut symbols).unwrap();
            let symbols = symbols.to_dense();
            // Of any joints: Γ_ijk + Γ_jik = ∂_k M_ij.
            within(&format!("{name}: ∂M/∂q_{k}"), extent(&(&symbols + symbols.transpose() - &gradients[k])) / scale, 2e-14);
            if one_dof {
                let expected = DMatrix::from_fn(n, n, |i, j| 0.5 * (gradients[k][(i, j)] + gradients[j][(i, k)] - gradients[i][(j, k)]));
                within(&format!("{name}: Γ of {k}"), extent(&(&symbols - expected)) / scale, 2e-14);
            }
            sum += symbols * v[k];
        }
        let matrix = coriolis_matrix(model, q, v).unwrap().to_dense();
        within(&format!("{name}: Σ Γ v"), extent(&(sum - &matrix)) / (scale + extent(&matrix)), 1e-14);
        assert!(coriolis.christoffel(model, q, n, &mut symbols).is_err(), "{name}: there is no dof {n}");
    }
}

fn six(m: Motion<f64>) -> [f64; 6] {
    m.to_array()
}

fn rounded(m: &Motion<Truth>) -> [[f64; 6]; 2] {
    [m.to_array().map(|x| x.value.to_f64()), m.to_array().map(derivative)]
}

#[test]
fn rates_of_jacobians() {
    each_robot_and_state(|name, model, [q, v, ..], _| {
        let body = model.described[model.described.len() - 1];
        let speed = 1.0 + largest(v);
        let truth = jacobian(model, &moving(model, q, v), body).unwrap();
        let found = jacobian_rate(model, q, v, body).unwrap();
        let (columns, rates) = (found.columns(), found.rates());
        let expected = jacobian(model, q, body).unwrap();
        for (k, truth) in truth.iter().enumerate() {
            let [value, rate] = rounded(truth);
            assert_eq!(columns[k], expected[k], "{name}: column {k}");
            within(&format!("{name}: J of {k}"), distance(&six(columns[k]), &value), 2e-14);
            // Displacements of up to twenty metres at angular velocities of a dozen: chains of 36.
            within(&format!("{name}: J̇ of {k}"), distance(&six(rates[k]), &rate) / speed, 1e-13);
        }

        // Another frame on the body: its origin moves with ω × d in addition.
        let offset = Vec3::new(0.3, -0.2, 0.7);
        let (mut workspace, mut exact) = (JacobianRate::new(&model.topology), JacobianRate::new(&model.topology));
        workspace.run(model, q, v, body, offset).unwrap();
        exact.run(model, &moving(model, q, v), &constant(&lifted(v)), body, offset.lift()).unwrap();
        for k in 0..v.len() {
            let [value, rate] = rounded(&exact.columns()[k]);
            within(&format!("{name}: J of {k}, offset"), distance(&six(workspace.columns()[k]), &value), 2e-14);
            within(&format!("{name}: J̇ of {k}, offset"), distance(&six(workspace.rates()[k]), &rate) / speed, 1e-13);
        }
    });
}

#[test]
fn centroidal_momentum_matrix_and_its_rate() {
    each_robot_and_state(|name, model, [q, v, ..], _| {
        let n = v.len();
        let found = momentum_matrix(model, q, v).unwrap();
        let (columns, rates) = (found.columns(), found.rates());
        let truth: Vec<[[f64; 6]; 2]> = (0..n)
            .map(|k| {
                let one: Vec<Truth> = unit(n, k);
                let Force { ang, lin } = centroidal_momentum(model, &moving(model, q, v), &one).unwrap().momentum;
                rounded(&Motion::new(ang, lin))
            })
            .collect();
        let scale =
            |which: usize| f64::MIN_POSITIVE + truth.iter().fold(0.0, |scale, columns| common::larger(scale, largest(&columns[which])));
        for (k, [value, rate]) in truth.iter().enumerate() {
            // The centre of mass is a mean over all bodies: roundings of the size of the largest column.
            within(&format!("{name}: A of {k}"), distance(&columns[k].to_array(), value) / scale(0), 2e-14);
            within(&format!("{name}: Ȧ of {k}"), distance(&rates[k].to_array(), rate) / (scale(1) + scale(0)), 2e-14);
        }
    });
}

/// A matrix, and what does not fit it.
#[test]
fn other_topologies_are_refused() {
    let (small, large) = (common::build(&common::ROBOTS[0].1), common::build(&common::ROBOTS[6].1));
    let states = StateBatch::random(&small, 1, 1);
    let mut pair: TreePair<f64> = TreePair::new(&large.topology);
    assert!(Coriolis::new(&small.topology).run(&small, states.q(0), states.v(0), &mut pair).is_err());
    let mut pair = TreePair::new(&small.topology);
    assert!(Coriolis::new(&large.topology).run(&small, states.q(0), states.v(0), &mut pair).is_err());
    assert!(Coriolis::new(&small.topology).run(&small, states.q(0), &states.v(0)[1..], &mut pair).is_err());
    assert!(pair.symmetric_sum(&mut TreeSparse::new(&large.topology)).is_err());
}
