//! `cargo fmu wheel`: the Python package with its native library, the scenes and their FMUs.
//!
//! Written by hand rather than by a build tool of Python's: the library is behind a C interface, so a wheel is the files below, a list
//! of them with their hashes, and a tag. The same files beside each other are what scripts and tests of this project run from.

use super::library::{self, PYTHON};
use super::{Platform, glibc, licences};
use crate::output::{self, print_line};
use crate::{project, scenes};
use anyhow::{Context, Result};
use fmu_file::archive::{self, Files};
use sha2::{Digest, Sha256};
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

const PACKAGE: &str = "sliding_contact";
/// The command that an installation puts on the path.
const ENTRY_POINTS: &str = "[console_scripts]\nsliding-contact = sliding_contact._commands:main\n";
const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Make a wheel of the Python package: native library, scenes and their FMUs, for any Python from 3.9 on.
#[derive(clap::Args, Debug)]
pub struct Arguments {
    /// Folder to write to [default: target/dist]
    #[arg(short, long, value_name = "FOLDER")]
    output: Option<PathBuf>,
    /// Platform [default: that of this machine]
    #[arg(long)]
    platform: Option<Platform>,
}

/// Runs the command.
pub fn execute(arguments: &Arguments) -> Result<()> {
    output::check_folder(arguments.output.as_deref())?;
    let folder = arguments.output.clone().unwrap_or_else(|| project::target().join("dist"));
    print_line!("{}", build(&folder, arguments.platform)?.display());
    Ok(())
}

/// Makes the wheel for a platform, by default that of this machine, in a folder, and returns its path.
pub(crate) fn build(folder: &Path, platform: Option<Platform>) -> Result<PathBuf> {
    let platform = match platform {
        Some(platform) => platform,
        None => of_this_machine()?,
    };
    super::check_platforms(&[platform])?;
    let library = library::build(platform, &PYTHON)?;
    let tags = tags(platform, &library)?;
    let mut files = sources()?;
    files.insert(format!("{PACKAGE}/{}", platform.built_name("sliding_contact_native")), library);
    for name in scenes::names() {
        files.insert(format!("{PACKAGE}/fmus/{name}.fmu"), fmu(&name, platform)?);
    }
    let information = format!("{PACKAGE}-{VERSION}.dist-info");
    licences::add(&mut files, "sliding-contact-python", &format!("{information}/licenses"))?;
    files.insert(format!("{information}/METADATA"), metadata()?.into_bytes());
    files.insert(format!("{information}/entry_points.txt"), ENTRY_POINTS.into());
    files.insert(format!("{information}/WHEEL"), wheel(&tags).into_bytes());
    files.insert(format!("{information}/RECORD"), record(&files, &information).into_bytes());
    let path = folder.join(format!("{PACKAGE}-{VERSION}-py3-none-{}.whl", tags.join(".")));
    super::write(&path, &archive::pack(&files)?)?;
    Ok(path)
}

/// The package as a folder for `PYTHONPATH`, with the library for this machine as the other programs here are built and the FMUs of
/// these scenes.
pub(crate) fn unpacked(fmus: &[&str]) -> Result<PathBuf> {
    let folder = project::target().join("python-package");
    let mut files = sources()?;
    let library = for_scripts()?;
    let name = library.file_name().unwrap_or_default().to_string_lossy().into_owned();
    files.insert(
        format!("{PACKAGE}/{name}"),
        fs::read(&library).with_context(|| format!("reading {}", library.display()))?,
    );
    for &name in fmus {
        files.insert(format!("{PACKAGE}/fmus/{name}.fmu"), fmu(name, of_this_machine()?)?);
    }
    for (name, bytes) in &files {
        let path = folder.join(name);
        // A library that a process has loaded is not written over but replaced, and only where it differs.
        if fs::read(&path).ok().as_ref() != Some(bytes) {
            super::write(&path, bytes)?;
        }
    }
    Ok(folder)
}

