//! Commands that compute with the model natively: `fmu-lab` has them, and is compiled when one is first called.

use crate::project;
use anyhow::{Context, Result, bail};
use std::ffi::{OsStr, OsString};
use std::path::Path;
use std::process::{Command, Stdio};

/// Environment variable that names the program to start instead of having cargo build and find it.
pub(crate) const PROGRAM: &str = "SLIDING_CONTACT_LAB";

macro_rules! commands {
    ($($name:ident = $command:literal, $about:literal;)*) => {
        $(#[doc = concat!("What `cargo fmu ", $command, "` does.")] pub const $name: &str = $about;)*

        /// Names of the commands, and what they do in one line.
        pub const COMMANDS: &[(&str, &str)] = &[$(($command, $about)),*];
    };
}

commands! {
    SIMULATE = "simulate", "Simulate a scene with inputs of your own: table, CSV, figure, and the deviation from a measured record";
    STEADY = "steady", "Compute a scene's steady state under nominal load and sliding, without time integration, print and draw it";
    CYCLES = "cycles", "Advance a reciprocating scene over many cycles at nominal load and speed";
    TABLES = "tables", "Print the tables of a scene's lumped level as JSON: decay rates, residues and static corrections of both bodies and of the moving source, and the rate that sliding adds to its decay rates";
    VERIFY = "verify", "Solve problems with a known solution and compare: exact and computed value, error, bound and cost";
    STABILITY = "stability", "Compute stability maps: where each method is accurate, oscillates, grows or is refused, with the theoretical bound";
    CHART = "chart", "Chart accuracy against cost: wear depth, contact temperature, friction force and peak pressure of six scenes";
    PLAN = "plan", "Print the level that `solver.fidelity = auto` takes for a scene, and the effects that it includes or leaves out";
    GOLDEN = "golden", "Record what the golden scenes compute, or compare it with the records to the bit";
    FUZZ = "fuzz", "Call the library, its states, scene files and batch inputs with random values and sequences, and report what breaks";
    MAN = "man", "Write man pages and completions of bash, zsh and fish for all commands to a folder";
}

/// Whether a command of this name is among them.
pub fn has(name: &OsStr) -> bool {
    COMMANDS.iter().any(|(own, _)| name == *own)
}

/// Arguments that the other program reads, its `--help` among them.
#[derive(clap::Args, Debug)]
#[command(disable_help_flag = true)]
pub struct Forwarded {
    #[arg(hide = true, trailing_var_arg = true, allow_hyphen_values = true)]
    arguments: Vec<OsString>,
}

/// Runs a command in this process's place: its input, output and status are those of this process.
///
/// # Errors
/// Where it cannot be started; where it fails this does not return.
pub fn forward(arguments: &[OsString]) -> Result<()> {
    project::leave_ctrl_c()?;
    let status = program()?.args(arguments).status().context("starting fmu-lab")?;
    if status.success() { Ok(()) } else { project::leave(status, "fmu-lab") }
}

/// Standard output of a command.
pub(crate) fn printed<I: AsRef<OsStr>>(arguments: impl IntoIterator<Item = I>) -> Result<Vec<u8>> {
    let mut command = program()?;
    command.args(arguments).stdin(Stdio::null()).stderr(Stdio::inherit());
    let output = command.output().context("starting fmu-lab")?;
    if !output.status.success() {
        bail!("fmu-lab did not finish ({})", output.status);
    }
    Ok(output.stdout)
}

/// `fmu-lab`, up to date with its sources. Compiling it the first time takes minutes, so cargo then shows its progress.
fn program() -> Result<Command> {
    if let Some(program) = std::env::var_os(PROGRAM) {
        return Ok(Command::new(program));
    }
    if !project::target().join("release").join(format!("fmu-lab{}", std::env::consts::EXE_SUFFIX)).is_file() {
        project::compile(cargo("build", &project::root()).stdout(Stdio::null()), "fmu-lab")?;
    }
    let mut run = cargo("run", &project::root());
    run.args(["--quiet", "--"]);
    Ok(run)
}

/// cargo with `fmu-lab`, in the folder of this process: paths among the arguments stay what they are.
fn cargo(action: &str, root: &Path) -> Command {
    let mut command = project::cargo();
    command.args([action, "--release", "--package", "fmu-lab", "--manifest-path"]).arg(root.join("Cargo.toml"));
    command.arg("--target-dir").arg(project::target());
    command
}
