//! Causes on edits that no one picked: any field of any body, several at once, by a rule or by none. No cause is named unless it gives all
//! numbers of the engine, and the named one is the planted one.

use crate::share::one_of;
use featherbench_bench::ImportVariant;
use featherbench_comparison::import::{Cause, Comparison, Field, Weight};
use featherbench_formats::neutral;
use featherbench_model::{BodyDescription, Description, JointDescription, JointType};
use featherbench_robots::Random;
use featherbench_spatial::{Sym3, Transform, Vec3};
use std::collections::BTreeMap;
use std::path::Path;

const ROBOTS: [&str; 6] = ["panda", "hyq", "baxter", "allegro_right", "anymal_c", "xarm7"];

fn robot(random: &mut Random) -> Description {
    let name = ROBOTS[random.below(ROBOTS.len())];
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../../../datasets/models/{name}.json"));
    neutral::read(path).unwrap().canonical().unwrap()
}

/// An edit of one field of a body, and the cause that gives its number, if a rule does.
fn edited(body: &mut BodyDescription, random: &mut Random) -> Option<(Field, Cause)> {
    let turn = |random: &mut Random| {
        let angle = random.uniform(0.1, 1.0);
        Transform::axis_rotation(Vec3::from_array(random.direction()), angle.sin(), angle.cos())
    };
    let heavy = body.mass > 0.0 && body.com.iter().all(|x| x.abs() > 1e-3) && body.inertia.iter().all(|x| x.abs() > 1e-7);
    let case = random.below(8);
    Some(match case {
        0 if heavy => {
            body.mass *= random.uniform(0.3, 3.0);
            (Field::Mass, Cause::Number)
        }
        1 if heavy => {
            body.com = std::array::from_fn(|k| body.com[k] + random.uniform(0.01, 0.1));
            (Field::Com, Cause::Number)
        }
        2 if heavy => {
            body.inertia = body.inertia.map(|x| x * random.uniform(1.1, 2.0));
            (Field::Inertia, Cause::Number)
        }
        3 if heavy => {
            body.inertia = Sym3::from_array(body.inertia).rotate(turn(random)).to_array();
            (Field::Inertia, Cause::InertiaTurned)
        }
        4 if body.joint.kind != JointType::Free => {
            let translation = body.joint.placement.translation;
            body.joint.placement.translation = std::array::from_fn(|k| translation[k] + random.uniform(0.01, 0.1));
            (Field::Placement, Cause::Number)
        }
        5 if heavy => {
            body.mass *= 1e3;
            (Field::Mass, Cause::Unit)
        }
        6 if heavy => {
            body.com = body.com.map(|x| -x);
            (Field::Com, Cause::ComSign)
        }
        7 if body.joint.kind.nv() == 1 => {
            let armature = body.joint.armature.first().copied().unwrap_or(0.0);
            body.joint.armature = vec![armature + random.uniform(0.01, 0.1)];
            (Field::Armature, Cause::Number)
        }
        _ => return None,
    })
}

#[test]
fn edits_that_no_rule_makes_have_no_cause_and_the_others_their_own() {
    let mut wrong = Vec::new();
    for k in (0..1000).step_by(one_of(16)) {
        let mut random = Random::new(44, k as u64);
        let ours = robot(&mut random);
        let mut theirs = ours.clone();
        let mut planted = BTreeMap::new();
        for _ in 0..1 + random.below(4) {
            let i = random.below(ours.bodies.len());
            // One edit of a body: two may look like a third.
            if planted.keys().all(|(body, _)| *body != ours.bodies[i].name)
                && let Some((field, cause)) = edited(&mut theirs.bodies[i], &mut random)
            {
                planted.insert((ours.bodies[i].name.clone(), field), cause);
            }
        }
        let found = Comparison::of(&ours, &theirs, &[], &[]);
        let found: BTreeMap<_, _> = found.differences().map(|found| ((found.body.clone(), found.field), found.cause)).collect();
        if found != planted {
            wrong.push(format!("{k}: planted {planted:?}, found {found:?}"));
        }
    }
    assert!(wrong.is_empty(), "{}:\n{}", wrong.len(), wrong.join("\n"));
}

