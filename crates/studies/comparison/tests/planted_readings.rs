//! Two import results of one robot with one planted difference: its place and its field are named, and nothing else is.
//!
//! Four hundred differences, drawn by seed over ten committed robots, as an engine's parser might cause them.

use featherbench_bench::ImportNote;
use featherbench_comparison::import::{Cause, Comparison, Difference, Field, Weight};
use featherbench_formats::neutral;
use featherbench_model::{BodyDescription, Description, JointType, Placement};
use featherbench_robots::Random;
use featherbench_spatial::{Mat3, Sym3, Transform, Vec3};
use std::path::Path;

const ROBOTS: [&str; 10] =
    ["panda", "hyq", "g1", "g1_with_hands", "baxter", "centauro", "allegro_right", "simple_humanoid", "anymal_c", "xarm7"];
/// Planted differences: forty on each robot.
const PLANTS: u64 = 400;

fn robot(name: &str) -> Description {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../../../datasets/models/{name}.json"));
    neutral::read(path).unwrap().canonical().unwrap()
}

/// An edit by a parser.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Plant {
    Mass,
    Axis,
    Flip,
    InertialRotation,
    Armature,
    Order,
    Moved,
    Turned,
    MillimetresOfPlacement,
    Grams,
    ComSign,
    OffDiagonals,
    AboutOrigin,
    TransposedPlacement,
}

const ALL: [Plant; 14] = [
    Plant::Mass,
    Plant::Axis,
    Plant::Flip,
    Plant::InertialRotation,
    Plant::Armature,
    Plant::Order,
    Plant::Moved,
    Plant::Turned,
    Plant::MillimetresOfPlacement,
    Plant::Grams,
    Plant::ComSign,
    Plant::OffDiagonals,
    Plant::AboutOrigin,
    Plant::TransposedPlacement,
];

/// Whether a rotation is not its own transpose.
fn asymmetric(rotation: [f64; 9]) -> bool {
    [(1, 3), (2, 6), (5, 7)].into_iter().any(|(i, j)| (rotation[i] - rotation[j]).abs() > 1e-3)
}

/// What must be found: the body and field, and the cause if numbers alone determine it.
type Expected = (String, Field, Option<Cause>);

fn rotation(random: &mut Random) -> Mat3<f64> {
    let angle = random.uniform(0.1, 1.0);
    Transform::axis_rotation(Vec3::from_array(random.direction()), angle.sin(), angle.cos())
}

