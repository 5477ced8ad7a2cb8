//! `cargo fmu test`: all checks of a change, in tiers.

mod platforms;
mod tally;

use crate::python::{self, Tier};
use crate::{bench, native, package, project, realtime, release, run, scenes, site};
use anyhow::{Context, Result, bail};
use std::path::{Path, PathBuf};
use std::process::Command;
use tally::{Counter, Tally};

/// Scene that the importers and the clock run.
const BRAKE: &str = "disc_brake";

/// Seconds of random calls, states, scene files and batch inputs; `cargo fmu fuzz` takes longer by command.
const FUZZED: &str = "60";

/// Check formatting and lints, run the Rust tests, package the scenes and test the FMU from fmpy.
///
/// --fast is what to run between edits: formatting, lints, the unit tests of every layer, the golden scenes, and the calls in
/// every order that FMI allows or forbids. --slow adds what takes
/// long: random calls, soak, batches, the examples, the release folder, the Python package with its wheel, the site.
/// Continuous integration runs the usual tests, the slow ones and the importers on every change.
///
/// Ends with what was skipped and why, and with one line that counts everything.
#[derive(clap::Args, Debug)]
pub struct Arguments {
    /// Only what takes under two minutes: formatting, lints, unit tests, golden scenes, FMI policy.
    #[arg(long, conflicts_with_all = ["slow", "importers", "platforms", "all", "only"])]
    fast: bool,
    /// Also random calls for a minute, a short soak, batches, the examples, the release folder, the Python package and the site.
    #[arg(long)]
    slow: bool,
    /// Also load the FMU natively with the `fmi` crate, compare the C declarations with its bindings, and drive it with
    /// other importers from Python.
    #[arg(long)]
    importers: bool,
    /// Also package the FMU for Windows and 64-bit ARM and run it there, under Wine and qemu.
    #[arg(long)]
    platforms: bool,
    /// All tiers.
    #[arg(long)]
    all: bool,
    /// Only the tiers named here, not what is tested otherwise.
    #[arg(long, conflicts_with = "all")]
    only: bool,
    /// Print the counts as JSON; the log goes to the error stream.
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub fn execute(arguments: &Arguments) -> Result<()> {
    if arguments.only && !(arguments.slow || arguments.importers || arguments.platforms) {
        bail!("--only needs the name of a tier: --slow, --importers or --platforms");
    }
    let mut tally = Tally::new(arguments.json);
    if arguments.fast {
        fast(&mut tally);
        return tally.close();
    }
    if arguments.only {
        tally.skip("everything else", "not requested: --only");
    } else {
        usual(&mut tally);
    }
    if arguments.slow || arguments.all {
        slow(&mut tally);
    } else {
        tally.skip("slow tests", "not requested: --slow");
    }
    if arguments.importers || arguments.all {
        tally.step("importer tests", |step| step.run(importers()?, Counter::CargoTest));
        tally.step("other importers", |step| step.run(wheels()?, Counter::Pytest));
    } else {
        tally.skip("importer tests", "not requested: --importers");
    }
    if arguments.platforms || arguments.all {
        platforms::check(&mut tally);
    } else {
        tally.skip("platforms", "not requested: --platforms");
    }
    tally.close()
}

fn fast(tally: &mut Tally) {
    lints(tally);
    tally.step("unit tests", |step| step.run(rust_tests(&["--lib", "--bins"]), Counter::CargoTest));
    own_command(tally, "golden scenes", &["golden", "compare"]);
    tally.step("FMI policy", |step| step.run(rust_tests(&["--test", "fmi_policy"]), Counter::CargoTest));
    for name in ["integration tests", "packaging", "fmpy tests", "cost of a step", "real time", "slow tests"] {
        tally.skip(name, "not requested: --fast");
    }
}

/// Runs a command of this program as a step.
fn own_command(tally: &mut Tally, name: &str, arguments: &[&str]) {
    tally.step(name, |step| {
        let mut command = Command::new(project::program()?);
        command.current_dir(project::root()).args(arguments);
        step.check(command)?;
        step.pass();
        Ok(())
    });
}

/// Tests of all crates; the whole workspace, so that no selection of crates compiles a dependency anew.
fn rust_tests(targets: &[&str]) -> Command {
    let mut command = cargo(&["test", "--locked", "--release", "--workspace", "--all-features", "--no-fail-fast"]);
    command.args(targets);
    command
}

fn usual(tally: &mut Tally) {
    lints(tally);
    tally.step("Rust tests", |step| step.run(rust_tests(&[]), Counter::CargoTest));
    tally.step("packaging", |step| {
        package_scenes()?;
        step.pass();
        Ok(())
    });
    tally.step("fmpy tests", |step| step.run(fmpy(&["--ignore", "tests/fmpy/slow", "tests/fmpy"])?, Counter::Pytest));
    if cfg!(all(target_os = "linux", target_arch = "x86_64")) {
        tally.step("cost of a step", |step| {
            for cost in bench::measure(&bench::lumped(None)?)? {
                step.judge(&cost.to_string(), cost.is_tolerable());
            }
            Ok(())
        });
        tally.step("real time", |step| {
            let run = realtime::measure(&realtime::Case::new(realtime::Contact::Cold))?;
            step.judge(&run.summary(), run.is_tolerable());
            Ok(())
        });
    } else {
        for name in ["cost of a step", "real time"] {
            tally.skip(name, "the FMU that is packaged holds the library for Linux on x86-64 only");
        }
    }
}

fn slow(tally: &mut Tally) {
    own_command(tally, "fuzzing", &["fuzz", "--seconds", FUZZED]);
    tally.step("site", |step| {
        site::build(&project::target().join("site"))?;
        step.pass();
        Ok(())
    });
    tally.step("slow fmpy tests", |step| {
        package_scenes()?;
        // FMUs for the check of the heat partition: the stock scene as it is, and at a far stricter tolerance.
        for (name, tolerance) in [("scene", None), ("fine", Some("--tolerance=1e-5"))] {
            let file = project::target().join("fmu").join(format!("tables.{name}.json"));
            std::fs::write(file, native::printed(["tables"].into_iter().chain(tolerance))?)?;
        }
        let mut command = fmpy(&["tests/fmpy/slow"])?;
        // Requirements of the batch tests: the Python package, the example's own environment, and this program.
        command
            .env("PYTHONPATH", package::wheel::unpacked(&[BRAKE])?)
            .env("SLIDING_CONTACT_BATCH_PYTHON", python::own(python::BATCH)?)
            .env("SLIDING_CONTACT_RELEASE", released()?);
        step.run(command, Counter::Pytest)
    });
    own_command(tally, "soak", &["soak", "--short"]);
    tally.step("Python package", |step| step.run(python_package()?, Counter::Pytest));
}

fn package_scenes() -> Result<()> {
    for scene in std::iter::once(None).chain(scenes::names().iter().map(|name| Some(name.as_str()))) {
        package::build(scene, &package::Options::default())?;
    }
    Ok(())
}

/// pytest in an environment, of the tests that these arguments select.
fn pytest(python: PathBuf, selection: &[&str]) -> Command {
    let mut command = Command::new(python);
    command
        .current_dir(project::root())
        .args(["-m", "pytest", "-p", "no:cacheprovider", "-r", "s", "--tb", "short"])
        .args(selection)
        .env("PYTHONDONTWRITEBYTECODE", "1");
    command
}

/// Tests of the packaged FMUs from fmpy.
fn fmpy(selection: &[&str]) -> Result<Command> {
    let mut command = pytest(python::environment_for(Tier::Test)?, selection);
    command
        .env("SLIDING_CONTACT_FMU_FOLDER", project::target().join("fmu"))
        .env("SLIDING_CONTACT_COMMAND", project::program()?)
        .env("MPLCONFIGDIR", project::target().join("python").join("matplotlib"));
    Ok(command)
}

/// Tests of the Python package: its functions, doc strings and notebooks from the package as a folder, and its wheel in an empty
/// environment.
fn python_package() -> Result<Command> {
    let names = scenes::names();
    let mut command = pytest(python::own(python::PACKAGE)?, &["tests/python"]);
    command
        .env("PYTHONPATH", package::wheel::unpacked(&names.iter().map(String::as_str).collect::<Vec<_>>())?)
        .env("SLIDING_CONTACT_WHEEL", package::wheel::build(&project::target().join("dist"), None)?)
        .env("SLIDING_CONTACT_COMMAND", project::program()?)
        .env("MPLBACKEND", "Agg")
        .env("MPLCONFIGDIR", project::target().join("python-package-environment").join("matplotlib"));
    Ok(command)
}

/// A release for this machine, in a folder of its own.
fn released() -> Result<PathBuf> {
    let folder = project::target().join("fmu").join("release");
    if folder.exists() {
        std::fs::remove_dir_all(&folder).with_context(|| format!("replacing {}", folder.display()))?;
    }
    release::build(&folder, &package::Options::default().platforms)?;
    Ok(folder)
}

/// Formatting and lints change with the toolchain, so they are judged by the one that the project names.
fn lints(tally: &mut Tally) {
    if let Err(reason) = named_toolchain() {
        tally.skip("formatting", &reason);
        tally.skip("lints", &reason);
        return;
    }
    let importers = project::root().join("tests/importers/Cargo.toml");
    tally.step("formatting", |step| {
        step.check(cargo(&["fmt", "--all", "--check"]))?;
        let mut command = cargo(&["fmt", "--check", "--manifest-path"]);
        command.arg(&importers);
        step.check(command)?;
        step.pass();
        Ok(())
    });
    tally.step("lints", |step| {
        step.check(cargo(&[
            "clippy",
            "--locked",
            "--release",
            "--workspace",
            "--all-targets",
            "--all-features",
            "--",
            "--deny",
            "warnings",
        ]))?;
        let mut documentation = cargo(&["doc", "--locked", "--release", "--workspace", "--all-features", "--no-deps"]);
        documentation.env("RUSTDOCFLAGS", "--deny warnings");
        step.check(documentation)?;
        step.pass();
        Ok(())
    });
}

/// `Ok` where the running toolchain is the one of rust-toolchain.toml and has its tools, else why not.
fn named_toolchain() -> Result<(), String> {
    let file = project::root().join("rust-toolchain.toml");
    let text = std::fs::read_to_string(&file).map_err(|error| format!("{}: {error}", file.display()))?;
    let named = text
        .lines()
        .find_map(|line| line.trim().strip_prefix("channel = \"")?.strip_suffix('"'))
        .ok_or_else(|| format!("{} names no channel", file.display()))?;
    let version = |program: &str, arguments: &[&str]| {
        let output = Command::new(program).args(arguments).current_dir(project::root()).output().ok()?;
        output.status.success().then(|| String::from_utf8_lossy(&output.stdout).into_owned())
    };
    let running = version("rustc", &["--version"]).ok_or("rustc does not run")?;
    if running.split_whitespace().nth(1) != Some(named) {
        return Err(format!("rust-toolchain.toml names {named}, running is {}", running.trim()));
    }
    for tool in ["fmt", "clippy"] {
        if version("cargo", &[tool, "--version"]).is_none() {
            return Err(format!("cargo {tool} is not installed: rustup component add rustfmt clippy"));
        }
    }
    Ok(())
}

fn cargo(arguments: &[&str]) -> Command {
    let mut command = Command::new("cargo");
    command.current_dir(project::root()).args(arguments);
    command
}

/// The importer tests bind the FMI headers, so they need libclang and the C compiler's own headers.
fn importers() -> Result<Command> {
    let python = python::environment_for(Tier::Importers)?;
    let library = output(&python, &["-c", "import clang, os; print(os.path.join(clang.__path__[0], 'native'))"])?;
    let headers = output(Path::new("cc"), &["-print-file-name=include"])?;
    let folder = project::target().join("importers");
    let fmu = package::build(Some(BRAKE), &package::Options::default())?;
    let recording = run::record(&python, &fmu, &folder)?;
    let mut command = cargo(&["test", "--locked", "--no-fail-fast", "--manifest-path", "tests/importers/Cargo.toml"]);
    command
        .env("CARGO_TARGET_DIR", folder)
        .env("LIBCLANG_PATH", library)
        .env("BINDGEN_EXTRA_CLANG_ARGS", format!("-I{headers}"))
        .env("SLIDING_CONTACT_FMU", fmu)
        .env("SLIDING_CONTACT_RECORDING", recording);
    Ok(command)
}

/// Tests of importers for Python; each gets an environment of its own.
fn wheels() -> Result<Command> {
    let mut command = pytest(python::environment_for(Tier::Test)?, &["tests/importers/wheels"]);
    command
        .env("SLIDING_CONTACT_FMU", package::build(Some(BRAKE), &package::Options::default())?)
        .env("SLIDING_CONTACT_IMPORTERS", project::target().join("importers").join("wheels"));
    Ok(command)
}

fn output(program: &Path, arguments: &[&str]) -> Result<String> {
    let name = program.display().to_string();
    let fault = format!("{name} {}: ", arguments.join(" "));
    Ok(project::printed(Command::new(program).args(arguments), &name, &fault)?.trim().to_owned())
}
