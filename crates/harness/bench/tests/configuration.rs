//! Files that users write: an error in `gates.toml`, a file of `deviations/`, `engines.toml` or a suite names the file and the key or entry.
//! Every unknown key is an error.

use featherbench_bench::{Counts, Engines, FileFormat, Gates, HarnessError, NoSettings, Ranges, Suite};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

const GATE: &str = "[[gate]]\nstudy = \"agreement\"\nquantities = [\"id\"]\nmetric = \"scaled\"\nbound = 1e-14\nreason = \"rounding\"\n";
const DEVIATION: &str =
    "version = \"1\"\n[[deviation]]\nid = \"k\"\nverdict = \"fail\"\nreason = \"known\"\nreproduction = \"not reproduced\"\n";
const ENGINE: &str = "[e]\ntitle = \"T\"\npackage = { name = \"p\", version = \"1\", released = \"2026-01-31\", licence = \"MIT\", home = \"https://example.org\" }\nstart = { kind = \"python\", module = \"m\" }\n[[e.lacks]]\nrobots = [\"m\"]\nreason = \"none\"\n";
const SUITE: &str = "about = \"a suite\"\nseed = 1\n[[robot]]\ngenerate = \"humanoid\"\nfamily = \"humanoid\"\n";

/// Asserts that an error names its file and contains these words.
#[track_caller]
fn names<T: std::fmt::Debug>(result: Result<T, HarnessError>, file: &Path, words: &[&str]) {
    let error = result.unwrap_err();
    let message = error.to_string();
    assert!(message.contains(&file.display().to_string()), "{message} does not name {}", file.display());
    for word in words {
        assert!(message.contains(word), "{message} does not name {word}");
    }
}

fn gates(gates: &str, deviations: &str) -> (Result<Gates, HarnessError>, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("gates.toml"), gates).unwrap();
    let path = file_of(&folder);
    std::fs::create_dir(path.parent().unwrap()).unwrap();
    std::fs::write(path, deviations).unwrap();
    (Gates::read(folder.path(), &Engines::default()), folder)
}

/// The file of the known deviations of the engine `e`.
fn file_of(folder: &tempfile::TempDir) -> PathBuf {
    folder.path().join("deviations/e.toml")
}

#[test]
fn gates_name_what_is_wrong() {
    assert!(gates(GATE, DEVIATION).0.is_ok());
    assert!(gates(GATE, "version = \"1\"\n").0.is_ok(), "nothing need deviate");
    let cases = [
        (format!("{GATE}max_dept = 20\n"), "max_dept"),
        (GATE.replace("bound = 1e-14\n", ""), "bound"),
        (GATE.replace("reason = \"rounding\"\n", ""), "reason"),
        (GATE.replace("1e-14", "\"small\""), "bound"),
        (format!("{GATE}times = \"width\"\n"), "width"),
        (format!("{GATE}max_depth = -1\n"), "max_depth"),
        (format!("threshold = 1\n{GATE}"), "threshold"),
        (format!("{GATE}[sharp]\nstudy = \"agreement\"\n"), "quantity"),
        (format!("{GATE}[[gate]\n"), "line 7"),
        (String::new(), "gate"),
    ];
    for (text, word) in cases {
        let (result, folder) = gates(&text, DEVIATION);
        names(result, &folder.path().join("gates.toml"), &[word]);
    }
}