/// Plants into a body that has the necessary property.
fn sow(description: &mut Description, plant: Plant, random: &mut Random) -> Expected {
    if plant == Plant::Order {
        return reorder(description, random);
    }
    let fits = |body: &BodyDescription| match plant {
        Plant::Mass | Plant::Grams => body.mass > 0.0,
        Plant::Axis | Plant::Flip => body.joint.kind.axis().is_some(),
        Plant::InertialRotation => {
            let [xx, xy, xz, yy, yz, zz] = body.inertia;
            [xy, xz, yz].iter().any(|x| *x != 0.0) || xx != yy || yy != zz
        }
        Plant::Armature => body.joint.kind.nv() == 1,
        Plant::MillimetresOfPlacement => body.joint.placement.translation != [0.0; 3],
        Plant::Moved | Plant::Turned => body.joint.kind != JointType::Free,
        Plant::Order => false,
        Plant::ComSign | Plant::AboutOrigin => body.mass > 0.0 && body.com.iter().any(|x| x.abs() > 1e-3),
        Plant::OffDiagonals => body.mass > 0.0 && [1, 2, 4].into_iter().any(|k| body.inertia[k].abs() > 1e-6 * body.inertia[0]),
        Plant::TransposedPlacement => body.joint.kind != JointType::Free && asymmetric(body.joint.placement.rotation),
    };
    let candidates: Vec<usize> = (0..description.bodies.len()).filter(|&i| fits(&description.bodies[i])).collect();
    if candidates.is_empty() {
        // Some robots have only isotropic inertias: another difference is planted.
        return sow(description, Plant::Moved, random);
    }
    let body = &mut description.bodies[candidates[random.below(candidates.len())]];
    let name = body.name.clone();
    let placement = &mut body.joint.placement;
    match plant {
        Plant::Mass => {
            body.mass *= random.uniform(1.01, 1.5);
            (name, Field::Mass, Some(Cause::Number))
        }
        Plant::Grams => {
            body.mass *= 1e3;
            (name, Field::Mass, Some(Cause::Unit))
        }
        Plant::Axis | Plant::Flip => {
            let turn = rotation(random);
            if let JointType::Revolute { axis } | JointType::Prismatic { axis } | JointType::Helical { axis, .. } = &mut body.joint.kind {
                let moved = if plant == Plant::Flip { axis.map(|x| -x) } else { (turn * Vec3::from_array(*axis)).to_array() };
                *axis = moved;
            }
            (name, Field::Axis, Some(if plant == Plant::Flip { Cause::Flipped } else { Cause::Number }))
        }
        Plant::InertialRotation => {
            body.inertia = Sym3::from_array(body.inertia).rotate(rotation(random)).to_array();
            (name, Field::Inertia, None)
        }
        Plant::Armature => {
            body.joint.armature = vec![body.joint.armature.first().copied().unwrap_or(0.0) + random.uniform(0.01, 0.1)];
            (name, Field::Armature, Some(Cause::Number))
        }
        Plant::Moved => {
            placement.translation = std::array::from_fn(|k| placement.translation[k] + random.uniform(0.01, 0.1));
            (name, Field::Placement, Some(Cause::Number))
        }
        Plant::Turned => {
            placement.rotation = (rotation(random) * Mat3::from_array(placement.rotation)).to_array();
            (name, Field::Placement, Some(Cause::Number))
        }
        Plant::MillimetresOfPlacement => {
            placement.translation = placement.translation.map(|x| x * 1e3);
            (name, Field::Placement, Some(Cause::Unit))
        }
        Plant::ComSign => {
            body.com = body.com.map(|x| -x);
            (name, Field::Com, Some(Cause::ComSign))
        }
        Plant::OffDiagonals => {
            let [xx, _, _, yy, _, zz] = body.inertia;
            body.inertia = [xx, 0.0, 0.0, yy, 0.0, zz];
            (name, Field::Inertia, Some(Cause::OffDiagonals))
        }
        Plant::AboutOrigin => {
            let sign = if random.below(2) == 0 { 1.0 } else { -1.0 };
            let moved = Sym3::from_array(body.inertia) + Sym3::point_mass(sign * body.mass, Vec3::from_array(body.com));
            body.inertia = moved.to_array();
            (name, Field::Inertia, Some(Cause::AboutOrigin))
        }
        Plant::TransposedPlacement => {
            placement.rotation = Mat3::from_array(placement.rotation).transpose().to_array();
            (name, Field::Placement, Some(Cause::Transposed))
        }
        Plant::Order => unreachable!("returned above"),
    }
}

/// Exchanges two siblings with everything that they support.
fn reorder(description: &mut Description, random: &mut Random) -> Expected {
    let bodies = &description.bodies;
    let families: Vec<Vec<usize>> = (0..=bodies.len())
        .map(|parent| (0..bodies.len()).filter(|&i| bodies[i].parent == parent.checked_sub(1)).collect())
        .filter(|children: &Vec<usize>| children.len() > 1)
        .collect();
    if families.is_empty() {
        // A chain has one order: another difference is planted.
        return sow(description, Plant::Moved, random);
    }
    let children = &families[random.below(families.len())];
    let first = random.below(children.len() - 1);
    // The description's order of siblings is theirs: the later one is put first.
    let (a, b) = (children[first], children[first + 1]);
    let mut order: Vec<usize> = (0..bodies.len()).collect();
    order.swap(a, b);
    let place: Vec<usize> = (0..bodies.len()).map(|i| order.iter().position(|&o| o == i).unwrap()).collect();
    let moved = order.iter().map(|&i| BodyDescription { parent: bodies[i].parent.map(|parent| place[parent]), ..bodies[i].clone() });
    let frames =
        description.frames.iter().map(|frame| featherbench_model::Frame { body: frame.body.map(|body| place[body]), ..frame.clone() });
    let reordered = Description { bodies: moved.collect(), frames: frames.collect(), ..description.clone() };
    *description = reordered.canonical().unwrap();
    (String::new(), Field::DofOrder, Some(Cause::Order))
}

/// All fields but limits, which no planted difference changes.
fn found(ours: &Description, theirs: &Description) -> Vec<Difference> {
    Comparison::of(ours, theirs, &[], &[]).differences().cloned().collect()
}

#[test]
fn each_plant_is_named_and_nothing_else_is() {
    let mut missed = Vec::new();
    for k in 0..PLANTS {
        let ours = robot(ROBOTS[k as usize % ROBOTS.len()]);
        let mut random = Random::new(2026, k);
        let plant = ALL[random.below(ALL.len())];
        let mut theirs = ours.clone();
        let (body, field, cause) = sow(&mut theirs, plant, &mut random);
        let found = found(&ours, &theirs);
        let right = |difference: &Difference| {
            difference.body == body && difference.field == field && cause.is_none_or(|cause| cause == difference.cause)
        };
        if found.len() != 1 || !found.iter().all(right) {
            missed.push(format!("{k}: {plant:?} in {field:?} of '{body}' of {}: {found:#?}", ours.name));
        }
    }
    assert!(missed.is_empty(), "{} of {PLANTS} are not named:\n{}", missed.len(), missed.join("\n"));
}

