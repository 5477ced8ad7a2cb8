//! The Python environment of this project: `target/python`, with every package at a pinned version.
//!
//! It is made by the ordinary pip client, which keeps to the user's own pip settings (index, certificates, cache).
//! Where the interpreter comes without `ensurepip` - a Debian system without python3-venv - pip is brought in by what
//! there is: the interpreter's own pip, a pip wheel of the distribution, `virtualenv` or `uv`.

use crate::output::Heartbeat;
use crate::project;
use anyhow::{Context, Result, bail};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::fs::{self, File};
use std::io::{BufRead, BufReader};
use std::panic::resume_unwind;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::thread;

/// Oldest Python that the pinned packages serve.
const OLDEST: (u32, u32) = (3, 10);
/// pip that is put into an environment made without one.
const PIP: &str = "pip==25.3";

/// Purpose of the environment; each tier includes the ones before it.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) enum Tier {
    /// Building the FMU.
    Build,
    /// Driving it.
    Run,
    /// The fmpy tests.
    Test,
    /// Binding the FMI headers.
    Importers,
}

/// Packages under the name of their stamp.
type Requirements = (&'static str, &'static str);

/// Pinned packages of every tier: tier, name of its stamp, requirements.
const REQUIREMENTS: [(Tier, &str, &str); 4] = [
    (Tier::Build, "build", include_str!("../python/build.txt")),
    (Tier::Run, "run", include_str!("../python/run.txt")),
    (Tier::Test, "test", include_str!("../python/test.txt")),
    (Tier::Importers, "importers", include_str!("../python/importers.txt")),
];
/// An environment of its own: folder under `target`, and its packages.
type Own = (&'static str, &'static [Requirements]);

const BATCH_PACKAGES: Requirements = ("batch", include_str!("../../examples/batch/requirements.txt"));
/// Of the batch examples: a cluster's workers need the same and no more.
pub(crate) const BATCH: Own = ("python-batch", &[BATCH_PACKAGES]);
/// Of the tests of the Python package.
pub(crate) const PACKAGE: Own =
    ("python-package-environment", &[BATCH_PACKAGES, ("package", include_str!("../python/package.txt"))]);
/// Writes the bill of materials of a release.
pub(crate) const RELEASE: Own = ("python-release", &[("release", include_str!("../python/release.txt"))]);
/// Makes the site of the documentation.
pub(crate) const SITE: Own = ("python-site", &[("site", include_str!("../python/site.txt"))]);
/// Of the peers that the charts compare with.
pub const PEERS: Own = ("python-peers", &[("peers", include_str!("../../benches/peers/requirements.txt"))]);

/// Runs a script as Python does, except that Ctrl-C, also while it imports, and a call of the FMU that fails end it without a traceback.
const QUIETLY: &str = "\
import runpy, sys
del sys.argv[0]
sys.path[0] = sys.argv[0].rpartition('/')[0]
try:
    runpy.run_path(sys.argv[0], run_name='__main__')
except KeyboardInterrupt:
    sys.exit(130)
except Exception as error:
    # The FMU has told why before.
    if type(error).__name__ != 'FMICallException':
        raise
    sys.exit(f'error: {error}')
";

/// A script of the examples, with byte code and the caches of fonts in the target folder, not in the sources or the user's home.
pub(crate) fn script(python: &Path, environment: &str, script: &str) -> Command {
    let mut command = Command::new(python);
    command
        .args(["-c", QUIETLY])
        .arg(project::root().join("examples").join(script))
        .env("MPLCONFIGDIR", project::target().join(environment).join("matplotlib"))
        .env("PYTHONDONTWRITEBYTECODE", "1");
    command
}

/// Makes the environment for [`Tier::Run`] unless it is there and returns its Python.
///
/// # Errors
/// Where no Python of 3.10 or newer, no pip or not every package could be had; the message says what to type.
pub fn environment() -> Result<PathBuf> {
    environment_for(Tier::Run)
}