/// A difference holds the one body that is another. If each held a robot, those of this tree would need 10 GB.
#[test]
fn a_difference_alone_is_our_robot_with_one_other_body() {
    let mut random = Random::new(47, 0);
    let ours = featherbench_doubles::robot("tree:n=2000,seed=47,spread=0.3").description.canonical().unwrap();
    let mut theirs = ours.clone();
    for body in &mut theirs.bodies {
        body.joint.damping = vec![random.uniform(1.0, 2.0); body.joint.kind.nv()];
        body.joint.friction = vec![random.uniform(1.0, 2.0); body.joint.kind.nv()];
        body.mass *= random.uniform(1.1, 2.0);
    }
    let found = Comparison::of(&ours, &theirs, &[], &[]);
    assert_eq!(found.findings.len(), 3 * ours.bodies.len());
    for _ in 0..20 {
        let finding = &found.findings[random.below(found.findings.len())];
        let robot = finding.alone.as_ref().unwrap().of(&found.ours);
        let other: Vec<usize> = (0..ours.bodies.len()).filter(|&i| robot.bodies[i] != found.ours.bodies[i]).collect();
        assert_eq!(other.len(), 1);
        let (body, due) = (&robot.bodies[other[0]], &theirs.bodies[other[0]]);
        assert_eq!(body.name, finding.difference.body);
        match finding.difference.field {
            Field::Mass => assert_eq!(body.mass, due.mass),
            Field::Damping => assert_eq!(body.joint.damping, due.joint.damping),
            Field::Friction => assert_eq!(body.joint.friction, due.joint.friction),
            field => panic!("{field:?} was not changed"),
        }
    }
}

/// What a file would be to parsers that read one thing otherwise.
fn variants(ours: &Description, random: &mut Random) -> Vec<ImportVariant> {
    let variant =
        |cause: &str, description: Description| ImportVariant { cause: cause.into(), text: format!("by {cause}"), edits: 1, description };
    let gravity = Description { gravity: random.direction().map(|x| 9.0 * x), ..ours.clone() };
    let mut ones = ours.clone();
    for body in &mut ones.bodies {
        (body.mass, body.com, body.inertia) = (1.0, [0.0; 3], [1.0, 0.0, 0.0, 1.0, 0.0, 1.0]);
    }
    let mut groups = ours.clone();
    let mut shell = ours.clone();
    for k in 0..ours.bodies.len() {
        if random.below(2) == 0 {
            groups.bodies[k].mass += random.uniform(0.5, 2.0);
            shell.bodies[k].inertia = ours.bodies[k].inertia.map(|x| x * random.uniform(1.1, 2.0));
        }
    }
    groups.bodies[0].mass += 1.0;
    shell.bodies[0].mass += 0.5;
    vec![variant("gravity_ignored", gravity), variant("default_inertia", ones), variant("inertia_groups", groups), variant("shell", shell)]
}

/// What two variants do together is named by each, and not by the variant of both.
#[test]
fn a_variant_of_two_edits_is_named_where_single_ones_do_not_suffice() {
    for k in (0..400).step_by(one_of(16)) {
        let mut random = Random::new(46, k as u64);
        let ours = robot(&mut random);
        let mut variants = variants(&ours, &mut random);
        let both = Description { gravity: variants[0].description.gravity, ..variants[1].description.clone() };
        variants.push(ImportVariant { cause: "shell".into(), text: "both".into(), edits: 2, description: both.clone() });
        let causes = |variants: &[ImportVariant]| -> Vec<(Field, Cause)> {
            let found = Comparison::of(&ours, &both, &[], &[]).explained_by(&ours, &both, variants, &[]);
            let felt = found.differences().filter(|found| found.field.weight() == Weight::Dynamics);
            felt.map(|found| (found.field, found.cause)).collect()
        };
        for (field, cause) in causes(&variants) {
            let due = if field == Field::Gravity { Cause::GravityIgnored } else { Cause::DefaultInertia };
            assert_eq!(cause, due, "{k}: {field:?}");
        }
        // Without one of the two, the variant of both is the one that gives the numbers.
        variants.remove(1);
        assert!(causes(&variants).iter().all(|(_, cause)| *cause == Cause::Shell), "{k}");
    }
}

