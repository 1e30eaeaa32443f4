//! Known deviations and lacks by properties of robots: which rows they are about, and what is ambiguous.

use featherbench_bench::{DeviationFile, Engines, Gates, Range, RangeKey, Ranges, RangesMeter};
use featherbench_results::{Base, Feature, Properties, Relation, Row, Verdict};
use std::path::Path;

fn properties() -> Properties {
    Properties {
        joints: vec!["prismatic".into(), "revolute".into()],
        armature: vec!["revolute".into()],
        base: Base::Fixed,
        dofs: 65,
        offset: 100.0,
        mass_ratio: 1000.0,
        features: vec![Feature::JointChain, Feature::Balanced],
    }
}

fn row() -> Row {
    let [study, engine, engine_version, quantity, robot] = ["agreement", "crane", "2", "id", "gantry"].map(str::to_owned);
    Row { study, engine, engine_version, quantity, robot, metric: "scaled".into(), ..Row::default() }
}

fn error() -> Row {
    row().without_value(Verdict::Error, "it says so")
}

fn failure() -> Row {
    row().gated(2e-14, Relation::Le, 1e-14)
}

/// An entry with these keys.
fn entry(id: &str, verdict: &str, keys: &str) -> String {
    format!("[[deviation]]\nid = \"{id}\"\n{keys}\nverdict = \"{verdict}\"\nreason = \"because\"\nreproduction = \"not reproduced\"\n")
}

/// The gates with these entries, and the robot with its properties.
fn gates(entries: &str) -> Gates {
    let file = DeviationFile::parse(&format!("version = \"2\"\n{entries}"), Path::new("deviations/crane.toml")).unwrap();
    Gates::default().with_deviations(file)
}

fn with_robot(gates: Gates) -> Gates {
    gates.with_robots([("gantry".to_owned(), properties())]).unwrap()
}

const MET: [&str; 15] = [
    "",
    "joint = [\"revolute\"]",
    "joint = [\"helical\", \"prismatic\"]",
    "armature = true",
    "armature = [\"revolute\"]",
    "base = \"fixed\"",
    "dofs_above = 64",
    "offset_above = 99.0",
    "mass_ratio_above = 999.0",
    "feature = [\"balanced\"]",
    "feature = [\"singular_mass\", \"joint_chain\"]",
    "without = [\"singular_mass\"]",
    "robots = [\"gantry\"]",
    "robots = [\"derrick\", \"gan*\"]",
    "joint = [\"revolute\"]\nbase = \"fixed\"\nfeature = [\"balanced\"]",
];

const UNMET: [&str; 14] = [
    "joint = [\"helical\"]",
    "armature = false",
    "armature = [\"prismatic\"]",
    "base = \"free\"",
    "dofs_above = 65",
    "offset_above = 100.0",
    "mass_ratio_above = 1000.0",
    "feature = [\"singular_mass\"]",
    "without = [\"balanced\"]",
    "without = [\"singular_mass\", \"balanced\"]",
    "robots = [\"derrick\"]",
    "robots = [\"gan\"]",
    "joint = [\"revolute\"]\nbase = \"free\"",
    "robots = [\"gantry\"]\nbase = \"free\"",
];

#[test]
fn every_condition_is_met_or_not() {
    for (conditions, verdict) in MET.iter().map(|met| (met, Verdict::Deviation)).chain(UNMET.iter().map(|unmet| (unmet, Verdict::Error))) {
        let gates = with_robot(gates(&entry("known", "error", conditions)));
        assert_eq!(gates.explain(error()).verdict, verdict, "{conditions}");
    }
}

#[test]
fn a_robot_without_properties_is_in_no_class_with_a_condition_on_them() {
    for conditions in MET {
        let by_name = conditions.is_empty() || conditions.starts_with("robots");
        let expected = if by_name { Verdict::Deviation } else { Verdict::Error };
        assert_eq!(gates(&entry("known", "error", conditions)).explain(error()).verdict, expected, "{conditions}");
    }
}

#[test]
fn lacks_have_the_same_classes() {
    for (conditions, known) in MET.iter().map(|met| (met, true)).chain(UNMET.iter().map(|unmet| (unmet, false))) {
        let text = format!(
            "[crane]\ntitle = \"C\"\npackage = {{ name = \"c\", version = \"2\", released = \"2026-01-31\", licence = \"MIT\", home = \"https://example.org\" }}\nstart = {{ kind = \"python\", module = \"c\" }}\n[[crane.lacks]]\n{conditions}\nreason = \"not made for it\"\n"
        );
        let engines = Engines::parse(&text, Path::new("engines.toml")).unwrap();
        let gates = with_robot(Gates::default().with_lacks(engines.lacks()));
        let row = gates.explain(row().without_value(Verdict::Skip, "it says so"));
        let expected = if known { "not made for it (it says so)" } else { "it says so" };
        assert_eq!((row.verdict, row.reason.as_str()), (Verdict::Skip, expected), "{conditions}");
    }
}

