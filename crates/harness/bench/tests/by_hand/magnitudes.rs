//! Every field of [`Magnitudes`]. In the comments, |·| is a length, v_J and a_J are the joint's own velocity and acceleration, p the parent.

use super::assert_close;
use super::robots::{free_and_spherical, two_screws, two_slides};
use featherbench_bench::measure::Magnitudes;

/// Joint 1: |ω_J| = 3, |v_J| = 1.5, |α_J| = 2, |a_J| = 1. Joint 2: |ω_J| = 2, |v_J| = 0.5, |α_J| = 4, |a_J| = 1.
///
/// The angular velocities themselves: |ω_1| = 3, and ω_2 = Rᵀω_1 + ω_J, where Rᵀω_1 = (0, 3, 0) before the rotation about u and ω_J = −2u:
/// |ω_2|² = 9 + 4 − 2·2·3·0.6 = 5.8.
#[test]
fn two_screws_have_these_magnitudes() {
    let at = Magnitudes::new(&two_screws(), 0);
    let spin: f64 = 5.8_f64.sqrt();

    // |mount| + |pitch·q|: 5 + 0.5, and 3 + 0.5 more.
    assert_close("reach", &at.reach, &[5.5, 9.0]);
    // The farther of the centre of mass and the next joint: 0.75 or 3; 0.5.
    assert_close("size", &at.size, &[3.0, 0.5]);
    // Σ|ω_J|
    assert_close("angular velocity", &at.angular_velocity, &[3.0, 5.0]);
    // v_p + ω_p·step + |v_J|: 1.5, and 1.5 + 3·3.5 + 0.5.
    assert_close("linear velocity", &at.linear_velocity, &[1.5, 12.5]);
    // α_p + (|ω_p| + |ω_J|)·|ω_J| + |α_J|: 3·3 + 2, and 11 + (3 + 2)·2 + 4.
    assert_close("angular acceleration", &at.angular_acceleration, &[11.0, 25.0]);
    // a_p + (α_p + |ω_p|²)·step + (2|ω_p| + |ω|)·|v_J| + |a_J|: 3·1.5 + 1, and 5.5 + (11 + 9)·3.5 + (6 + √5.8)·0.5 + 1.
    assert_close("linear acceleration", &at.linear_acceleration, &[5.5, 79.5 + spin / 2.0]);

    // Turning is α + |ω|²: 11 + 9 = 20 and 25 + 5.8 = 30.8. Falling is a + g + |ω|·v: 5.5 + 5 + 3·1.5 = 15, and the sum below.
    let falling = 79.5 + spin / 2.0 + 5.0 + spin * 12.5;
    // Moment |Ī|·turning + |h|·falling and force m·falling + |h|·turning.
    let frobenius = 13.78_f64.sqrt();
    let (moment, force) = (frobenius * 20.0 + 1.5 * 15.0, 2.0 * 15.0 + 1.5 * 20.0);
    let (tip_moment, tip_force) = (3.0 * 30.8 + 2.0 * falling, 4.0 * falling + 2.0 * 30.8);
    // The parent gets force and moment, and the moment of the force at the end of the step of 3.5.
    // τ = |S_ang|·moment + |S_lin|·force + armature·|a|, S_lin the pitch.
    let of = |moment: f64, force: f64, tip_moment: f64, tip_force: f64| {
        let (moment, force) = (moment + tip_moment + 3.5 * tip_force, force + tip_force);
        [moment + 0.5 * force, tip_moment + 0.25 * tip_force]
    };
    let armature = [0.7 * 2.0, 0.3 * 4.0];
    let [first, second] = of(moment, force, tip_moment, tip_force);
    assert_close("joint force", &at.joint_force, &[first + armature[0], second + armature[1]]);
    // Wrenches add their lengths.
    let [first, second] = of(moment + 7.0, force + 9.0, tip_moment + 11.0, tip_force + 5.0);
    assert_close("joint force with wrenches", &at.joint_force_wrench, &[first + armature[0], second + armature[1]]);

    // Without accelerations α is 9 and 9 + 10, a is 4.5 and 4.5 + (9 + 9)·3.5 + (6 + √5.8)·0.5, and armature adds nothing.
    let falling = 70.5 + spin / 2.0 + 5.0 + spin * 12.5;
    let (moment, force) = (frobenius * 18.0 + 1.5 * 14.0, 2.0 * 14.0 + 1.5 * 18.0);
    let expected = of(moment, force, 3.0 * 24.8 + 2.0 * falling, 4.0 * falling + 2.0 * 24.8);
    assert_close("bias force", &at.bias_force, &expected);
}

