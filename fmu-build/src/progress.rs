//! Progress of long work on the error stream: nothing in the first second; then a bar on a terminal, elsewhere a line after ten seconds and
//! then one every minute.

use indicatif::{ProgressBar, ProgressStyle};
use std::io::{IsTerminal, stderr};
use std::time::{Duration, Instant};

/// Time before the bar.
const QUIET: Duration = Duration::from_secs(1);

/// Time between two changes of the bar.
const CHANGE: Duration = Duration::from_millis(100);

/// Time before the first line, where the error stream is no terminal.
const FIRST: Duration = Duration::from_secs(10);

/// Time between two lines.
const PAUSE: Duration = Duration::from_secs(60);

const PARTS: usize = 1000;

/// Progress of one piece of work; the bar is removed when this is dropped.
pub struct Progress {
    begin: Instant,
    next: Instant,
    pause: Duration,
    bar: Option<ProgressBar>,
    /// Where lines go; `None` on a terminal.
    tell: Option<Box<dyn FnMut(String)>>,
}

impl Default for Progress {
    fn default() -> Self {
        if stderr().is_terminal() {
            Self::with(QUIET, CHANGE, None)
        } else {
            Self::with(FIRST, PAUSE, Some(Box::new(|line| eprintln!("{line}"))))
        }
    }
}

impl Progress {
    fn with(first: Duration, pause: Duration, tell: Option<Box<dyn FnMut(String)>>) -> Self {
        let begin = Instant::now();
        Self { begin, next: begin + first, pause, bar: None, tell }
    }

    /// This part of the work is done, which is described in words.
    pub fn reached(&mut self, part: f64, what: impl FnOnce() -> String) {
        let now = Instant::now();
        if now < self.next {
            return;
        }
        self.next = now + self.pause;
        if let Some(tell) = &mut self.tell {
            tell(format!("{}, {:.0} % after {:.0} s", what(), 100.0 * part, (now - self.begin).as_secs_f64()));
            return;
        }
        let bar = self.bar.get_or_insert_with(|| bar(PARTS, "{percent} % {msg}, {eta} left"));
        bar.set_position((PARTS as f64 * part) as u64);
        bar.set_message(what());
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

/// A bar of `count` parts on the error stream, followed by what the template shows.
pub fn bar(count: usize, template: &str) -> ProgressBar {
    let style = ProgressStyle::with_template(&format!("{{bar:30}} {template}"));
    ProgressBar::new(count as u64).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::channel;

    #[test]
    fn without_a_terminal_there_is_a_line_in_every_pause() {
        let (sender, told) = channel();
        let tell = move |line| sender.send(line).unwrap();
        let mut progress = Progress::with(Duration::ZERO, Duration::from_secs(3600), Some(Box::new(tell)));
        for part in 0..4 {
            progress.reached(0.25 * f64::from(part), || format!("{part} of 4 scenes"));
        }
        assert_eq!(told.try_iter().collect::<Vec<_>>(), ["0 of 4 scenes, 0 % after 0 s"]);
        progress.next = Instant::now();
        progress.reached(0.5, || "2 of 4 scenes".into());
        assert_eq!(told.try_iter().collect::<Vec<_>>(), ["2 of 4 scenes, 50 % after 0 s"]);
        assert!(progress.bar.is_none());
    }
}