#[test]
fn a_variant_is_named_if_it_gives_all_numbers_and_refuted_by_one() {
    let causes = [Cause::GravityIgnored, Cause::DefaultInertia, Cause::InertiaGroups, Cause::Shell];
    for k in (0..400).step_by(one_of(16)) {
        let mut random = Random::new(45, k as u64);
        let ours = robot(&mut random);
        let variants = variants(&ours, &mut random);
        let which = random.below(variants.len());
        let mut theirs = variants[which].description.clone();
        let of = |theirs: &Description| Comparison::of(&ours, theirs, &[], &[]).explained_by(&ours, theirs, &variants, &[]);
        let found = of(&theirs);
        let dynamics = || found.differences().filter(|found| found.field.weight() == Weight::Dynamics);
        assert!(dynamics().count() > 0 && dynamics().all(|found| found.cause == causes[which]), "{k}: {found:#?}");
        assert!(!found.refuted.iter().any(|text| text.starts_with(&variants[which].text)), "{k}: {:?}", found.refuted);
        // One number is another, in the tenth digit: this hypothesis does not hold.
        if which == 0 {
            theirs.gravity[0] += 1e-9;
        } else {
            theirs.bodies[0].mass *= 1.0 + 1e-10;
        }
        let found = of(&theirs);
        assert!(
            found.differences().all(
                |found| found.cause != causes[which] || which == 1 && (found.body != ours.bodies[0].name || found.field != Field::Mass)
            )
        );
        assert!(found.refuted.iter().any(|text| text.starts_with(&variants[which].text)), "{k}: {:?}", found.refuted);
    }
}

/// Bodies that lost their joint, with their mass or without; where the carrier's mass is neither, nothing is claimed.
#[test]
fn a_merge_is_claimed_where_the_mass_is_found() {
    for k in (0..400).step_by(one_of(10)) {
        let mut random = Random::new(46, k as u64);
        let ours = robot(&mut random);
        let carried = |i: &usize| {
            let body = &ours.bodies[*i];
            body.mass > 1e-3 && body.parent.is_some_and(|parent| ours.bodies[parent].mass > 0.0)
        };
        let candidates: Vec<usize> = (0..ours.bodies.len()).filter(carried).collect();
        let at = candidates[random.below(candidates.len())];
        let (name, parent) = (ours.bodies[at].name.clone(), ours.bodies[at].parent.unwrap());
        let mut theirs = ours.clone();
        let joint = &theirs.bodies[at].joint;
        theirs.bodies[at].joint = JointDescription { name: joint.name.clone(), placement: joint.placement, ..Default::default() };
        let due = match random.below(3) {
            0 => Cause::Merged,
            1 => {
                (theirs.bodies[at].mass, theirs.bodies[at].inertia) = (0.0, [0.0; 6]);
                Cause::Dropped
            }
            _ => {
                theirs.bodies[parent].mass += random.uniform(0.1, 2.0) * ours.bodies[at].mass;
                Cause::Number
            }
        };
        let theirs = theirs.canonical().unwrap();
        let found = Comparison::of(&ours, &theirs, &[], &[]);
        let missing: Vec<_> =
            found.differences().filter(|found| found.field == Field::Body).map(|found| (&found.body, found.cause)).collect();
        assert_eq!(missing, [(&name, due)], "{k}: {found:#?}");
    }
}

/// A body of the world without a partner leaves its mass in no number: it is fixed to the world if a frame says so, else it is lost.
#[test]
fn a_body_of_the_world_without_a_trace_is_lost() {
    let mut random = Random::new(47, 0);
    for _ in (0..200).step_by(one_of(10)) {
        let arm = |name: &str, random: &mut Random| BodyDescription {
            name: name.into(),
            parent: None,
            mass: random.uniform(0.5, 3.0),
            com: random.direction(),
            inertia: [0.2, 0.0, 0.0, 0.3, 0.0, 0.4],
            joint: JointDescription {
                name: format!("{name}_joint"),
                kind: JointType::Revolute { axis: random.direction() },
                ..Default::default()
            },
        };
        let ours = Description { bodies: vec![arm("left", &mut random), arm("right", &mut random)], ..Description::default() };
        let mut theirs = Description { bodies: vec![ours.bodies[0].clone()], ..ours.clone() };
        let cause = |theirs: &Description| {
            let found: Vec<_> =
                Comparison::of(&ours, theirs, &[], &[]).differences().map(|found| (found.body.clone(), found.cause)).collect();
            assert_eq!(found.len(), 1, "{found:?}");
            found[0].clone()
        };
        assert_eq!(cause(&theirs), ("right".to_owned(), Cause::Dropped));
        theirs.frames.push(featherbench_model::Frame { name: "right".into(), body: None, placement: Default::default() });
        assert_eq!(cause(&theirs), ("right".to_owned(), Cause::Merged));
    }
}