#[test]
fn deviations_name_what_is_wrong() {
    let cases = [
        (format!("{DEVIATION}upto = 1e-9\n"), "'k': unknown key 'upto'"),
        (DEVIATION.replace("version = \"1\"\n", ""), "version"),
        (DEVIATION.replace("id = \"k\"\n", ""), "id"),
        (DEVIATION.replace("\"k\"", "\"k, l\""), "id"),
        (DEVIATION.replace("\"k\"", "\"\""), "id"),
        (format!("{DEVIATION}{}", DEVIATION.replace("version = \"1\"\n", "")), "same id"),
        (DEVIATION.replace("reproduction = \"not reproduced\"\n", ""), "reproduction"),
        (DEVIATION.replace("not reproduced", "no"), "'k': there is no [[reproduction]] named 'no'"),
        (format!("{DEVIATION}joint = [\"hinge\"]\n"), "'hinge'"),
        (format!("{DEVIATION}armature = [\"hinge\"]\n"), "'hinge'"),
        (format!("{DEVIATION}armature = \"hinge\"\n"), "kinds of joints"),
        (format!("{DEVIATION}base = \"loose\"\n"), "loose"),
        (format!("{DEVIATION}feature = [\"round\"]\n"), "round"),
        (format!("{DEVIATION}dofs_above = \"many\"\n"), "many"),
        (twice("base = \"free\"", "base = \"free\"\nquantities = [\"id\"]"), "'l': it is about rows that 'k' is about"),
        (DEVIATION.replace("reason = \"known\"\n", ""), "reason"),
        (DEVIATION.replace("\"fail\"", "\"pass\""), "pass"),
        (DEVIATION.replace("\"fail\"", "\"Fail\""), "Fail"),
        (DEVIATION.replace("\"fail\"", "\"skip\""), "[[e.lacks]]"),
        (format!("{DEVIATION}range = [1e-14, 1e-13]\n"), "range"),
        (format!("{DEVIATION}robots = \"m\"\n"), "sequence"),
        (DEVIATION.replace("[[deviation]]", "[[deviations]]"), "deviations"),
    ];
    for (text, word) in cases {
        let (result, folder) = gates(GATE, &text);
        names(result, &file_of(&folder), &[word]);
    }
    assert!(gates(GATE, &twice("base = \"free\"", "base = \"fixed\"")).0.is_ok());
}

/// The table of a native oracle of the engine, and the beginning of the next.
const NATIVE: &str = "[n]\ntitle = \"T\"\nof = \"e\"\nstart = { kind = \"native\", folder = \"f\", language = \"C\", compilers = [\"cc\"], packages = [\"p\"] }\n[[n";

/// Two deviations that are errors, with further keys of each.
fn twice(first: &str, second: &str) -> String {
    let error = DEVIATION.replace("fail", "error");
    let other = error.replace("version = \"1\"\n", "").replace("\"k\"", "\"l\"");
    format!("{error}{first}\n{other}{second}\n")
}

#[test]
fn lacks_name_what_is_wrong() {
    let path = Path::new("engines.toml");
    let engines = Engines::parse(ENGINE, path).unwrap();
    let lacks = engines.lacks();
    assert_eq!((lacks[0].engine.as_str(), lacks[0].version.as_str()), ("e", "1"));
    let native = Engines::parse(&ENGINE.replace("e.lacks", "n.lacks").replace("[[n", NATIVE), path).unwrap();
    assert_eq!((native.lacks()[0].engine.as_str(), native.lacks()[0].version.as_str()), ("n", "1"));
    let cases = [
        (ENGINE.replace("reason", "cause"), "reason"),
        (format!("{ENGINE}verdict = \"skip\"\n"), "unknown key 'verdict'"),
        (format!("{ENGINE}joint = [\"hinge\"]\n"), "'hinge'"),
        (ENGINE.replace("lacks", "lack"), "lack"),
        (ENGINE.replace("version", "release"), "release"),
    ];
    for (text, word) in cases {
        names(Engines::parse(&text, path), path, &[word]);
    }
}

#[test]
fn missing_files_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let none = Engines::default();
    names(Gates::read(folder.path(), &none), &folder.path().join("gates.toml"), &[]);
    std::fs::write(folder.path().join("gates.toml"), GATE).unwrap();
    names(Gates::read(folder.path(), &none), &folder.path().join("deviations"), &[]);
    let path = folder.path().join("none.toml");
    names(Suite::read(&path), &path, &[]);
}

#[test]
fn suites_name_what_is_wrong() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("suite.toml");
    let read = |text: &str| {
        std::fs::write(&path, text).unwrap();
        Suite::read(&path)
    };
    let (suite, hash) = read(SUITE).unwrap();
    assert_eq!((suite.about.as_str(), suite.robots.len(), suite.engines), ("a suite", 1, None));
    assert_ne!(read(&format!("{SUITE}\n")).unwrap().1, hash, "every byte of a suite counts");
    let cases = [
        (format!("speed = 3\n{SUITE}"), "speed"),
        (format!("{SUITE}floats = true\n"), "floats"),
        (format!("states = -3\n{SUITE}"), "states"),
        (format!("engines = \"drake\"\n{SUITE}"), "engines"),
        (format!("engines = []\nengines = []\n{SUITE}"), "engines"),
        (format!("seeds = 2\n{SUITE}"), "line 1: unknown key 'seeds'"),
        (format!("{SUITE}model = \"g1\"\n"), "humanoid"),
        (SUITE.replace("generate = \"humanoid\"\n", ""), "exactly one"),
        (SUITE.replace("seed = 1\n", ""), "seed"),
        (SUITE.replace("family = \"humanoid\"\n", ""), "family"),
    ];
    for (text, word) in cases {
        names(read(&text), &path, &[word]);
    }
}

