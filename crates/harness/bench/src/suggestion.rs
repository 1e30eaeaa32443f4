//! Names that are near to one that does not exist, for messages.

use strsim::levenshtein;

/// The largest distance of a name that is offered, as a part of the word's length: more is no slip of the fingers.
const SLIP: usize = 2;

/// `; did you mean 'pinocchio'?`, or nothing if no name is near: at most half of the word's letters differ.
///
/// ```
/// assert_eq!(featherbench_bench::did_you_mean("pinochio", ["drake", "pinocchio"]), "; did you mean 'pinocchio'?");
/// assert_eq!(featherbench_bench::did_you_mean("bullet", ["drake", "pinocchio"]), "");
/// ```
pub fn did_you_mean<'a>(word: &str, names: impl IntoIterator<Item = &'a str>) -> String {
    let near = names.into_iter().map(|name| (levenshtein(word, name), name)).min();
    let limit = word.chars().count().div_ceil(SLIP);
    near.filter(|(letters, _)| *letters <= limit).map_or_else(String::new, |(_, name)| format!("; did you mean '{name}'?"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_near_names_are_offered() {
        assert_eq!(did_you_mean("smok", ["default", "smoke"]), "; did you mean 'smoke'?");
        assert_eq!(did_you_mean("x", ["default", "smoke"]), "");
        assert_eq!(did_you_mean("smoke", []), "");
    }
}
