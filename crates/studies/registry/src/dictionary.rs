//! What the names in rows mean: each study brings its words, and `schema.json` of a run has those that occur in it.

use crate::STUDIES;
use featherbench_answers::lesson;
use featherbench_results::{Dictionary, Named, Quantity, Row};
use featherbench_speed::operations;

/// Keys of `params` that several studies have with one meaning.
const PARAMS: [(&str, &str); 4] = [
    ("case", "the numbers that define the case, by name"),
    ("deviation", "the id of the known deviation that explains the row"),
    ("seed", "the seed of what is drawn"),
    ("seconds", "for how long it was timed, in s"),
];

/// The dictionary of rows: every name that occurs in them, with its meaning.
pub fn dictionary(rows: &[Row]) -> Dictionary {
    Dictionary::of(rows, meaning)
}

/// What a name in a column means in the rows of a study.
pub(crate) fn meaning(study: &str, column: Named, name: &str) -> Option<String> {
    let words = &STUDIES.iter().find(|entry| entry.name == study)?.words;
    let own = |list: &[(&str, &'static str)]| {
        let exact = list.iter().find(|(known, _)| *known == name);
        exact.or_else(|| list.iter().find(|(known, _)| stands_for(known, name))).map(|(_, meaning)| (*meaning).to_owned())
    };
    match column {
        Named::Quantity => of_quantity(name).or_else(|| of_claim(study, name)).or_else(|| own(words.quantities)),
        Named::Metric => {
            let counted = ["operations", "scaling"].contains(&study).then(|| own(&operations::COUNTS)).flatten();
            counted.or_else(|| own(words.metrics))
        }
        Named::Parameter => own(words.params).or_else(|| own(&PARAMS)),
    }
}

/// A quantity of engines: its title, and the measure of its error.
fn of_quantity(name: &str) -> Option<String> {
    let quantity = Quantity::parse(name)?;
    // A title that is the name itself explains nothing.
    let title = if quantity.title() == name { quantity.words() } else { quantity.title() };
    Some(if quantity.error().is_empty() { title.to_owned() } else { format!("{title}; its error: {}", quantity.error()) })
}

/// A claim of the lesson: what it is about, and what is right.
fn of_claim(study: &str, name: &str) -> Option<String> {
    let claim =
        (study == lesson::STUDY).then(|| featherbench_lesson::claims::all().into_iter().find(|claim| claim.id == name)).flatten()?;
    Some(format!("{}: {}", claim.title, claim.right))
}

/// Whether a name with a `*` stands for another.
fn stands_for(pattern: &str, name: &str) -> bool {
    let Some((before, after)) = pattern.split_once('*') else { return false };
    name.len() > before.len() + after.len() && name.starts_with(before) && name.ends_with(after)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;
    use std::path::{Path, PathBuf};

    fn sources(folder: &Path, into: &mut Vec<(PathBuf, String)>) {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                sources(&path, into);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                let text = std::fs::read_to_string(&path).unwrap();
                into.push((path, text));
            }
        }
    }

    /// The texts in quotes that follow a beginning, up to the next quote.
    fn after<'t>(text: &'t str, beginning: &'t str) -> impl Iterator<Item = &'t str> {
        text.split(beginning).skip(1).filter_map(|rest| rest.split('"').next())
    }

    fn is_name(text: &str) -> bool {
        !text.is_empty() && text.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_')
    }

    #[test]
    fn every_metric_and_quantity_in_the_sources_is_explained() {
        let mut checked = 0;
        let mut missing = BTreeSet::new();
        for entry in STUDIES {
            let mut files = Vec::new();
            let rooms = ["comparison", "answers", "speed"];
            let of_room = |room: &str| Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(room).join("src").join(entry.name);
            sources(&rooms.map(of_room).into_iter().find(|folder| folder.exists()).unwrap(), &mut files);
            let of_rows = |path: &Path| {
                let text = path.to_string_lossy();
                !["tests.rs", "words.rs"].iter().any(|end| text.ends_with(end)) && !text.contains("section")
            };
            for (path, text) in files.iter().filter(|(path, _)| of_rows(path)) {
                // Tests in a file follow its code.
                let code = text.split("#[cfg(test)]").next().unwrap_or_default();
                let metrics =
                    ["told(\"", "error(\"", "count(\"", "metric: \"", "row(\"", "of(\""].into_iter().flat_map(|at| after(code, at));
                for (column, name) in metrics
                    .map(|name| (Named::Metric, name))
                    .chain(after(code, "quantity: \"").map(|name| (Named::Quantity, name)))
                    .filter(|(_, name)| is_name(name))
                {
                    checked += 1;
                    if meaning(entry.name, column, name).is_none() {
                        missing.insert(format!("{}: {column:?} {name} ({})", entry.name, path.display()));
                    }
                }
            }
        }
        assert!(checked > 250, "{checked} names found");
        assert!(missing.is_empty(), "no words.rs explains {missing:#?}");
    }

    #[test]
    fn every_quantity_of_the_counted_suites_is_explained() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../ci/counts.csv");
        let text = std::fs::read_to_string(path).unwrap();
        let mut checked = 0;
        for line in text.lines().skip(1) {
            let fields: Vec<&str> = line.split(',').collect();
            if !fields[3].is_empty() {
                assert!(meaning(fields[1], Named::Quantity, fields[3]).is_some(), "no words.rs explains {line}");
                checked += 1;
            }
        }
        assert!(checked > 300, "{checked} lines");
    }

    #[test]
    fn no_word_is_left_of_a_name_that_is_gone() {
        let mut files = Vec::new();
        sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../.."), &mut files);
        let words = |path: &Path| path.ends_with("words.rs") || path.ends_with("registry/src/dictionary.rs");
        let files: Vec<String> = files.into_iter().filter(|(path, _)| !words(path)).map(|(_, text)| text).collect();
        // What is between two quotes.
        let quoted: BTreeSet<&str> = files.iter().flat_map(|text| text.split('"').skip(1)).collect();
        // A parameter may be the field of a type.
        let is_name = |c: char| c.is_alphanumeric() || c == '_';
        let fields: BTreeSet<&str> =
            files.iter().flat_map(|text| text.split(": ")).filter_map(|text| text.rsplit(|c| !is_name(c)).next()).collect();
        for entry in STUDIES {
            let words = &entry.words;
            for (name, meaning) in words.quantities.iter().chain(words.metrics).chain(words.params).chain(&PARAMS) {
                assert!(!meaning.is_empty(), "{}: {name}", entry.name);
                let found = match name.split_once('*') {
                    None => quoted.contains(name) || words.params.iter().any(|(param, _)| param == name) && fields.contains(name),
                    Some((begin, _)) => quoted.range(begin..).next().is_some_and(|text| text.starts_with(begin)),
                };
                assert!(found, "{}: no source writes {name}; take it out of words.rs", entry.name);
            }
        }
    }

    #[test]
    fn a_star_stands_for_any_text() {
        assert!(stands_for("x_*", "x_12") && stands_for("drift_*", "drift_1000s") && !stands_for("x_*", "x_") && !stands_for("x", "x"));
    }

    #[test]
    fn rows_give_a_dictionary_with_units() {
        let row = |metric: &str, unit: &str| Row {
            study: "growth".into(),
            metric: metric.into(),
            unit: unit.into(),
            quantity: "fd".into(),
            params: "{\"line\":\"chain\",\"unheard_of\":1}".into(),
            ..Row::default()
        };
        let found = dictionary(&[row("seconds", "s"), row("error", "1"), row("nobody_knows", "1")]);
        let of = |list: &[featherbench_results::Term]| -> Vec<(String, Vec<String>, bool)> {
            list.iter().map(|term| (term.name.clone(), term.units.clone(), term.meaning.is_empty())).collect()
        };
        let text = |units: &[&str]| units.iter().map(|unit| (*unit).to_owned()).collect::<Vec<_>>();
        assert_eq!(of(&found.quantities), [("fd".into(), text(&["ratio", "s"]), false)]);
        assert_eq!(
            of(&found.metrics),
            [
                ("error".into(), text(&["ratio"]), false),
                ("nobody_knows".into(), text(&["ratio"]), true),
                ("seconds".into(), text(&["s"]), false)
            ]
        );
        assert_eq!(of(&found.parameters), [("line".into(), text(&[]), false), ("unheard_of".into(), text(&[]), true)]);
        assert_eq!(found.unexplained(), ["growth: nobody_knows", "growth: unheard_of"]);
    }
}
