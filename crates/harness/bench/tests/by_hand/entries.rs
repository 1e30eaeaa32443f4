//! One wrong number among many: for every quantity, δ in one entry is an error of exactly δ over the magnitude of this entry.

use super::close;
use super::robots::{free_and_spherical, two_screws, two_slides};
use featherbench_bench::measure::{Magnitudes, scaled_error};
use featherbench_bench::{Quantity, Robot};
use featherbench_results::ModelOrigin;
use featherbench_robots::Family;

/// The magnitude against which each entry of a quantity is measured.
struct Expected {
    quantity: Quantity,
    /// Any answer, where the scale comes from robot and state.
    reference: Vec<f64>,
    magnitudes: Vec<f64>,
}

/// Numbers of both signs and a zero.
fn some(count: usize) -> Vec<f64> {
    (0..count).map(|k| 0.25 * k as f64 - 0.5).collect()
}

/// Every entry in turn, changed by a thousandth of its magnitude in either direction; and all entries changed by less than one of them.
fn check(robot: &Robot, expected: &Expected) {
    let Expected { quantity, reference, magnitudes } = expected;
    let at = Magnitudes::new(robot, 0);
    let error = |value: &[f64]| scaled_error(robot, *quantity, &at, reference, value);
    assert_eq!(reference.len(), quantity.size(robot), "{quantity:?}");
    assert_eq!(magnitudes.len(), reference.len(), "{quantity:?}");
    assert!(!reference.is_empty() && magnitudes.iter().all(|m| *m > 0.0), "{quantity:?}");
    assert_eq!(error(reference), 0.0, "{quantity:?}");
    for (entry, &magnitude) in magnitudes.iter().enumerate() {
        for size in [1e-3, -1e-3] {
            let mut value = reference.clone();
            value[entry] += size * magnitude;
            let due = (value[entry] - reference[entry]).abs() / magnitude;
            let found = error(&value);
            assert!(close(found, due), "{quantity:?}, entry {entry}: {found:e} instead of {due:e}");

            // The error is the largest, not the sum.
            let all: Vec<f64> =
                (0..value.len()).map(|k| if k == entry { value[k] } else { reference[k] + 0.5 * size * magnitudes[k] }).collect();
            assert!(close(error(&all), due), "{quantity:?}, entry {entry} among others");
        }
        let mut value = reference.clone();
        value[entry] = f64::NAN;
        assert!(error(&value).is_nan(), "{quantity:?}, entry {entry}");
    }
}

