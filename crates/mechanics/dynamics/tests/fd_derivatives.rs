//! First derivatives of forward dynamics against duals over double-double numbers, which go through the articulated-body algorithm.

use crate::common;

use common::{condition, constant, each_robot_and_state, flow, generated, larger, lifted, unit, within};
use featherbench_dynamics::{Aba, FdDerivatives, FdPartials, TreeSparse, fd_derivatives, mass_matrix};
use featherbench_model::Model;
use featherbench_robots::StateBatch;
use featherbench_spatial::{DoubleDouble, Dual, Force, Real};
use nalgebra::DMatrix;

type Truth = Dual<DoubleDouble>;

/// The derivative of accelerations along a direction.
fn along(model: &Model<f64>, q: &[Truth], v: &[Truth], tau: &[Truth], f: &[Force<f64>]) -> Vec<f64> {
    let f: Vec<Force<Truth>> = f.iter().map(|f| f.lift()).collect();
    let mut a = vec![Truth::zero(); v.len()];
    Aba::new(&model.topology).run(model, q, v, tau, Some(&f), &mut a).unwrap();
    a.iter().map(|a| a.derivative.to_f64()).collect()
}

/// The true ∂v̇/∂q, ∂v̇/∂v and ∂v̇/∂τ, column by column.
fn truth(model: &Model<f64>, [q, v, tau]: [&[f64]; 3], f: &[Force<f64>]) -> [DMatrix<f64>; 3] {
    let n = v.len();
    let [q, v, tau] = [q, v, tau].map(lifted::<DoubleDouble>);
    let moving = |x: &[DoubleDouble], j| -> Vec<Truth> { x.iter().zip(unit(n, j)).map(|(&x, rate)| Dual::new(x, rate)).collect() };
    let by = |column: &dyn Fn(usize) -> Vec<f64>| DMatrix::from_vec(n, n, (0..n).flat_map(column).collect());
    [
        by(&|j| along(model, &flow(model, &q, &unit(n, j)), &constant(&v), &constant(&tau), f)),
        by(&|j| along(model, &constant(&q), &moving(&v, j), &constant(&tau), f)),
        by(&|j| along(model, &constant(&q), &constant(&v), &moving(&tau, j), f)),
    ]
}

/// The largest difference over the largest entry, each entry times √M_ii and over `column_j`: so units drop out.
fn over_inertias(matrix: &TreeSparse<f64>, column: impl Fn(f64) -> f64, truth: &DMatrix<f64>, found: &[f64]) -> f64 {
    let root: Vec<f64> = matrix.diagonal().map(f64::sqrt).collect();
    let n = root.len();
    let found = DMatrix::from_row_slice(n, n, found);
    let over =
        |entries: &DMatrix<f64>| entries.iter().enumerate().map(|(k, x)| x.abs() * root[k % n] / column(root[k / n])).fold(0.0, larger);
    let (scale, error) = (over(truth), over(&(found - truth)));
    if error == 0.0 { 0.0 } else { error / scale }
}

#[test]
fn derivatives_of_forward_dynamics_are_those_of_duals() {
    each_robot_and_state(|name, model, [q, v, _, tau], f| {
        let mut partials = FdPartials::new(&model.topology);
        let mut workspace = FdDerivatives::new(&model.topology);
        workspace.run(model, q, v, tau, Some(f), &mut partials).unwrap();
        let matrix = mass_matrix(model, q).unwrap();
        let [by_q, by_v, by_tau] = truth(model, [q, v, tau], f);
        // A relative error ε of the entries of M moves a solution by κ ε. κ is 1e3 and less, but of chains of 36 it is 1e5, and 1e7 of a
        // straight one in a plane.
        let tolerance = 4.0 * condition(&matrix) * f64::EPSILON;
        within(&format!("{name}: ∂v̇/∂q"), over_inertias(&matrix, |m| m, &by_q, &partials.q), tolerance);
        within(&format!("{name}: ∂v̇/∂v"), over_inertias(&matrix, |m| m, &by_v, &partials.v), tolerance);
        within(&format!("{name}: ∂v̇/∂τ"), over_inertias(&matrix, |m| 1.0 / m, &by_tau, &partials.tau), tolerance);

        let first = partials.clone();
        workspace.run(model, q, v, tau, Some(f), &mut partials).unwrap();
        assert_eq!(first, partials, "{name}: a second call");
    });
}

