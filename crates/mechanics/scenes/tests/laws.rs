//! Laws of contact models by a second route.

use featherbench_scenes::{Fit, SoftContact, block_step_felt};

/// The inverse mass of a contact by vectors and a matrix inverse, where the law has products and Cramer's rule.
#[test]
fn a_block_step_turns_friction_away_from_the_slip() {
    use nalgebra::{Matrix2, Vector2, Vector3};
    let (mass, moment) = (1.0, 0.125);
    let arms = [[0.5, 0.5, -0.1], [-0.5, 0.5, -0.1], [-0.5, -0.5, -0.1], [0.5, -0.5, -0.1]];
    for degrees in [0.0_f64, 15.0, 45.0, 70.0, 90.0] {
        let heading = degrees.to_radians();
        let slip = Vector2::new(heading.cos(), heading.sin());
        let along = |arm: [f64; 3]| {
            let turned = [Vector3::x(), Vector3::y()].map(|axis| Vector3::from(arm).cross(&axis));
            let seen = Matrix2::from_fn(|i, j| turned[i].dot(&turned[j]) / moment + if i == j { 1.0 / mass } else { 0.0 });
            (seen.try_inverse().unwrap() * slip).normalize().dot(&slip)
        };
        let due = arms.map(along).iter().sum::<f64>() / 4.0;
        assert!((block_step_felt(heading, &arms, mass, moment) - due).abs() < 1e-15, "{degrees}");
    }
    // By hand: K = (3.08, −2; −2, 3.08) at a corner, so e_x is turned to (3.08, 2); the diagonals are its axes.
    assert!((block_step_felt(0.0, &arms, mass, moment) - 3.08 / 3.08_f64.hypot(2.0)).abs() < 1e-15);
    assert!((block_step_felt(std::f64::consts::FRAC_PI_4, &arms, mass, moment) - 1.0).abs() < 1e-15);
}

/// At rest the soft contact carries its load: the two sides of its equation, and the creep of a box on four corners at 20°.
#[test]
fn a_soft_contact_creeps() {
    let soft = SoftContact::default();
    let (sine, cosine) = 20.0_f64.to_radians().sin_cos();
    let (normal, tangential) = (9.81 * cosine / 4.0, 9.81 * sine / 4.0);
    let r = soft.penetration(normal, 1.0);
    let (d, k) = (soft.impedance_at(r), 1.0 / (0.95_f64 * 0.02).powi(2));
    assert!(((1.0 - d) / d * normal - k * r).abs() < 1e-12 && r > 0.0);
    let creep = soft.creep(tangential, normal, 1.0);
    // The largest foot's load of MuJoCo's own run is 15 % more; this is the mean's, and its known 8.75e-4 has three digits.
    assert!((creep / 8.75e-4 - 1.0).abs() < 5e-3, "{creep:e}");
    assert!((SoftContact { ratio: 100.0, ..soft }.creep(tangential, normal, 1.0) * 100.0 - creep).abs() < 1e-18);
    assert_eq!((soft.impedance_at(0.0), soft.impedance_at(1.0), soft.impedance_at(5e-4)), (0.9, 0.95, 0.925));
}

#[test]
fn a_line_needs_two_steps_and_numbers() {
    assert_eq!(Fit::of(&[(1e-3, 1.0)]), None);
    assert_eq!(Fit::of(&[(1e-3, 1.0), (1e-3, 2.0)]), None);
    assert_eq!(Fit::of(&[(1e-3, 1.0), (2e-3, f64::NAN)]), None);
    let bent = Fit::of(&[(4e-3, 16.0), (2e-3, 4.0), (1e-3, 1.0)]).unwrap();
    assert!(bent.off > 0.5, "a parabola is no line");
}
