//! The scales of forward dynamics, on the two slides of `robots.rs`: M = [9 4; 4 4], τ − h = (6, −4), a = (2, −3).

use super::close;
use super::robots::two_slides;
use featherbench_bench::measure::ForwardScale;

#[track_caller]
fn same(found: f64, due: f64) {
    assert!(close(found, due), "{found:e} instead of {due:e}");
}

/// D^-½ M D^-½ = [1 ⅔; ⅔ 1] has the eigenvalues 1 ± ⅔. The terms of the residual at a are w = ĥ + |τ| + Σ_j √(M_ii·M_jj)|a_j| =
/// (22.5 + 19.5 + 9·2 + 6·3, 10 + 2 + 6·2 + 4·3) = (78, 36), and ‖a‖_M² = 6·2 + 4·3 = 24.
#[test]
fn condition_and_amplification_of_two_slides() {
    let robot = two_slides(4.0);
    let at = robot.magnitudes();
    let scales = ForwardScale::all(&robot, &at);
    assert_eq!(scales.len(), 1);
    same(scales[0].condition, 5.0);
    // 2·√(78²/9 + 36²/4)/√(24/3)
    same(scales[0].amplification, 2.0 * (676.0_f64 + 324.0).sqrt() / 8.0_f64.sqrt());
}

#[test]
fn errors_of_two_slides() {
    let robot = two_slides(4.0);
    let at = robot.magnitudes();
    let scale = &ForwardScale::all(&robot, &at)[0];
    let right = [2.0, -3.0];
    assert_eq!((scale.backward_error(&right), scale.residual(&right), scale.forward_error(&right, &right)), (0.0, 0.0, 0.0));

    // Δa = (½, 0): residual M Δa = (4.5, 2), w = (42 + 22.5 + 18, 12 + 15 + 12); ‖Δa‖_M² = 9/4; ‖τ − h‖² = 36 + 16.
    let wrong = [2.5, -3.0];
    same(scale.backward_error(&wrong), 4.5 / 82.5);
    same(scale.residual(&wrong), (24.25_f64 / 52.0).sqrt());
    same(scale.forward_error(&right, &wrong), (2.25_f64 / 24.0).sqrt());

    // Δa = (0, −½): residual (−2, −2), w = (42 + 18 + 21, 12 + 12 + 14).
    let wrong = [2.0, -3.5];
    same(scale.backward_error(&wrong), 2.0 / 38.0);
    same(scale.residual(&wrong), (8.0_f64 / 52.0).sqrt());
    same(scale.forward_error(&right, &wrong), (1.0_f64 / 24.0).sqrt());

    for wrong in [[f64::NAN, -3.0], [2.0, f64::NAN]] {
        assert!(scale.backward_error(&wrong).is_nan() && scale.residual(&wrong).is_nan() && scale.forward_error(&right, &wrong).is_nan());
    }
    // An answer with a missing number has no error that could pass.
    let short = &right[..1];
    assert!(scale.backward_error(short).is_nan() && scale.residual(short).is_nan() && scale.forward_error(&right, short).is_nan());
}

/// A tip without mass: M is singular, and no answer is right, not even the one whose residual is exactly zero.
#[test]
fn nothing_passes_where_the_mass_matrix_is_singular() {
    let mut robot = two_slides(0.0);
    // h = 1.5·(5, 0), and so a = 0 leaves no residual.
    robot.states.tau = vec![7.5, 0.0];
    let at = robot.magnitudes();
    let scale = &ForwardScale::all(&robot, &at)[0];
    assert!(scale.condition.is_nan() && scale.amplification.is_nan());
    for a in [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0]] {
        assert!(scale.backward_error(&a).is_nan(), "{a:?}");
        assert!(scale.forward_error(&[0.0, 0.0], &a).is_nan() && scale.forward_error(&a, &a).is_nan(), "{a:?}");
    }
}
