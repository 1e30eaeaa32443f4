//! `featherbench explain`: one cell of a run, from question to verdict.

use crate::args::ExplainArgs;
use crate::fail::Fail;
use crate::message::{say, tell};
use ::featherbench_results::Row;
use featherbench_bench::{Entries, NoAnswer, OUTCOMES_NAME, Outcome, Quantity};

/// Prints what a cell asked, what was answered, and how it was judged.
pub fn explain(args: &ExplainArgs) -> Result<(), Fail> {
    let (info, records) = ::featherbench_results::read_run(&args.folder)?;
    let rows: Vec<&Row> = records.iter().filter(|row| row.cell.starts_with(&args.cell)).collect();
    let Some(first) = rows.first() else {
        let message =
            format!("{} has no cell that begins with '{}'; ids stand in the column 'cell' of rows.csv", args.folder.display(), args.cell);
        return Err(Fail::input(message));
    };
    if let Some(other) = rows.iter().find(|row| row.cell != first.cell) {
        return Err(Fail::input(format!("'{}' begins more than one cell: {}, {}; give more digits", args.cell, first.cell, other.cell)));
    }
    let quantity = Quantity::parse(&first.quantity).map_or("", Quantity::words);
    say!("cell      {}", first.cell);
    say!("study     {}", first.study);
    say!("robot     {} ({}; nv {}, depth {})", first.robot, first.family, count(first.nv), count(first.depth));
    say!("asked     {} {} by {} in {}", first.engine, first.engine_version, first.method, first.precision);
    say!("quantity  {}: {quantity}", first.quantity);
    say!("params    {}", first.params);
    if args.folder.join(OUTCOMES_NAME).is_file() || info.has_file(OUTCOMES_NAME) {
        if !info.has_file(OUTCOMES_NAME) {
            tell!("note: {OUTCOMES_NAME} has no checksum of its own: an older version wrote the run; each entry of it has one");
        }
        match Entries::whole(&args.folder)?.outcome(&first.cell)? {
            Some(Outcome::Values(values)) => {
                let head: Vec<String> = values.iter().take(6).map(|value| format!("{value:?}")).collect();
                say!("answer    {} numbers: {}{}", values.len(), head.join(", "), if values.len() > 6 { ", …" } else { "" });
            }
            Some(Outcome::Text(text)) => {
                let head: String = text.chars().take(400).collect();
                let more = if head.len() < text.len() { " …" } else { "" };
                say!("answer    a text of {} characters: {head}{more}", text.chars().count());
            }
            Some(Outcome::NoAnswer(NoAnswer::NotOffered(reason))) => say!("answer    not offered: {reason}"),
            Some(Outcome::NoAnswer(NoAnswer::Failed(reason))) => say!("answer    failed: {reason}"),
            None => say!("answer    not kept"),
        }
    }
    say!("");
    for row in &rows {
        let number = |value: Option<f64>| value.map_or_else(|| "–".into(), |value| format!("{value:.3e}"));
        let against = if row.reference.is_empty() { String::new() } else { format!(" against {}", row.reference) };
        say!(
            "{:<9} {:<10} {:<24} {} {} (bound {}, margin {} decades){against} {}",
            row.verdict.as_str(),
            [row.body.as_str(), &row.states, &row.cache].concat(),
            row.metric,
            number(row.value),
            row.unit,
            number(row.bound),
            row.margin.map_or_else(|| "–".into(), |margin| format!("{margin:.1}")),
            row.reason
        );
    }
    say!("\nagain     {}", info.again(&first.study, &first.robot).map_err(Fail::input)?);
    Ok(())
}

fn count(number: Option<u64>) -> String {
    number.map_or_else(|| "–".into(), |number| number.to_string())
}
