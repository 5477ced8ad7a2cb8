//! Builds shared libraries to be shipped: optimised, free of the paths of this machine, for old distributions too.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, anyhow};

use super::glibc;
use super::platform::Platform;
use super::toolchain::Toolchain;
use crate::project;
use crate::python::{self, Tier};

/// Cargo's separator of compiler flags in `CARGO_ENCODED_RUSTFLAGS`; it lets paths contain spaces.
const SEPARATOR: &str = "\u{1f}";

/// A library that is shipped.
pub(crate) struct Product {
    package: &'static str,
    name: &'static str,
    /// Profile of cargo that it is built with.
    profile: &'static str,
}

/// The FMU's library, its scene slot not yet filled.
pub(crate) const FMU: Product = Product { package: "sliding-contact", name: "sliding_contact", profile: "fmu" };

pub(crate) const PYTHON: Product =
    Product { package: "sliding-contact-python", name: "sliding_contact_native", profile: "wheel" };

/// Builds a library for a platform and returns its bytes.
pub(crate) fn build(platform: Platform, product: &Product) -> Result<Vec<u8>> {
    let path = match platform {
        Platform::Linux64 => linux64(product)?,
        other => with_toolchain(other, product)?,
    };
    std::fs::read(&path).with_context(|| format!("reading the built library {}", path.display()))
}

/// Builds a library that this machine itself can load.
pub(crate) fn for_this_machine(product: &Product) -> Result<Vec<u8>> {
    if cfg!(all(target_os = "linux", target_arch = "x86_64")) {
        return build(Platform::Linux64, product);
    }
    let mut command = project::cargo();
    command.arg("rustc");
    let version = Command::new("rustc").arg("-vV").output().context("starting rustc")?;
    let version = String::from_utf8(version.stdout)?;
    let target = version.lines().find_map(|line| line.strip_prefix("host: ")).context("rustc -vV names no host")?;
    let folder = project::target().join("system-linker");
    cargo(command, target, &folder, &sysroot()?, product)?;
    let name = format!("{}{}{}", std::env::consts::DLL_PREFIX, product.name, std::env::consts::DLL_SUFFIX);
    let path = folder.join(target).join(product.profile).join(name);
    std::fs::read(&path).with_context(|| format!("reading the built library {}", path.display()))
}

/// With the toolchain in use. The linker is zig's, which links against glibc 2.17 whatever is installed here. Where it
/// cannot be had, the system's linker is used and the library needs at least the glibc of this machine: a warning
/// says so.
fn linux64(product: &Product) -> Result<PathBuf> {
    let target = Platform::Linux64.target();
    let (command, written, folder) = match zigbuild() {
        Ok(zigbuild) => {
            let (major, minor) = glibc::WANTED;
            (zigbuild, format!("{target}.{major}.{minor}"), project::target())
        }
        Err(reason) => {
            eprintln!("warning: {reason:#}");
            eprintln!("warning: linking with this system's linker; the library will not run on older distributions");
            let mut command = project::cargo();
            command.arg("rustc");
            // Apart from the other one: cargo does not notice that the linker has changed.
            (command, target.to_owned(), project::target().join("system-linker"))
        }
    };
    cargo(command, &written, &folder, &sysroot()?, product)?;
    Ok(folder.join(target).join(product.profile).join(Platform::Linux64.built_name(product.name)))
}

/// With whatever toolchain can build for the platform.
fn with_toolchain(platform: Platform, product: &Product) -> Result<PathBuf> {
    let toolchain = Toolchain::find(platform).map_err(|missing| anyhow!(missing))?;
    // Apart from the programs of this command, which another compiler may have built.
    let folder = project::target().join("platforms");
    cargo(toolchain.command(), toolchain.target, &folder, toolchain.sysroot(), product)?;
    Ok(folder.join(toolchain.target).join(product.profile).join(platform.built_name(product.name)))
}

/// cargo-zigbuild of the project's Python environment, ready to build.
fn zigbuild() -> Result<Command> {
    let python = python::environment_for(Tier::Build)
        .context("cargo-zigbuild, which links for old Linux distributions, cannot be installed")?;
    let scripts = python.parent().unwrap_or(Path::new("")).to_owned();
    let mut command = Command::new(scripts.join("cargo-zigbuild"));
    command.arg("rustc");
    // It finds zig as a module of the Python that comes first on the path.
    let mut path = OsString::from(&scripts);
    if let Some(rest) = std::env::var_os("PATH") {
        path.push(if cfg!(windows) { ";" } else { ":" });
        path.push(rest);
    }
    command.env("PATH", path).env("CARGO_ZIGBUILD_PYTHON_PATH", python);
    Ok(command)
}

/// Runs the build; cargo itself shows the progress. Only the C library is built: beside a Rust library of the same name cargo does not
/// optimise at link time, and nothing small would be inlined from the layers below.
fn cargo(mut command: Command, target: &str, folder: &Path, sysroot: &Path, product: &Product) -> Result<()> {
    command
        .args(["--package", product.package, "--lib", "--crate-type", "cdylib", "--profile", product.profile])
        .args(["--locked", "--target", target])
        .arg("--target-dir")
        .arg(folder)
        .current_dir(project::root())
        .env_remove("RUSTFLAGS")
        .env("CARGO_ENCODED_RUSTFLAGS", flags(sysroot)?.join(SEPARATOR));
    project::compile(&mut command, &format!("the library {} for {target}", product.name))
}

/// Compiler flags that replace the paths of this machine, which panic messages would carry into the library, by the
/// same names everywhere. Whatever flags the user has set do not apply: the bytes must depend on the source alone.
fn flags(sysroot: &Path) -> Result<Vec<String>> {
    let home = match std::env::var_os("CARGO_HOME") {
        Some(home) => PathBuf::from(home),
        None => std::env::home_dir().context("neither CARGO_HOME nor a home directory is known")?.join(".cargo"),
    };
    // Of several that fit the compiler takes the last one, and a toolchain may lie above the others (/usr).
    let replaced = [(sysroot.to_owned(), "/rust"), (home, "/cargo"), (project::root(), "/source")];
    // The compiler compares texts, and cargo may hand it a path through a link as it is or resolved.
    let mut flags = Vec::new();
    for (from, to) in replaced {
        let resolved = from.canonicalize().unwrap_or_else(|_| from.clone());
        flags.extend([&from, &resolved].map(|path| format!("--remap-path-prefix={}={to}", path.display())));
    }
    Ok(flags)
}

/// Root of the toolchain in use.
fn sysroot() -> Result<PathBuf> {
    let output = Command::new("rustc").args(["--print", "sysroot"]).output().context("starting rustc")?;
    Ok(PathBuf::from(String::from_utf8(output.stdout)?.trim()))
}
