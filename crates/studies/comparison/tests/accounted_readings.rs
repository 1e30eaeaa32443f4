//! A cause is named only if it gives the engine's numbers. Edits of the links of a body, planted by the parsers' own rules, are named with
//! their size. The same notes beside other numbers name nothing.

use featherbench_bench::{FileInertial, FileLink, ImportNote};
use featherbench_comparison::import::{Cause, Comparison, Difference, Field, Precision, bound};
use featherbench_model::{BodyDescription, Description, Frame, JointDescription, JointType, Placement};
use featherbench_robots::Random;
use featherbench_spatial::{Mat3, RigidBodyInertia, Sym3, Transform, Vec3};

const NO_TURN: [f64; 9] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];

fn turn(axis: [f64; 3], angle: f64) -> Mat3<f64> {
    Transform::axis_rotation(Vec3::from_array(axis), angle.sin(), angle.cos())
}

/// The links of one moving body, each with its placement on the body. They are the body itself, a tool with a rotated inertial, a shell
/// with geometry and no inertial, a frame with neither, and a link of unphysical inertia.
fn links() -> Vec<(FileLink, Transform<f64>)> {
    let place = |k: f64| Transform::new(turn([0.0, 0.6, 0.8], k), Vec3::new(0.1 * k, -0.2, 0.05));
    let link = |name: &str, inertial, solids| FileLink { name: name.into(), inertial, solids };
    let given = |mass, com, rotation, inertia| Some(FileInertial { mass, com, rotation, inertia });
    let turned = turn([0.6, 0.0, 0.8], 0.7).to_array();
    vec![
        (link("arm", given(2.0, [0.1, 0.02, -0.03], NO_TURN, [0.02, 0.001, 0.002, 0.03, 0.003, 0.04]), None), Transform::identity()),
        (link("tool", given(0.5, [0.02, 0.01, 0.0], turned, [0.002, 0.0003, 0.0002, 0.003, 0.0001, 0.004]), None), place(0.3)),
        (link("shell", None, given(29.4, [0.1, 0.2, 0.3], NO_TURN, [0.5, 0.01, 0.02, 0.6, 0.03, 0.7])), place(0.9)),
        (link("frame", None, None), place(1.4)),
        (link("plate", given(0.3, [0.0, 0.01, 0.0], NO_TURN, [0.001, 0.0, 0.0, 0.001, 0.0, 0.005]), None), place(2.0)),
    ]
}

/// The body made of these links, with some of them replaced.
fn merged(replace: impl Fn(&FileLink) -> Option<FileInertial>) -> BodyDescription {
    let mut sum = RigidBodyInertia::zero();
    for (link, place) in links() {
        if let Some(x) = replace(&link).or(link.inertial) {
            let about_com = Sym3::from_array(x.inertia).rotate(Mat3::from_array(x.rotation));
            sum += RigidBodyInertia::from_com(x.mass, Vec3::from_array(x.com), about_com).to_parent(&place);
        }
    }
    let com = sum.com();
    let joint = JointDescription { name: "hinge".into(), kind: JointType::Revolute { axis: [0.0, 1.0, 0.0] }, ..Default::default() };
    let inertia = (sum.rotational + Sym3::point_mass(-sum.mass, com)).to_array();
    BodyDescription { name: "arm".into(), parent: None, mass: sum.mass, com: com.to_array(), inertia, joint }
}

fn robot(body: BodyDescription) -> Description {
    let fixed = links().into_iter().skip(1).map(|(link, place)| Frame {
        name: link.name,
        body: Some(0),
        placement: Placement::from_transform(&place),
    });
    Description { name: "r".into(), bodies: vec![body], frames: fixed.collect(), ..Description::default() }
}

fn found(replace: impl Fn(&FileLink) -> Option<FileInertial>, notes: &[ImportNote]) -> Vec<Difference> {
    let of_file: Vec<FileLink> = links().into_iter().map(|(link, _)| link).collect();
    let (ours, theirs) = (robot(merged(|_| None)), robot(merged(replace)));
    Comparison::of(&ours, &theirs, &of_file, notes).differences().cloned().collect()
}

/// All differences have this cause, and the account contains these words.
fn named(found: &[Difference], cause: Cause, words: &[&str]) {
    assert!(!found.is_empty(), "{cause:?} is found");
    for difference in found {
        assert_eq!(difference.cause, cause, "{difference:#?}");
        let account = difference.account.as_deref().unwrap_or_default();
        assert!(words.iter().all(|word| account.contains(word)), "{words:?}: {account}");
    }
}

/// There are differences, and no cause gives their numbers.
fn unknown(found: &[Difference]) {
    assert!(!found.is_empty());
    assert!(found.iter().all(|difference| difference.cause == Cause::Number && difference.account.is_none()), "{found:#?}");
}