/// The numbers of the table in `robots.rs` and of the tests in `magnitudes.rs`.
#[test]
fn every_entry_of_two_screws_has_its_magnitude() {
    let robot = two_screws();
    let at = Magnitudes::new(&robot, 0);
    let spin: f64 = 5.8_f64.sqrt();
    let of =
        |quantity: Quantity, magnitudes: &[f64]| Expected { quantity, reference: some(magnitudes.len()), magnitudes: magnitudes.to_vec() };
    let scaled = |quantity: Quantity, reference: &[f64], magnitudes: &[f64]| {
        let (reference, magnitudes) = (reference.to_vec(), magnitudes.to_vec());
        Expected { quantity, reference, magnitudes }
    };
    let body = |angular: f64, linear: f64| [[angular; 3], [linear; 3]].concat();
    // The path to the centre of mass, weighted: (2·5.5 + 1.5 + 4·9 + 2)/6, with the lever c = h/m.
    let reach_of_mass = 50.5 / 6.0;
    // M = [4 1; 1 9] has the square roots 2 and 3 of its diagonal.
    let matrix = [4.0, 1.0, 1.0, 9.0];
    // Products with four vectors, of which only the scale counts here; then the diagonal, then the last row.
    let probe = robot.probe();
    let products = probe.chunks_exact(2).flat_map(|x| {
        let weight = 2.0 * x[0].abs() + 3.0 * x[1].abs();
        [2.0 * weight, 3.0 * weight]
    });
    let products = [products.collect(), vec![4.0, 9.0], vec![6.0, 9.0]].concat();
    let mut products_reference = some(12);
    products_reference[8..].copy_from_slice(&[4.0, 9.0, 1.0, 9.0]);
    // Mass, centre of mass, trace about the body's origin (trace about the centre of mass + 2m·c²), rotation, placement.
    let held =
        |mass: f64, com: f64, trace: f64, length: f64| [vec![mass], vec![com; 3], vec![trace; 6], vec![1.0; 9], vec![length; 3]].concat();
    // Momentum. Linear m·v + |h|·ω: 2·1.5 + 1.5·3 = 7.5 and 4·12.5 + 2·5 = 60. Angular tr(Ī)·ω + |h|·v + reach·linear:
    // 6·3 + 1.5·1.5 + 5.5·7.5 = 61.5 and 5·5 + 2·12.5 + 9·60 = 590.
    let mass = featherbench_dynamics::mass_matrix(&robot.model, robot.states.q(0)).unwrap();
    let root = [mass.get(0, 0).sqrt(), mass.get(1, 1).sqrt()];
    // So large that no rate of the state is larger
    let partial = [2e9, -3e9, 1e9, 9e9];
    let products_of = |unit: fn(f64, f64) -> f64| {
        let units = [unit(root[0], root[0]), unit(root[0], root[1]), unit(root[1], root[0]), unit(root[1], root[1])];
        let largest = partial.iter().zip(units).map(|(x, unit): (&f64, f64)| x.abs() / unit).fold(0.0, featherbench_bench::measure::worst);
        units.map(|unit| largest * unit)
    };
    // The largest mass, first moment and inertia of the scaled rows are those of the first body in the first row.
    let of_body = [50.0, -80.0, 1.0, 0.0, 1.0, 2.0, 90.0, 0.0, 1.0, 1.0];
    let regressor: Vec<f64> = [1e9, 5e8, 1e8, 2e8].iter().flat_map(|share| of_body.map(|x| share * x)).collect();
    assert!(root[0] < 5.0 * root[1]);
    let of_row = |of: f64| [50.0, 80.0, 80.0, 80.0, 90.0, 90.0, 90.0, 90.0, 90.0, 90.0].map(|x| 1e9 * x / root[0] * of);
    let of_regressor = [of_row(root[0]), of_row(root[0]), of_row(root[1]), of_row(root[1])].concat();
    let rates: Vec<f64> = robot.probe()[..4].iter().map(|x| x.abs()).collect();
    let first = rates.chunks(2).flat_map(|x| body(x[0], 9.0 * x[0]));
    let second = rates.chunks(2).flat_map(|x| body(x[0] + x[1], 10.0 * x[0] + 9.75 * x[1]));
    let jacobian_products: Vec<f64> = first.chain(second).collect();
    let cases = [
        of(Quantity::InverseDynamics, &at.joint_force),
        of(Quantity::InverseDynamicsWrench, &at.joint_force_wrench),
        of(Quantity::Bias, &at.bias_force),
        scaled(Quantity::MassMatrix, &matrix, &[4.0, 6.0, 6.0, 9.0]),
        scaled(Quantity::MassMatrixInverse, &matrix, &[4.0, 6.0, 6.0, 9.0]),
        scaled(Quantity::MassMatrixSparse, &[4.0, 1.0, 9.0], &[4.0, 6.0, 9.0]),
        scaled(Quantity::MassMatrixProbe, &products_reference, &products),
        scaled(Quantity::KineticEnergy, &[3.0], &[3.0]),
        of(Quantity::PotentialEnergy, &[6.0 * 5.0 * reach_of_mass]),
        of(Quantity::CenterOfMass, &[reach_of_mass; 3]),
        of(Quantity::Momentum, &body(61.5 + 590.0, 67.5)),
        of(Quantity::BodyPlacement, &[[1.0; 9].as_slice(), &[5.5; 3], &[1.0; 9], &[9.0; 3]].concat()),
        // v + ω·size: 1.5 + 3·3 and 12.5 + 5·0.5.
        of(Quantity::BodyVelocity, &[body(3.0, 10.5), body(5.0, 15.0)].concat()),
        // a + g + (α + ω²)·size: 5.5 + 5 + (11 + 9)·3 and 79.5 + √5.8/2 + 5 + (25 + 25)·0.5.
        of(Quantity::BodyAcceleration, &[body(11.0, 70.5), body(25.0, 109.5 + spin / 2.0)].concat()),
        // A screw rotates by one, and moves by its reach of 9 and its pitch.
        of(Quantity::BodyJacobian, &[[1.0; 6], [9.5, 9.25, 9.5, 9.25, 9.5, 9.25]].concat()),
        // The same with the size of the body, times the rates of the probe along its path: of 8.5 m and 9.5 m.
        of(Quantity::BodyJacobians, &jacobian_products),
        scaled(Quantity::Readback, &robot.readback(), &[held(2.0, 0.75, 3.75 + 2.25, 5.0), held(4.0, 0.5, 3.0 + 2.0, 3.0)].concat()),
        of(Quantity::StoredEntries, &[1.0]),
        scaled(Quantity::ForwardDynamics, &[-8.0, 2.0], &[8.0; 2]),
        scaled(Quantity::ForwardDynamicsSingle, &[-8.0, 2.0], &[8.0; 2]),
        scaled(Quantity::Solve, &[-8.0, 2.0], &[8.0; 2]),
        // The largest scaled entry times the unit of each: √(M_ii·M_jj) of ∂ID and C, √(M_jj/M_ii) of ∂FD.
        scaled(Quantity::InverseDynamicsDq, &partial, &products_of(|i, j| i * j)),
        scaled(Quantity::InverseDynamicsDv, &partial, &products_of(|i, j| i * j)),
        scaled(Quantity::CoriolisMatrix, &partial, &products_of(|i, j| i * j)),
        scaled(Quantity::ForwardDynamicsDq, &partial, &products_of(|i, j| j / i)),
        scaled(Quantity::ForwardDynamicsDv, &partial, &products_of(|i, j| j / i)),
        scaled(Quantity::TorqueRegressor, &regressor, &of_regressor),
    ];
    for expected in &cases {
        check(&robot, expected);
    }
    let missing: Vec<Quantity> =
        Quantity::ALL.into_iter().filter(|quantity| !cases.iter().any(|case| case.quantity == *quantity)).collect();
    let others = [Quantity::Factorization, Quantity::FactorEntries, Quantity::InverseDynamicsSecond, Quantity::ForwardDynamicsSecond];
    assert_eq!(missing, others, "factors and second derivatives have tests of their own");
}

