//! Finds a Rust toolchain that can build the library for another platform.
//!
//! Either its standard library for that platform is installed (`rustup target add`), or the sources of the standard
//! library are, and cargo compiles them too (`-Z build-std`, which a stable compiler does where `RUSTC_BOOTSTRAP` is
//! set). Debian's rustc-web with rust-web-src is a toolchain of the second kind; it is looked for where distributions
//! install it, because another one may come before it on the path.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use super::platform::Platform;

/// Installation folder of the distribution's toolchain.
const SYSTEM: &str = "/usr/bin";

/// A compiler with its cargo.
struct Compiler {
    cargo: PathBuf,
    rustc: PathBuf,
    sysroot: PathBuf,
}

impl Compiler {
    /// `None` where there is none that runs.
    fn of(cargo: PathBuf, rustc: PathBuf) -> Option<Self> {
        let output = Command::new(&rustc).args(["--print", "sysroot"]).stdin(Stdio::null()).output().ok()?;
        let runs = output.status.success() && runs(&cargo);
        let sysroot = PathBuf::from(String::from_utf8(output.stdout).ok()?.trim());
        runs.then_some(Self { cargo, rustc, sysroot })
    }

    /// Whether something is installed for it.
    fn has(&self, path: &str) -> bool {
        self.sysroot.join("lib/rustlib").join(path).exists()
    }
}

/// Toolchain that builds for a platform.
pub(crate) struct Toolchain {
    compiler: Compiler,
    /// Rust target.
    pub target: &'static str,
    /// Whether the standard library is compiled too.
    with_sources: bool,
    linker: Option<&'static str>,
}

impl Toolchain {
    /// The first toolchain that can build for the platform.
    pub(crate) fn find(platform: Platform) -> Result<Self, String> {
        if platform == Platform::Darwin64 && cfg!(not(target_os = "macos")) {
            return Err("darwin64 is built on macOS only: Apple's SDK, which the linker needs, is for macOS".into());
        }
        let mut missing = Vec::new();
        let linker = platform.linker();
        if let Some((program, package)) = linker
            && !runs(Path::new(program))
        {
            missing.push(format!("the linker {program} (Debian: apt install {package})"));
        }
        let cargo = std::env::var_os("CARGO").map_or_else(|| PathBuf::from("cargo"), PathBuf::from);
        let system = Path::new(SYSTEM);
        let mut compilers: Vec<Compiler> =
            [(cargo, PathBuf::from("rustc")), (system.join("cargo"), system.join("rustc"))]
                .into_iter()
                .filter_map(|(cargo, rustc)| Compiler::of(cargo, rustc))
                .collect();
        let prebuilt = platform.target();
        let with = |path: &str| compilers.iter().position(|compiler| compiler.has(path));
        let found = with(&format!("{prebuilt}/lib"))
            .map(|at| (at, prebuilt, false))
            .or_else(|| with("src/rust/library/Cargo.toml").map(|at| (at, platform.target_with_sources(), true)));
        if found.is_none() {
            missing.push(format!(
                "the standard library for {prebuilt} (rustup target add {prebuilt}) or its sources (rustup component \
                 add rust-src; Debian: apt install rustc-web cargo-web rust-web-src)"
            ));
        }
        match found {
            Some((at, target, with_sources)) if missing.is_empty() => Ok(Self {
                compiler: compilers.swap_remove(at),
                target,
                with_sources,
                linker: linker.map(|(program, _)| program),
            }),
            _ => Err(format!("{} needs {}", platform.folder(), missing.join(" and "))),
        }
    }

    /// Root of the toolchain, whose path must not get into the library.
    pub(crate) fn sysroot(&self) -> &Path {
        &self.compiler.sysroot
    }

    /// `cargo build` for the target, without the arguments that say what.
    pub(crate) fn command(&self) -> Command {
        let mut command = Command::new(&self.compiler.cargo);
        command.arg("rustc").env("RUSTC", &self.compiler.rustc);
        if self.with_sources {
            command.arg("-Zbuild-std=std,panic_unwind").env("RUSTC_BOOTSTRAP", "1");
        }
        if let Some(linker) = self.linker {
            let target = self.target.to_uppercase().replace('-', "_");
            command.env(format!("CARGO_TARGET_{target}_LINKER"), linker);
        }
        command
    }
}

/// Whether a program exists and runs with `--version`.
fn runs(program: &Path) -> bool {
    let status = Command::new(program)
        .arg("--version")
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status();
    status.is_ok_and(|status| status.success())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_built_here_says_what_to_install() {
        // Whatever is installed: a compiler that does not exist is none, and a program that does not exist does not run.
        assert!(Compiler::of("cargo".into(), "no-such-compiler".into()).is_none());
        assert!(!runs(Path::new("no-such-linker")));
        for platform in [Platform::Win64, Platform::Aarch64Linux, Platform::Darwin64] {
            match Toolchain::find(platform) {
                Ok(toolchain) => {
                    assert!([platform.target(), platform.target_with_sources()].contains(&toolchain.target))
                }
                Err(reason) => {
                    assert!(reason.starts_with(platform.folder()), "{reason}");
                    assert!(reason.contains("install") || reason.contains("macOS"), "{reason}");
                }
            }
        }
    }
}
