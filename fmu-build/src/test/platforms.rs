//! Platform tier: the FMU of every platform that can be built here, run on it or on an emulator.
//!
//! A small C host (tests/platforms/host.c), compiled for the platform as well, drives the packaged library through
//! the UDDS; every output must follow the trajectory that the same host gets from the Linux library.

use super::tally::Tally;
use crate::bench;
use crate::package::{self, Platform};
use crate::project;
use anyhow::{Context, Result, bail, ensure};
use fmu_file::archive;
use scene::variables::{Kind, TABLE, find};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Largest deviation from the Linux trajectory, relative to each output's range: another mathematics library rounds
/// exponentials and powers differently in the last digit, nothing else may differ.
const TOLERANCE: f64 = 1e-9;
/// Fraction of the largest range among the outputs of a unit below which a range is rounding error: the heat through an insulated
/// base, a difference of large numbers, is not 0 but has no significant digits.
const LEAST_RANGE: f64 = 1e-13;
const SCENE: &str = "disc_brake";

struct Foreign {
    platform: Platform,
    compiler: &'static str,
    /// Program that runs programs of the platform, and the Debian packages that have it.
    emulator: (&'static [&'static str], &'static str),
}

const FOREIGN: [Foreign; 2] = [
    Foreign { platform: Platform::Win64, compiler: "x86_64-w64-mingw32-gcc", emulator: (&["wine"], "wine wine64") },
    Foreign {
        platform: Platform::Aarch64Linux,
        compiler: "aarch64-linux-gnu-gcc",
        emulator: (&["qemu-aarch64", "-L", "/usr/aarch64-linux-gnu"], "qemu-user"),
    },
];

pub(crate) fn check(tally: &mut Tally) {
    if !cfg!(all(target_os = "linux", target_arch = "x86_64")) {
        tally.skip("platforms", "the trajectory that they are compared with is that of Linux on x86-64");
        return;
    }
    let folder = project::target().join("platforms").join("test");
    let mut drive = None;
    tally.step("platform linux64", |step| {
        let built = Drive::new(&folder)?;
        step.judge(&format!("{} steps of {} outputs", built.rows(), built.outputs.len()), built.rows() > 10_000);
        drive = Some(built);
        Ok(())
    });
    for foreign in &FOREIGN {
        let name = format!("platform {}", foreign.platform.folder());
        let Some(drive) = &drive else {
            tally.skip(&name, "there is no Linux trajectory to compare with");
            continue;
        };
        if let Some(reason) = foreign.missing() {
            tally.skip(&name, &reason);
            continue;
        }
        tally.step(&name, |step| {
            let (deviation, output) = drive.deviation(&foreign.run(drive)?)?;
            let text = format!("largest deviation from Linux {deviation:.1e} of the range, in {output}");
            step.judge(&text, deviation <= TOLERANCE);
            Ok(())
        });
    }
}

impl Foreign {
    fn missing(&self) -> Option<String> {
        package::missing(self.platform).or_else(|| {
            let (words, packages) = self.emulator;
            let runs = Command::new(words[0]).arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
            let there = runs.is_ok_and(|status| status.success());
            (!there).then(|| format!("running its programs needs {} (Debian: apt install {packages})", words[0]))
        })
    }

    /// Packages the FMU with both libraries and returns the trajectory of this platform's.
    fn run(&self, drive: &Drive) -> Result<Vec<f64>> {
        let folder = &drive.folder;
        let host = compile(self.compiler, self.platform, folder)?;
        let library = extract(&drive.fmu(&[Platform::Linux64, self.platform])?, self.platform, folder)?;
        let (words, _) = self.emulator;
        let mut command = Command::new(words[0]);
        command.args(&words[1..]).arg(host);
        // Of Wine: its own folder, no messages, no windows.
        command.env("WINEPREFIX", folder.join("wine")).env("WINEDEBUG", "-all").env("DISPLAY", "");
        command.env("WINEDLLOVERRIDES", "mscoree,mshtml=");
        drive.trajectory(command, &library, self.platform)
    }
}

struct Output {
    name: String,
    reference: u32,
    unit: &'static str,
}

/// The drive and its trajectory on Linux.
struct Drive {
    folder: PathBuf,
    guid: String,
    outputs: Vec<Output>,
    expected: Vec<f64>,
}

impl Drive {
    fn new(folder: &Path) -> Result<Self> {
        fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
        let outputs = TABLE
            .iter()
            .filter(|row| row.is_result())
            .filter_map(|row| match row.kind {
                Kind::Real { unit, .. } => Some((row, unit.name)),
                _ => None,
            })
            .flat_map(|(row, unit)| (0..row.count()).map(move |index| (row.element_name(index), unit)))
            .map(|(name, unit)| {
                let reference = find(&name).with_context(|| name.clone())?;
                Ok(Output { name, reference, unit })
            })
            .collect::<Result<Vec<_>>>()?;
        let inputs: Vec<u8> =
            bench::Drive::udds()?.inputs.concat().iter().flat_map(|value| value.to_le_bytes()).collect();
        fs::write(folder.join("inputs"), inputs)?;
        let mut drive = Self { folder: folder.to_owned(), guid: String::new(), outputs, expected: Vec::new() };
        let fmu = drive.fmu(&[Platform::Linux64])?;
        drive.guid = crate::scenes::load(Some(SCENE))?.packaged.guid();
        let library = extract(&fmu, Platform::Linux64, folder)?;
        let host = compile("cc", Platform::Linux64, folder)?;
        drive.expected = drive.trajectory(Command::new(folder.join(host)), &library, Platform::Linux64)?;
        Ok(drive)
    }

