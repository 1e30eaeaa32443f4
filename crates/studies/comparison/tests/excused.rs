//! Known deviations excuse what they name, no more, and only as long as it occurs.

use crate::convicted::{EVERYTHING, FREE, first_names_the_double};
use featherbench_bench::{Engines, Gates, Quantity, Range, RangeKey, Ranges, RangesMeter, Robot};
use featherbench_doubles::{Double, Twist, beside_native, doubles, gates, red, robot as robot_of, suite};
use featherbench_results::{GateKind, Verdict};
use std::path::Path;

/// One known deviation of this version of an engine on robots with a name like this, with this verdict and further keys.
fn deviation(id: &str, verdict: &str, more: &str) -> String {
    let names = "robots = [\"joints-*\"]\nreason = \"a known cause\"\nreproduction = \"not reproduced\"";
    format!("[[deviation]]\nid = \"{id}\"\n{names}\nverdict = \"{verdict}\"\n{more}\n")
}

/// The gates with one known deviation of the double.
fn excusing(verdict: &str, more: &str) -> Gates {
    gates(&deviation("known", verdict, more))
}

/// The double's deviations, failures and skips, and whether a suite that expects the explained ones passes.
fn trial(gates: &Gates, robot: &Robot, double: Double) -> (usize, usize, usize, bool) {
    let records = beside_native(robot, gates, double);
    let unmet = suite(&records).conditions(gates, &records, true);
    let count = |verdict| doubles(&records, verdict).len();
    (count(Verdict::Deviation), count(Verdict::Fail), count(Verdict::Skip), red(&unmet).is_empty())
}

#[test]
fn a_skip_is_red_unless_it_is_known_that_it_is_not_offered() {
    let robot = robot_of(FREE);
    let (deviations, _, skips, green) = trial(&gates(""), &robot, Double::refusing(&robot));
    assert_eq!((deviations, green), (0, false));
    assert!(skips > EVERYTHING.len(), "the forward dynamics has two methods: {skips}");
    let records = beside_native(&robot, &gates(""), Double::refusing(&robot));
    let conditions = suite(&records).conditions(&gates(""), &records, true);
    first_names_the_double(&conditions, &records, GateKind::Unlisted, &[]);
    let not_offered = |more: &str| {
        let engine = "[double]\ntitle = \"T\"\npackage = { name = \"double\", version = \"1\", released = \"2026-01-31\", licence = \"MIT\", home = \"https://example.org\" }\nstart = { kind = \"python\", module = \"m\" }\n";
        let text = format!("{engine}[[double.lacks]]\nrobots = [\"joints-*\"]\nreason = \"a known cause\"\n{more}");
        gates("").with_lacks(Engines::parse(&text, Path::new("engines.toml")).unwrap().lacks())
    };
    let (deviations, _, left, green) = trial(&not_offered(""), &robot, Double::refusing(&robot));
    assert_eq!((deviations, left, green), (0, skips, true), "what is not offered is no deviation, and no longer red");
    assert!(!trial(&not_offered("quantities = [\"com\"]"), &robot, Double::refusing(&robot)).3);
    for verdict in ["fail", "error"] {
        assert!(!trial(&excusing(verdict, ""), &robot, Double::refusing(&robot)).3, "{verdict}");
    }
}

#[test]
fn a_deviation_that_is_no_longer_seen_is_red() {
    let robot = robot_of(FREE);
    let gates = excusing("fail", "");
    let records = beside_native(&robot, &gates, Double::of(&robot));
    let conditions = suite(&records).conditions(&gates, &records, true);
    assert_eq!(red(&conditions), ["known deviation of double, 'known', still seen: a known cause"]);
    // A part of a run has no such conditions.
    assert!(red(&suite(&records).conditions(&gates, &records, false)).is_empty());
}

