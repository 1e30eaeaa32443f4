//! The lesson: which of its statements hold, and by how much do the others miss?
//!
//! Each number of each claim of the library `lesson` is a case with two methods: `corrected`, against a second route; and `lesson`, whose distance
//! from the right value is judged against a second route of its own. So the statement that fails does so by exactly this number.
//!
//! - `pipeline.rs`: problem 5, stage by stage.

mod pipeline;
pub(crate) mod section;
#[cfg(test)]
mod tests;
pub(crate) mod words;

use featherbench_bench::{NoAnswer, NoSettings};
use featherbench_lesson::{Claim, Number, claims};
use featherbench_study::Entry;
use featherbench_study::known::{Case, KnownAnswers, error, failed, told};
use serde_json::json;

/// The study's name in rows.
pub const STUDY: &str = "lesson";

/// The method that is right.
const CORRECTED: &str = "corrected";
/// The lesson's statement.
const LESSON: &str = "lesson";

/// The study in the registry.
pub const ENTRY: Entry = Entry {
    name: "lesson",
    make: |setup| setup.made(STUDY, |_: NoSettings| KnownAnswers::new(STUDY, cases())),
    sections: section::sections,
    words: words::WORDS,
};

/// Every case.
fn cases() -> Vec<Case> {
    claims::all().into_iter().flat_map(of_claim).chain(pipeline::cases()).collect()
}

/// The cases of a claim. Its numbers have the same names for every seed.
fn of_claim(claim: Claim) -> Vec<Case> {
    match (claim.numbers)(1) {
        Ok(numbers) => numbers.iter().flat_map(|number| of_number(claim, number)).collect(),
        // The error is the answer of the one case.
        Err(_) => vec![case(claim, "all", CORRECTED, "1")],
    }
}

fn of_number(claim: Claim, number: &Number) -> Vec<Case> {
    let mut cases = vec![case(claim, &number.name, CORRECTED, number.unit)];
    if number.lesson.is_some() {
        cases.push(case(claim, &number.name, LESSON, number.unit));
    }
    cases
}

fn case(claim: Claim, name: &str, method: &'static str, unit: &'static str) -> Case {
    let numbers = if method == LESSON {
        vec![told("value", unit), told("off_by", unit), error("separation_error", "second route")]
    } else {
        vec![told("value", unit), error("error", "second route")]
    };
    let wanted = name.to_owned();
    Case {
        name: name.into(),
        quantity: claim.id,
        method: method.into(),
        params: json!({"place": claim.place}),
        numbers,
        evaluate: Box::new(move |seed| {
            let found = (claim.numbers)(seed).map_err(failed)?;
            let number = found.iter().find(|number| number.name == wanted);
            let number = number.ok_or_else(|| NoAnswer::Failed(format!("there is no number '{wanted}'")))?;
            if method == CORRECTED {
                return Ok(vec![number.corrected, number.error()]);
            }
            let stated = number.lesson.zip(number.off_by()).zip(number.separation_error());
            let ((lesson, off_by), apart) = stated.ok_or_else(|| NoAnswer::Failed(format!("the lesson has no '{wanted}'")))?;
            Ok(vec![lesson.value, off_by, apart])
        }),
    }
}
