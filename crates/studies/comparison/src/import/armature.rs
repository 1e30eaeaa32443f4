//! Armature on free joints. Engines mean different things by it, so descriptions do not have it. The parsers' notes are compared instead.

use super::comparison::SingleDifference;
use super::fields::{digits, relative};
use super::{Cause, Difference, Field};
use featherbench_bench::ImportNote;

/// The word of notes about it.
const FREE_ARMATURE: &str = "free_armature";

/// Whether an engine has another armature on a free joint than the reference: the notes of both give what they removed.
pub(super) fn on_free_joints(reference: &[ImportNote], notes: &[ImportNote]) -> Vec<SingleDifference> {
    let of = |notes: &[ImportNote], joint: &str| -> Vec<f64> {
        let held = notes.iter().find(|note| note.cause == FREE_ARMATURE && note.about.as_deref() == Some(joint));
        held.filter(|note| note.numbers.len() == 6).map_or_else(|| vec![0.0; 6], |note| note.numbers.clone())
    };
    let mut joints: Vec<&str> = Vec::new();
    for note in reference.iter().chain(notes).filter(|note| note.cause == FREE_ARMATURE) {
        joints.extend(note.about.as_deref().filter(|joint| !joints.contains(joint)));
    }
    let written = |list: &[f64], size: f64| format!("({})", list.iter().map(|&x| digits(x, size)).collect::<Vec<_>>().join(", "));
    let finding = |joint: &str| {
        let (ours, theirs) = (of(reference, joint), of(notes, joint));
        let size = relative(&ours, &theirs);
        let cause = if theirs == [0.0; 6] { Cause::Unsupported } else { Cause::Number };
        let difference = Difference {
            body: joint.to_owned(),
            field: Field::Armature,
            ours: written(&ours, size),
            theirs: written(&theirs, size),
            size,
            cause,
            account: None,
            note: Some("armature of a free joint: it is taken out of both sides before answers are compared".into()),
        };
        (ours != theirs).then_some(SingleDifference { difference, alone: None })
    };
    joints.into_iter().filter_map(finding).collect()
}

#[cfg(test)]
mod tests {
    use super::{Cause, Field, on_free_joints};
    use featherbench_bench::ImportNote;

    fn holds(armature: f64) -> Vec<ImportNote> {
        vec![ImportNote { cause: "free_armature".into(), about: Some("root".into()), text: String::new(), numbers: vec![armature; 6] }]
    }

    #[test]
    fn what_only_one_holds_or_both_hold_otherwise_is_found() {
        assert!(on_free_joints(&holds(0.1), &holds(0.1)).is_empty());
        assert!(on_free_joints(&[], &[]).is_empty());
        let found = |ours: &[ImportNote], theirs: &[ImportNote]| {
            let found = on_free_joints(ours, theirs);
            assert_eq!(found.len(), 1);
            assert_eq!((found[0].difference.field, found[0].difference.body.as_str()), (Field::Armature, "root"));
            (found[0].difference.cause, found[0].difference.size)
        };
        assert_eq!(found(&holds(0.1), &[]), (Cause::Unsupported, 1.0));
        assert_eq!(found(&[], &holds(0.1)), (Cause::Number, 1.0));
        assert_eq!(found(&holds(0.2), &holds(0.1)), (Cause::Number, 0.5));
    }
}
