//! The program: what it prints, and how it ends.

use featherbench_results::{Row, RunInfo, write_run};
use std::path::Path;
use std::process::Command;

/// Its exit code, what it says, and its errors.
fn run(folder: &Path, arguments: &[&str]) -> (Option<i32>, String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_featherbench-parquet"));
    let output = command.args(arguments).current_dir(folder).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code(), text(output.stdout), text(output.stderr))
}

#[test]
fn rows_of_a_run_become_files_and_files_become_csv() {
    let folder = tempfile::tempdir().unwrap();
    let rows: Vec<Row> = ["timing", "agreement", "timing"].map(|study| Row { study: study.into(), ..Row::default() }.informed(0.1)).into();
    let info = RunInfo { rows: rows.len() as u64, ..RunInfo::default() };
    write_run(&folder.path().join("run"), &info, &rows).unwrap();
    let (code, said, errors) = run(folder.path(), &["rows", "run", "files"]);
    assert_eq!((code, errors.as_str()), (Some(0), ""));
    assert_eq!(said, "files/study=agreement/part-0.parquet\nfiles/study=timing/part-0.parquet\n3 rows\n");

    let (code, said, errors) = run(folder.path(), &["table", "files/study=timing/part-0.parquet"]);
    assert_eq!((code, errors.as_str()), (Some(0), ""));
    let lines: Vec<&str> = said.lines().collect();
    assert!(lines.len() == 3 && lines[0].starts_with("run,cell,family,") && lines[1].contains(",0.1,"), "{said}");
}

#[test]
fn bad_input_is_exit_code_two() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("log.csv"), "time\n1\n").unwrap();
    let cases: [(&[&str], &str); 5] = [
        (&[], "featherbench-parquet rows RUN FOLDER"),
        (&["rows", "run"], "featherbench-parquet table FILE"),
        (&["--help"], "featherbench-parquet table FILE"),
        (&["rows", "nowhere", "files"], "nowhere"),
        (&["table", "log.csv"], "log.csv: the Parquet file is not readable"),
    ];
    for (arguments, words) in cases {
        let (code, said, errors) = run(folder.path(), arguments);
        assert_eq!((code, said.as_str()), (Some(2), ""), "{arguments:?}");
        assert!(errors.starts_with("error: ") && errors.contains(words), "{errors}");
    }
    assert!(!folder.path().join("files").exists());
}
