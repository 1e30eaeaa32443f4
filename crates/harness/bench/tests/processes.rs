//! Cells in processes of their own: each process gets its cells, and whatever becomes of it is the outcome of those.

use featherbench_bench::run::{NewProcess, Opening, Run, Silent, answer};
use featherbench_bench::{Asked, Cell, Context, Finished, Gates, Outcome, Study};
use featherbench_results::{Row, RunInfo};
use std::path::Path;
use std::process::Command;

/// Cells 0 to 6. The first is evaluated here, the others two by two in processes 0, 1 and 2.
struct Parts;

impl Study for Parts {
    fn name(&self) -> &'static str {
        "parts"
    }

    fn exclusive(&self) -> bool {
        true
    }

    fn plan(&self, _: &Context) -> Vec<Cell> {
        (0..7).map(|k| Cell::of_case("parts", "case", ("some", "1"), "id", k.to_string(), serde_json::json!({ "k": k }))).collect()
    }

    fn process(&self, cell: &Cell) -> Option<usize> {
        (cell.params["k"].as_u64()? as usize + 1).checked_sub(2).map(|k| k / 2)
    }

    /// The number of the cell, and that of the process.
    fn evaluate(&self, asked: &Asked) -> Outcome {
        Outcome::Values(vec![asked.cell.params["k"].as_f64().unwrap(), f64::from(std::process::id())])
    }

    fn compare_all(&self, _: &Context, finished: &[Finished]) -> Vec<Row> {
        let row = |(cell, outcome): &Finished| {
            let blank = Row { method: cell.method.clone(), ..Row::default() };
            match outcome.answer() {
                Ok(values) => Row { reason: values[1].to_string(), ..blank.informed(values[0]) },
                Err(no_answer) => Row { reason: no_answer.to_string(), ..blank },
            }
        };
        finished.iter().map(row).collect()
    }
}

/// A process that runs a command of the shell.
#[derive(Debug)]
struct Shell(String);

impl NewProcess for Shell {
    fn command(&self, study: &str) -> Command {
        assert_eq!(study, "parts");
        let mut command = Command::new("sh");
        command.args(["-c", &self.0]);
        command
    }
}

fn with_context<T>(act: impl FnOnce(&Context) -> T) -> T {
    let gates = Gates::default();
    act(&Context { robots: &[], engines: &[], gates: &gates, seed: 1 })
}

/// The rows of a run whose processes run this command.
fn rows(folder: &Path, command: &str) -> Vec<Row> {
    let mut run = Run::open(&folder.join("run"), Opening::New, RunInfo::default()).unwrap();
    run.new_process = Some(Box::new(Shell(command.to_owned())));
    with_context(|context| run.conduct(&[Box::new(Parts)], context, &|_| true, &Silent).unwrap())
}

/// What a process writes that is asked for these cells.
fn entries(cells: &[usize]) -> Vec<u8> {
    let mut written = Vec::new();
    with_context(|context| {
        let plan = Parts.plan(context);
        let ids: String = cells.iter().map(|&k| plan[k].id() + "\n").collect();
        answer(&Parts, context, ids.as_bytes(), &mut written).unwrap();
    });
    written
}

#[test]
fn each_process_gets_its_cells_and_gives_their_outcomes() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::create_dir(at.join("asked")).unwrap();
    for (process, cells) in [[1, 2], [3, 4], [5, 6]].iter().enumerate() {
        std::fs::write(at.join(process.to_string()), entries(cells)).unwrap();
    }
    let at = at.display();
    let found = rows(folder.path(), &format!("n=$(ls '{at}/asked' | wc -l); cat > '{at}/asked/'$n; cat '{at}/'$n"));
    assert_eq!(found.iter().map(|row| row.value).collect::<Vec<_>>(), (0..7).map(|k| Some(f64::from(k))).collect::<Vec<_>>());
    let plan = with_context(|context| Parts.plan(context));
    for (process, cells) in [[1, 2], [3, 4], [5, 6]].iter().enumerate() {
        let asked = std::fs::read_to_string(folder.path().join("asked").join(process.to_string())).unwrap();
        assert_eq!(asked.lines().collect::<Vec<_>>(), cells.map(|k| plan[k].id()), "process {process}");
    }
}

#[test]
fn what_becomes_of_a_process_is_the_outcome_of_its_cells() {
    let folder = tempfile::tempdir().unwrap();
    let (one, strange) = (folder.path().join("one"), folder.path().join("strange"));
    std::fs::write(&one, entries(&[1])).unwrap();
    std::fs::write(&strange, entries(&[0])).unwrap();
    let (one, strange) = (one.display(), strange.display());
    for (name, command, words) in [
        ("ends", "exit 3".to_owned(), "exit status: 3"),
        ("is killed", "kill -9 $$".to_owned(), "signal: 9"),
        ("writes no entry", "cat > /dev/null; echo hello; exec sleep 1000".to_owned(), "header"),
        ("answers something else", format!("cat > /dev/null; cat '{strange}'; exec sleep 1000"), "which it was not asked for"),
        ("stops in an entry", format!("cat > /dev/null; head -c 100 '{one}'"), "in the middle of a message"),
    ] {
        let scratch = tempfile::tempdir().unwrap();
        let found = rows(scratch.path(), &command);
        assert_eq!(found[0].value, Some(0.0), "{name}: what is evaluated here is not touched");
        for row in &found[1..] {
            assert!(row.value.is_none() && row.reason.contains("the process that was to evaluate it ended before"), "{name}: {row:?}");
            assert!(row.reason.contains(words), "{name}: {}", row.reason);
        }
    }
    // The outcomes that came before are kept.
    let scratch = tempfile::tempdir().unwrap();
    let found = rows(scratch.path(), &format!("cat > /dev/null; cat '{one}'; exit 4"));
    assert_eq!(found[1].value, Some(1.0));
    assert!(found[2].reason.contains("exit status: 4") && found[3].reason.contains("which it was not asked for"), "{found:?}");
}

#[test]
fn without_a_way_to_start_one_all_are_evaluated_here() {
    let folder = tempfile::tempdir().unwrap();
    let mut run = Run::open(&folder.path().join("run"), Opening::New, RunInfo::default()).unwrap();
    let found = with_context(|context| run.conduct(&[Box::new(Parts)], context, &|_| true, &Silent).unwrap());
    assert!(found.len() == 7 && found.iter().all(|row| row.reason == std::process::id().to_string()), "{found:?}");
}

#[test]
fn a_cell_that_the_study_does_not_have_is_an_error() {
    let mut written = Vec::new();
    let error = with_context(|context| answer(&Parts, context, &b"0123456789abcdef\n"[..], &mut written).unwrap_err());
    assert!(error.to_string().contains("parts has no cell 0123456789abcdef"), "{error}");
    assert!(written.is_empty());
}
