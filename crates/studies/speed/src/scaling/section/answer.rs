//! The answer of the section in words: how far our algorithms went, and where others stopped.

use super::data::{Data, Series};
use featherbench_bench::OWN;
use featherbench_report::Overview;
use featherbench_report::numbers::{grouped, short};
use featherbench_results::RunInfo;

/// The answer.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Answer {
    /// Ours on the line with the largest tree.
    pub(super) own: Option<String>,
    /// Where each other engine stopped on that line, with the reason.
    pub(super) others: Vec<(String, String)>,
}

/// The answer on the line where our forward dynamics went furthest.
pub(super) fn answer(run: &RunInfo, overview: &Overview, data: &Data) -> Answer {
    let largest = |one: &&Series| one.points.last().map_or(0, |point| point.size);
    let forward = || data.series.iter().filter(|one| one.quantity == "fd");
    let own = forward().filter(|one| overview.engines[one.engine] == OWN && one.method == "aba");
    // Of equally large ones, the first line of the suite.
    let Some(best) = own.rev().max_by_key(largest) else { return Answer::default() };
    let others = (0..overview.engines.len()).filter(|&engine| overview.engines[engine] != OWN);
    let stopped = others.filter_map(|engine| {
        // An engine goes as far as its best method.
        let series = forward().filter(|one| one.line == best.line && one.engine == engine).rev().max_by_key(largest)?;
        Some((overview.engines[engine].to_owned(), stop(series)))
    });
    // An engine of the study that was not there has no series.
    let missing = run.engines.iter().filter(|engine| engine.status != "ok");
    let missing = missing.map(|engine| (engine.name.clone(), format!("was not measured: {}", engine.reason)));
    Answer { own: sentence(data, best), others: stopped.chain(missing).collect() }
}

/// Ours: the size, the time, the memory and the error.
fn sentence(data: &Data, series: &Series) -> Option<String> {
    let point = series.points.last()?;
    let mut parts = vec![format!("{} a call", time(point.seconds?))];
    parts.extend(series.memory_per_dof.map(|bytes| format!("{} more memory per degree of freedom", memory(bytes))));
    let exact = data.errors.iter().find(|error| error.robot == point.robot && error.method == series.method);
    let over = exact.and_then(|error| error.over);
    parts.extend(match (over, point.error) {
        (Some(over), _) => Some(format!("an error of {} times the conditioning bound", short(over))),
        (None, Some(error)) => Some(format!("a relative error of {}", short(error))),
        (None, None) => None,
    });
    let list = featherbench_report::numbers::listed(&parts);
    Some(format!("Our forward dynamics of a {} of {} degrees of freedom: {list}.", series.line, grouped(point.size as usize)))
}

/// How far a series went, and why no further.
fn stop(series: &Series) -> String {
    let size = series.points.last().map_or(0, |point| point.size);
    if series.reason.is_empty() {
        return format!("answers up to {}, the largest that was asked", grouped(size as usize));
    }
    format!("stops after {}: {}", grouped(size as usize), series.reason)
}

/// Seconds for readers.
pub(super) fn time(seconds: f64) -> String {
    let (scale, unit) = match seconds {
        s if s >= 1.0 => (1.0, "s"),
        s if s >= 1e-3 => (1e3, "ms"),
        s if s >= 1e-6 => (1e6, "µs"),
        _ => (1e9, "ns"),
    };
    format!("{} {unit}", short(seconds * scale))
}

/// Bytes for readers.
pub(super) fn memory(bytes: f64) -> String {
    let (scale, unit) = match bytes.abs() {
        b if b >= 1e9 => (1e-9, "GB"),
        b if b >= 1e6 => (1e-6, "MB"),
        b if b >= 1e3 => (1e-3, "kB"),
        _ => (1.0, "B"),
    };
    format!("{} {unit}", short(bytes * scale))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_and_bytes_read_well() {
        assert_eq!([2.5, 0.25, 3e-5, 7e-8].map(time), ["2.5 s", "250 ms", "30 µs", "70 ns"]);
        assert_eq!([3e9, 2.5e6, 600.0, 1200.0].map(memory), ["3 GB", "2.5 MB", "600 B", "1.2 kB"]);
    }
}
