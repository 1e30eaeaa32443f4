//! Hypotheses about a whole file: what it would be if one thing of it were read otherwise, by the engine that is the reference of its format.
//!
//! A variant is named if the engine's robot is that of the variant in *every* body and field that the variant changes, to rounding.
//! Variants compete: the one that accounts for most differences is named first, and of equals the one with fewer edits. One that accounts
//! for what several with fewer edits do together is not named. The others are listed with the first number that refutes them.

use super::comparison::{Alone, Comparison, SingleDifference};
use super::fields::{self, Precision};
use super::{Cause, Difference, Field, Weight};
use featherbench_bench::{ImportNote, ImportVariant};
use featherbench_model::Description;

/// The cause of a variant.
fn cause(word: &str) -> Cause {
    match word {
        "gravity_ignored" => Cause::GravityIgnored,
        "total_mass" => Cause::TotalMass,
        "first_tree" => Cause::FirstTree,
        "frame_skipped" => Cause::FrameSkipped,
        "world_pose" => Cause::WorldPose,
        "free_pose" => Cause::FreePose,
        "inertia_groups" => Cause::InertiaGroups,
        "joint_ref" => Cause::JointRef,
        "shell" => Cause::Shell,
        "classes" | "nested_classes" | "defaults" | "class_mass" | "childclass" => Cause::Classes,
        "inertial_ignored" => Cause::InertialIgnored,
        "first_compiler" => Cause::FirstCompiler,
        "axis_length" => Cause::AxisLength,
        "default_inertia" => Cause::DefaultInertia,
        "unseen_geoms" => Cause::UnseenGeoms,
        "first_geoms" => Cause::FirstGeoms,
        "inertial_frame" => Cause::InertialFrame,
        "freejoint_ignored" => Cause::FreejointIgnored,
        "euler_sequence" => Cause::EulerSequence,
        "degrees" => Cause::Degrees,
        _ => Cause::Edited,
    }
}

/// Names the variants that give the engine's numbers as causes; returns the refuted ones, each with a reason.
pub(super) fn explain(found: &mut Comparison, ours: &Description, theirs: &Description, variants: &[ImportVariant]) -> Vec<String> {
    let reach = fields::reach(ours).max(fields::reach(theirs));
    let mut refuted = Vec::new();
    let mut standing: Vec<(&ImportVariant, Vec<usize>)> = Vec::new();
    for variant in variants {
        let predicted = Comparison::of(ours, &variant.description, &[], &[]);
        match covered(&predicted, found, reach) {
            Ok(places) if !places.is_empty() => standing.push((variant, places)),
            Ok(_) => {}
            // Those of several edits are many, and each edit is listed by itself.
            Err(reason) if variant.edits == 1 => refuted.push(format!("{}: {reason}", variant.text)),
            Err(_) => {}
        }
    }
    let composed = |k: usize| {
        let (_, places) = &standing[k];
        let fewer = |other: &ImportVariant| other.edits < standing[k].0.edits;
        let parts = standing[..k]
            .iter()
            .filter(|(other, of)| fewer(other) && of.len() < places.len() && of.iter().all(|place| places.contains(place)));
        let covered: Vec<usize> = parts.flat_map(|(_, of)| of).copied().collect();
        places.iter().all(|place| covered.contains(place))
    };
    let composed: Vec<bool> = (0..standing.len()).map(composed).collect();
    let mut composed = composed.into_iter();
    standing.retain(|_| composed.next() == Some(false));
    standing.sort_by_key(|(_, places)| std::cmp::Reverse(places.len()));
    let mut claimed = vec![false; found.findings.len()];
    for (variant, places) in standing {
        let open: Vec<usize> = places.into_iter().filter(|&k| !claimed[k]).collect();
        if open.is_empty() && variant.edits == 1 {
            refuted.push(format!("{}: it accounts for nothing that another does not", variant.text));
        }
        for k in open {
            claimed[k] = true;
            let difference = &mut found.findings[k].difference;
            (difference.cause, difference.account) = (cause(&variant.cause), Some(variant.text.clone()));
            if difference.field == Field::Body && difference.cause != Cause::FreejointIgnored {
                difference.theirs = LOST.into();
            }
        }
    }
    refuted
}

