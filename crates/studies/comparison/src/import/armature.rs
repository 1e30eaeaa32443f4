//! Armature that descriptions do not have: on free joints, by which engines mean different things, and of tendons and actuators. The parsers'
//! notes are compared instead.

use super::comparison::SingleDifference;
use super::fields::{digits, relative};
use super::{Cause, Difference, Field};
use featherbench_bench::ImportNote;

/// The words of notes about it, each with what holds it and how many numbers it has.
const WORDS: [(&str, &str, usize); 3] = [(FREE, "free joint", 6), ("tendon_armature", "tendon", 1), ("actuator_armature", "actuator", 1)];
const FREE: &str = "free_armature";

/// Whether an engine has another armature of this kind than the reference: the notes of both give what they removed.
pub(super) fn beside_descriptions(reference: &[ImportNote], notes: &[ImportNote]) -> Vec<SingleDifference> {
    WORDS.into_iter().flat_map(|word| of_kind(word, reference, notes)).collect()
}

fn of_kind((word, holder, count): (&str, &str, usize), reference: &[ImportNote], notes: &[ImportNote]) -> Vec<SingleDifference> {
    let of = |notes: &[ImportNote], name: &str| -> Vec<f64> {
        let held = notes.iter().find(|note| note.cause == word && note.about.as_deref() == Some(name));
        held.filter(|note| note.numbers.len() == count).map_or_else(|| vec![0.0; count], |note| note.numbers.clone())
    };
    let mut names: Vec<&str> = Vec::new();
    for note in reference.iter().chain(notes).filter(|note| note.cause == word) {
        names.extend(note.about.as_deref().filter(|name| !names.contains(name)));
    }
    let written = |list: &[f64], size: f64| format!("({})", list.iter().map(|&x| digits(x, size)).collect::<Vec<_>>().join(", "));
    let finding = |name: &str| {
        let (ours, theirs) = (of(reference, name), of(notes, name));
        let size = relative(&ours, &theirs);
        let cause = match theirs.iter().all(|&x| x == 0.0) {
            _ if word != FREE => Cause::AddedArmature,
            true => Cause::Unsupported,
            false => Cause::Number,
        };
        let difference = Difference {
            body: name.to_owned(),
            field: Field::Armature,
            ours: written(&ours, size),
            theirs: written(&theirs, size),
            size,
            cause,
            account: Some(format!("armature of the {holder}, a part of M; it is taken out of both sides before answers are compared")),
            note: None,
        };
        (ours != theirs).then_some(SingleDifference { difference, alone: None })
    };
    names.into_iter().filter_map(finding).collect()
}

#[cfg(test)]
mod tests {
    use super::{Cause, Field, beside_descriptions};
    use featherbench_bench::ImportNote;

    fn holds_as(cause: &str, numbers: Vec<f64>) -> Vec<ImportNote> {
        vec![ImportNote { cause: cause.into(), about: Some("root".into()), text: String::new(), numbers }]
    }

    fn holds(armature: f64) -> Vec<ImportNote> {
        holds_as("free_armature", vec![armature; 6])
    }

    /// A tendon and an actuator may have the same name: each is compared with its own kind.
    #[test]
    fn kinds_of_armature_are_told_apart() {
        let [tendon, actuator] = ["tendon_armature", "actuator_armature"].map(|cause| holds_as(cause, vec![0.3]));
        assert!(beside_descriptions(&tendon, &tendon).is_empty());
        let found = beside_descriptions(&tendon, &actuator);
        assert_eq!(found.iter().map(|found| found.difference.cause).collect::<Vec<_>>(), [Cause::AddedArmature; 2]);
        assert!(found.iter().all(|found| found.difference.field == Field::Armature && found.difference.size == 1.0));
    }

    #[test]
    fn what_only_one_holds_or_both_hold_otherwise_is_found() {
        assert!(beside_descriptions(&holds(0.1), &holds(0.1)).is_empty());
        assert!(beside_descriptions(&[], &[]).is_empty());
        let found = |ours: &[ImportNote], theirs: &[ImportNote]| {
            let found = beside_descriptions(ours, theirs);
            assert_eq!(found.len(), 1);
            assert_eq!((found[0].difference.field, found[0].difference.body.as_str()), (Field::Armature, "root"));
            (found[0].difference.cause, found[0].difference.size)
        };
        assert_eq!(found(&holds(0.1), &[]), (Cause::Unsupported, 1.0));
        assert_eq!(found(&[], &holds(0.1)), (Cause::Number, 1.0));
        assert_eq!(found(&holds(0.2), &holds(0.1)), (Cause::Number, 0.5));
    }
}