/// As [`environment`], with the rest of its packages installed while `work` is done, which needs those of [`Tier::Build`]
/// only: compiling seldom keeps every core busy.
pub(crate) fn environment_beside<T>(work: impl FnOnce() -> Result<T>) -> Result<(PathBuf, T)> {
    environment_for(Tier::Build)?;
    thread::scope(|scope| {
        // cargo shows its own progress.
        let rest = scope.spawn(|| ensure_with("python", &requirements(Tier::Run), ProgressDrawTarget::hidden));
        let done = work();
        let python = rest.join().unwrap_or_else(|panic| resume_unwind(panic))?;
        Ok((python, done?))
    })
}

/// Makes the environment for `tier` unless it is there and returns its Python.
pub(crate) fn environment_for(tier: Tier) -> Result<PathBuf> {
    ensure("python", &requirements(tier))
}

/// Makes an environment unless it is there and returns its Python.
pub fn own((folder, packages): Own) -> Result<PathBuf> {
    ensure(folder, packages)
}

/// Requirements of a tier, including those of the tiers before it.
fn requirements(tier: Tier) -> Vec<Requirements> {
    REQUIREMENTS.iter().filter(|(own, ..)| *own <= tier).map(|&(_, name, text)| (name, text)).collect()
}

fn ensure(name: &str, wanted: &[Requirements]) -> Result<PathBuf> {
    ensure_with(name, wanted, ProgressDrawTarget::stderr)
}

/// As [`ensure`], with its progress shown there.
fn ensure_with(name: &str, wanted: &[Requirements], progress: fn() -> ProgressDrawTarget) -> Result<PathBuf> {
    let folder = project::target().join(name);
    let python = executable(&folder);
    if is_current(&folder, wanted) {
        return Ok(python);
    }
    fs::create_dir_all(project::target())?;
    let path = project::target().join(format!("{name}.lock"));
    let lock = File::create(&path).with_context(|| format!("creating {}", path.display()))?;
    if lock.try_lock().is_err() {
        eprintln!("Waiting for another process that is making {}", folder.display());
        lock.lock().with_context(|| format!("locking {}", path.display()))?;
    }
    // The lock is released when the file is closed, also where the process is killed.
    if !is_current(&folder, wanted) {
        make(&folder, wanted, progress)?;
    }
    Ok(python)
}

fn executable(folder: &Path) -> PathBuf {
    if cfg!(windows) { folder.join("Scripts/python.exe") } else { folder.join("bin/python") }
}

fn stamp(folder: &Path, name: &str) -> PathBuf {
    folder.join(format!("{name}.installed.txt"))
}

/// Packages are there when their stamp holds the very text of the requirements and the interpreter still exists (its
/// link dangles once the system's Python was replaced).
fn is_current(folder: &Path, wanted: &[Requirements]) -> bool {
    executable(folder).exists()
        && wanted.iter().all(|(name, text)| fs::read_to_string(stamp(folder, name)).is_ok_and(|found| found == *text))
}

fn make(folder: &Path, wanted: &[Requirements], progress: fn() -> ProgressDrawTarget) -> Result<()> {
    let python = executable(folder);
    // A tier is added to an environment that holds the ones below; anything else starts afresh.
    if !is_current(folder, &wanted[..1]) {
        if folder.exists() {
            fs::remove_dir_all(folder).with_context(|| format!("removing the outdated {}", folder.display()))?;
        }
        let base = Interpreter::find()?;
        eprintln!("Making the Python {} environment {}", base.version(), folder.display());
        let helpers = Helpers { wheels: distribution_wheels(), virtualenv: "virtualenv".into(), uv: "uv".into() };
        if let Err(error) = create(&base, folder, &helpers) {
            // An incomplete environment must not be taken for a complete one later.
            let _ = fs::remove_dir_all(folder);
            return Err(error);
        }
    }
    for &(name, text) in wanted {
        if fs::read_to_string(stamp(folder, name)).is_ok_and(|found| found == text) {
            continue;
        }
        install(&python, folder, name, text, progress())?;
        fs::write(stamp(folder, name), text)?;
    }
    Ok(())
}

