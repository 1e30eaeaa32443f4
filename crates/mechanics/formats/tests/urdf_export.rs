//! URDF out: what is written is imported again, to the bit where URDF can express it, and a second round trip changes nothing.

use crate::robots;
use crate::share::one_of;
use crate::support::chain;
use featherbench_formats::urdf::{self, Options};
use featherbench_formats::{ExportError, Loss, OnLoss, Reason, neutral};
use featherbench_model::{BodyDescription, Description, Frame, JointDescription, JointType, Placement};
use featherbench_spatial::largest;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use std::path::Path;

const OPTIONS: Options = Options { base: urdf::Base::Fixed, allow_massless: true, independent_mimics: false };

fn read(text: &str) -> Description {
    urdf::import(text, "written.urdf", &OPTIONS).unwrap_or_else(|error| panic!("{error}\n{text}")).0
}

/// Two round trips. Everything but rotations must be equal to the bit, rotations within 8ε, and the second trip must change nothing.
fn round_trip(robot: &Description, on_loss: OnLoss) -> (Description, Vec<Loss>) {
    let (text, losses) = urdf::to_string(robot, on_loss).unwrap_or_else(|error| panic!("{}: {error}", robot.name));
    let once = read(&text);
    let (again, still) = urdf::to_string(&once, on_loss).unwrap_or_else(|error| panic!("{}: {error}", robot.name));
    assert_eq!(again, text.lines().filter(|line| !line.contains("<!--")).map(|line| format!("{line}\n")).collect::<String>());
    // A prismatic joint that has no limits now still lacks them.
    assert!(still.iter().all(|loss| loss.reason == Reason::IncompleteLimits), "{still:?}");
    assert_eq!(read(&again), once, "{}", robot.name);
    (once, losses)
}

/// What a description becomes in URDF when nothing is lost: its canonical form with the world's frame, and without lists of zeros.
fn expected(robot: &Description) -> Description {
    let mut robot = robot.canonical().expect("canonical");
    robot.provenance = None;
    for joint in robot.bodies.iter_mut().map(|body| &mut body.joint) {
        joint.armature.clear();
        if joint.kind.nv() != 1 {
            joint.damping.clear();
            joint.friction.clear();
        }
    }
    if !robot.frames.iter().any(|frame| frame.name == "world") {
        robot.frames.insert(0, Frame { name: "world".to_owned(), body: None, placement: Placement::default() });
    }
    robot
}

/// Asserts equality, of rotations within 8ε. Returns how many rotations are equal to the bit, and how many there are.
fn assert_same(read: &Description, expected: &Description) -> (usize, usize) {
    let mut exact = (0, 0);
    let mut level = read.clone();
    let pairs =
        level.bodies.iter_mut().map(|body| &mut body.joint.placement).chain(level.frames.iter_mut().map(|frame| &mut frame.placement));
    let wanted = expected.bodies.iter().map(|body| &body.joint.placement).chain(expected.frames.iter().map(|frame| &frame.placement));
    for (placement, wanted) in pairs.zip(wanted) {
        let error = largest(placement.rotation.iter().zip(&wanted.rotation).map(|(a, b)| a - b));
        assert!(error <= 8.0 * f64::EPSILON, "{}: {error:e}", read.name);
        exact = (exact.0 + usize::from(error == 0.0), exact.1 + 1);
        placement.rotation = wanted.rotation;
    }
    assert_eq!(&level, expected);
    exact
}

#[test]
fn every_committed_robot_goes_round() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../datasets/models");
    let (mut met, mut rotations, mut whole, mut in_part) = (0, 0, 0, 0);
    for entry in std::fs::read_dir(folder).expect("the folder exists") {
        let path = entry.expect("an entry").path();
        if path.extension().is_none_or(|extension| extension != "json") {
            continue;
        }
        let robot = neutral::read(&path).unwrap_or_else(|error| panic!("{error}"));
        match urdf::to_string(&robot, OnLoss::Refuse) {
            Ok(_) => {
                let (exact, of) = assert_same(&round_trip(&robot, OnLoss::Refuse).0, &expected(&robot));
                (met, rotations, whole) = (met + exact, rotations + of, whole + 1);
            }
            Err(ExportError::Inexpressible { losses, .. }) => {
                assert!(robot.provenance.is_none(), "real robots came from URDF: {losses:?}");
                if losses.iter().all(|loss| loss.reason.can_be_left_out()) {
                    let (once, left_out) = round_trip(&robot, OnLoss::LeaveOut);
                    assert_eq!((left_out, once.nv()), (losses, robot.nv()));
                    in_part += 1;
                }
            }
            Err(error) => panic!("{}: {error}", path.display()),
        }
    }
    assert!(whole >= 15 && in_part >= 15, "{whole} written whole, {in_part} in part");
    // Angles cannot express the products of a merged link's rotations to the bit; they can express all others.
    assert!(met * 10 > rotations * 9, "{met} of {rotations} rotations to the bit");
}

