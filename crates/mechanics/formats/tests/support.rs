//! What the tests of files have in common.

use featherbench_formats::neutral;
use featherbench_model::Description;
use featherbench_robots::Family;
use proptest::prelude::*;
use proptest::sample::Index;

/// A chain of so many hinges, in the gravity of URDF.
pub fn chain(n: usize) -> Description {
    let robot = Family::parse(&format!("chain:n={n},layout=spatial")).and_then(|family| family.generate()).expect("a family");
    Description { gravity: [0.0, 0.0, -9.81], ..robot }
}

/// Written and read again it is the same robot, to the bit: `Debug` gives each number a text of its own, −0 too.
pub fn assert_round_trip(robot: &Description) {
    let text = neutral::to_string(robot).unwrap_or_else(|error| panic!("{}: {error}", robot.name));
    let again = neutral::parse(&text, "robot.json").unwrap_or_else(|error| panic!("{error}\n{text}"));
    assert_eq!(&again, robot);
    assert_eq!(format!("{again:?}"), format!("{robot:?}"));
    assert_eq!(neutral::to_string(&again).as_ref(), Ok(&text), "the same bytes for the same robot");
}

/// A description file in which each placement `P` is the identity.
pub fn placed(text: &str) -> String {
    text.replace(":P", r#":{"rotation":[1,0,0,0,1,0,0,0,1],"translation":[0,0,0]}"#)
}

/// The error of a description file.
pub fn refused(text: &str) -> String {
    neutral::parse(text, "f.json").expect_err(text).to_string()
}

/// A change of a good file (what is replaced, and by what), and the parts of its error.
pub type Change<'a> = (&'a str, &'a str, &'a [&'a str]);

/// Each change is an error that begins with the name of the file.
pub fn assert_named(good: &str, changes: &[Change<'_>], refused: impl Fn(&str) -> String) {
    for (from, to, parts) in changes {
        assert!(good.contains(from), "{from}");
        let error = refused(&good.replacen(from, to, 1));
        assert!(error.starts_with("f."), "{error}");
        for part in *parts {
            assert!(error.contains(part), "{to}\n  {error}\n  lacks {part}");
        }
    }
}

/// Two places of a text, what is done there, and a character for it.
pub type Edit = (Index, Index, usize, char);

/// Fewer edits than `most`.
pub fn edits(most: usize) -> impl Strategy<Value = Vec<Edit>> {
    proptest::collection::vec((any::<Index>(), any::<Index>(), 0_usize..6, any::<char>()), 1..most)
}

/// A text with characters changed, removed, doubled or exchanged, or cut off; an edit is of at most `span` characters.
pub fn edited(text: &str, edits: Vec<Edit>, span: usize) -> String {
    let mut text: Vec<char> = text.chars().collect();
    for (at, to, kind, with) in edits {
        if text.is_empty() {
            break;
        }
        let (at, to) = (at.index(text.len()), to.index(text.len()));
        let (from, to) = (at.min(to), at.max(to).min(at.min(to).saturating_add(span)));
        match kind {
            0 => text[at] = with,
            1 => text[at] = "0123456789-.e\"<>/ "[..].chars().nth(with as usize % 18).unwrap_or('0'),
            2 => _ = text.drain(from..to),
            3 => {
                let copy = text[from..to].to_vec();
                text.splice(from..from, copy);
            }
            4 => text.swap(from, to),
            _ => text.truncate(at),
        }
    }
    text.into_iter().collect()
}