/// The robot written in other frames: each rotated, and moved along the axis of a rotating joint or anywhere on a sliding one.
fn regauged(description: &Description, random: &mut Random) -> Description {
    let mut result = description.clone();
    let mut gauges: Vec<Transform<f64>> = Vec::new();
    for body in &mut result.bodies {
        let gauge = match body.joint.kind {
            JointType::Revolute { axis } => Transform::new(rotation(random), Vec3::from_array(axis) * random.uniform(-0.1, 0.1)),
            JointType::Prismatic { .. } => Transform::new(rotation(random), Vec3::from_array(random.direction()) * 0.1),
            _ => Transform::identity(),
        };
        let back = gauge.inverse();
        let above = body.parent.map_or(Transform::identity(), |parent| gauges[parent].inverse());
        body.joint.placement = Placement::from_transform(&above.compose(&body.joint.placement.to_transform()).compose(&gauge));
        body.com = back.point(Vec3::from_array(body.com)).to_array();
        body.inertia = Sym3::from_array(body.inertia).rotate(back.rotation).to_array();
        if let JointType::Revolute { axis } | JointType::Prismatic { axis } = &mut body.joint.kind {
            *axis = (back.rotation * Vec3::from_array(*axis)).to_array();
        }
        gauges.push(gauge);
    }
    result
}

#[test]
fn frames_that_move_along_are_no_difference() {
    for (k, name) in ROBOTS.into_iter().enumerate() {
        let ours = robot(name);
        let mut random = Random::new(7, k as u64);
        let theirs = regauged(&ours, &mut random);
        // Every frame is a product of all frames before it: rounding grows with the depth. A difference is larger than rounding.
        let large: Vec<Difference> = found(&ours, &theirs).into_iter().filter(|difference| difference.size > 1e-12).collect();
        assert!(large.is_empty(), "{name}: {large:#?}");
    }
}

#[test]
fn in_other_frames_a_mass_and_an_armature_are_still_named() {
    for (k, name) in ROBOTS.into_iter().enumerate() {
        let ours = robot(name);
        let mut random = Random::new(8, k as u64);
        for plant in [Plant::Mass, Plant::Armature] {
            let mut theirs = regauged(&ours, &mut random);
            let (body, field, _) = sow(&mut theirs, plant, &mut random);
            let large: Vec<Difference> = found(&ours, &theirs).into_iter().filter(|difference| difference.size > 1e-12).collect();
            assert!(large.len() == 1 && large[0].body == body && large[0].field == field, "{name}: {plant:?} of {body}: {large:#?}");
        }
    }
}

#[test]
fn a_lost_inertial_rotation_is_told_from_an_applied_one() {
    let mut ours = robot("panda");
    let turn = rotation(&mut Random::new(9, 0));
    ours.bodies[3].inertia = [0.01, 0.0, 0.0, 0.02, 0.0, 0.025];
    let mut theirs = ours.clone();
    theirs.bodies[3].inertia = Sym3::from_array(ours.bodies[3].inertia).rotate(turn).to_array();
    let cause = |ours: &Description, theirs: &Description| {
        let found = found(ours, theirs);
        assert_eq!(found.len(), 1, "{found:#?}");
        found[0].cause
    };
    assert_eq!(cause(&ours, &theirs), Cause::InertialRotationApplied);
    assert_eq!(cause(&theirs, &ours), Cause::InertialRotationLost);
    theirs.bodies[3].inertia = [0.055 / 3.0, 0.0, 0.0, 0.055 / 3.0, 0.0, 0.055 / 3.0];
    assert_eq!(cause(&ours, &theirs), Cause::Balanced);
}

#[test]
fn angles_in_degrees_are_told_from_other_angles() {
    let ours = robot("panda");
    let mut theirs = ours.clone();
    let angle = 0.3_f64;
    let about = |angle: f64| Transform::axis_rotation(Vec3::new(0.0, 0.0, 1.0), angle.sin(), angle.cos()).to_array();
    let mut ours = ours;
    ours.bodies[2].joint.placement.rotation = about(angle);
    theirs.bodies[2].joint.placement.rotation = about(angle.to_radians());
    let degrees = found(&ours, &theirs);
    assert_eq!(degrees.iter().map(|d| (d.field, d.cause)).collect::<Vec<_>>(), [(Field::Placement, Cause::Degrees)]);
    theirs.bodies[2].joint.placement.rotation = about(0.31);
    assert_eq!(found(&ours, &theirs)[0].cause, Cause::Number);
}

