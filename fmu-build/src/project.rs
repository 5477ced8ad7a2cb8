//! Locations of the project's files.

use std::fs;
use std::io::Write;
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Output, Stdio, exit};
use std::sync::Arc;

use crate::output::{Heartbeat, INTERRUPTED};
use anyhow::{Context, Result, bail, ensure};
use signal_hook::consts::SIGINT;
use signal_hook::flag;
use signal_hook::iterator::Signals;
use std::thread;

/// Root of the source tree: that of the running `cargo fmu`, so that a moved clone is found.
pub fn root() -> PathBuf {
    let member =
        std::env::var_os("CARGO_MANIFEST_DIR").map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")), PathBuf::from);
    // Members lie at several depths; the lock file is at the root alone.
    let root = member.ancestors().skip(1).find(|folder| folder.join("Cargo.lock").is_file());
    root.or(member.parent()).unwrap_or(&member).to_owned()
}

/// cargo's target folder, which holds all generated files.
pub fn target() -> PathBuf {
    match std::env::var_os("CARGO_TARGET_DIR") {
        Some(folder) => root().join(folder),
        None => root().join("target"),
    }
}

/// The file that is replaced where `path` is written anew: what a link leads to, so that the link stays.
pub(crate) fn replaceable(path: &Path) -> Result<PathBuf> {
    let Ok(known) = fs::metadata(path) else {
        if fs::symlink_metadata(path).is_ok() {
            bail!("{} is a link that leads nowhere; name a file", path.display());
        }
        return Ok(path.to_owned());
    };
    if !known.is_file() {
        bail!("{} is no regular file and would be replaced by one; name a file", path.display());
    }
    fs::canonicalize(path).with_context(|| format!("following {}", path.display()))
}

/// Path of this program. Where a build has replaced the file while it runs, Linux calls the old one deleted; the new one is meant.
pub fn program() -> std::io::Result<PathBuf> {
    let path = std::env::current_exe()?;
    Ok(match path.to_str().and_then(|text| text.strip_suffix(" (deleted)")) {
        Some(replaced) => PathBuf::from(replaced),
        None => path,
    })
}

/// `cargo`, the one that started this program where there is one.
pub(crate) fn cargo() -> Command {
    Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
}

/// What a command prints; `fault` begins the message where it fails, and `starting` that where it does not start.
pub(crate) fn printed(command: &mut Command, starting: &str, fault: &str) -> Result<String> {
    let output = command.stdin(Stdio::null()).output().with_context(|| format!("starting {starting}"))?;
    ensure!(output.status.success(), "{fault}{}", String::from_utf8_lossy(&output.stderr).trim());
    Ok(String::from_utf8(output.stdout)?)
}

/// How a command ended that was given `input`, and what it wrote. One that ends before it has read all has told why.
pub fn fed(command: &mut Command, starting: &str, input: &[u8]) -> Result<Output> {
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().with_context(|| format!("starting {starting}"))?;
    let sent = child.stdin.take().map_or(Ok(()), |mut pipe| pipe.write_all(input));
    let output = child.wait_with_output()?;
    if output.status.success() {
        sent.with_context(|| format!("writing to {starting}"))?;
    }
    Ok(output)
}

/// Has cargo compile what is told; it shows its own progress.
pub(crate) fn compile(command: &mut Command, what: &str) -> Result<()> {
    let _beat = Heartbeat::start(&format!("Compiling {what}"));
    let status = command.status().with_context(|| format!("starting {}", command.get_program().display()))?;
    ensure!(status.success(), "compiling {what} failed ({status})");
    Ok(())
}

/// Leaves Ctrl-C to the program that this process waits for: what it keeps and tells comes before the end of this process.
pub(crate) fn leave_ctrl_c() -> Result<()> {
    flag::register(SIGINT, Arc::default())?;
    Ok(())
}

/// Ends this process at Ctrl-C with a hint how its work goes on.
pub(crate) fn end_at_ctrl_c(hint: &'static str) -> Result<()> {
    let mut signals = Signals::new([SIGINT])?;
    thread::spawn(move || {
        if signals.forever().next().is_some() {
            eprintln!("interrupted; {hint}");
            exit(i32::from(INTERRUPTED));
        }
    });
    Ok(())
}

/// Whether Ctrl-C has ended a program that this process waited for.
pub fn interrupted(status: ExitStatus) -> bool {
    status.code() == Some(i32::from(INTERRUPTED)) || status.signal() == Some(SIGINT)
}

/// Ends this process with the status of a program that failed and has told why.
pub(crate) fn leave(status: ExitStatus, program: &str) -> Result<()> {
    match (status.code(), status.signal()) {
        (Some(code), _) => exit(code),
        // Ctrl-C reached it too; the status is that of shells.
        (None, Some(SIGINT)) => exit(i32::from(INTERRUPTED)),
        (None, _) => bail!("{program} was ended ({status})"),
    }
}

#[cfg(test)]
mod replaceable_tests {
    use super::replaceable;
    use std::fs;

    #[test]
    #[cfg(unix)]
    fn links_are_followed_and_devices_refused() {
        let folder = std::env::temp_dir().join(format!("replaceable-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let (file, link, open) = (folder.join("file"), folder.join("link"), folder.join("open"));
        assert_eq!(replaceable(&file).unwrap(), file);
        fs::write(&file, "").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        std::os::unix::fs::symlink(folder.join("nothing"), &open).unwrap();
        assert_eq!(replaceable(&link).unwrap(), fs::canonicalize(&file).unwrap());
        for refused in ["/dev/null".as_ref(), folder.as_path(), open.as_path()] {
            let text = replaceable(refused).unwrap_err().to_string();
            assert!(text.contains(&refused.display().to_string()) && text.contains("name a file"), "{text}");
        }
        fs::remove_dir_all(&folder).unwrap();
    }
}
