//! Names that are near to one that does not exist, for messages.

/// The largest distance of a name that is offered, as a part of the word's length: more is no slip of the fingers.
const SLIP: usize = 2;

/// `; did you mean 'pinocchio'?`, or nothing if no name is near: at most half of the word's letters differ.
///
/// ```
/// assert_eq!(featherbench_bench::did_you_mean("pinochio", ["drake", "pinocchio"]), "; did you mean 'pinocchio'?");
/// assert_eq!(featherbench_bench::did_you_mean("bullet", ["drake", "pinocchio"]), "");
/// ```
pub fn did_you_mean<'a>(word: &str, names: impl IntoIterator<Item = &'a str>) -> String {
    let near = names.into_iter().map(|name| (distance(word, name), name)).min();
    let limit = word.chars().count().div_ceil(SLIP);
    near.filter(|(letters, _)| *letters <= limit).map_or_else(String::new, |(_, name)| format!("; did you mean '{name}'?"))
}

/// Levenshtein's distance, in letters.
pub fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, letter) in a.chars().enumerate() {
        let mut diagonal = std::mem::replace(&mut row[0], i + 1);
        for (j, other) in b.iter().enumerate() {
            let changed = diagonal + usize::from(letter != *other);
            diagonal = row[j + 1];
            row[j + 1] = changed.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_count_letters() {
        for (a, b, due) in
            [("", "", 0), ("fd", "fd", 0), ("fdd", "fd", 1), ("", "id", 2), ("pinochio", "pinocchio", 1), ("panda", "hand", 2)]
        {
            assert_eq!((distance(a, b), distance(b, a)), (due, due), "{a} {b}");
        }
    }

    #[test]
    fn only_near_names_are_offered() {
        assert_eq!(did_you_mean("smok", ["default", "smoke"]), "; did you mean 'smoke'?");
        assert_eq!(did_you_mean("x", ["default", "smoke"]), "");
        assert_eq!(did_you_mean("smoke", []), "");
    }
}