/// Installs exactly what the file names - no dependency is resolved - and has pip check that nothing is missing.
fn install(python: &Path, folder: &Path, name: &str, text: &str, progress: ProgressDrawTarget) -> Result<()> {
    let file = folder.join(format!("{name}.requirements.txt"));
    fs::write(&file, text)?;
    let pins = text.lines().filter(|line| !line.is_empty() && !line.starts_with('#')).count();
    let bar = ProgressBar::with_draw_target(Some(pins as u64), progress);
    bar.set_style(ProgressStyle::with_template("  Python packages [{bar:30}] {pos}/{len} {msg}")?);
    let mut child = Command::new(python)
        .args(["-m", "pip", "install", "--no-input", "--no-deps", "--progress-bar", "off", "--requirement"])
        .arg(&file)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::inherit())
        .spawn()
        .with_context(|| format!("starting {}", python.display()))?;
    let beat = Heartbeat::start(&format!("Installing {pins} Python packages into {}", folder.display()));
    let mut log = Vec::new();
    for line in BufReader::new(child.stdout.take().expect("stdout is piped")).lines() {
        let line = line?;
        if let Some(rest) = line.strip_prefix("Collecting ") {
            bar.inc(1);
            bar.set_message(rest.split([' ', '=']).next().unwrap_or_default().to_owned());
        } else if line.starts_with("Ignoring ") {
            // A pin for another Python.
            bar.inc(1);
        } else if line.starts_with("Installing ") {
            bar.set_message("installing");
        }
        log.push(line);
    }
    let status = child.wait()?;
    drop(beat);
    bar.finish_and_clear();
    if !status.success() {
        let tail = log[log.len().saturating_sub(8)..].join("\n");
        bail!("pip could not install the packages of {} ({status}); its last lines:\n{tail}", file.display());
    }
    let check = run(python, &["-m", "pip", "check"])?;
    if !check.status.success() {
        bail!("the pinned packages do not fit together:\n{}", String::from_utf8_lossy(&check.stdout));
    }
    Ok(())
}

struct Interpreter {
    path: PathBuf,
    version: (u32, u32, u32),
}

impl Interpreter {
    /// The first interpreter new enough: `PYTHON`, then `python3` and its numbered names on the path.
    fn find() -> Result<Self> {
        let mut found = Vec::new();
        let chosen = std::env::var_os("PYTHON").map(PathBuf::from);
        let names: Vec<PathBuf> = match &chosen {
            Some(path) => vec![path.clone()],
            None => ["python3", "python3.14", "python3.13", "python3.12", "python3.11", "python3.10", "python"]
                .map(PathBuf::from)
                .to_vec(),
        };
        for name in names {
            let program = "import sys; print(*sys.version_info[:3], sys.executable)";
            let Ok(output) = run(&name, &["-c", program]) else { continue };
            let text = String::from_utf8_lossy(&output.stdout).into_owned();
            let mut words = text.trim().splitn(4, ' ');
            let mut number = || words.next().and_then(|word| word.parse::<u32>().ok());
            let (Some(major), Some(minor), Some(patch)) = (number(), number(), number()) else { continue };
            let path = words.next().filter(|path| !path.is_empty()).map_or(name, PathBuf::from);
            if (major, minor) >= OLDEST {
                return Ok(Self { path, version: (major, minor, patch) });
            }
            found.push(format!("{} is {major}.{minor}.{patch}", path.display()));
        }
        let (major, minor) = OLDEST;
        let seen = match (found.is_empty(), chosen) {
            (true, Some(path)) => format!("PYTHON = {} is none", path.display()),
            (true, None) => "none was found".to_owned(),
            (false, _) => found.join(", "),
        };
        bail!(
            "Python {major}.{minor} or newer is needed and {seen}; install one, or name it in the environment variable PYTHON."
        )
    }

    fn version(&self) -> String {
        let (major, minor, patch) = self.version;
        format!("{major}.{minor}.{patch}")
    }

