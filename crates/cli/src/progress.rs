//! Progress on standard error: a bar on a terminal; elsewhere a line per phase, and one now and then.

use crate::message::tell;
use ::featherbench_results::quoted;
use featherbench_bench::run::Progress;
use featherbench_bench::{Cell, Lost, Outcome};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// The longest silence, without a terminal.
const SILENCE: Duration = Duration::from_secs(20);

/// Shows a run on standard error.
pub struct Bar {
    shown: Mutex<Shown>,
    terminal: bool,
}

/// What is shown, and since when.
struct Shown {
    bar: ProgressBar,
    phase: String,
    cells: usize,
    done: usize,
    told: Instant,
    /// What is told once of a run that takes long: how it goes on after an interruption.
    hint: Option<String>,
}

impl Bar {
    /// Of cells that are not kept.
    pub fn new() -> Self {
        Self::with_hint(None)
    }

    /// Of a run in a folder, which can be resumed.
    pub fn of_run(folder: &Path) -> Self {
        let folder = quoted(&folder.to_string_lossy());
        Self::with_hint(Some(format!(
            "finished cells are kept: if this is interrupted, the same command with `--resume --out {folder}` goes on"
        )))
    }

    fn with_hint(hint: Option<String>) -> Self {
        let shown = Shown { bar: ProgressBar::hidden(), phase: String::new(), cells: 0, done: 0, told: Instant::now(), hint };
        Self { shown: Mutex::new(shown), terminal: std::io::stderr().is_terminal() }
    }

    fn with(&self, act: impl FnOnce(&mut Shown)) {
        act(&mut self.shown.lock().unwrap_or_else(PoisonError::into_inner));
    }
}

impl Progress for Bar {
    fn lost(&self, lost: &Lost) {
        tell!("{lost}: its cells are evaluated again");
    }

    fn begin(&self, phase: &str, count: usize) {
        self.with(|shown| {
            (shown.phase, shown.cells, shown.done) = (phase.to_owned(), count, 0);
            if !self.terminal {
                shown.told = Instant::now();
                tell!("{phase}: {count} cells");
                return;
            }
            shown.bar = ProgressBar::with_draw_target(Some(count as u64), ProgressDrawTarget::stderr());
            if let Ok(style) = ProgressStyle::with_template("{prefix:<10} {bar:30} {pos}/{len} {eta:>4} {wide_msg}") {
                shown.bar.set_style(style);
            }
            shown.bar.set_prefix(phase.to_owned());
        });
    }

    fn cell(&self, cell: &Cell) {
        if self.terminal {
            self.with(|shown| shown.bar.set_message(cell.path()));
        }
    }

    fn done(&self, _: &Cell, _: &Outcome) {
        self.with(|shown| {
            shown.done += 1;
            shown.bar.inc(1);
            if shown.told.elapsed() < SILENCE {
                return;
            }
            shown.told = Instant::now();
            let hint = shown.hint.take();
            if self.terminal {
                hint.into_iter().for_each(|hint| shown.bar.println(hint));
            } else {
                hint.into_iter().for_each(|hint| tell!("{hint}"));
                tell!("{}: {} of {} cells", shown.phase, shown.done, shown.cells);
            }
        });
    }

    fn end(&self) {
        self.with(|shown| shown.bar.finish_and_clear());
    }
}

/// Progress of something long; without a terminal, `announced` is printed once.
pub fn spinner(announced: &str) -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        tell!("{announced}");
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new_spinner();
    if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed} {wide_msg}") {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_millis(120));
    bar
}
