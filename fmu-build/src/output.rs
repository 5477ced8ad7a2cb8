//! Output of the commands: standard output and files.

use crate::project;
use anyhow::{Context, Result, bail};
use std::fmt;
use std::fs;
use std::io::{self, ErrorKind, IsTerminal, Write};
use std::path::{Component, Path, PathBuf};
use std::process::{ExitCode, exit};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// Exit status after a closed output pipe, as in shells: 128 plus the number of SIGPIPE.
const NOT_READ: i32 = 141;

/// Prints a text. Ends the process silently where the output pipe is closed (`cargo fmu verify | head`), with an error where it
/// cannot be written.
///
/// The signal itself stays ignored: a batch must outlive a worker process that it writes to.
pub fn print(text: fmt::Arguments<'_>) {
    let mut out = io::stdout().lock();
    match out.write_fmt(text).and_then(|()| out.flush()) {
        Ok(()) => {}
        Err(error) if error.kind() == ErrorKind::BrokenPipe => exit(NOT_READ),
        Err(error) => {
            eprintln!("error: writing the output: {error}");
            exit(1)
        }
    }
}

/// Prints a line; see [`print()`].
#[macro_export]
macro_rules! print_line {
    ($($text:tt)*) => {
        $crate::output::print(format_args!("{}\n", format_args!($($text)*)))
    };
}

/// Prints a text as it is; see [`print()`].
#[macro_export]
macro_rules! print_text {
    ($($text:tt)*) => {
        $crate::output::print(format_args!($($text)*))
    };
}

pub use {print_line, print_text};

/// Exit status after Ctrl-C, as in shells: 128 plus the number of SIGINT.
pub const INTERRUPTED: u8 = 130;

/// Work was ended by Ctrl-C; what is kept of it.
#[derive(Debug)]
pub struct Interrupted(pub String);

impl fmt::Display for Interrupted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Interrupted {}

/// Status of the process that a command ends with; tells the error that it ends with.
pub fn status(result: Result<()>) -> ExitCode {
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) if error.is::<Interrupted>() => {
            eprintln!("{error}");
            ExitCode::from(INTERRUPTED)
        }
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

/// Time between two lines of a [`Heartbeat`].
const INTERVAL: Duration = Duration::from_secs(8);