/// Two engines may deviate for the same cause: the rows of one do not show the other's, nor those of one quantity another's.
#[test]
fn a_deviation_is_seen_in_its_own_rows() {
    let robot = robot_of(FREE);
    let wrong: Twist = |answer| {
        if answer.quantity == Quantity::Bias {
            answer.values[7] *= -1.0
        }
    };
    let other = deviation("other", "fail", "quantities = [\"id\"]");
    let gates = gates(&(deviation("known", "fail", "quantities = [\"bias\"]") + &other));
    let gates = gates.with_deviations(featherbench_doubles::of_engine("featherbench", &deviation("known", "fail", "")));
    let gates = measured(gates, &robot, Double::twisting(&robot, wrong), 1.0);
    let records = beside_native(&robot, &gates, Double::twisting(&robot, wrong));
    let mut suite = suite(&records);
    suite.suite.engines.as_mut().unwrap().push("featherbench".into());
    let conditions = suite.conditions(&gates, &records, true);
    let unseen = [
        "known deviation of double, 'other', still seen: a known cause",
        "known deviation of featherbench, 'known', still seen: a known cause",
    ];
    assert_eq!(red(&conditions), unseen);
}

/// The same gates with the double's ranges in the size that it shows, times a factor.
fn measured(gates: Gates, robot: &Robot, double: Double, factor: f64) -> Gates {
    let mut meter = RangesMeter::default();
    meter.add(&gates, &beside_native(robot, &gates, double));
    let scale =
        |(key, range): (&RangeKey, &Range)| (key.clone(), Range { low: range.low * factor, high: range.high * factor, ..range.clone() });
    let ranges: Ranges = meter.ranges(&Ranges::default()).unwrap().iter().map(scale).collect();
    assert!(ranges.iter().count() > 0);
    gates.with_ranges(ranges, &featherbench_doubles::gates_folder()).unwrap()
}

#[test]
fn a_deviation_explains_no_more_than_was_measured() {
    let robot = robot_of(FREE);
    let wrong = |robot: &Robot| Double::altered(robot, |description| description.bodies[3].mass *= 1.0 + 1e-10);
    let (_, fails, _, green) = trial(&gates(""), &robot, wrong(&robot));
    assert!(fails > 0 && !green);
    let (deviations, left, _, green) = trial(&excusing("fail", ""), &robot, wrong(&robot));
    assert_eq!((deviations, left, green), (0, fails, false), "a cause without a size excuses nothing");
    let sized = |more: &str, factor: f64| measured(excusing("fail", more), &robot, wrong(&robot), factor);
    assert_eq!(trial(&sized("", 1.0), &robot, wrong(&robot)), (fails, 0, 0, true));
    let (deviations, left, _, green) = trial(&sized("", 0.1), &robot, wrong(&robot));
    assert!(left > deviations && !green, "ten times as large as known; the largest case has the range: {deviations} excused, {left} not");
    assert_eq!(deviations + left, fails);
    let grown = sized("", 0.1);
    let records = beside_native(&robot, &grown, wrong(&robot));
    first_names_the_double(&suite(&records).conditions(&grown, &records, true), &records, GateKind::Bound, &EVERYTHING);
    // Smaller than known: every row is explained, and the list must be corrected.
    assert_eq!(trial(&sized("", 10.0), &robot, wrong(&robot)), (fails, 0, 0, false));
    let (deviations, left, _, green) = trial(&sized("quantities = [\"id\"]", 1.0), &robot, wrong(&robot));
    assert!(deviations > 0 && left > 0 && !green);
    assert_eq!(deviations + left, fails);
    // A size that was measured on one robot excuses no other robot of its class.
    let other = robot_of("joints:kind=mixed,base=fixed");
    let elsewhere = measured(excusing("fail", ""), &other, wrong(&other), 1.0);
    let (deviations, left, _, green) = trial(&elsewhere, &robot, wrong(&robot));
    assert_eq!((deviations, left, green), (0, fails, false));
}
