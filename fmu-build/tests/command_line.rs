//! The command as a user starts it: forwarded commands, and behaviour with a closed output pipe.

use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

fn command(line: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_fmu-build"));
    command.args(line.split(' ')).stdin(Stdio::null());
    command
}

fn run(line: &str) -> (bool, String, String) {
    let Output { status, stdout, stderr } = command(line).output().unwrap();
    (status.success(), String::from_utf8(stdout).unwrap(), String::from_utf8(stderr).unwrap())
}

/// A file of a test, removed at its end.
struct File(PathBuf);

impl std::ops::Deref for File {
    type Target = Path;

    fn deref(&self) -> &Path {
        &self.0
    }
}

impl Drop for File {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

fn file(name: &str, text: &str) -> File {
    let path = std::env::temp_dir().join(format!("command-line-{}-{name}", std::process::id()));
    std::fs::write(&path, text).unwrap();
    File(path)
}

#[test]
fn nobody_reading_the_output_is_no_panic() {
    let set = File(std::env::temp_dir().join(format!("command-line-{}.ssv", std::process::id())));
    for line in [&format!("package clutch --ssv -o {}", set.display()), "--help"] {
        let (reader, writer) = io::pipe().unwrap();
        drop(reader);
        let output = command(line).stdout(writer).output().unwrap();
        let told = String::from_utf8_lossy(&output.stderr);
        assert!(!told.contains("panicked") && !told.contains("error"), "{line}: {told}");
        if line != "--help" {
            assert_eq!(output.status.code(), Some(141), "{line}: {told}");
        }
    }
}

/// A stand-in for `fmu-lab` that tells its arguments and its input, and ends with status 7.
#[cfg(unix)]
fn stand_in(name: &str) -> File {
    use std::os::unix::fs::PermissionsExt;
    let text = "#!/bin/sh\nprintf '<%s>' \"$@\"\ncat\necho told >&2\nexit 7\n";
    let path = file(name, text);
    std::fs::set_permissions(&*path, std::fs::Permissions::from_mode(0o755)).unwrap();
    path
}

#[test]
#[cfg(unix)]
fn commands_that_compute_natively_are_forwarded_as_they_are() {
    let lab = stand_in("forwarded");
    let input = file("input", "what is typed");
    for line in [
        "steady disc_brake --cells 9 --json --set a=1",
        "cycles --help",
        "help verify",
        "help golden compare",
        "verify -h",
        "verify --version",
        "tables -- --strange",
        "golden compare --tolerance 7",
        "plan",
        "simulate disc_brake --inputs in.csv --at 0,1 --json",
        "help simulate",
        "chart --list",
        "stability --map wear-step",
        "bench --line --json",
        "bench --line",
    ] {
        let output = command(line)
            .env("SLIDING_CONTACT_LAB", &*lab)
            .stdin(std::fs::File::open(&*input).unwrap())
            .output()
            .unwrap();
        let told: String = line.split(' ').map(|word| format!("<{word}>")).collect();
        assert_eq!(String::from_utf8_lossy(&output.stdout), format!("{told}what is typed"), "{line}");
        assert_eq!(String::from_utf8_lossy(&output.stderr), "told\n", "{line}");
        assert_eq!(output.status.code(), Some(7), "{line}");
    }
    let (success, listed, _) = run("--help");
    assert!(success);
    for (name, about) in fmu_build::native::COMMANDS {
        let line = listed.lines().find(|line| line.split_whitespace().next() == Some(name)).unwrap();
        assert!(line.trim_start()[name.len()..].trim_start() == *about, "{line}");
    }
}

#[test]
#[cfg(unix)]
fn a_program_that_cannot_be_started_is_told() {
    let output = command("verify").env("SLIDING_CONTACT_LAB", "/nonexistent/fmu-lab").output().unwrap();
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success() && told.starts_with("error: starting fmu-lab"), "{told}");
}