/// Fill-in is no error, and a factor with fewer numbers than M is one.
#[test]
fn a_factor_has_as_many_numbers_as_the_matrix_or_more() {
    let robot = two_screws();
    let at = Magnitudes::new(&robot, 0);
    let error = |value: f64| scaled_error(&robot, Quantity::FactorEntries, &at, &[3.0], &[value]);
    assert_eq!([3.0, 4.0, 2.0].map(error), [0.0, 0.0, 1.0]);
    assert!(error(f64::NAN).is_nan());
}

/// LᵀDL with D = (2, 9) and L_10 = 0.5: M_11 = D_1 = 9, M_10 = L_10·D_1 = 4.5, M_00 = D_0 + L_10²·D_1 = 4.25.
#[test]
fn every_factor_is_seen_in_the_matrix_that_it_makes() {
    let robot = two_screws();
    let at = Magnitudes::new(&robot, 0);
    let factors = [2.0, 0.5, 9.0];
    let (delta, root) = (1e-3, (4.25_f64 * 9.0).sqrt());
    let worst = |errors: [f64; 3]| errors.into_iter().fold(0.0, featherbench_bench::measure::worst);
    let moved = 0.5 + delta;
    let expected = [
        delta / 4.25,
        worst([(moved * moved - 0.25) * 9.0 / 4.25, delta * 9.0 / root, 0.0]),
        worst([0.25 * delta / 4.25, 0.5 * delta / root, delta / 9.0]),
    ];
    for (entry, due) in expected.into_iter().enumerate() {
        let mut value = factors;
        value[entry] += delta;
        let found = scaled_error(&robot, Quantity::Factorization, &at, &factors, &value);
        // Sums of the size of an entry round by 1e-16 of it. A difference of a thousandth rounds by 1e-12 of itself.
        assert!((found - due).abs() <= 1e-12 * due, "factor {entry}: {found:e} instead of {due:e}");
    }
}

