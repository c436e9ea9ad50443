//! A progress bar on stderr, for people who wait: only on a terminal, and only once the work has taken a while.

use super::args::General;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::sync::OnceLock;
use std::time::{Duration, Instant};

/// Work that is done sooner shows no bar.
const PATIENCE: Duration = Duration::from_secs(1);

/// A bar that appears when it is worth it and goes when dropped.
pub(super) struct Progress {
    what: String,
    start: Instant,
    visible: bool,
    bar: OnceLock<ProgressBar>,
}

impl Progress {
    pub(super) fn new(what: impl Into<String>, general: &General) -> Self {
        let visible = !general.quiet && std::io::stderr().is_terminal();
        Self { what: what.into(), start: Instant::now(), visible, bar: OnceLock::new() }
    }

    /// Tells the bar; callable from any thread.
    pub(super) fn tell(&self, done: usize, total: usize) {
        if !self.visible || self.start.elapsed() < PATIENCE {
            return;
        }
        let bar = self.bar.get_or_init(|| {
            let style = ProgressStyle::with_template("{msg} {wide_bar} {percent:>3} % {eta:>4}");
            let style = style.unwrap_or_else(|_| ProgressStyle::default_bar());
            ProgressBar::new(total as u64).with_style(style).with_message(self.what.clone())
        });
        // Threads report out of order; a bar that steps back confuses.
        if done as u64 > bar.position() {
            bar.set_position(done as u64);
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = self.bar.get() {
            bar.finish_and_clear();
        }
    }
}