#[test]
fn bodies_that_are_merged_dropped_or_added_are_told_apart() {
    let ours = robot("hyq");
    let leaf = ours.bodies.len() - 1;
    let name = ours.bodies[leaf].name.clone();
    let fixed = |description: &mut Description| {
        let joint = &mut description.bodies[leaf].joint;
        *joint = featherbench_model::JointDescription { name: joint.name.clone(), placement: joint.placement, ..Default::default() };
    };
    let mut merged = ours.clone();
    fixed(&mut merged);
    let mut dropped = merged.clone();
    (dropped.bodies[leaf].mass, dropped.bodies[leaf].inertia) = (0.0, [0.0; 6]);
    let (merged, dropped) = (merged.canonical().unwrap(), dropped.canonical().unwrap());
    for (theirs, cause) in [(&merged, Cause::Merged), (&dropped, Cause::Dropped)] {
        let found = found(&ours, theirs);
        assert_eq!(found.iter().map(|d| (d.body.as_str(), d.field, d.cause)).collect::<Vec<_>>(), [(name.as_str(), Field::Body, cause)]);
    }
    let found = found(&merged, &ours);
    assert_eq!(found.iter().map(|d| (d.body.as_str(), d.field, d.cause)).collect::<Vec<_>>(), [(name.as_str(), Field::Body, Cause::Added)]);
}

#[test]
fn a_joint_of_another_type_is_one_difference() {
    let ours = robot("ur5");
    let mut theirs = ours.clone();
    let axis = theirs.bodies[2].joint.kind.axis().unwrap();
    theirs.bodies[2].joint.kind = JointType::Prismatic { axis };
    let found = found(&ours, &theirs);
    assert_eq!(
        found.iter().map(|d| (d.field, d.ours.as_str(), d.theirs.as_str())).collect::<Vec<_>>(),
        [(Field::JointType, "revolute", "prismatic")]
    );
    assert_eq!(found[0].field.weight(), Weight::Dynamics);
}

#[test]
fn a_base_that_floats_by_another_link_is_told_from_a_joint_that_is_elsewhere() {
    let turn = rotation(&mut Random::new(11, 0));
    let mut ours = robot("anymal_c");
    let root = ours.bodies.iter().position(|body| body.joint.kind == JointType::Free).unwrap();
    let placement = Placement { rotation: turn.to_array(), translation: [0.1, 0.0, 0.0] };
    ours.frames.push(featherbench_model::Frame { name: "inner".into(), body: Some(root), placement });
    let mut theirs = ours.clone();
    theirs.bodies[root].name = "inner".into();
    let back = placement.to_transform().inverse();
    for body in theirs.bodies.iter_mut().filter(|body| body.parent == Some(root)) {
        body.joint.placement = Placement::from_transform(&back.compose(&body.joint.placement.to_transform()));
    }
    let placements: Vec<Difference> = found(&ours, &theirs).into_iter().filter(|difference| difference.field == Field::Placement).collect();
    assert!(!placements.is_empty() && placements.iter().all(|difference| difference.cause == Cause::OtherRoot), "{placements:#?}");
    theirs.bodies[root].name = ours.bodies[root].name.clone();
    assert!(found(&ours, &theirs).iter().all(|difference| difference.cause != Cause::OtherRoot));
}