/// The first three dofs of a free joint slide and the others rotate; a spherical joint rotates.
#[test]
fn columns_of_the_jacobian_slide_or_turn() {
    let robot = free_and_spherical();
    // The angular entries of a slide's column: over the rotation that moves the reach of 5.5 m as far as the slide.
    let angular = [[1.0 / 5.5; 3], [1.0; 3], [1.0; 3]].concat();
    let linear = [[1.0; 3], [5.5; 3], [5.5; 3]].concat();
    let magnitudes = [angular.repeat(3), linear.repeat(3)].concat();
    check(&robot, &Expected { quantity: Quantity::BodyJacobian, reference: some(54), magnitudes });

    // Without a reach there is no such rotation: any angular entry but zero has an infinite error.
    let robot = two_slides(4.0);
    let at = Magnitudes::new(&robot, 0);
    let reference = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0];
    for entry in 0..12 {
        let mut value = reference;
        value[entry] += 0.125;
        let due = if entry < 6 { f64::INFINITY } else { 0.125 };
        assert_eq!(scaled_error(&robot, Quantity::BodyJacobian, &at, &reference, &value), due, "entry {entry}");
    }
}

/// Sparse M and its products on a branched tree, entry by entry, against the dense matrix.
#[test]
fn every_entry_of_a_branched_tree_has_its_magnitude() {
    for spec in ["tree:n=7,seed=3,base=fixed,joints=all,armature=true", "joints:kind=mixed,base=free"] {
        let description = Family::parse(spec).unwrap().generate().unwrap();
        let robot = Robot::new(&description, "test", ModelOrigin::Generated, 1, 1).unwrap();
        let topology = &robot.model.topology;
        let sparse = featherbench_dynamics::mass_matrix(&robot.model, robot.states.q(0)).unwrap();
        let (n, dense) = (topology.nv(), sparse.to_dense());
        let magnitude = |i: usize, j: usize| (dense[(i, i)] * dense[(j, j)]).sqrt();
        let pairs = (0..n).flat_map(|i| topology.row_dofs(i).iter().map(move |&j| (i, j)));
        let magnitudes: Vec<f64> = pairs.map(|(i, j)| magnitude(i, j)).collect();
        assert!(magnitudes.len() < n * (n + 1) / 2, "{spec} has no branches");
        check(&robot, &Expected { quantity: Quantity::MassMatrixSparse, reference: sparse.values().to_vec(), magnitudes });

        let probe = robot.probe();
        let (mut reference, mut magnitudes) = (Vec::new(), Vec::new());
        for x in probe.chunks_exact(n) {
            reference.extend((0..n).map(|i| (0..n).map(|j| dense[(i, j)] * x[j]).sum::<f64>()));
            magnitudes.extend((0..n).map(|i| (0..n).map(|j| magnitude(i, j) * x[j].abs()).sum::<f64>()));
        }
        reference.extend((0..n).map(|i| dense[(i, i)]).chain((0..n).map(|j| dense[(n - 1, j)])));
        magnitudes.extend((0..n).map(|i| dense[(i, i)]).chain((0..n).map(|j| magnitude(n - 1, j))));
        check(&robot, &Expected { quantity: Quantity::MassMatrixProbe, reference, magnitudes });
    }
}