/// What an engine has of a body that it lost.
pub(super) const LOST: &str = "none, and its mass is gone";

/// The places of the differences that a variant predicts; the first that refutes it, if one does.
fn covered(predicted: &Comparison, found: &Comparison, reach: f64) -> Result<Vec<usize>, String> {
    let place = |difference: &Difference, field: Field| {
        found.findings.iter().position(|other| other.difference.body == difference.body && other.difference.field == field)
    };
    let mut places = Vec::new();
    let mut felt = false;
    for finding in &predicted.findings {
        let difference = &finding.difference;
        // Of a body that the engine does not have, only this can be seen.
        if difference.field != Field::Body && !difference.body.is_empty() && place(difference, Field::Body).is_some() {
            continue;
        }
        let at = place(difference, difference.field);
        let same = at.filter(|&k| equal(&predicted.ours, finding, &found.findings[k], reach, found.precision));
        let dynamics = difference.field.weight() == Weight::Dynamics;
        match same {
            Some(k) => {
                felt |= dynamics;
                places.push(k);
            }
            None if dynamics => return Err(refutation(difference, at.map(|k| &found.findings[k].difference))),
            None => {}
        }
    }
    Ok(if felt { places } else { Vec::new() })
}

fn refutation(due: &Difference, held: Option<&Difference>) -> String {
    let body = if due.body.is_empty() { "the robot" } else { &due.body };
    let held = held.map_or_else(|| format!("it has {}", due.ours), |held| format!("it has {}", held.theirs));
    format!("{body}: {} would be {}, and {held}", due.field.name().replace('_', " "), due.theirs)
}

/// Whether two differences of one place are to the same value; `ours` is the robot of the first.
fn equal(ours: &Description, due: &SingleDifference, held: &SingleDifference, reach: f64, precision: Precision) -> bool {
    let tested = precision.tested();
    let field = due.difference.field;
    if field == Field::Body {
        let missing = |finding: &SingleDifference| finding.difference.cause != Cause::Added;
        return missing(due) && missing(held);
    }
    match (&due.alone, &held.alone) {
        (Some(Alone::Gravity(a)), Some(Alone::Gravity(b))) => fields::distance(*a, *b) <= tested * fields::norm(*a).max(fields::norm(*b)),
        (Some(Alone::Body(i, a)), Some(Alone::Body(_, b))) => {
            let links = 1 + ours.frames.iter().filter(|frame| frame.body == Some(*i)).count();
            fields::size(field, a, b, reach) <= tested * links as f64
        }
        _ => due.difference.theirs == held.difference.theirs,
    }
}

/// What the check after loading found: matrices that are no rotations and masses that are none. A difference of the engine in that body,
/// whatever the nearest sound number is.
pub(super) fn unsound(found: &mut Comparison, ours: &Description, notes: &[ImportNote]) {
    let words = [("not_a_rotation", Cause::NotARotation, Field::Placement), ("not_a_mass", Cause::NotAMass, Field::Mass)];
    for note in notes {
        let Some((_, cause, field)) = words.iter().find(|(word, ..)| note.cause == *word) else { continue };
        let about = note.about.clone().unwrap_or_default();
        // What replaced the matrix is in no engine.
        found.findings.retain(|other| other.difference.body != about || other.difference.field != *field);
        let body = ours.bodies.iter().find(|body| body.name == about);
        let due = body.map_or_else(|| "a rotation".to_owned(), |body| fields::written(*field, body, 1.0));
        let difference = Difference {
            body: about,
            field: *field,
            ours: due,
            theirs: note.text.clone(),
            size: 1.0,
            cause: *cause,
            account: Some(note.text.clone()),
            note: None,
        };
        found.findings.push(SingleDifference { difference, alone: None });
    }
}