/// The tables of a suite belong to studies, which read them.
#[test]
fn tables_name_what_is_wrong() {
    let path = Path::new("suite.toml");
    let suite = |more: &str| Suite::parse(&format!("{SUITE}{more}"), path).unwrap();
    let none = |more: &str| suite(more).settings::<NoSettings>("toy");
    assert_eq!((none("").unwrap(), none("[toy]\n").unwrap()), (None, Some(NoSettings {})));
    assert_eq!(suite("[toy]\n[other]\nx = 1\n").studies, ["other", "toy"]);
    names(none("[toy]\nsize = 2\n"), path, &["[toy]", "line 7", "size"]);
    let sizes = |more: &str| suite(more).settings::<BTreeMap<String, u32>>("toy");
    assert_eq!(sizes("[toy]\nsize = 2\n").unwrap().unwrap()["size"], 2);
    names(sizes("[other]\n[toy]\nsize = -2\n"), path, &["[toy]", "line 8", "size"]);
    assert!(suite("[toy]\n").check_studies(&["toy"]).is_ok());
    names(suite("[toy]\n").check_studies(&["plot", "rows"]), path, &["no study 'toy'", "plot, rows"]);
    names(suite("studies = [\"toy\"]\n").check_studies(&["rows"]), path, &["no study 'toy'"]);
}

#[test]
fn counts_name_what_is_wrong() {
    const HEAD: &str = "suite,study,engine,quantity,cells,rows\n";
    let path = Path::new("counts.csv");
    assert_eq!(Counts::parse(HEAD, path).unwrap(), Counts::default());
    let line = "default,agreement,drake,id,3,40\n";
    assert_eq!(Counts::parse(&format!("{HEAD}{line}"), path).unwrap().to_csv(), format!("{HEAD}{line}"));
    for (text, word) in [
        (String::new(), "line 1"),
        (line.into(), "line 1"),
        (format!("{HEAD}{line}{line}"), "line 3"),
        (format!("{HEAD}default,agreement,drake,id,3\n"), "5 columns"),
        (format!("{HEAD}{}", line.replace(",3,", ",-3,")), "cells '-3'"),
        (format!("{HEAD}{}", line.replace(",40", ",many")), "rows 'many'"),
    ] {
        names(Counts::parse(&text, path), path, &[word]);
    }
}

/// The repository's own files and all its suites are valid.
#[test]
fn our_own_files_are_right() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../..");
    let engines = Engines::read(&root.join("oracles/engines.toml")).unwrap();
    let gates = Gates::read(&root.join("ci"), &engines).unwrap();
    for known in gates.deviations().iter().filter(|known| known.is_measured()) {
        let sizes = gates.ranges().iter().filter(|(key, range)| known.has(key) && range.deviation == known.id).count();
        assert!(sizes > 0, "a deviation without a size excuses nothing: {} {}", known.engine, known.id);
    }
    let classes = gates.deviations().iter().map(|known| &known.class).chain(gates.lacks().iter().map(|lack| &lack.class));
    let names: Vec<&String> = classes.flat_map(|class| class.names()).collect();
    assert!(names.len() <= 22, "robots are told by their properties; a name needs a reason: {names:?}");
    let suites: Vec<_> = std::fs::read_dir(root.join("datasets/suites")).unwrap().map(|entry| entry.unwrap().path()).collect();
    let suites: Vec<_> = suites.iter().filter(|path| path.extension().is_some_and(|ending| ending == "toml")).collect();
    assert!(suites.len() >= 5, "{} suites", suites.len());
    for path in suites {
        Suite::read(path).unwrap();
    }
}