/// Joint 1: |ω_J| = 3, |v_J| = 2, |α_J| = 0.5, |a_J| = 1. Joint 2: |ω_J| = 4, |α_J| = 6; ω_2 = (0, 3, 4), of length 5.
#[test]
fn free_and_spherical_joints_have_these_magnitudes() {
    let at = Magnitudes::new(&free_and_spherical(), 0);
    assert_close("reach", &at.reach, &[2.0 + 3.0, 5.5]);
    assert_close("size", &at.size, &[0.5, 1.5]);
    assert_close("angular velocity", &at.angular_velocity, &[3.0, 7.0]);
    // 2, and 2 + 3·0.5.
    assert_close("linear velocity", &at.linear_velocity, &[2.0, 3.5]);
    // 3·3 + 0.5, and 9.5 + (3 + 4)·4 + 6.
    assert_close("angular acceleration", &at.angular_acceleration, &[9.5, 43.5]);
    // 3·2 + 1, and 7 + (9.5 + 9)·0.5.
    assert_close("linear acceleration", &at.linear_acceleration, &[7.0, 16.25]);

    // The first body is balanced: its first moment counts an eighth of mass times radius of gyration, 3·√(½·5/3)/8.
    let lever = 7.5_f64.sqrt() / 8.0;
    assert_close("first moment", &at.lever, &[lever, 3.0]);
    // Turning 18.5 and 43.5 + 25 = 68.5; falling 7 + 5 + 3·2 = 18 and 16.25 + 5 + 5·3.5 = 38.75.
    let (tip_moment, tip_force) = (51.0_f64.sqrt() * 68.5 + 3.0 * 38.75, 2.0 * 38.75 + 3.0 * 68.5);
    let (force, moment) = (3.0 * 18.0 + lever * 18.5 + tip_force, 3.0 * 18.5 + lever * 18.0 + tip_moment + 0.5 * tip_force);
    // Forces before moments, as the dofs of a free joint are; the armature of 0.2 is multiplied by |a| = 6.
    let expected = [[force; 3], [moment; 3], [tip_moment, tip_moment + 0.2 * 6.0, tip_moment]].concat();
    assert_close("joint force", &at.joint_force, &expected);
    assert_close("joint force with wrenches of zero", &at.joint_force_wrench, &expected);

    // Without accelerations α is 9 and 9 + 28, a is 6 and 6 + (9 + 9)·0.5.
    let (tip_moment, tip_force) = (51.0_f64.sqrt() * (37.0 + 25.0) + 3.0 * (15.0 + 5.0 + 17.5), 2.0 * 37.5 + 3.0 * 62.0);
    let own = (3.0 * 17.0 + lever * 18.0, 3.0 * 18.0 + lever * 17.0);
    let (force, moment) = (own.0 + tip_force, own.1 + tip_moment + 0.5 * tip_force);
    assert_close("bias force", &at.bias_force, &[[force; 3], [moment; 3], [tip_moment; 3]].concat());
}

/// Slides at rest have the length of gravity, whatever its direction: m·2.5. A body without mass has no centre of mass and no size.
#[test]
fn slides_at_rest_carry_the_weight_alone() {
    let at = Magnitudes::new(&two_slides(4.0), 0);
    for forces in [&at.joint_force, &at.joint_force_wrench, &at.bias_force] {
        assert_close("weight", forces, &[9.0 * 2.5, 4.0 * 2.5]);
    }
    let at = Magnitudes::new(&two_slides(0.0), 0);
    assert_eq!((at.size[1], at.lever[1], at.bias_force), (0.0, 0.0, vec![12.5, 0.0]));
    // The first has its centre of mass at its origin, and counts an eighth of its radius of gyration.
    assert_close("size", &at.size[..1], &[1.5_f64.sqrt() / 8.0]);
}
