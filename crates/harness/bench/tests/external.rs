//! Gates of a run with an external engine.

use featherbench_bench::{Gates, Suite};
use featherbench_results::{Relation, Row, Verdict};

fn row(engine: &str) -> Row {
    Row { engine: engine.into(), study: "agreement".into(), quantity: "id".into(), ..Row::default() }
}

/// The conditions that are not met.
fn red(gates: &Gates, records: &[Row]) -> Vec<String> {
    let conditions = gates.conditions(&Suite::default(), records, true).into_iter();
    conditions.filter(|condition| condition.verdict != Verdict::Pass).map(|condition| condition.what).collect()
}

/// An external engine may leave something out. An engine of the project must say so, and a failure of an external engine is a failure.
#[test]
fn only_an_external_engine_may_leave_out_what_it_does_not_have() {
    let skip = |engine: &str| row(engine).without_value(Verdict::Skip, "no such joint");
    let (plain, with_external) = (Gates::default(), Gates::default().with_external(&["mine"]));
    let unexplained = "rows that an engine does not offer and oracles/engines.toml does not name";
    assert_eq!(red(&plain, &[skip("mine")]), [unexplained]);
    assert!(red(&with_external, &[skip("mine")]).is_empty());
    for engine in ["pinocchio", "featherbench", "mine2", ""] {
        assert_eq!(red(&with_external, &[skip("mine"), skip(engine)]), [unexplained], "{engine}");
    }
    let failed = row("mine").without_value(Verdict::Error, "it broke");
    assert_eq!(red(&with_external, &[failed]), ["rows without a value that was due"]);
    let wrong = row("mine").gated(2.0, Relation::Le, 1.0);
    assert_eq!(red(&with_external, &[wrong]), ["rows outside their bound"]);
}