fn bounded(x: FileInertial) -> FileInertial {
    FileInertial {
        mass: x.mass.max(1e-6),
        inertia: std::array::from_fn(|k| if [0, 3, 5].contains(&k) { x.inertia[k].max(1e-6) } else { x.inertia[k] }),
        ..x
    }
}

const NOTHING: FileInertial = FileInertial { mass: 0.0, com: [0.0; 3], rotation: NO_TURN, inertia: [0.0; 6] };

fn of_nothing(mass: f64, moment: f64) -> FileInertial {
    FileInertial { mass, inertia: [moment, 0.0, 0.0, moment, 0.0, moment], ..NOTHING }
}

/// The notes of MuJoCo's oracle beside its bounds: one with a number larger than any mass, and one of another link.
fn told_of_bounds() -> Vec<ImportNote> {
    let note = |cause: &str, about: Option<&str>, text: &str| ImportNote {
        cause: cause.into(),
        about: about.map(str::to_owned),
        text: text.into(),
        numbers: Vec::new(),
    };
    vec![
        note("bounds", None, "boundmass and boundinertia of 1e-06, were needed; Element name 'hatch', id 78"),
        note("mass_edited", Some("frame"), "0.0 kg in the file became 1e-06 kg"),
    ]
}

#[test]
fn geometry_that_weighs_is_not_called_a_bound_of_a_milligram() {
    let shell = |link: &FileLink| link.solids.filter(|_| link.inertial.is_none());
    let geometry = found(shell, &told_of_bounds());
    assert_eq!(geometry.iter().map(|d| d.field).collect::<Vec<_>>(), [Field::Mass, Field::Com, Field::Inertia]);
    named(&geometry, Cause::Geometry, &["'shell'", "0 kg became 29.4 kg", "1000 kg/m³"]);
    // Together with the bounds of other links, the cause of the largest change names the whole.
    let balanced = |x: FileInertial| if x.inertia[0] + x.inertia[3] < x.inertia[5] { of_mean(x) } else { x };
    let all = |link: &FileLink| Some(shell(link).unwrap_or_else(|| balanced(bounded(link.inertial.unwrap_or(NOTHING)))));
    named(&found(all, &told_of_bounds()), Cause::Geometry, &["'shell'", "'plate'", "three equal moments"]);
    // A mass that no rule gives has no cause, whatever the notes say.
    let other = |link: &FileLink| shell(link).map(|solids| FileInertial { mass: 21.7, ..solids });
    unknown(&found(other, &told_of_bounds()));
}

fn of_mean(x: FileInertial) -> FileInertial {
    let mean = (x.inertia[0] + x.inertia[3] + x.inertia[5]) / 3.0;
    FileInertial { inertia: [mean, 0.0, 0.0, mean, 0.0, mean], ..x }
}

#[test]
fn what_parsers_do_to_links_is_named_with_its_size() {
    let only = |name: &'static str, to: fn(FileInertial) -> FileInertial| {
        move |link: &FileLink| (link.name == name).then(|| to(link.inertial.unwrap_or(NOTHING)))
    };
    named(&found(|link| link.inertial.is_none().then(|| of_nothing(1.0, 1.0)), &[]), Cause::DefaultInertia, &["0 kg became 1 kg"]);
    named(&found(only("frame", |_| of_nothing(1.0, 1.0)), &[]), Cause::DefaultInertia, &["'frame'"]);
    let bounds = |link: &FileLink| link.inertial.is_none().then(|| of_nothing(1e-6, 1e-6));
    let repaired = |link: &FileLink| bounds(link).or_else(|| only("plate", of_mean)(link));
    named(&found(only("plate", of_mean), &[]), Cause::Balanced, &["'plate'"]);
    // Both bounds and equal moments: the inertia of the plate is the larger change.
    named(&found(repaired, &[]), Cause::Balanced, &["'plate'"]);
    let ball = |x: FileInertial| {
        let radius = (3.0 * x.mass / (4.0 * std::f64::consts::PI * 1000.0)).cbrt();
        let moment = 0.4 * x.mass * radius * radius;
        FileInertial { inertia: [moment, 0.0, 0.0, moment, 0.0, moment], ..x }
    };
    named(&found(only("plate", ball), &[]), Cause::Unphysical, &["'plate'", "ball of water"]);
    named(&found(only("tool", |x| FileInertial { rotation: NO_TURN, ..x }), &[]), Cause::InertialRotationLost, &["'tool'"]);
    let transposed = |x: FileInertial| FileInertial { rotation: Mat3::from_array(x.rotation).transpose().to_array(), ..x };
    named(&found(only("tool", transposed), &[]), Cause::Transposed, &["'tool'"]);
    let diagonal = |x: FileInertial| FileInertial { inertia: [x.inertia[0], 0.0, 0.0, x.inertia[3], 0.0, x.inertia[5]], ..x };
    named(&found(only("tool", diagonal), &[]), Cause::OffDiagonals, &["'tool'"]);
    named(&found(only("arm", |x| FileInertial { com: x.com.map(|c| -c), ..x }), &[]), Cause::ComSign, &["'arm'"]);
    named(&found(only("arm", |x| FileInertial { com: [x.com[0], -x.com[1], x.com[2]], ..x }), &[]), Cause::ComSign, &["'arm'"]);
    let about = |x: FileInertial| {
        let com = Mat3::from_array(x.rotation).transpose() * Vec3::from_array(x.com);
        FileInertial { inertia: (Sym3::from_array(x.inertia) + Sym3::point_mass(-x.mass, com)).to_array(), ..x }
    };
    named(&found(only("tool", about), &[]), Cause::AboutOrigin, &["'tool'"]);
    named(&found(only("tool", |_| NOTHING), &[]), Cause::Dropped, &["'tool'", "0.5 kg became 0 kg"]);
}