/// Limits that differ are told with both numbers and their unit. A range that only one side has is told as none on the other.
#[test]
fn limits_that_differ_are_told_with_numbers_and_unit() {
    const DRAWN: u64 = 400;
    let number = |word: &str| word.parse::<f64>().unwrap_or_else(|error| panic!("{word}: {error}"));
    let mut told = 0;
    for k in 0..DRAWN {
        let mut ours = robot(ROBOTS[k as usize % ROBOTS.len()]);
        let mut random = Random::new(44, k);
        let i = random.below(ours.bodies.len());
        let unit = match ours.bodies[i].joint.kind {
            JointType::Revolute { .. } => "rad",
            JointType::Prismatic { .. } => "m",
            _ => continue,
        };
        let mut theirs = ours.clone();
        // The second is the first in degrees, the first turned about, or another one.
        let range = [random.uniform(-3.0, 0.0), random.uniform(0.1, 3.0)];
        let other = match random.below(4) {
            0 => Some(range.map(f64::to_degrees)),
            1 => Some([-range[1], -range[0]]),
            2 => Some([random.uniform(-9.0, -4.0), range[1]]),
            _ => None,
        };
        let joint = &mut ours.bodies[i].joint;
        (joint.lower, joint.upper) = (vec![range[0]], vec![range[1]]);
        let joint = &mut theirs.bodies[i].joint;
        (joint.lower, joint.upper) = other.map_or((vec![], vec![]), |[low, high]| (vec![low], vec![high]));
        let found = found(&ours, &theirs);
        assert_eq!(found.len(), 1, "{k}: {found:#?}");
        assert_eq!((found[0].field, found[0].field.weight()), (Field::Limits, Weight::Information));
        for (text, range) in [(&found[0].ours, Some(range)), (&found[0].theirs, other)] {
            let Some(range) = range else {
                assert_eq!(text, "no limits", "{k}");
                continue;
            };
            let words: Vec<&str> = text.split(' ').collect();
            assert!(words.len() == 4 && words[1] == "to" && words[3] == unit, "{k}: {text}");
            // Four digits are written at least: half a unit of the fourth is 5e-4 of the number.
            for (word, limit) in [(words[0], range[0]), (words[2], range[1])] {
                assert!((number(word) - limit).abs() <= 5e-4 * limit.abs(), "{k}: {text} for {limit}");
            }
        }
        told += 1;
    }
    assert!(told > DRAWN / 2, "{told}");
}

/// The rotor of an actuator is named as the cause of an armature where its numbers give it, and not where they give another one.
#[test]
fn a_rotor_is_named_only_where_its_numbers_give_the_armature() {
    const DRAWN: u64 = 400;
    let mut named = 0;
    for k in 0..DRAWN {
        let ours = robot(ROBOTS[k as usize % ROBOTS.len()]);
        let mut random = Random::new(45, k);
        let turning = |body: &BodyDescription| matches!(body.joint.kind, JointType::Revolute { .. });
        let hinges: Vec<usize> = (0..ours.bodies.len()).filter(|&i| turning(&ours.bodies[i])).collect();
        let i = hinges[random.below(hinges.len())];
        let (rotor, gear) = (random.uniform(1e-6, 1e-3), random.uniform(2.0, 200.0));
        let right = random.below(2) == 0;
        let mut theirs = ours.clone();
        let joint = &mut theirs.bodies[i].joint;
        let before = joint.armature.first().copied().unwrap_or(0.0);
        joint.armature = vec![before + rotor * gear * gear * if right { 1.0 } else { random.uniform(1.01, 2.0) }];
        let note = ImportNote {
            cause: "rotor_inertia".into(),
            about: Some(joint.name.clone()),
            text: "a rotor".into(),
            numbers: vec![rotor, gear],
        };
        let found: Vec<Difference> = Comparison::of(&ours, &theirs, &[], &[note]).differences().cloned().collect();
        assert_eq!(found.len(), 1, "{k}: {found:#?}");
        assert_eq!((found[0].field, found[0].cause == Cause::RotorInertia), (Field::Armature, right), "{k}: {found:#?}");
        named += usize::from(right);
    }
    assert!(named > 100, "{named}");
}

/// Another order names only what the file names: a joint without a name is told by its body.
#[test]
fn another_order_names_no_joint_that_the_file_does_not_name() {
    const DRAWN: u64 = 240;
    let mut told = 0;
    for k in 0..DRAWN {
        let mut ours = robot(ROBOTS[k as usize % ROBOTS.len()]);
        let mut random = Random::new(46, k);
        for i in 0..ours.bodies.len() {
            if random.below(2) == 0 {
                // As MuJoCo's reading names a joint that has no name.
                ours.bodies[i].joint.name = format!("joint {i}");
            }
        }
        let mut theirs = ours.clone();
        let (_, field, _) = sow(&mut theirs, Plant::Order, &mut random);
        // A robot without siblings has one order alone.
        if field != Field::DofOrder {
            continue;
        }
        let found: Vec<Difference> = found(&ours, &theirs).into_iter().filter(|difference| difference.field == field).collect();
        assert_eq!(found.len(), 1, "{k}");
        for name in found[0].ours.split(", ").chain(found[0].theirs.split(", ")) {
            let body = name.strip_prefix("that of ");
            let known = |body: &BodyDescription| body.joint.name == name && !name.starts_with("joint ");
            let named = body.map_or_else(|| ours.bodies.iter().any(known), |body| ours.bodies.iter().any(|other| other.name == body));
            assert!(named, "{k}: {name} in {found:#?}");
            told += usize::from(body.is_some());
        }
    }
    assert!(told > 100, "{told}");
}
