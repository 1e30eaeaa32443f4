//! `featherbench diff`: what changed between two runs beyond noise.

use crate::args::DiffArgs;
use crate::fail::Fail;
use crate::message::{self, say, tell};
use ::featherbench_results::{
    Apart, Change, Changed, Diff, ERROR_FACTOR, FALSE_SHARE, Row, RunInfo, TIME_NOISE, atomic_write, diff, read_run,
};
use serde_json::{Value, json};
use std::fmt::Write as _;

/// Rows of each kind of change that are listed one by one.
const LISTED: usize = 40;

/// Prints what changed; a change is exit code 1.
pub fn compare(args: &DiffArgs) -> Result<(), Fail> {
    let (before, old) = read_run(&args.before)?;
    let (after, new) = read_run(&args.after)?;
    if let Some(path) = &args.html {
        atomic_write(path, featherbench_report::changes::between((&before, &old), (&after, &new)).as_bytes())?;
        // Standard output is one object with --json.
        tell!("page: {}", path.display());
    }
    let mut found = diff(&old, &new);
    let apart = Apart::of(&before, &after, &mut found);
    if args.json {
        say!("{:#}", json(&before, &after, &found, apart.as_ref()));
    } else {
        let text = if args.markdown { markdown(&before, &after, &found) } else { terminal(&before, &after, &found) };
        message::text(&(text + &apart.as_ref().map_or_else(String::new, |apart| format!("\n{}\n", apart.sentence()))));
    }
    match (found.changes.len(), apart) {
        (0, None) => Ok(()),
        (0, Some(apart)) => Err(Fail::Gate(apart.sentence())),
        (count, _) => Err(Fail::Gate(format!("{count} of {} rows changed beyond noise", found.compared + unmatched(&found)))),
    }
}

fn unmatched(found: &Diff) -> usize {
    found.changes.iter().filter(|changed| changed.is_unmatched()).count()
}

/// Everything that changed, for programs. `diff --help` describes the fields.
fn json(before: &RunInfo, after: &RunInfo, found: &Diff, apart: Option<&Apart>) -> Value {
    let run = |run: &RunInfo| json!({ "run": run.run, "suite": run.suite, "revision": run.git.revision, "started": run.started });
    let count = |change: Change| found.changes.iter().filter(|changed| changed.change == change).count();
    let only = apart.map_or_else(|| [count(Change::Gone), count(Change::New)], |apart| apart.only);
    json!({
        "before": run(before),
        "after": run(after),
        "status": if found.changes.is_empty() && apart.is_none() { "same" } else { "changed" },
        "same_suite": apart.is_none(),
        "compared": found.compared,
        "invalid": found.invalid,
        "common": found.common,
        "only_before": only[0],
        "only_after": only[1],
        "changes": found.changes.iter().filter_map(changed).collect::<Vec<_>>(),
    })
}

fn changed(changed: &Changed) -> Option<Value> {
    let side = |row: Option<&Row>| row.map(|row| json!({ "value": row.value, "verdict": row.verdict }));
    let row = changed.after.or(changed.before)?;
    Some(json!({
        "change": changed.change.as_str(),
        "study": row.study,
        "robot": row.robot,
        "engine": row.engine,
        "method": row.method,
        "precision": row.precision,
        "quantity": row.quantity,
        "states": row.states,
        "body": row.body,
        "cache": row.cache,
        "metric": row.metric,
        "reference": row.reference,
        "unit": row.unit,
        "before": side(changed.before),
        "after": side(changed.after),
        "factor": changed.factor().filter(|factor| factor.is_finite()),
    }))
}

/// The columns of a listing.
const HEAD: [&str; 8] = ["change", "robot", "engine", "quantity", "measure", "before", "after", "factor"];

/// A changed row as the columns of a listing.
fn columns(changed: &Changed) -> [String; 8] {
    let shown = |row: Option<&Row>| match row {
        None => "–".to_owned(),
        Some(row) => {
            let value = row.value.map_or_else(|| "–".to_owned(), |value| number(value, &row.unit));
            if changed.change == Change::Verdict { format!("{} {value}", row.verdict) } else { value }
        }
    };
    let factor = changed.factor().filter(|factor| factor.is_finite()).map_or_else(|| "–".into(), |factor| format!("{factor:.3}"));
    let measure = |row: &Row| {
        [&row.metric, &row.body, &row.states, &row.cache].into_iter().filter(|word| !word.is_empty()).cloned().collect::<Vec<_>>().join(" ")
    };
    let Some(row) = changed.after.or(changed.before) else { return Default::default() };
    [
        changed.change.as_str().to_owned(),
        row.robot.clone(),
        format!("{} {}", row.engine, row.method),
        row.quantity.clone(),
        measure(row),
        shown(changed.before),
        shown(changed.after),
        factor,
    ]
}