    fn fmu(&self, platforms: &[Platform]) -> Result<PathBuf> {
        let output = Some(self.folder.join("SlidingContact.fmu"));
        package::build(Some(SCENE), &package::Options { output, platforms: platforms.to_vec() })
    }

    fn rows(&self) -> usize {
        self.expected.len() / self.outputs.len()
    }

    /// Runs the host, which is the first part of the command, in the folder: paths of Linux are not valid on Windows.
    fn trajectory(&self, mut command: Command, library: &str, platform: Platform) -> Result<Vec<f64>> {
        let written = format!("outputs.{}", platform.folder());
        let references = ["sliding_velocity", "normal_load"]
            .map(|name| find(name).with_context(|| format!("no variable {name}")))
            .into_iter()
            .chain(self.outputs.iter().map(|output| Ok(output.reference)))
            .map(|reference| reference.map(|number| number.to_string()))
            .collect::<Result<Vec<_>>>()?;
        command
            .current_dir(&self.folder)
            .args([library, &self.guid, &bench::STEP.to_string(), "inputs", &written])
            .args(references)
            .stdin(Stdio::null());
        let output = command.output().with_context(|| format!("starting {}", command.get_program().display()))?;
        if !output.status.success() {
            bail!("the host ended with {}: {}", output.status, String::from_utf8_lossy(&output.stderr).trim());
        }
        let bytes = fs::read(self.folder.join(&written)).with_context(|| written.clone())?;
        let (numbers, rest) = bytes.as_chunks();
        ensure!(rest.is_empty() && !numbers.is_empty(), "{written} holds {} bytes", bytes.len());
        Ok(numbers.iter().map(|number| f64::from_le_bytes(*number)).collect())
    }

    /// Values of an output after every step.
    fn column<'a>(&self, values: &'a [f64], at: usize) -> impl Iterator<Item = f64> + 'a {
        values.iter().skip(at).step_by(self.outputs.len()).copied()
    }

    /// Reference scale of the deviation of every output: its range on Linux; where that is rounding only, the largest range
    /// among the outputs of its unit, and 1 where nothing changes.
    fn scales(&self) -> Vec<f64> {
        let range = |at: usize| {
            let ends = (f64::INFINITY, f64::NEG_INFINITY);
            let (low, high) =
                self.column(&self.expected, at).fold(ends, |(low, high), value| (low.min(value), high.max(value)));
            high - low
        };
        let ranges: Vec<f64> = (0..self.outputs.len()).map(range).collect();
        let largest = |unit: &str| {
            let alike = self.outputs.iter().zip(&ranges).filter(|(output, _)| output.unit == unit);
            alike.fold(0.0, |most: f64, (_, range)| most.max(*range))
        };
        let scale = |(output, &range): (&Output, &f64)| {
            let largest = largest(output.unit);
            match range > LEAST_RANGE * largest {
                true => range,
                false if range > 0.0 => largest,
                false => 1.0,
            }
        };
        self.outputs.iter().zip(&ranges).map(scale).collect()
    }

    /// Largest deviation from the Linux trajectory in units of [`Drive::scales`], and its output.
    fn deviation(&self, found: &[f64]) -> Result<(f64, &str)> {
        ensure!(found.len() == self.expected.len(), "{} values instead of {}", found.len(), self.expected.len());
        let mut worst = (0.0, "none");
        for (at, (output, scale)) in self.outputs.iter().zip(self.scales()).enumerate() {
            for (own, other) in self.column(&self.expected, at).zip(self.column(found, at)) {
                let deviation = (own - other).abs() / scale;
                // No number is worse than any; nothing exceeds it afterwards.
                if deviation.is_nan() || deviation > worst.0 {
                    worst = (deviation, output.name.as_str());
                }
            }
        }
        Ok(worst)
    }
}

/// Compiles the host and returns its name in the folder; for Windows also a library that old versions of Wine do not have.
fn compile(compiler: &str, platform: Platform, folder: &Path) -> Result<String> {
    let windows = platform == Platform::Win64;
    let name = format!("host-{}{}", platform.folder(), if windows { ".exe" } else { "" });
    let build = |source: &str, libraries: &[&str], target: &str| {
        let mut command = Command::new(compiler);
        command.args(["-std=c99", "-O1", "-Wall", "-D_POSIX_C_SOURCE=200809L", "-o"]).arg(folder.join(target));
        command.arg(project::root().join("tests/platforms").join(source)).args(libraries);
        project::printed(&mut command, compiler, &format!("{compiler} does not compile {source}:\n"))
    };
    if windows {
        build("bcryptprimitives.c", &["-shared", "-ladvapi32"], "bcryptprimitives.dll")?;
    }
    build("host.c", if windows { &[] } else { &["-ldl"] }, &name)?;
    Ok(name)
}

/// Takes the platform's library out of the FMU and returns its path as the host is given it.
fn extract(fmu: &Path, platform: Platform, folder: &Path) -> Result<String> {
    let path = platform.library_path();
    let library = archive::entry(fmu, &path)?;
    let file = folder.join(&path);
    fs::create_dir_all(file.parent().context("a library in no folder")?)?;
    fs::write(&file, library)?;
    // With a separator, so that no system's search path is asked.
    Ok(if platform == Platform::Win64 { path.replace('/', "\\") } else { format!("./{path}") })
}
