//! URDF 1.1 and 1.2: orientations as quaternions, versions, and attributes that have no part in a description.

use crate::share::one_of;
use featherbench_formats::urdf::{self, Options};
use featherbench_model::Description;
use featherbench_spatial::larger;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

/// A robot with an orientation at its joint and one at its inertial.
fn robot(version: &str, joint: &str, inertial: &str, limit: &str) -> String {
    format!(
        r#"<robot name="r" {version}><link name="base"/><link name="tip"><inertial><origin xyz="0.1 0.2 0.3" {inertial}/>
<mass value="2"/><inertia ixx="0.3" ixy="0" ixz="0" iyy="0.2" iyz="0" izz="0.15"/></inertial></link>
<joint name="j" type="revolute"><parent link="base"/><child link="tip"/><origin xyz="1 2 3" {joint}/>
<axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="5" velocity="3" {limit}/></joint></robot>"#
    )
}

fn import(text: &str) -> Result<(Description, Vec<String>), String> {
    let (robot, notes) = urdf::import(text, "r.urdf", &Options::default()).map_err(|error| error.to_string())?;
    Ok((robot, notes.iter().map(ToString::to_string).collect()))
}

/// The quaternion of roll, pitch and yaw, times a length.
fn quaternion([roll, pitch, yaw]: [f64; 3], length: f64) -> [f64; 4] {
    let [(sr, cr), (sp, cp), (sy, cy)] = [roll, pitch, yaw].map(|angle| (angle / 2.0).sin_cos());
    [sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy, cr * cp * sy - sr * sp * cy, cr * cp * cy + sr * sp * sy].map(|x| x * length)
}

fn words<const N: usize>(name: &str, numbers: [f64; N]) -> String {
    format!("{name}=\"{}\"", numbers.map(|x| format!("{x:e}")).join(" "))
}

/// Every number of the two robots that an orientation decides.
fn apart(a: &Description, b: &Description) -> f64 {
    let numbers =
        |robot: &Description| [&robot.bodies[0].joint.placement.rotation[..], &robot.bodies[0].inertia, &robot.bodies[0].com].concat();
    numbers(a).iter().zip(numbers(b)).map(|(a, b)| (a - b).abs()).fold(0.0, larger)
}

/// A quaternion from rounded half angles has an error of a few ulps of one: six rounded operations an entry, and twice that in a rotation.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

proptest! {
    #![proptest_config(ProptestConfig { cases: 1_000 / one_of(4) as u32, failure_persistence: None, rng_seed: RngSeed::Fixed(44), ..ProptestConfig::default() })]

    /// The same robot by angles and by quaternions of any length. A length other than one is told. Where the version knows no
    /// quaternions, each is told by name, and the robot is that without them.
    #[test]
    fn a_quaternion_is_the_rotation_of_its_angles(
        angles in [-7.0..7.0_f64, -1.6..1.6, -7.0..7.0],
        exponent in prop_oneof![2 => Just(0), 3 => -160..160_i32],
        version in prop::sample::select(vec!["", r#"version="1.0""#, r#"version="1.1""#, r#"version="1.2""#]),
        inertial in any::<bool>(),
    ) {
        let length = 10_f64.powi(exponent);
        let (rpy, quat) = (words("rpy", angles), words("quat_xyzw", quaternion(angles, length)));
        let both = |word: &str| if inertial { robot(version, "", word, "") } else { robot(version, word, "", "") };
        let (turned, said) = import(&both(&quat)).expect("a quaternion");
        let knows = version.contains("1.1") || version.contains("1.2");
        let (same, _) = import(&both(if knows { &rpy } else { "" })).expect("angles");
        prop_assert!(apart(&turned, &same) <= ROUNDING, "{:e} {turned:?} {same:?}", apart(&turned, &same));
        let due = match (knows, exponent) {
            (false, _) => vec!["quat_xyzw in <origin> (it needs <robot version=\"1.1\">) is not read"],
            (true, 0) => vec![],
            (true, _) => vec!["the quaternion of", "it is normalised"],
        };
        prop_assert_eq!(said.len(), usize::from(!due.is_empty()), "{:?}", said);
        prop_assert!(due.iter().all(|part| said[0].contains(part)), "{:?}", said);
        // Both in one <origin> have no meaning where both are known.
        let twice = import(&both(&format!("{quat} {rpy}")));
        prop_assert_eq!(twice.is_err(), knows);
        if let Err(error) = twice {
            prop_assert!(error.contains("both rpy and quat_xyzw") && error.contains(if inertial { "link 'tip'" } else { "joint 'j'" }), "{}", error);
        }
    }

    /// An attribute that is not read is told by its name and its element, whatever it is and wherever it stands.
    #[test]
    fn an_attribute_that_is_not_read_is_told(
        name in prop_oneof![3 => prop::sample::select(vec!["acceleration", "deceleration", "jerk"]).prop_map(str::to_owned), 2 => "[a-z]{12}"],
        at in prop::sample::select(vec!["robot", "link", "joint", "inertial", "mass", "inertia", "origin", "parent", "child", "axis", "limit"]),
        value in 0.0..100.0_f64,
    ) {
        let text = robot(r#"version="1.2""#, "", "", "");
        let (plain, silent) = import(&text).expect("a robot");
        prop_assert!(silent.is_empty(), "{:?}", silent);
        // "<inertia" begins "<inertial" too.
        let end = if at == "inertial" { '>' } else { ' ' };
        let more = text.replacen(&format!("<{at}{end}"), &format!("<{at} {name}=\"{value}\"{end}"), 1);
        let (same, said) = import(&more).expect("the same robot");
        prop_assert_eq!(same, plain);
        prop_assert_eq!(said.len(), 1);
        prop_assert!(said[0].contains(&format!("{name} in <{at}> is not read")), "{:?}", said);
    }
}

/// A version is x.y, from 1.0 to 1.2: the specification demands that others are refused.
#[test]
fn a_version_that_is_not_known_is_refused() {
    for good in ["1.0", "1.1", "1.2"] {
        assert!(import(&robot(&format!("version=\"{good}\""), "", "", "")).is_ok(), "{good}");
    }
    for bad in ["", "1", "1.3", "2.0", "0.9", "1.0.0", "1.1~pre6", "+1.1", "-1.0", " 1.0", "x", "1.", "99999999999.0"] {
        let error = import(&robot(&format!("version=\"{bad}\""), "", "", "")).expect_err(bad);
        assert!(error.starts_with("r.urdf:1:1: ") && error.contains(&format!("'{bad}'")) && error.contains("1.0, 1.1 and 1.2"), "{error}");
    }
}

/// A quaternion of zeros is no orientation. (urdfdom takes it for the identity.)
#[test]
fn a_quaternion_of_zeros_is_refused() {
    let error = import(&robot(r#"version="1.1""#, r#"quat_xyzw="0 0 0 -0""#, "", "")).expect_err("no orientation");
    assert!(error.starts_with("r.urdf:3:") && error.contains("quat_xyzw of joint 'j' is 0 0 0 0, which is no orientation"), "{error}");
    for (bad, part) in [("0 0 1", "is not four numbers"), ("0 0 nan 1", "is not finite"), ("0 0 1 x", "is not four numbers")] {
        let error = import(&robot(r#"version="1.1""#, "", &format!("quat_xyzw=\"{bad}\""), "")).expect_err(bad);
        assert!(error.contains(part) && error.contains("link 'tip'"), "{error}");
    }
}
