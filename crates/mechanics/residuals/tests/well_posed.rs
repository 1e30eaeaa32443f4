//! M + ∂r/∂a must be regular.

use crate::support::{apart, cart, lesson};
use featherbench_model::Model;
use featherbench_residuals::{Corrected, Linear, Nominal, Residual, ResidualError, Rigid, State, WELL_POSED, WellPosed};
use nalgebra::DMatrix;

/// r = factor · a of one dof.
fn of_acceleration(factor: f64) -> Linear {
    Linear::new(1, 1, vec![0.0, 0.0, factor, 0.0]).unwrap()
}

/// m a + α a = τ: α = −m has no answer (or all of them), any other α has τ / (m + α). d = −r = m a is the lesson's case m − a = 0.
#[test]
fn a_residual_that_cancels_the_mass_is_refused() {
    let model = cart(2.0);
    for (factor, right) in
        [(1.0, true), (-1.0, true), (-2.0, false), (-2.0 * (1.0 - 1e-13), false), (-2.0 * (1.0 - 1e-11), true), (-3.0, true)]
    {
        let mut corrected = Corrected::new(Rigid::new(&model), of_acceleration(factor)).unwrap();
        let answer = corrected.forward(&[0.0], &[0.0], &[3.0]);
        match answer {
            Ok(a) => {
                assert!(right, "{factor}");
                // ½ ulp of M and of α, over what is left of them.
                let most = 4.0 * f64::EPSILON * 2.0 / (2.0 + factor).abs();
                assert!((a[0] * (2.0 + factor) / 3.0 - 1.0).abs() < most, "{factor}: {a:?}");
            }
            Err(ResidualError::IllPosed { reciprocal_condition, threshold }) => {
                assert!(!right && reciprocal_condition < threshold && threshold == WELL_POSED, "{factor}");
            }
            Err(other) => panic!("{factor}: {other}"),
        }
    }
    let message =
        Corrected::new(Rigid::new(&model), of_acceleration(-2.0)).unwrap().forward(&[0.0], &[0.0], &[3.0]).unwrap_err().to_string();
    assert!(message.contains("the acceleration is not determined"), "{message}");
}

/// On an arm: ∂r/∂a = −M + w wᵀ has rank one, and is refused at that configuration alone. Units do not count.
#[test]
fn rank_decides_and_units_do_not() {
    let model = Model::build(&lesson()).unwrap();
    let mass = Rigid::new(&model).mass_matrix(&[0.3, -0.5]).unwrap();
    let w = nalgebra::DVector::from_vec(vec![0.7, -0.4]);
    let singular = &w * w.transpose() - &mass;
    assert!(matches!(WellPosed::of(&mass, &singular), Err(ResidualError::IllPosed { .. })));
    let none = DMatrix::zeros(2, 2);
    let plain = WellPosed::of(&mass, &none).unwrap();
    assert!(plain.smallest_eigenvalue > 0.0);
    // Metres in millimetres: dof 1 counts 1000 times, M is scaled from both sides, and nothing changes.
    let units = DMatrix::from_diagonal(&nalgebra::DVector::from_vec(vec![1.0, 1e3]));
    let scaled = WellPosed::of(&(&units * &mass * &units), &none).unwrap();
    assert!((scaled.reciprocal_condition / plain.reciprocal_condition - 1.0).abs() < 1e-12);
    // An indefinite W that is regular has an answer, and its smallest eigenvalue says what it is.
    assert!(WellPosed::of(&mass, &(&mass * -3.0)).unwrap().smallest_eigenvalue < 0.0);
}

/// r = β a³: Newton's method, against the formula of Cardano for m a + β a³ = τ.
#[test]
fn nonlinear_accelerations_are_found() {
    #[derive(Debug)]
    struct Cubic(f64);
    impl Residual for Cubic {
        fn nv(&self) -> usize {
            1
        }
        fn add(&self, state: &State<'_>, r: &mut [f64]) -> Result<(), ResidualError> {
            r[0] += self.0 * state.a[0].powi(3);
            Ok(())
        }
        fn has_acceleration(&self) -> bool {
            true
        }
        fn add_by_acceleration(&self, state: &State<'_>, matrix: &mut DMatrix<f64>) -> Result<(), ResidualError> {
            matrix[(0, 0)] += 3.0 * self.0 * state.a[0].powi(2);
            Ok(())
        }
    }
    let model = cart(2.0);
    for (beta, tau) in [(0.1, 3.0), (5.0, -7.0), (1e3, 0.02)] {
        let a = Corrected::new(Rigid::new(&model), Cubic(beta)).unwrap().forward(&[0.0], &[0.0], &[tau]).unwrap()[0];
        let (p, half) = (2.0 / beta, tau / (2.0 * beta));
        let root = (half * half + p * p * p / 27.0_f64).sqrt();
        // The other root by its product with this one, −p/3: their sum cancels.
        let first = (half + root.copysign(half)).cbrt();
        let due = first - p / (3.0 * first);
        assert!((a - due).abs() < 1e-13 * due.abs() * 10.0, "{beta}: {a} {due}");
        assert!(apart(&[2.0 * a + beta * a.powi(3)], &[tau]) < 1e-14);
    }
}