    fn has(&self, module: &str) -> bool {
        run(&self.path, &["-c", &format!("import {module}")]).is_ok_and(|output| output.status.success())
    }
}

/// Sources of pip for an environment whose interpreter comes without it.
struct Helpers {
    /// pip wheels that the distribution has left.
    wheels: Vec<PathBuf>,
    virtualenv: PathBuf,
    uv: PathBuf,
}

/// An empty environment with pip in it, by the first way that is open.
fn create(base: &Interpreter, folder: &Path, helpers: &Helpers) -> Result<()> {
    let python = executable(folder);
    let done = |program: &Path, before: &[&str], path: &Path, after: &[&str]| {
        let mut command = Command::new(program);
        command.args(before).arg(path).args(after).stdin(Stdio::null());
        command.output().is_ok_and(|output| output.status.success())
    };
    let has_pip = || run(&python, &["-m", "pip", "--version"]).is_ok_and(|output| output.status.success());
    let base_does = |before: &[&str], path: &Path, after: &[&str]| done(&base.path, before, path, after);

    if base.has("venv") {
        if base.has("ensurepip") && base_does(&["-m", "venv", "--clear"], folder, &[]) && has_pip() {
            return Ok(());
        }
        if base_does(&["-m", "venv", "--clear", "--without-pip"], folder, &[]) {
            let packages = site_packages(&python)?;
            // `--target` serves pip of any age and is open on systems that manage their own packages.
            if base_does(&["-m", "pip", "install", "--no-input", "--target"], &packages, &[PIP]) && has_pip() {
                return Ok(());
            }
            // A wheel is a zip file that Python runs from.
            let from_wheel = |wheel: &PathBuf| done(&python, &[], &wheel.join("pip"), &["install", "--no-input", PIP]);
            if helpers.wheels.iter().any(from_wheel) && has_pip() {
                return Ok(());
            }
        }
    }
    let interpreter = base.path.to_string_lossy();
    let ways: [(&Path, &[&str]); 3] = [
        (&base.path, &["-m", "virtualenv"]),
        (&helpers.virtualenv, &["--python", &interpreter]),
        (&helpers.uv, &["venv", "--seed", "--python", &interpreter]),
    ];
    for (program, arguments) in ways {
        // Not every age of these tools overwrites what another has begun.
        if folder.exists() {
            fs::remove_dir_all(folder).with_context(|| format!("removing {}", folder.display()))?;
        }
        if done(program, arguments, folder, &[]) && has_pip() {
            return Ok(());
        }
    }
    bail!(
        "Python {} at {} can make no environment with pip in it; type `{}` and run this command again.",
        base.version(),
        base.path.display(),
        remedy(base)
    )
}

/// Where an environment keeps its packages.
fn site_packages(python: &Path) -> Result<PathBuf> {
    let output = run(python, &["-c", "import sysconfig; print(sysconfig.get_path('purelib'))"])?;
    Ok(PathBuf::from(String::from_utf8(output.stdout)?.trim()))
}

/// pip wheels that Debian's and Fedora's packages leave for virtual environments.
fn distribution_wheels() -> Vec<PathBuf> {
    ["/usr/share/python-wheels", "/usr/share/python3-wheels"]
        .iter()
        .filter_map(|folder| fs::read_dir(folder).ok())
        .flat_map(|entries| entries.flatten().map(|entry| entry.path()))
        .filter(|path| {
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            name.starts_with("pip-") && name.ends_with(".whl")
        })
        .collect()
}

/// The command that adds what is missing.
fn remedy(base: &Interpreter) -> String {
    let exists = |program: &str| run(Path::new(program), &["--version"]).is_ok();
    let system = base.path.starts_with("/usr/bin");
    if system && exists("apt-get") {
        "sudo apt install python3-venv".to_owned()
    } else if system && exists("dnf") {
        "sudo dnf install python3-pip".to_owned()
    } else if system && exists("pacman") {
        "sudo pacman -S python-pip".to_owned()
    } else if system && exists("apk") {
        "sudo apk add py3-pip".to_owned()
    } else if base.has("pip") {
        format!("{} -m pip install virtualenv", base.path.display())
    } else if base.has("ensurepip") {
        format!("{} -m ensurepip", base.path.display())
    } else {
        "export PYTHON=PATH_OF_ANOTHER_PYTHON".to_owned()
    }
}

