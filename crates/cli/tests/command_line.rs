//! The manners of the command line: completions, the manual page, lists.

use crate::support;

use support::{Sandbox, project};

#[test]
fn completions_and_the_manual_know_every_command() {
    let sandbox = Sandbox::new();
    for shell in ["bash", "zsh", "fish"] {
        let ended = sandbox.run(&["completions", shell]);
        ended.expect(0, &["featherbench", "compare", "oracles", "markdown"]);
    }
    sandbox.run(&["completions", "tcl"]).expect(2, &["tcl", "bash"]);
    sandbox.run(&["man"]).expect(0, &[".TH featherbench 1", "compare"]);
}

#[test]
fn suites_are_listed_with_their_purpose() {
    let sandbox = Sandbox::new();
    let ended = sandbox.run(&["list", "--suite", "smoke"]);
    let suites = project().join("datasets/suites").read_dir().unwrap().map(|entry| entry.unwrap().path());
    let names: Vec<String> = suites
        .filter(|path| path.extension().is_some_and(|ending| ending == "toml"))
        .map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned())
        .collect();
    assert!(names.len() > 15);
    for name in names {
        let line = ended.output.lines().find(|line| line.starts_with(&format!("  {name} "))).unwrap_or_else(|| panic!("{name}: {ended:?}"));
        assert!(line.len() > name.len() + 20, "{line}");
    }
}
