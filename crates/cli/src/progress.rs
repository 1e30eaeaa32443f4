//! Progress on standard error: a bar on a terminal, a line per phase elsewhere.

use crate::message::tell;
use featherbench_bench::run::Progress;
use featherbench_bench::{Cell, Lost, Outcome};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// Shows a run on standard error.
pub struct Bar {
    bar: Mutex<ProgressBar>,
    terminal: bool,
}

impl Bar {
    pub fn new() -> Self {
        Self { bar: Mutex::new(ProgressBar::hidden()), terminal: std::io::stderr().is_terminal() }
    }

    fn with(&self, act: impl FnOnce(&mut ProgressBar)) {
        act(&mut self.bar.lock().unwrap_or_else(PoisonError::into_inner));
    }
}

impl Progress for Bar {
    fn lost(&self, lost: &Lost) {
        tell!("{lost}: its cells are evaluated again");
    }

    fn begin(&self, phase: &str, count: usize) {
        if !self.terminal {
            tell!("{phase}: {count} cells");
            return;
        }
        self.with(|bar| {
            *bar = ProgressBar::with_draw_target(Some(count as u64), ProgressDrawTarget::stderr());
            if let Ok(style) = ProgressStyle::with_template("{prefix:<10} {bar:30} {pos}/{len} {eta:>4} {wide_msg}") {
                bar.set_style(style);
            }
            bar.set_prefix(phase.to_owned());
        });
    }

    fn cell(&self, cell: &Cell) {
        if self.terminal {
            self.with(|bar| bar.set_message(cell.path()));
        }
    }

    fn done(&self, _: &Cell, _: &Outcome) {
        if self.terminal {
            self.with(|bar| bar.inc(1));
        }
    }

    fn end(&self) {
        self.with(|bar| bar.finish_and_clear());
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