/// Runs a program to its end without input; what it prints is returned.
fn run(program: &Path, arguments: &[&str]) -> Result<Output> {
    Command::new(program)
        .args(arguments)
        .stdin(Stdio::null())
        .output()
        .with_context(|| format!("starting {}", program.display()))
}

#[cfg(all(test, unix))]
mod limited;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(unix)]
    fn ctrl_c_and_a_failed_call_end_a_script_without_a_traceback() {
        let folder = std::env::temp_dir().join(format!("quietly-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        // A shell that runs the tests in the background has them ignore Ctrl-C.
        let beside = "import signal, time\nsignal.signal(signal.SIGINT, signal.default_int_handler)\nprint('started', flush=True)\n";
        fs::write(folder.join("beside.py"), format!("{beside}time.sleep(60)\n")).unwrap();
        let file = folder.join("script.py");
        fs::write(&file, "import beside\n").unwrap();
        let mut command = script(Path::new("python3"), "python", file.to_str().unwrap());
        let mut run = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        BufReader::new(run.stdout.as_mut().unwrap()).read_line(&mut String::new()).unwrap();
        assert!(Command::new("kill").args(["-INT", &run.id().to_string()]).status().unwrap().success());
        let ended = run.wait_with_output().unwrap();
        assert!(project::interrupted(ended.status) && ended.stderr.is_empty(), "{ended:?}");
        fs::write(&file, "class FMICallException(Exception): pass\nraise FMICallException('a step failed')\n").unwrap();
        let failed = script(Path::new("python3"), "python", file.to_str().unwrap()).output().unwrap();
        fs::remove_dir_all(&folder).unwrap();
        assert_eq!((failed.status.code(), failed.stderr.as_slice()), (Some(1), &b"error: a step failed\n"[..]));
    }

    #[test]
    fn every_requirement_is_pinned_and_listed_once_per_python() {
        let tiers = requirements(Tier::Importers);
        for (folder, packages) in [("python", &tiers[..]), PACKAGE, RELEASE, SITE, PEERS] {
            let mut seen = std::collections::BTreeSet::new();
            for line in packages.iter().flat_map(|(_, text)| text.lines()) {
                if line.is_empty() || line.starts_with('#') {
                    continue;
                }
                let (package, rest) =
                    line.split_once("==").unwrap_or_else(|| panic!("{folder}: {line} has no version"));
                let (version, marker) = rest.split_once("; ").unwrap_or((rest, ""));
                assert!(version.chars().all(|c| c.is_ascii_alphanumeric() || c == '.'), "{folder}: {line}");
                assert!(seen.insert((package.to_lowercase(), marker)), "{folder}: {package} stands twice");
            }
        }
    }

    #[test]
    fn a_stamp_of_other_requirements_is_not_current() {
        let folder = std::env::temp_dir().join(format!("sliding-contact-python-{}", std::process::id()));
        fs::create_dir_all(executable(&folder).parent().unwrap()).unwrap();
        fs::write(executable(&folder), "").unwrap();
        for (_, name, text) in REQUIREMENTS {
            fs::write(stamp(&folder, name), text).unwrap();
        }
        assert!(is_current(&folder, &requirements(Tier::Importers)));
        fs::write(stamp(&folder, "test"), "pytest==1.0\n").unwrap();
        assert!(is_current(&folder, &requirements(Tier::Run)));
        assert!(!is_current(&folder, &requirements(Tier::Test)));
        assert!(!is_current(&folder, BATCH.1));
        fs::remove_file(executable(&folder)).unwrap();
        assert!(!is_current(&folder, &requirements(Tier::Run)));
        fs::remove_dir_all(&folder).unwrap();
    }
}
