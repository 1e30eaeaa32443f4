//! The list of conventions: each row has its test, each test its row, each named function exists, and CONVENTIONS.md shows the list.

use crate::support;

use std::collections::BTreeSet;
use support::{Sandbox, project};

fn read(name: &str) -> String {
    std::fs::read_to_string(project().join(name)).unwrap()
}

fn ledger() -> Vec<featherbench_results::Convention> {
    featherbench_bench::conventions::read(&project().join("oracles/conventions.toml")).unwrap()
}

#[test]
fn each_row_has_its_test_and_each_test_its_row() {
    let rows = ledger();
    let engines = featherbench_bench::Engines::read(&project().join("oracles/engines.toml")).unwrap();
    let text: String = engines
        .iter()
        .map(|engine| project().join(format!("oracles/featherbench_oracles/{}/conventions.py", engine.name)))
        .filter_map(|path| std::fs::read_to_string(path).ok())
        .collect();
    let tests: BTreeSet<&str> = text
        .lines()
        .filter(|line| line.ends_with("-> Claims:"))
        .filter_map(|line| line.strip_prefix("def ")?.split_once('('))
        .map(|(name, _)| name)
        .collect();
    let named: Vec<&str> = rows.iter().map(|row| row.test.as_str()).collect();
    let distinct: BTreeSet<&str> = named.iter().copied().collect();
    assert_eq!(named.len(), distinct.len(), "two rows name one test");
    assert_eq!(distinct, tests);
    assert!(rows.len() >= 30, "{} rows", rows.len());
    for row in &rows {
        assert!(row.test.starts_with(&row.engine), "{} of {}", row.test, row.engine);
    }
}

/// A conversion names functions, classes or constants of the engine's file in backticks, as `file: name`, or none.
#[test]
fn each_named_function_exists() {
    let mut found = 0;
    for row in ledger() {
        let named: Vec<&str> = row.conversion.split('`').skip(1).step_by(2).collect();
        assert!(!named.is_empty() || row.conversion.starts_with('–'), "{}: neither a function nor '–'", row.test);
        for word in named {
            let (file, name) = word.split_once(": ").unwrap_or_else(|| panic!("{word} is not `file: name`"));
            let text = read(&format!("oracles/featherbench_oracles/{file}"));
            let defined = [format!("def {name}("), format!("class {name}:"), format!("class {name}("), format!("\n{name} = ")]
                .iter()
                .any(|definition| text.contains(definition));
            assert!(defined, "{}: {file} has neither a function nor a class nor a constant {name}", row.test);
            found += 1;
        }
    }
    assert!(found >= 20, "{found} functions");
}

#[test]
fn the_page_shows_the_ledger() {
    let table = featherbench_bench::conventions::markdown(&ledger());
    let page = read("CONVENTIONS.md");
    assert!(page.contains(&table), "put the output of `featherbench list --conventions` into CONVENTIONS.md, in the place of its tables");
    let sandbox = Sandbox::new();
    let printed = sandbox.run(&["list", "--conventions"]);
    printed.expect(0, &[]);
    assert_eq!(printed.output, table);
}

#[test]
fn a_bad_ledger_is_told_by_file_and_key() {
    let sandbox = Sandbox::new();
    let row = "[[convention]]\nengine = \"e\"\ntopic = \"s\"\ntheirs = \"t\"\nconversion = \"–\"\ntest = \"e_s\"\n";
    let ours = "[ours]\ns = \"o\"\n";
    let good = sandbox.write("good.toml", &format!("{ours}{row}"));
    assert_eq!(featherbench_bench::conventions::read(&good).unwrap().len(), 1);
    let cases = [
        (format!("[ours]\n{row}"), "'s' has no entry"),
        (format!("{ours}z = \"o\"\n{row}"), "about 'z'"),
        (format!("{ours}{}", row.replace("test", "proof")), "proof"),
        (format!("{ours}{}", row.replace("engine = \"e\"\n", "")), "engine"),
    ];
    for (text, words) in cases {
        let path = sandbox.write("bad.toml", &text);
        let message = featherbench_bench::conventions::read(&path).unwrap_err().to_string();
        assert!(message.contains(words) && message.contains("bad.toml"), "{message}");
    }
}