#[test]
fn reproductions_name_what_is_wrong() {
    let known = "[[reproduction]]\nname = \"e_loss\"\ncondition = \"always\"\nmeasure = \"a share\"\nrange = [0.1, 0.4]\nupstream = \"none found\"\n";
    let shown = |name: &str| DEVIATION.replace("not reproduced", name);
    let alone = format!("version = \"1\"\n{known}");
    let read = gates(GATE, &alone).0.unwrap();
    assert_eq!(read.reproductions().len(), 1);
    assert_eq!((read.reproductions()[0].engine.as_str(), read.reproductions()[0].version.as_str()), ("e", "1"));
    assert!(gates(GATE, &format!("{}{known}", shown("e_loss"))).0.is_ok());
    let cases = [
        (alone.replace("[0.1, 0.4]", "[0.4, 0.1]"), "'e_loss': range"),
        (alone.replace("[0.1, 0.4]", "[0.0, 0.1]"), "'e_loss': range"),
        (alone.replace("[0.1, 0.4]", "[0.1]"), "range"),
        (alone.replace("upstream = \"none found\"\n", ""), "upstream"),
        (format!("{alone}seeds = 20\n"), "seeds"),
        (alone.replace("e_loss", "f_loss"), "e_"),
        (format!("{}{known}", shown("e_gain")), "e_gain"),
    ];
    for (text, word) in cases {
        let (result, folder) = gates(GATE, &text);
        names(result, &file_of(&folder), &[word]);
    }
}

/// The files that `gate --ranges … --write` writes are data of a gate: each line is checked.
#[test]
fn ranges_name_what_is_wrong() {
    const HEAD: &str = "engine,version,method,quantity,robot,metric,deviation,low,high,outside,seeds\n";
    const LINE: &str = "e,1,rnea,id,m,scaled,k,1e-14,2e-14,20,20\n";
    let path = Path::new("default.csv");
    let parse = |text: &str| Ranges::parse(text, path);
    assert_eq!(parse(&format!("{HEAD}{LINE}")).unwrap().iter().count(), 1);
    assert_eq!(parse(HEAD).unwrap(), Ranges::default());
    let cases = [
        (String::new(), "line 1"),
        (HEAD.replace("low,high", "high,low") + LINE, "line 1"),
        (format!("{HEAD}{LINE}{LINE}"), "line 3"),
        (format!("{HEAD}{}", LINE.replace(",20,20", ",20")), "10 columns"),
        (format!("{HEAD}{}", LINE.replace("1e-14,", "small,")), "low"),
        (format!("{HEAD}{}", LINE.replace("2e-14", "NaN")), "high"),
        (format!("{HEAD}{}", LINE.replace("2e-14", "inf")), "high"),
        (format!("{HEAD}{}", LINE.replace("1e-14,", "-1e-14,")), "low"),
        (format!("{HEAD}{}", LINE.replace("1e-14,", "3e-14,")), "low, high"),
        (format!("{HEAD}{}", LINE.replace("1e-14,2e-14", "0,0")), "low, high"),
        (format!("{HEAD}{}", LINE.replace("20,20", "x,20")), "outside"),
        (format!("{HEAD}{}", LINE.replace("20,20", "20,-1")), "seeds"),
        (format!("{HEAD}{}", LINE.replace("20,20", "21,20")), "outside"),
        (format!("{HEAD}{}", LINE.replace("20,20", "0,20")), "outside"),
    ];
    for (text, word) in cases {
        names(parse(&text), path, &[word]);
    }
    // A size without a known deviation is a leftover file.
    let known = || gates(GATE, DEVIATION).0.unwrap();
    let here = Path::new("ci");
    let sizes = |line: &str| parse(&format!("{HEAD}{line}")).unwrap();
    assert!(known().with_ranges(sizes(LINE), here).is_ok());
    for (old, new) in [("e,1", "f,1"), ("e,1", "e,2"), (",k,", ",other,")] {
        names(known().with_ranges(sizes(&LINE.replace(old, new)), here), &here.join("deviations"), &[".toml names no such deviation"]);
    }
    let narrow = format!("{DEVIATION}method = \"crba\"\nquantities = [\"mass_matrix\"]\n");
    let narrow = || gates(GATE, &narrow).0.unwrap();
    assert!(narrow().with_ranges(sizes("e,1,crba,mass_matrix,m,scaled,k,1e-14,2e-14,20,20\n"), here).is_ok());
    for line in ["e,1,rnea,mass_matrix,m,scaled,k,1e-14,2e-14,20,20\n", "e,1,crba,id,m,scaled,k,1e-14,2e-14,20,20\n"] {
        assert!(narrow().with_ranges(sizes(line), here).is_err(), "{line}");
    }
    let error = || gates(GATE, &DEVIATION.replace("\"fail\"", "\"error\"")).0.unwrap();
    assert!(error().with_ranges(sizes(LINE), here).is_err(), "an error has no size");
}