/// Tells every few seconds on the error stream that something still runs, where that is no terminal: there progress bars show it.
pub(crate) struct Heartbeat {
    /// Closed when this is dropped.
    end: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Heartbeat {
    /// With what runs, in words.
    pub(crate) fn start(what: &str) -> Self {
        Self::with(what, INTERVAL, io::stderr().is_terminal(), |line| eprintln!("{line}"))
    }

    fn with(what: &str, interval: Duration, hidden: bool, tell: impl Fn(String) + Send + 'static) -> Self {
        if hidden {
            return Self { end: None, thread: None };
        }
        let (end, ended) = channel::<()>();
        let (what, begin) = (what.to_owned(), Instant::now());
        let thread = thread::spawn(move || {
            while ended.recv_timeout(interval) == Err(RecvTimeoutError::Timeout) {
                tell(format!("  {what}, {:.0} s", begin.elapsed().as_secs_f64()));
            }
        });
        Self { end: Some(end), thread: Some(thread) }
    }
}

impl Drop for Heartbeat {
    fn drop(&mut self) {
        drop(self.end.take());
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// Whether a file has this ending, in letters of any size.
pub fn ends_with(path: &Path, ending: &str) -> bool {
    path.extension().is_some_and(|own| own.eq_ignore_ascii_case(ending))
}

/// Refuses a file that could not be written, or whose ending promises another format than those of `endings`, one of which is written:
/// before anything is computed for it. Folders above it that are missing are made when it is written.
pub fn check_ending(path: Option<&Path>, endings: &[&str]) -> Result<()> {
    let Some(path) = path else { return Ok(()) };
    check_file("--output", path)?;
    match path.extension() {
        Some(given) if !endings.iter().any(|ending| given.eq_ignore_ascii_case(ending)) => {
            let written = endings.join(" or .");
            bail!("--output {}: .{written} is written, not .{}", path.display(), given.to_string_lossy())
        }
        _ => Ok(()),
    }
}

/// Refuses a file of this option that could not be written.
pub fn check_file(option: &str, path: &Path) -> Result<()> {
    project::replaceable(path).with_context(|| format!("{option} {}", path.display()))?;
    check_above(option, path)
}

/// Refuses a path below a file.
fn check_above(option: &str, path: &Path) -> Result<()> {
    match path.ancestors().skip(1).find(|above| above.exists()) {
        Some(above) if above.is_file() => bail!("{option} {}: {} is no folder", path.display(), above.display()),
        _ => Ok(()),
    }
}

/// Makes the folders above a file that is to be written.
pub fn make_above(path: &Path) -> Result<()> {
    match path.parent() {
        Some(folder) => fs::create_dir_all(folder).with_context(|| format!("making {}", folder.display())),
        None => Ok(()),
    }
}

/// Whether writing `path` would replace the file `read`, however both are spelled; also where a folder of `path` is still to be made.
pub fn would_replace(path: &Path, read: &Path) -> bool {
    // What `..` leaves need not exist: it is made before the file is.
    let written = || {
        let mut plain = PathBuf::new();
        for component in std::path::absolute(path)?.components() {
            match component {
                Component::ParentDir => drop(plain.pop()),
                other => plain.push(other),
            }
        }
        fs::canonicalize(plain)
    };
    let written = fs::canonicalize(path).or_else(|_| written()).ok();
    written.is_some() && written == fs::canonicalize(read).ok()
}

/// A number of things, by the name of one.
pub(crate) fn counted(count: usize, thing: &str) -> String {
    format!("{count} {thing}{}", if count == 1 { "" } else { "s" })
}

/// Endings of files, which no folder of results has.
const FILES: [&str; 8] = ["csv", "html", "json", "parquet", "pdf", "png", "svg", "txt"];

/// Refuses a path for a folder of results that is meant, or exists, as a file.
pub fn check_folder(path: Option<&Path>) -> Result<()> {
    let Some(path) = path else { return Ok(()) };
    let file = path.extension().is_some_and(|given| FILES.iter().any(|ending| given.eq_ignore_ascii_case(ending)));
    if path.is_file() || file && !path.is_dir() {
        bail!("--output {}: several files are written, so a folder must be named", path.display());
    }
    check_above("--output", path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_runs_for_long_is_told_until_it_ends() {
        let (sender, told) = channel();
        let beat =
            Heartbeat::with("Compiling", Duration::from_millis(5), false, move |line| sender.send(line).unwrap());
        assert_eq!(told.recv().unwrap(), "  Compiling, 0 s");
        told.recv().unwrap();
        drop(beat);
        // The thread has ended, and with it the sender.
        while let Ok(line) = told.try_recv() {
            assert!(line.starts_with("  Compiling"));
        }
        assert!(told.recv().is_err());
        let (sender, told) = channel::<String>();
        let hidden = Heartbeat::with("Compiling", Duration::ZERO, true, move |line| sender.send(line).unwrap());
        assert!(told.recv().is_err());
        drop(hidden);
    }

    #[test]
    fn a_file_that_is_read_is_known_in_every_spelling() {
        let folder = std::env::temp_dir().join(format!("would-replace-{}", std::process::id()));
        fs::create_dir_all(folder.join("b")).unwrap();
        let read = folder.join("a.csv");
        fs::write(&read, "").unwrap();
        for same in ["a.csv", "./a.csv", "b/../a.csv", "missing/../a.csv", "b/missing/../../a.csv"] {
            assert!(would_replace(&folder.join(same), &read), "{same}");
        }
        for other in ["c.csv", "b/a.csv", "missing/a.csv"] {
            assert!(!would_replace(&folder.join(other), &read), "{other}");
        }
        assert!(!would_replace(&folder.join("c.csv"), &folder.join("d.csv")));
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn a_file_is_no_folder() {
        let told = |path: &Path| check_folder(Some(path)).map_err(|error| error.to_string());
        assert_eq!(told(Path::new("results/run.3")), Ok(()));
        assert!(told(Path::new("results.png")).unwrap_err().contains("a folder must be named"));
        assert!(told(&std::env::current_exe().unwrap()).unwrap_err().contains("a folder must be named"));
        assert!(check_folder(None).is_ok());
    }
}