/// Numbers that the engine reports of a link name a cause if they give the body, and otherwise not.
#[test]
fn what_an_engine_tells_is_held_against_its_body() {
    let held = FileInertial { mass: 3.3, com: [0.1, 0.0, 0.2], ..of_nothing(0.0, 0.07) };
    let note = |mass: f64| {
        let numbers = [&[mass][..], &held.com, &held.inertia].concat();
        ImportNote { cause: "mass_edited".into(), about: Some("tool".into()), text: "0.5 kg became 3.3 kg".into(), numbers }
    };
    let tool = |link: &FileLink| (link.name == "tool").then_some(held);
    named(&found(tool, &[note(3.3)]), Cause::Edited, &["'tool'", "0.5 kg became 3.3 kg"]);
    unknown(&found(tool, &[note(3.2)]));
    unknown(&found(tool, &[]));
}

/// A body without mass in an MJCF whose links are not known: one kilogram is DART's default, not a unit's factor on a milligram.
#[test]
fn one_kilogram_for_nothing_is_a_default_and_no_unit() {
    let body = |mass: f64, moment: f64| BodyDescription {
        mass,
        inertia: [moment, 0.0, 0.0, moment, 0.0, moment],
        com: [0.0; 3],
        ..merged(|_| None)
    };
    let of = |ours: BodyDescription, theirs: BodyDescription| {
        let [ours, theirs] = [ours, theirs].map(|body| Description { bodies: vec![body], ..Description::default() });
        Comparison::of(&ours, &theirs, &[], &[]).differences().map(|d| (d.field, d.cause)).collect::<Vec<_>>()
    };
    let default = [(Field::Mass, Cause::DefaultInertia), (Field::Inertia, Cause::DefaultInertia)];
    assert_eq!(of(body(0.0, 0.0), body(1.0, 1.0)), default);
    assert_eq!(of(body(0.0, 0.0), body(1e-6, 1e-6)), [(Field::Mass, Cause::Bounds), (Field::Inertia, Cause::Bounds)]);
}

/// The note has the numbers of the file: so the bound is named, not only that the parser reports it.
#[test]
fn a_bound_that_is_told_is_still_a_bound() {
    let body = |mass: f64, moment: f64| {
        let inertial = BodyDescription { mass, inertia: [moment, 0.0, 0.0, moment, 0.0, moment], com: [0.0; 3], ..merged(|_| None) };
        Description { bodies: vec![inertial], ..Description::default() }
    };
    let numbers = [&[0.0; 10][..], &[1e-6, 0.0, 0.0, 0.0, 1e-6, 0.0, 0.0, 1e-6, 0.0, 1e-6]].concat();
    let note = ImportNote { cause: "mass_edited".into(), about: Some("arm".into()), text: "raised".into(), numbers };
    let mut held = body(1e-6, 1e-6);
    held.bodies[0].com = [0.0, 0.0, 1.0];
    let comparison = Comparison::of(&body(0.0, 0.0), &held, &[], &[note]);
    assert!(comparison.differences().all(|d| d.cause == Cause::Bounds), "{:#?}", comparison.findings);
    // DART with the file's mass and its own moments.
    let comparison = Comparison::of(&body(2.0, 0.3), &body(2.0, 1.0), &[], &[]);
    assert_eq!(comparison.differences().map(|d| d.cause).collect::<Vec<_>>(), [Cause::DefaultInertia]);
}