const PYTHON: &str = r#"
[zed]
title = "Zed"
package = { name = "zed-py", version = "1.2", released = "2026-01-31", licence = "MIT", home = "https://example.org" }
start = { kind = "python", module = "zed" }
reads = ["mjcf"]
recorded = true
clock = "estimates"
"#;
const COMPILED: &str = r#"
[built]
title = "Built"
package = { name = "built", version = "3", released = "2026-01-31", licence = "MIT", home = "https://example.org" }
start = { kind = "cargo", folder = "built", program = "built-oracle" }
[a-native]
title = "Zed, in C"
of = "zed"
start = { kind = "native", folder = "zed", language = "C", compilers = ["cc"], packages = ["zed"] }
clock = "measures"
"#;

#[test]
fn engines_are_described_in_the_order_of_their_file() {
    let engines = Engines::parse(&format!("{PYTHON}{COMPILED}"), Path::new("engines.toml")).unwrap();
    assert_eq!(engines.names(|_| true), ["zed", "built", "a-native"]);
    assert_eq!(engines.names(|engine| engine.clock.is_some()), ["zed", "a-native"]);
    assert_eq!(engines.pins(), ["zed-py==1.2"], "cargo has its own lock file");
    let native = engines.get("a-native").unwrap();
    assert_eq!(engines.package(native).unwrap().version, "1.2");
    assert_eq!(engines.released("a-native", "1.2"), Some("2026-01-31"), "that of the engine which it is built of");
    assert_eq!(engines.released("a-native", "1.3"), None, "another version has another day");
    let unknown = engines.get("zad").unwrap_err();
    assert!(unknown.contains("'zad'") && unknown.contains("zed, built, a-native"), "{unknown}");
}

#[test]
fn engines_name_what_is_wrong() {
    let both = || format!("{PYTHON}{COMPILED}");
    let cases = [
        (format!("{PYTHON}colour = 1\n"), "colour"),
        (both().replace("kind = \"python\", module", "kind = \"python\", modul"), "modul"),
        (both().replace("kind = \"python\"", "kind = \"java\""), "java"),
        (both().replace("packages = [\"zed\"]", "packages = [\"zed\"], flags = 1"), "flags"),
        (both().replace("compilers = [\"cc\"], ", ""), "compilers"),
        (both().replace("[\"cc\"]", "[]"), "[a-native]: start: compilers"),
        (both().replace("language = \"C\"", "language = \"Pascal\""), "Pascal"),
        (both().replace("version = \"1.2\", ", ""), "version"),
        (both().replace("released = \"2026-01-31\", ", ""), "released"),
        (both().replace("2026-01-31", "31 January"), "released = \"31 January\" is no day as 2026-01-31"),
        (both().replace("2026-01-31", "2026-1-31"), "[zed]: released"),
        (both().replace("title = \"Zed\"\n", ""), "title"),
        (both().replace("clock = \"measures\"", "clock = \"guesses\""), "guesses"),
        (both().replace("reads = [\"mjcf\"]", "reads = [\"step\"]"), "step"),
        (both().replace("of = \"zed\"", "of = \"built\""), "[a-native]: of: there is no 'built'"),
        (both().replace("of = \"zed\"\n", ""), "[a-native]: give `of`"),
        (format!("{PYTHON}of = \"zed\"\n"), "[zed]: give `of`"),
        (PYTHON.replace("[zed]", "[featherbench]"), "[featherbench]"),
        (format!("{PYTHON}[zed]\n"), "line 9"),
    ];
    for (text, word) in cases {
        let path = Path::new("oracles/engines.toml");
        names(Engines::parse(&text, path), path, &[word]);
    }
}

#[test]
fn the_engines_of_the_project_are_described() {
    let oracles = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../../oracles");
    let engines = Engines::read(&oracles.join("engines.toml")).unwrap();
    let names = engines.names(|_| true);
    let all = "pinocchio mujoco drake dart rapier dynibo faer nalgebra adam idyntree mujoco_warp newton mjx pybullet exudyn simbody jaxsim frax sapien openusd usd_converters clarabel soromox pyelastica pinocchio-clang pinocchio-gcc mujoco-native";
    assert_eq!(names.join(" "), all);
    for format in [FileFormat::Mjcf, FileFormat::Sdf, FileFormat::Usd] {
        let reference = engines.get(format.reference()).unwrap();
        assert!(reference.reads.contains(&format), "{}", format.name());
    }
}
