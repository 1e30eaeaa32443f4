//! What users expect of a command line: completions, the manual page, lists.

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

fn parsed(ended: &support::Ended) -> serde_json::Value {
    serde_json::from_str(&ended.output).unwrap_or_else(|error| panic!("{error}: {ended:?}"))
}

#[test]
fn lists_are_read_by_programs() {
    let sandbox = Sandbox::new();
    let ended = sandbox.run(&["list", "--suite", "smoke", "--json"]);
    ended.expect(0, &[]);
    let list = parsed(&ended);
    assert_eq!(list["suite"]["name"], "smoke");
    let robots = list["robots"].as_array().unwrap();
    assert!(!robots.is_empty() && robots.iter().all(|robot| robot["nv"].as_u64().unwrap() > 0 && robot["robot"].is_string()), "{list}");
    assert!(list["suites"].as_array().unwrap().iter().any(|suite| suite["name"] == "smoke" && suite["about"].is_string()));
    for names in ["engines", "timed"] {
        assert_eq!(list[names][0], "featherbench", "{list}");
    }
    for names in ["studies", "families"] {
        assert!(list[names].as_array().unwrap().iter().all(serde_json::Value::is_string), "{list}");
    }

    let ended = sandbox.run(&["list", "--suite", "smoke", "--cells", "--json"]);
    ended.expect(0, &[]);
    let (list, plain) = (parsed(&ended), sandbox.run(&["list", "--suite", "smoke", "--cells"]));
    let cells = list["cells"].as_array().unwrap();
    assert_eq!(cells.len(), plain.output.lines().count(), "the cells of the plain list");
    assert!(!cells.is_empty());
    for (cell, line) in cells.iter().zip(plain.output.lines()) {
        assert_eq!(format!("{}  {}", cell["cell"].as_str().unwrap(), cell["path"].as_str().unwrap()), line);
    }

    let ended = sandbox.run(&["list", "--gates", "--json"]);
    ended.expect(0, &[]);
    let list = parsed(&ended);
    assert_eq!(list["silent"], 0);
    assert!(list["gates"].as_array().unwrap().iter().all(|gate| gate["fires"] == true && gate["bound"].is_number()), "{list}");
    sandbox.run(&["list", "--conventions", "--json"]).expect(2, &["--json", "--conventions"]);
}
