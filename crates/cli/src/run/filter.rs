//! `--filter`: a filter that lets nothing through is a mistake, and its words are compared with those that there are.

use crate::fail::Fail;
use regex_lite::Regex;
use std::collections::BTreeSet;
use strsim::levenshtein;

/// Names that are shown for each word that is none.
const SHOWN: usize = 4;

/// Refuses a filter that matches no path of the cells of a suite.
pub fn check(text: &str, only: &Regex, suite: &str, paths: &[String]) -> Result<(), Fail> {
    if paths.iter().any(|path| only.is_match(path)) {
        return Ok(());
    }
    let names: BTreeSet<&str> = paths.iter().flat_map(|path| path.split('/')).filter(|name| !name.is_empty()).collect();
    let mut hints: Vec<String> = pieces(text).filter_map(|word| hint(word, &names)).collect();
    if hints.is_empty() {
        let column = |place: usize| paths.iter().filter_map(|path| path.split('/').nth(place)).collect::<BTreeSet<_>>();
        let listed = |place: usize| column(place).into_iter().collect::<Vec<_>>().join(", ");
        hints.push(format!("the studies are {}; the engines {}; the quantities {}", listed(0), listed(2), listed(3)));
    }
    Err(Fail::input(format!(
        "--filter: no cell of the suite {suite} matches '{text}'; a path is study/robot/engine/quantity/method; {}",
        hints.join("; ")
    )))
}

/// The plain words of a regular expression.
fn pieces(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !(c.is_alphanumeric() || c == '_' || c == '-')).filter(|word| word.len() > 1)
}

/// The names that are nearest to a word which is no part of any.
fn hint(word: &str, names: &BTreeSet<&str>) -> Option<String> {
    if names.iter().any(|name| name.contains(word)) {
        return None;
    }
    let mut near: Vec<(usize, &str)> = names.iter().map(|name| (levenshtein(word, name), *name)).collect();
    near.sort_unstable();
    let listed: Vec<&str> = near.into_iter().take(SHOWN).map(|(_, name)| name).collect();
    Some(format!("nothing is named '{word}': nearest are {}", listed.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_filter_without_a_match_is_told_what_is_near() {
        let paths = ["agreement/panda/pinocchio/fd/aba", "agreement/panda/mujoco/id/rne"].map(str::to_owned);
        let said = |text: &str| check(text, &Regex::new(text).unwrap(), "smoke", &paths).map_err(|fail| fail.to_string());
        assert!(said("panda/.*/fd").is_ok() && said("").is_ok());
        let message = said("pandda/pinochio/fd").unwrap_err();
        assert!(message.contains("'pandda': nearest are panda,") && message.contains("'pinochio': nearest are pinocchio,"), "{message}");
        assert!(!message.contains("'fd'"), "what there is, is no mistake: {message}");
        let message = said("pinocchio/id").unwrap_err();
        assert!(message.contains("the engines mujoco, pinocchio; the quantities fd, id"), "{message}");
    }
}