/// A joint that moves nothing has no acceleration, and is named.
#[test]
fn a_joint_without_inertia_is_refused() {
    let mut model = common::build(&common::ROBOTS[0].1);
    let states = StateBatch::random(&model, 1, 3);
    let last = model.inertias.len() - 1;
    model.inertias[last] = featherbench_spatial::RigidBodyInertia::zero();
    let refused = fd_derivatives(&model, states.q(0), states.v(0), states.tau(0)).unwrap_err();
    assert!(matches!(refused, featherbench_dynamics::Error::NotPositiveDefinite(bad) if bad.dof == last), "{refused}");
}

/// Largest errors of v̇, ∂v̇/∂q and ∂v̇/∂v over 12 random states, in units free of dimension.
fn largest_errors(family: &str) -> [f64; 3] {
    let model = generated(family);
    let (states, n) = (StateBatch::random(&model, 12, 1), model.topology.nv());
    let mut errors = [0.0; 3];
    for k in 0..states.count() {
        let (q, v, tau) = (states.q(k), states.v(k), states.tau(k));
        let partials = fd_derivatives(&model, q, v, tau).unwrap();
        let [by_q, by_v, _] = truth(&model, [q, v, tau], &vec![Force::zero(); model.topology.bodies()]);
        let mut a = vec![DoubleDouble::zero(); n];
        let [q2, v2, tau2] = [q, v, tau].map(lifted::<DoubleDouble>);
        Aba::new(&model.topology).run(&model, &q2, &v2, &tau2, None, &mut a).unwrap();
        let matrix = mass_matrix(&model, q).unwrap();
        let root: Vec<f64> = matrix.diagonal().map(f64::sqrt).collect();
        let of = |numbers: &dyn Fn(usize) -> f64| root.iter().enumerate().map(|(k, root)| (numbers(k) * root).abs()).fold(0.0, larger);
        let acceleration = of(&|k| (a[k] - DoubleDouble::from_f64(partials.acceleration[k])).to_f64()) / of(&|k| a[k].to_f64());
        let found = [
            acceleration,
            over_inertias(&matrix, |root| root, &by_q, &partials.q),
            over_inertias(&matrix, |root| root, &by_v, &partials.v),
        ];
        errors = std::array::from_fn(|k| larger(errors[k], found[k]));
    }
    errors
}

/// −M⁻¹ ∂ID loses what M⁻¹ amplifies: 2·10⁻¹² on the planar chain of 50, 5·10⁻¹² on the spatial one.
#[test]
fn long_chains_keep_their_digits() {
    for family in ["chain:n=50,layout=planar", "chain:n=50,layout=spatial"] {
        let errors = largest_errors(family);
        // Fifty joints of rounding, each some ε of what passes through it.
        assert!(errors.iter().all(|error| *error <= 50.0 * 4.0 * f64::EPSILON), "{family}: {errors:?}");
    }
}

/// In the axes of the world, the inertia of a slender base about its own axis drowned in the rounding of the others: v̇ had 2·10⁻¹⁴.
#[test]
fn a_slender_floating_base_keeps_its_digits() {
    for family in ["chain:n=1,layout=spatial,base=free", "chain:n=12,layout=spatial,base=free"] {
        let errors = largest_errors(family);
        assert!(errors[0] <= 16.0 * f64::EPSILON && errors.iter().all(|error| *error <= 1e-13), "{family}: {errors:?}");
    }
}