/// Everything that URDF cannot hold is listed by name, with advice.
#[test]
fn what_urdf_lacks_is_refused_by_name() {
    let body = |name: &str, parent, kind: JointType| {
        let joint = JointDescription { name: format!("{name}_joint"), kind, ..JointDescription::default() };
        BodyDescription { name: name.to_owned(), parent, mass: 1.0, com: [0.0; 3], inertia: [1.0, 0.0, 0.0, 1.0, 0.0, 1.0], joint }
    };
    // Rotations and axes that deviate slightly are normalised; they are not errors.
    let (x, turned) = ([1.0, 0.0, 0.0], [1.0, 1e-9, 0.0, -1e-8, 1.0, 0.0, 0.0, 0.0, 1.0]);
    let mut bodies = vec![
        body("screw", None, JointType::Helical { axis: x, pitch: 0.1 }),
        body("ball", Some(0), JointType::Spherical),
        body("cross", Some(1), JointType::Universal),
        body("motor", Some(2), JointType::Revolute { axis: [0.6, 0.8 + 1e-9, 0.0] }),
        body("sled", Some(3), JointType::Planar),
        body("half", Some(4), JointType::Revolute { axis: x }),
        body("slide", Some(5), JointType::Prismatic { axis: x }),
        body("world", Some(6), JointType::Free),
        body("motor\n", Some(6), JointType::Free),
    ];
    bodies[3].joint.armature = vec![0.1];
    bodies[4].joint.damping = vec![0.0, 0.1, 0.0];
    bodies[4].joint.upper = vec![1.0; 3];
    bodies[5].joint.lower = vec![-1.0];
    bodies[5].joint.placement.rotation = turned;
    bodies[8].joint.name = "screw_joint".to_owned();
    let frame = Frame { name: "ball".to_owned(), body: Some(2), placement: Placement { rotation: turned, ..Placement::default() } };
    let robot = Description { name: "odd".to_owned(), gravity: [0.0, 0.0, -1.6], bodies, frames: vec![frame], ..Description::default() };

    let Err(ExportError::Inexpressible { losses, .. }) = urdf::to_string(&robot, OnLoss::Refuse) else { panic!("refused") };
    let told: Vec<String> = losses.iter().map(ToString::to_string).collect();
    let expected = [
        "the robot: gravity",
        "joint 'screw_joint': helical joint",
        "joint 'ball_joint': spherical joint",
        "joint 'cross_joint': universal joint",
        "joint 'motor_joint': armature",
        "joint 'sled_joint': damping, for which the format has a place on joints with one degree of freedom only",
        "joint 'sled_joint': upper",
        "joint 'half_joint': limits in part",
        "joint 'slide_joint': limits in part",
        "body 'world': the name 'world' is the root's own",
        "body 'motor\\n': a name that is empty, holds a control character or reads as a macro",
        "joint 'screw_joint': the name stands twice",
        "frame 'ball': the name stands twice",
    ];
    assert_eq!(told.len(), expected.len(), "{told:#?}");
    for (told, expected) in told.iter().zip(expected) {
        assert!(told.starts_with(expected), "{told} is not about {expected}");
    }
    // Leaving out helps only where the rest is still the robot.
    let Err(error) = urdf::to_string(&robot, OnLoss::LeaveOut) else { panic!("refused") };
    let message = error.to_string();
    assert!(message.starts_with("URDF cannot hold this robot:\n- joint 'screw_joint': helical joint"), "{message}");
    assert!(!message.contains("gravity") && message.contains("'ball_joint'"), "{message}");
}

#[test]
fn files_are_written_whole_or_not_at_all() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("robot.urdf");
    let mut robot = chain(3);
    urdf::write(&robot, &path, OnLoss::Refuse).expect("written");
    let text = std::fs::read_to_string(&path).expect("there");
    assert_eq!(urdf::read(&path, &OPTIONS).expect("readable").0.bodies, robot.bodies);
    robot.gravity = [0.0; 3];
    assert!(urdf::write(&robot, &path, OnLoss::Refuse).is_err());
    assert_eq!(std::fs::read_to_string(&path).expect("still there"), text);
    let error = urdf::write(&robot, folder.path().join("no/such/folder.urdf"), OnLoss::LeaveOut).expect_err("no folder").to_string();
    assert!(error.contains("folder.urdf: the file cannot be written"), "{error}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 512 / one_of(4) as u32, failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

    #[test]
    fn any_robot_goes_round(robot in robots::of(&[robots::Kind::Revolute, robots::Kind::Prismatic, robots::Kind::Planar, robots::Kind::Free])) {
        let robot = Description { gravity: [0.0, 0.0, -9.81], ..robot };
        let (mut once, _) = round_trip(&robot, OnLoss::LeaveOut);
        let mut wanted = expected(&robot);
        // The import has frames in depth-first order; here they had any order.
        for frames in [&mut once.frames, &mut wanted.frames] {
            frames.sort_by(|a, b| a.name.cmp(&b.name));
        }
        // Only incomplete limits are left out.
        for joint in wanted.bodies.iter_mut().map(|body| &mut body.joint) {
            let turns = matches!(joint.kind, JointType::Revolute { .. });
            let given = [&joint.lower, &joint.upper, &joint.velocity, &joint.effort].map(|list| !list.is_empty());
            if !(given == [true; 4] || turns && given == [false, false, true, true]) {
                for list in [&mut joint.lower, &mut joint.upper, &mut joint.velocity, &mut joint.effort] {
                    list.clear();
                }
            }
        }
        assert_same(&once, &wanted);
    }
}