/// Builds the native library as the programs of this project are built and returns its path.
fn for_scripts() -> Result<PathBuf> {
    let mut command = project::cargo();
    command
        // Beside the program that is built anyway: alone, two libraries beneath would have fewer features, and every layer above
        // them would be compiled again.
        .args(["build", "--package", "sliding-contact-python", "--package", "fmu-lab"])
        .args(["--release", "--locked", "--target-dir"])
        .arg(project::target())
        .current_dir(project::root());
    project::compile(&mut command, "the library of the Python package")?;
    let name = format!("{}sliding_contact_native{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    Ok(project::target().join("release").join(name))
}

pub(crate) fn of_this_machine() -> Result<Platform> {
    let (system, processor) = (std::env::consts::OS, std::env::consts::ARCH);
    let platform = Platform::host().filter(|platform| *platform != Platform::Darwin64 || processor == "x86_64");
    platform.with_context(|| format!("there is no wheel for {system} on {processor}"))
}

/// Python files and scenes.
fn sources() -> Result<Files> {
    let mut files = Files::new();
    let folder = project::root().join("python").join(PACKAGE);
    let reading = || format!("reading {}", folder.display());
    for entry in fs::read_dir(&folder).with_context(reading)? {
        let path = entry.with_context(reading)?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if name.ends_with(".py") || name == "py.typed" {
            files.insert(format!("{PACKAGE}/{name}"), fs::read(&path).with_context(reading)?);
        }
    }
    for name in scenes::names() {
        let path = scenes::locate(&name)?;
        let text = fs::read(&path).with_context(|| format!("reading {}", path.display()))?;
        files.insert(format!("{PACKAGE}/scenes/{name}/scene.toml"), text);
    }
    Ok(files)
}

fn fmu(scene: &str, platform: Platform) -> Result<Vec<u8>> {
    archive::pack(&super::files(&scenes::load(Some(scene))?, &[platform])?)
}

/// Platform tags: on Linux by the glibc that the library requires.
fn tags(platform: Platform, library: &[u8]) -> Result<Vec<String>> {
    let processor = match platform {
        Platform::Win64 => return Ok(vec!["win_amd64".into()]),
        Platform::Darwin64 => return Ok(vec!["macosx_10_12_x86_64".into()]),
        Platform::Linux64 => "x86_64",
        Platform::Aarch64Linux => "aarch64",
    };
    let (major, minor) = glibc::highest(library)?.unwrap_or(glibc::WANTED).max(glibc::WANTED);
    let mut tags = vec![format!("manylinux_{major}_{minor}_{processor}")];
    if (major, minor) == glibc::WANTED {
        // The name that installers before 2020 know.
        tags.push(format!("manylinux2014_{processor}"));
    }
    Ok(tags)
}

fn metadata() -> Result<String> {
    let read = |name: &str| {
        let path = project::root().join(name);
        fs::read_to_string(&path).with_context(|| format!("reading {}", path.display()))
    };
    Ok(format!("{}\n{}", read("python/METADATA")?.replace("VERSION", VERSION), read("docs/python.md")?))
}

fn wheel(tags: &[String]) -> String {
    let mut text = format!("Wheel-Version: 1.0\nGenerator: fmu-build {VERSION}\nRoot-Is-Purelib: false\n");
    for tag in tags {
        let _ = writeln!(text, "Tag: py3-none-{tag}");
    }
    text
}

/// Every file with its hash and size.
fn record(files: &Files, information: &str) -> String {
    let mut text = String::new();
    for (path, bytes) in files {
        let _ = writeln!(text, "{path},sha256={},{}", base64(&Sha256::digest(bytes)), bytes.len());
    }
    text + &format!("{information}/RECORD,,\n")
}

/// Base 64 with the alphabet for addresses and without padding.
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
    let mut text = String::new();
    for group in bytes.chunks(3) {
        let number = group.iter().fold(0_u32, |number, byte| number << 8 | u32::from(*byte)) << (8 * (3 - group.len()));
        for digit in 0..=group.len() {
            text.push(char::from(DIGITS[(number >> (18 - 6 * digit) & 63) as usize]));
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hashes_are_those_of_the_format() {
        // RFC 4648, section 10, and the example of FIPS 180-4.
        for (text, coded) in [("", ""), ("f", "Zg"), ("fo", "Zm8"), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")] {
            assert_eq!(base64(text.as_bytes()), coded);
        }
        assert_eq!(base64(&[0xfb, 0xff]), "-_8");
        let files = Files::from([("a/b.py".to_owned(), b"abc".to_vec())]);
        let expected = "a/b.py,sha256=ungWv48Bz-pBQUDeXa4iI7ADYaOWF3qctBD_YfIAFa0,3\ni/RECORD,,\n";
        assert_eq!(record(&files, "i"), expected);
    }

    #[test]
    fn the_package_is_complete_and_of_this_version() {
        let files = sources().unwrap();
        for name in ["__init__.py", "host.py", "py.typed", "_figure.py", "scenes/disc_brake/scene.toml"] {
            assert!(files.contains_key(&format!("{PACKAGE}/{name}")), "{name}: {:?}", files.keys());
        }
        let init = String::from_utf8(files[&format!("{PACKAGE}/__init__.py")].clone()).unwrap();
        assert!(init.contains(&format!("__version__ = \"{VERSION}\"")), "{init}");
        let metadata = metadata().unwrap();
        assert!(metadata.contains(&format!("Name: {PACKAGE}\nVersion: {VERSION}\n")), "{metadata}");
        assert!(metadata.contains("\n\n# "), "{metadata}");
    }
}
