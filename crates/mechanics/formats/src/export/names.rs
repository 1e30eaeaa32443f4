//! Names that a file can hold, each once.

use super::{Loss, Reason};
use std::collections::HashSet;

/// The names of one kind, each of which must be unique.
#[derive(Default)]
pub struct Names(HashSet<String>);

impl Names {
    /// Takes a name, or says what is wrong with it.
    pub fn take(&mut self, what: &str, name: &str, losses: &mut Vec<Loss>) {
        let mut lose = |reason| losses.push(Loss { about: format!("{what} '{}'", name.escape_debug()), reason });
        if name.is_empty() || !can_be_written(name) {
            lose(Reason::BadName);
        }
        if !self.0.insert(name.to_owned()) {
            lose(if name == ROOT { Reason::ReservedName } else { Reason::RepeatedName });
        }
    }

    /// Takes a name like this one that is not yet used.
    pub fn fresh(&mut self, wish: &str) -> String {
        let mut name = wish.to_owned();
        while !self.0.insert(name.clone()) {
            name.push('_');
        }
        name
    }
}

/// Whether XML can hold a name (it excludes control characters), and no URDF parser takes it for a macro.
pub fn can_be_written(name: &str) -> bool {
    let bad = |c: char| c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}');
    !name.contains(bad) && !name.contains("${") && !name.contains("$(")
}

/// What is wrong with the robot's own name, which may be empty.
pub fn of_robot(name: &str) -> Option<Loss> {
    (!can_be_written(name)).then(|| Loss { about: format!("robot '{}'", name.escape_debug()), reason: Reason::BadName })
}

/// The name of the fixed root.
pub const ROOT: &str = "world";
