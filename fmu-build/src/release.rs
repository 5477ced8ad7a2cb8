//! `cargo fmu release`: everything that users take away, in one folder.

mod bill;
mod notes;

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use clap::{Args, ValueEnum};
use sha2::{Digest, Sha256};

use crate::output::{self, print_line};
use crate::package::{self, Platform};
use crate::{project, scenes};

const VERSION: &str = env!("CARGO_PKG_VERSION");

/// File of the checksums, as `sha256sum -c` reads them.
const CHECKSUMS: &str = "SHA256SUMS";

/// Writes the FMUs of all shipped scenes, the wheel, bills of materials, release notes and checksums to one folder.
#[derive(Args, Debug)]
pub struct Arguments {
    /// Folder to write to, new or empty [default: target/dist/sliding-contact-VERSION, which is replaced]
    #[arg(short, long, value_name = "FOLDER")]
    output: Option<PathBuf>,
    /// Platforms whose library every FMU holds, with commas [default: all that can be built on this machine]
    #[arg(long, value_delimiter = ',')]
    platform: Vec<Platform>,
}

/// Runs the command.
pub fn execute(arguments: &Arguments) -> Result<()> {
    output::check_folder(arguments.output.as_deref())?;
    let own = || project::target().join("dist").join(format!("sliding-contact-{VERSION}"));
    let folder = arguments.output.clone().unwrap_or_else(own);
    if arguments.output.is_some() {
        check_empty(&folder)?;
    }
    let platforms = if arguments.platform.is_empty() { buildable() } else { arguments.platform.clone() };
    package::check_platforms(&platforms)?;
    for name in build(&folder, &platforms)? {
        print_line!("{}", folder.join(name).display());
    }
    Ok(())
}

fn check_empty(folder: &Path) -> Result<()> {
    let reading = || format!("reading {}", folder.display());
    if folder.is_dir() && fs::read_dir(folder).with_context(reading)?.next().is_some() {
        bail!("{} is not empty; name a new folder, so that it holds the release and nothing else", folder.display());
    }
    Ok(())
}

/// Platforms that can be built here; the reasons of the others go to the error stream.
fn buildable() -> Vec<Platform> {
    let mut found = Vec::new();
    for &platform in Platform::value_variants() {
        match package::missing(platform) {
            None => found.push(platform),
            Some(reason) => eprintln!("Not in this release: {reason}"),
        }
    }
    found
}

/// Makes a release, which takes the place of the folder where it is complete, and returns the names of its files.
pub(crate) fn build(folder: &Path, platforms: &[Platform]) -> Result<Vec<String>> {
    let folder = &std::path::absolute(folder)?;
    let mut name = folder.file_name().with_context(|| format!("{} names no folder", folder.display()))?.to_owned();
    name.push(format!(".{}.partial", std::process::id()));
    let partial = folder.with_file_name(name);
    let clear = |folder: &Path| if folder.exists() { fs::remove_dir_all(folder) } else { Ok(()) };
    let names = match fill(&partial, platforms) {
        Ok(names) => names,
        Err(error) => {
            let _ = clear(&partial);
            return Err(error);
        }
    };
    clear(folder)
        .and_then(|()| fs::rename(&partial, folder))
        .with_context(|| format!("replacing {} by {}", folder.display(), partial.display()))?;
    Ok(names)
}

/// Writes the files of a release into a new folder and returns their names.
fn fill(folder: &Path, platforms: &[Platform]) -> Result<Vec<String>> {
    let context = || format!("writing {}", folder.display());
    fs::create_dir_all(folder).with_context(context)?;
    // What may fail without a compiler comes first.
    let changelog = project::root().join("CHANGELOG.md");
    let text = fs::read_to_string(&changelog).with_context(|| format!("reading {}", changelog.display()))?;
    fs::write(folder.join("RELEASE_NOTES.md"), notes::cut(&text, VERSION)?).with_context(context)?;
    for (name, package, platforms) in [
        ("sbom.cdx.json", "sliding-contact", platforms),
        ("sbom.python.cdx.json", "sliding-contact-python", &[package::wheel::of_this_machine()?]),
    ] {
        fs::write(folder.join(name), bill::write(package, platforms)?).with_context(context)?;
    }
    let all = scenes::names();
    for scene in std::iter::once(None).chain(all.iter().map(|name| Some(name.as_str()))) {
        let name = scene.map_or_else(|| "SlidingContact.fmu".into(), |name| format!("SlidingContact.{name}.fmu"));
        eprintln!("{name}");
        let options = package::Options { output: Some(folder.join(name)), platforms: platforms.to_vec() };
        package::build(scene, &options)?;
    }
    package::wheel::build(folder, None)?;
    let mut names = files(folder)?;
    fs::write(folder.join(CHECKSUMS), checksums(folder, &names)?).with_context(context)?;
    names.push(CHECKSUMS.into());
    Ok(names)
}

/// Names of the files in a folder, in alphabetical order.
fn files(folder: &Path) -> Result<Vec<String>> {
    let mut names = Vec::new();
    for entry in fs::read_dir(folder).with_context(|| format!("reading {}", folder.display()))? {
        names.push(entry?.file_name().to_string_lossy().into_owned());
    }
    names.sort();
    Ok(names)
}

/// Lines of SHA-256 in hexadecimal digits, two spaces and the name.
fn checksums(folder: &Path, names: &[String]) -> Result<String> {
    let mut text = String::new();
    for name in names {
        let path = folder.join(name);
        let bytes = fs::read(&path).with_context(|| format!("reading {}", path.display()))?;
        for byte in Sha256::digest(bytes) {
            write!(text, "{byte:02x}")?;
        }
        writeln!(text, "  {name}")?;
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn checksums_are_those_of_the_standard() {
        let folder = std::env::temp_dir().join(format!("release-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        fs::write(folder.join("abc"), "abc").unwrap();
        // FIPS 180-4, example of one block.
        let expected = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad  abc\n";
        assert_eq!(checksums(&folder, &files(&folder).unwrap()).unwrap(), expected);
        let refused = check_empty(&folder).unwrap_err().to_string();
        assert!(refused.contains(&folder.display().to_string()) && refused.contains("not empty"), "{refused}");
        fs::remove_dir_all(&folder).unwrap();
    }
}