fn number(value: f64, unit: &str) -> String {
    match unit {
        "1" if value != 0.0 && !(1e-3..1e6).contains(&value.abs()) => format!("{value:.2e}"),
        "" | "1" => format!("{value:.4}"),
        _ => format!("{value:.1} {unit}"),
    }
}

/// What was compared and by which rule.
fn summary(before: &RunInfo, after: &RunInfo, found: &Diff) -> String {
    let counts: Vec<String> = Change::ALL
        .iter()
        .map(|&change| (change, found.changes.iter().filter(|changed| changed.change == change).count()))
        .filter(|(_, count)| *count > 0)
        .map(|(change, count)| format!("{count} {}", change.as_str()))
        .collect();
    let what = if counts.is_empty() { "nothing changed beyond noise".to_owned() } else { counts.join(", ") };
    let revision = |run: &RunInfo| run.git.revision.chars().take(10).collect::<String>();
    let mut text =
        format!("{} ({}) to {} ({}): {} rows compared, {what}", before.run, revision(before), after.run, revision(after), found.compared);
    if found.invalid > 0 {
        let _ = write!(text, "; {} times do not count in one of the runs and were not compared", found.invalid);
    }
    if before.host.cpu != after.host.cpu || before.host.cores != after.host.cores {
        text += "; the runs are of two machines: their times compare the machines";
    }
    let _ = write!(
        text,
        ". An error changes by a factor of {ERROR_FACTOR}; a time when the ratio is beyond ±{:.0} % and beyond chance (of those told, at most {:.0} % are chance)",
        100.0 * TIME_NOISE,
        100.0 * FALSE_SHARE
    );
    if found.common != 1.0 {
        let _ = write!(text, ", over the factor that all have in common, which is {:.3}", found.common);
    }
    text
}

/// The first rows of each kind of change, and how many more there are of each.
fn listing(found: &Diff) -> (Vec<[String; 8]>, Vec<String>) {
    let (mut rows, mut more) = (Vec::new(), Vec::new());
    for &change in Change::ALL {
        let mut of_kind = found.changes.iter().filter(|changed| changed.change == change);
        rows.extend(of_kind.by_ref().take(LISTED).map(columns));
        let rest = of_kind.count();
        if rest > 0 {
            more.push(format!("and {rest} more of kind '{}'", change.as_str()));
        }
    }
    (rows, more)
}

fn terminal(before: &RunInfo, after: &RunInfo, found: &Diff) -> String {
    let (rows, more) = listing(found);
    let mut text = String::new();
    if !rows.is_empty() {
        let rows: Vec<[String; 8]> = std::iter::once(HEAD.map(str::to_owned)).chain(rows).collect();
        let widths: [usize; 8] = std::array::from_fn(|column| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0));
        for row in rows {
            let cells: Vec<String> = row
                .iter()
                .zip(widths)
                .enumerate()
                .map(|(column, (cell, width))| if column < 5 { format!("{cell:<width$}") } else { format!("{cell:>width$}") })
                .collect();
            text += cells.join("  ").trim_end();
            text.push('\n');
        }
    }
    for line in more {
        text += &format!("{line}\n");
    }
    text + &summary(before, after, found) + "\n"
}

fn markdown(before: &RunInfo, after: &RunInfo, found: &Diff) -> String {
    let (rows, more) = listing(found);
    let mut text = summary(before, after, found) + "\n";
    if !rows.is_empty() {
        text += &format!("\n| {} |\n|---|---|---|---|---|---:|---:|---:|\n", HEAD.join(" | "));
        for row in rows {
            text += &format!("| {} |\n", row.map(|cell| cell.replace('|', "\\|")).join(" | "));
        }
    }
    for line in more {
        text += &format!("\n{line}\n");
    }
    text
}
