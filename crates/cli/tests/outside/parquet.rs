//! Rows in Parquet have the same types in polars, pandas and DuckDB, and figures are made of them.

use crate::support::{Sandbox, project};
use crate::{Outcome, Unpassed};
use std::path::Path;
use std::process::Command;

/// The example script on the rows of a recorded run.
pub fn figures(python: &Path) -> Outcome {
    let has = Command::new(python).args(["-c", "import duckdb, matplotlib, pandas, polars, pyarrow"]).output();
    if !has.is_ok_and(|output| output.status.success()) {
        return Err(Unpassed::Skipped("polars, pandas, DuckDB and matplotlib are not installed: ci/python-tools".into()));
    }
    let sandbox = Sandbox::new();
    sandbox.run(&["run", "--suite", "smoke", "--no-timing", "--out", "run"]).expect(0, &["report:"]);
    sandbox.run(&["export", "run", "--parquet", "rows"]).expect(0, &["study=agreement/part-0.parquet"]);
    let script = project().join("reports/examples/figures.py");
    let output = Command::new(python).arg(script).args(["rows", "figures"]).current_dir(sandbox.folder.path()).output().unwrap();
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{said}{}", String::from_utf8_lossy(&output.stderr));
    let (_, rows) = featherbench_results::read_run(&sandbox.path("run")).unwrap();
    let count = rows.len();
    assert!(
        count > 500 && said.starts_with(&format!("{count} rows by polars, {count} by pandas, {count} by DuckDB")),
        "{count} rows: {said}"
    );
    for name in ["figures/map.svg", "figures/depth.svg"] {
        assert!(std::fs::read_to_string(sandbox.path(name)).unwrap().contains("pinocchio"), "{name} names no engine");
    }
    Ok(())
}