/// The angles of a file in one order, used in the order x, y, z.
#[test]
fn a_sequence_of_angles_that_is_ignored_is_named() {
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let mut random = Random::new(17, 0);
    for order in [[2, 1, 0], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1]] {
        let angles: [f64; 3] = std::array::from_fn(|_| random.uniform(-1.5, 1.5));
        let about = |order: [usize; 3]| turn(axes[order[0]], angles[0]) * turn(axes[order[1]], angles[1]) * turn(axes[order[2]], angles[2]);
        let fixed = |order: [usize; 3]| turn(axes[order[2]], angles[2]) * turn(axes[order[1]], angles[1]) * turn(axes[order[0]], angles[0]);
        for written in [about(order), fixed(order)] {
            let of = |rotation: Mat3<f64>| {
                let mut body = merged(|_| None);
                body.joint.placement.rotation = rotation.to_array();
                Description { bodies: vec![body], ..Description::default() }
            };
            let comparison = Comparison::of(&of(written), &of(about([0, 1, 2])), &[], &[]);
            let found: Vec<_> = comparison.differences().map(|d| (d.field, d.cause)).collect();
            assert_eq!(found, [(Field::Placement, Cause::EulerSequence)], "{order:?} {angles:?}");
        }
    }
}

/// A planar joint about x, which a parser imports about z. Our parser rotates the plane and leaves a frame where the link is.
#[test]
fn a_plane_that_is_always_z_is_named() {
    let z_to_x = turn([0.0, 1.0, 0.0], std::f64::consts::FRAC_PI_2);
    let placed = |rotation: Mat3<f64>, translation: [f64; 3]| Placement { rotation: rotation.to_array(), translation };
    let joint = |name: &str, kind, placement| JointDescription { name: name.into(), kind, placement, ..Default::default() };
    let [place, below] = [(0.4, [0.1, 0.2, 0.3]), (0.9, [0.3, 0.0, 0.1])].map(|(angle, at)| placed(turn([0.6, 0.0, 0.8], angle), at));
    let child = |parent_turn: Mat3<f64>| {
        let at = Transform::new(parent_turn.transpose(), Vec3::zero()).compose(&below.to_transform());
        let kind = JointType::Revolute { axis: [0.0, 1.0, 0.0] };
        BodyDescription {
            name: "wheel".into(),
            parent: Some(0),
            joint: joint("axle", kind, Placement::from_transform(&at)),
            ..merged(|_| None)
        }
    };
    let inertial = merged(|_| None);
    let sled = |name: &str, turned: Mat3<f64>| {
        let at = place.to_transform().compose(&Transform::new(turned, Vec3::zero()));
        BodyDescription {
            name: name.into(),
            com: (turned.transpose() * Vec3::from_array(inertial.com)).to_array(),
            inertia: Sym3::from_array(inertial.inertia).rotate(turned.transpose()).to_array(),
            joint: joint("skate", JointType::Planar, Placement::from_transform(&at)),
            ..inertial.clone()
        }
    };
    let frame = Frame { name: "sled".into(), body: Some(0), placement: placed(z_to_x.transpose(), [0.0; 3]) };
    let ours = Description { bodies: vec![sled("sled_plane", z_to_x), child(z_to_x)], frames: vec![frame], ..Description::default() };
    let straight = turn([0.0, 0.0, 1.0], 0.0);
    let mut theirs = Description { bodies: vec![sled("sled", straight), child(straight)], ..Description::default() };
    let found: Vec<Difference> = Comparison::of(&ours, &theirs, &[], &[]).differences().cloned().collect();
    assert!(!found.is_empty() && found.iter().all(|difference| difference.cause == Cause::PlanarAxis), "{found:#?}");
    // A plane other than z is a difference of numbers.
    theirs.bodies[0] = sled("sled", turn([1.0, 0.0, 0.0], 0.3));
    let found: Vec<Difference> = Comparison::of(&ours, &theirs, &[], &[]).differences().cloned().collect();
    assert!(!found.is_empty() && found.iter().all(|difference| difference.cause != Cause::PlanarAxis), "{found:#?}");
}

/// The limit between equal and unexplained is one bound, which grows with the depth.
#[test]
fn the_bound_of_rounding_grows_with_the_depth() {
    let double = |depth| bound(depth, Precision::Double);
    assert_eq!([1, 100, 1000, 5000].map(double), [1e-12, 1e-12, 1e-11, 5e-11]);
    assert!(7.8e-12 <= double(1000));
    // That of single precision is as many times as large as its roundings.
    let times = f64::from(f32::EPSILON) / f64::EPSILON;
    for depth in [1, 100, 1000] {
        assert!((bound(depth, Precision::Single) / (times * double(depth)) - 1.0).abs() < 1e-12);
    }
}