#[test]
fn errors_that_nothing_tells_apart_are_refused_when_the_robots_are_known() {
    let two = |second: &str| gates(&(entry("one", "error", "joint = [\"revolute\"]") + &entry("two", "error", second)));
    let error = two("base = \"fixed\"").with_robots([("gantry".to_owned(), properties())]).unwrap_err().to_string();
    assert!(["crane.toml", "'two'", "'one'", "gantry"].iter().all(|word| error.contains(word)), "{error}");
    for apart in
        ["base = \"free\"", "base = \"fixed\"\nquantities = [\"id\"]\nstates = [\"zero\"]\nmethod = \"rnea\"\nrobots = [\"derrick\"]"]
    {
        with_robot(two(apart));
    }
    let by_quantity =
        entry("one", "error", "joint = [\"revolute\"]\nquantities = [\"fd\"]") + &entry("two", "error", "quantities = [\"id\"]");
    with_robot(gates(&by_quantity));
    with_robot(gates(&(entry("one", "error", "joint = [\"revolute\"]") + &entry("two", "fail", ""))));
}

fn sizes(id: &str) -> Ranges {
    let range = Range { deviation: id.into(), low: 1e-14, high: 2e-14, outside: 20, seeds: 20 };
    [(RangeKey::of(&row()), range)].into_iter().collect()
}

/// Several failures of one class are told apart by the range, which names its deviation.
#[test]
fn a_range_says_which_deviation_it_is() {
    let known = entry("one", "fail", "") + &entry("two", "fail", "").replace("because", "for another cause");
    for (id, reason) in [("one", "because"), ("two", "for another cause")] {
        let gates = with_robot(gates(&known).with_ranges(sizes(id), Path::new("ci")).unwrap());
        let row = gates.explain(failure());
        assert_eq!(row.verdict, Verdict::Deviation);
        assert!(row.reason.starts_with(reason) && row.params.contains(&format!("\"{id}\"")), "{row:?}");
    }
    let row = with_robot(gates(&known)).explain(failure());
    assert_eq!(row.verdict, Verdict::Fail);
    assert!(row.reason.contains("(one, two in ci/deviations/crane.toml)"), "{}", row.reason);
    assert!(gates(&known).with_ranges(sizes("three"), Path::new("ci")).is_err());
}

#[test]
fn a_range_of_a_robot_that_is_not_in_the_class_is_refused() {
    let narrow = || gates(&entry("one", "fail", "base = \"free\"")).with_ranges(sizes("one"), Path::new("ci")).unwrap();
    let error = narrow().with_robots([("gantry".to_owned(), properties())]).unwrap_err().to_string();
    assert!(["crane.toml", "'one'", "gantry"].iter().all(|word| error.contains(word)), "{error}");
    narrow().with_robots([("derrick".to_owned(), properties())]).unwrap();
}

/// What is measured keeps the deviation that the files name; without them, one of several cannot be chosen.
#[test]
fn measured_ranges_keep_their_deviation() {
    let two = with_robot(gates(&(entry("one", "fail", "") + &entry("two", "fail", ""))));
    let mut meter = RangesMeter::default();
    meter.add(&two, &[failure()]);
    let error = meter.ranges(&Ranges::default()).unwrap_err();
    assert!(["gantry", "one, two", "SUITE.csv"].iter().all(|word| error.contains(word)), "{error}");
    let ranges = meter.ranges(&sizes("two")).unwrap();
    assert_eq!(ranges.get(&row()).unwrap().deviation, "two");
    // A range of another version says it as well.
    let (mut key, range) = sizes("two").iter().map(|(key, range)| (key.clone(), range.clone())).next().unwrap();
    key.version = "1".into();
    assert_eq!(meter.ranges(&[(key, range)].into_iter().collect()).unwrap(), ranges);
    // Within the gate in every run, it is none.
    let mut meter = RangesMeter::default();
    meter.add(&two, &[row().gated(1e-15, Relation::Le, 1e-14)]);
    assert_eq!(meter.ranges(&Ranges::default()).unwrap(), Ranges::default());
}
