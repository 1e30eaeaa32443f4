//! Makes the golden data of `datasets/truth` from both witnesses, or prints the question of one case.
//!
//!     cargo run --release -p featherbench-reference --features examples --example golden -- make [PYTHON]
//!     cargo run --release -p featherbench-reference --features examples --example golden -- show planar_small_10
//!
//! PYTHON is an interpreter with mpmath and numpy; the default is the one that `featherbench oracles install` makes.

#[path = "../tests/support/mod.rs"]
mod support;

use featherbench_reference::{Mp, Precision, nearest_doubles};
use featherbench_results::Checksums;
use serde_json::{Value, json};
use std::error::Error;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use support::golden::{Answers, COLUMNS, DIGITS, SEED, folder, hash_of_doubles, hash_of_python, hash_of_rust, hash_of_state};
use support::{CASES, Case, State, distance, oracle};

/// Digits that the witnesses exchange.
const EXCHANGED: usize = 130;
/// The largest disagreement that is accepted.
const ACCEPTED: f64 = 1e-100;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["make"] => make(&oracle::python("mpmath, numpy").ok_or("no Python with mpmath; run `featherbench oracles install` or name one")?),
        ["make", python] => make(&PathBuf::from(python)),
        ["show", name] => {
            let case = CASES.iter().find(|case| case.name == name).ok_or("there is no such case")?;
            println!("{}", question(case, &case.state(SEED, 0))?);
            Ok(())
        }
        _ => Err("usage: golden make [PYTHON] | golden show CASE".into()),
    }
}

fn make(python: &Path) -> Result<(), Box<dyn Error>> {
    std::fs::create_dir_all(folder())?;
    let mut cases = Vec::new();
    for case in &CASES {
        let started = std::time::Instant::now();
        let state = case.state(SEED, 0);
        let answers = Answers::derive(case, &state)?;
        let here = started.elapsed();
        let theirs = ask(python, &question(case, &state)?)?;
        let mut disagreement = Mp::zero();
        for (name, ours) in [("id", &answers.id), ("fd", &answers.fd), ("mass_matrix", &answers.mass_matrix)] {
            disagreement = disagreement.max(distance(&numbers(&theirs[name])?, ours));
        }
        println!("{:<20} {disagreement:?}  Rust {here:.1?}, both {:.1?}", case.name, started.elapsed());
        if disagreement.to_f64() > ACCEPTED {
            return Err(format!("{}: the witnesses disagree by {disagreement:?}", case.name).into());
        }
        write(case, &answers)?;
        cases.push(json!({
            "name": case.name,
            "family": case.family,
            "bits": Precision::for_dofs(answers.id.len()).get(),
            "state": hash_of_state(&state),
            "mass_matrix": hash_of_doubles(&nearest_doubles(&answers.mass_matrix)),
            "disagreement": format!("{:.0e}", disagreement.to_f64()),
        }));
    }
    let index = json!({
        "format": 1,
        "digits": DIGITS,
        "seed": SEED,
        "rust": hash_of_rust(),
        "python": hash_of_python(),
        "cases": cases,
    });
    std::fs::write(folder().join("index.json"), serde_json::to_string_pretty(&index)? + "\n")?;
    let names: Vec<String> = CASES.iter().map(|case| format!("{}.csv", case.name)).chain(["index.json".to_owned()]).collect();
    Checksums::of(&folder(), &names.iter().map(String::as_str).collect::<Vec<_>>())?.write()?;
    Ok(())
}

/// One row per degree of freedom.
fn write(case: &Case, answers: &Answers) -> Result<(), Box<dyn Error>> {
    let columns = COLUMNS.map(|name| answers.text(name));
    let mut text = COLUMNS.join(",") + "\n";
    for row in 0..answers.id.len() {
        text += &columns.iter().map(|column| column[row].as_str()).collect::<Vec<_>>().join(",");
        text.push('\n');
    }
    std::fs::write(folder().join(format!("{}.csv", case.name)), text)?;
    Ok(())
}

/// The question for `python -m featherbench_oracles.truth --decimals`.
fn question(case: &Case, state: &State) -> Result<String, Box<dyn Error>> {
    let model = featherbench_formats::neutral::to_line(&case.describe())?;
    let State { q, v, a, tau } = state;
    Ok(format!("{{\"model\":{model},\"q\":{q:?},\"v\":{v:?},\"a\":{a:?},\"tau\":{tau:?},\"digits\":{EXCHANGED}}}"))
}

fn ask(python: &Path, question: &str) -> Result<Value, Box<dyn Error>> {
    let mut child = oracle::module(python, "truth").arg("--decimals").stdin(Stdio::piped()).stdout(Stdio::piped()).spawn()?;
    writeln!(child.stdin.take().ok_or("no standard input")?, "{question}")?;
    let output = child.wait_with_output()?;
    Ok(serde_json::from_slice(&output.stdout)?)
}

fn numbers(list: &Value) -> Result<Vec<Mp>, Box<dyn Error>> {
    let texts = list.as_array().ok_or("the Python witness sent no list")?;
    texts.iter().map(|text| Ok(Precision::STANDARD.parse(text.as_str().ok_or("not a text")?)?)).collect()
}
