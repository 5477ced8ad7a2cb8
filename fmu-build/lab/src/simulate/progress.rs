//! Progress of a run on the error stream: nothing in the first second; then a bar on a terminal, elsewhere a line every ten
//! seconds.

use analyses::simulation::quantity::rounded;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::{IsTerminal, stderr};
use std::time::{Duration, Instant};

/// Time before the first report.
const QUIET: Duration = Duration::from_secs(1);

/// Time between lines where the error stream is no terminal.
const PAUSE: Duration = Duration::from_secs(10);

/// Parts of the bar.
const PARTS: u64 = 1000;

pub struct Progress {
    first: f64,
    last: f64,
    next: Instant,
    bar: Option<ProgressBar>,
    terminal: bool,
}

impl Progress {
    /// Of a run from one time to another, s.
    pub fn new(first: f64, last: f64) -> Self {
        Self { first, last, next: Instant::now() + QUIET, bar: None, terminal: stderr().is_terminal() }
    }

    /// The run has reached this time, s.
    pub fn reached(&mut self, time: f64) {
        let now = Instant::now();
        if now < self.next {
            return;
        }
        let part = (time - self.first) / (self.last - self.first);
        if !self.terminal {
            self.next = now + PAUSE;
            eprintln!("{} s of {} s, {:.0} %", rounded(time), self.last, 100.0 * part);
            return;
        }
        self.next = now + QUIET / 10;
        let bar = self.bar.get_or_insert_with(|| {
            let style = ProgressStyle::with_template("{bar:30} {percent} % {msg}, {eta} left");
            ProgressBar::new(PARTS).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
        });
        bar.set_position((PARTS as f64 * part) as u64);
        bar.set_message(format!("{} s of {} s", rounded(time), self.last));
    }

    /// Removes the bar.
    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
