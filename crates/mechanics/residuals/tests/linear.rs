//! The linear residual: its regressor, robots with nq ≠ nv, and fits.

use crate::support::{apart, draw, state};
use featherbench_model::Model;
use featherbench_residuals::{Linear, Residual, State};
use featherbench_robots::{Family, Random};
use nalgebra::{DMatrix, DVector};

fn floating() -> Model<f64> {
    Model::build(&Family::parse("quadruped").unwrap().generate().unwrap()).unwrap()
}

/// A floating base has nq = nv + 1. The regressor has nv rows, and θ has nv·(nq + 2 nv + 1) numbers. The lesson's has n rows that are all equal.
#[test]
fn a_floating_base_has_nv_forces() {
    let model = floating();
    let (nq, nv) = (model.topology.nq(), model.topology.nv());
    assert_eq!((nq, nv), (19, 18));
    let mut random = Random::named(8, "linear");
    let linear = Linear::new(nq, nv, draw(&mut random, 18 * (19 + 36 + 1))).unwrap();
    let [q, v, a] = state(&mut random, &model);
    let state = State::new(&q, &v, &a);
    let r = linear.value(&state).unwrap();
    assert_eq!(r.len(), nv);
    let y = Linear::regressor(&state);
    assert_eq!(y.shape(), (18, 18 * 56));
    assert!(apart((&y * DVector::from_column_slice(linear.theta())).as_slice(), &r) < 1e-14);
    assert_eq!(y.rank(1e-9), 18, "the rows are independent");
    // All rows equal, as the lesson stacks them: rank one.
    let stacked = DMatrix::from_fn(18, 56, |_, column| Linear::phi(&state)[column]);
    assert_eq!(stacked.rank(1e-9), 1);
}

/// ∂r/∂a by its definition: r is affine in a, so a difference of a unit is exact to rounding.
#[test]
fn the_derivative_is_that_of_the_values() {
    let mut random = Random::named(9, "linear derivative");
    let linear = Linear::new(3, 2, draw(&mut random, 2 * 8)).unwrap();
    let (q, v) = (draw(&mut random, 3), draw(&mut random, 2));
    let matrix = linear.by_acceleration(&State::new(&q, &v, &[0.0; 2])).unwrap();
    for k in 0..2 {
        let mut a = [0.0; 2];
        a[k] = 1.0;
        let [with, without] = [&a, &[0.0; 2]].map(|a| linear.value(&State::new(&q, &v, a)).unwrap());
        (0..2).for_each(|row| assert!((with[row] - without[row] - matrix[(row, k)]).abs() < 1e-15));
    }
}

/// Noise-free samples give the parameters back; samples that do not excite them give the rank and the shortest parameters.
#[test]
fn fits_find_the_parameters() {
    let mut random = Random::named(10, "fits");
    let linear = Linear::new(2, 2, draw(&mut random, 14)).unwrap();
    let states: Vec<[Vec<f64>; 3]> = (0..40).map(|_| [draw(&mut random, 2), draw(&mut random, 2), draw(&mut random, 2)]).collect();
    let sampled = |states: &'_ [[Vec<f64>; 3]]| -> (Linear, usize) {
        let states = states.iter().map(|[q, v, a]| State::new(q, v, a));
        let samples: Vec<(State<'_>, Vec<f64>)> = states.map(|state| (state, linear.value(&state).unwrap())).collect();
        Linear::fit(&samples).unwrap()
    };
    let (fit, rank) = sampled(&states);
    assert_eq!(rank, 7);
    assert!(apart(fit.theta(), linear.theta()) < 1e-13, "{}", apart(fit.theta(), linear.theta()));
    // At rest: of [q; v; a; 1] only q and 1 are seen.
    let resting: Vec<[Vec<f64>; 3]> = states.iter().map(|[q, _, _]| [q.clone(), vec![0.0; 2], vec![0.0; 2]]).collect();
    let (fit, rank) = sampled(&resting);
    assert_eq!(rank, 3);
    assert!(fit.theta()[2..6].iter().all(|x| x.abs() < 1e-14));
}

/// Where the samples leave a choice, the shortest parameters in the scaled columns are taken, and the rank says so. By closed form: q₂ = −3 q₁ and
/// v = 0, so r = α q₁ + β is α/2 of q₁ and −α/6 of q₂, and of v nothing.
#[test]
fn dependent_columns_share_their_parameters() {
    let mut random = Random::named(5, "dependent");
    for count in [6, 40, 400] {
        let numbers: Vec<[Vec<f64>; 3]> = (0..count)
            .map(|_| {
                let [x, a, b] = [random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)];
                [vec![x, -3.0 * x], vec![0.0, 0.0], vec![a, b]]
            })
            .collect();
        let value = |[q, _, a]: &[Vec<f64>; 3]| vec![0.8 * q[0] - 0.3, 0.5 * a[1]];
        let samples: Vec<_> = numbers.iter().map(|all| (State::new(&all[0], &all[1], &all[2]), value(all))).collect();
        let (fit, rank) = Linear::fit(&samples).unwrap();
        // q, a₁, a₂, 1.
        assert_eq!(rank, 4);
        let due = [[0.4, -0.8 / 6.0, 0.0, 0.0, 0.0, 0.0, -0.3], [0.0, 0.0, 0.0, 0.0, 0.0, 0.5, 0.0]].concat();
        // Some roundings times the condition of four scaled columns, below 100.
        assert!(fit.theta().iter().zip(&due).all(|(found, due)| (found - due).abs() < 1e-13), "{count} {:?}", fit.theta());
    }
    // Fewer samples than parameters: all are met, by the shortest.
    let (q, v, a) = ([0.3], [0.5], [-0.4]);
    let (fit, rank) = Linear::fit(&[(State::new(&q, &v, &a), vec![2.0])]).unwrap();
    assert_eq!(rank, 1);
    // Each scaled column is ±1: each gives a quarter.
    let due = [0.5 / 0.3, 0.5 / 0.5, -0.5 / 0.4, 0.5];
    assert!(fit.theta().iter().zip(due).all(|(found, due)| (found - due).abs() < 1e-14), "{:?}", fit.theta());
    // Nothing but zeros has no rank but that of the constant.
    let still = [0.0];
    let (fit, rank) = Linear::fit(&[(State::new(&still, &still, &still), vec![2.0])]).unwrap();
    assert_eq!((rank, fit.theta()), (1, [0.0, 0.0, 0.0, 2.0].as_slice()));
}
