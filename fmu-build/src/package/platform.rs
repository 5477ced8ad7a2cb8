//! Platforms that an FMU can hold a library for.

use clap::ValueEnum;

use fmu_file::description::MODEL_IDENTIFIER;

/// Platforms under the names of FMI: the first two and the last are those of FMI 2.0, `aarch64-linux` is that of
/// FMI 3.0, which importers of FMI 2.0 on such machines look for as well.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug, ValueEnum)]
pub enum Platform {
    /// Linux on x86-64, glibc 2.17 or newer
    Linux64,
    /// Windows on x86-64
    Win64,
    /// Linux on 64-bit ARM
    Aarch64Linux,
    /// macOS on x86-64
    Darwin64,
}

impl Platform {
    /// Platform of this machine; [`None`] where there is none for it. A Mac with an ARM processor runs the library for x86-64 in an
    /// importer for x86-64.
    pub(crate) fn host() -> Option<Self> {
        Self::value_variants().iter().copied().find(|platform| platform.folder() == fmu_host::platform())
    }

    /// Name of its folder in the FMU, Rust target of the prebuilt standard library, and beginning and ending of a library's name.
    fn names(self) -> [&'static str; 4] {
        match self {
            Platform::Linux64 => ["linux64", "x86_64-unknown-linux-gnu", "lib", "so"],
            Platform::Win64 => ["win64", "x86_64-pc-windows-gnu", "", "dll"],
            Platform::Aarch64Linux => ["aarch64-linux", "aarch64-unknown-linux-gnu", "lib", "so"],
            Platform::Darwin64 => ["darwin64", "x86_64-apple-darwin", "lib", "dylib"],
        }
    }

    pub(crate) fn folder(self) -> &'static str {
        self.names()[0]
    }

    /// Path of the library in the FMU.
    pub(crate) fn library_path(self) -> String {
        let [folder, .., ending] = self.names();
        format!("binaries/{folder}/{MODEL_IDENTIFIER}.{ending}")
    }

    /// Name that cargo gives the built library of a crate.
    pub(crate) fn built_name(self, name: &str) -> String {
        let [_, _, prefix, ending] = self.names();
        format!("{prefix}{name}.{ending}")
    }

    pub(crate) fn target(self) -> &'static str {
        self.names()[1]
    }

    /// Rust target where the standard library is compiled too. The Windows one needs nothing newer than Windows 7,
    /// so that it also runs under Wine 8, which is without functions of Windows 10 that the prebuilt one imports.
    pub(crate) fn target_with_sources(self) -> &'static str {
        match self {
            Platform::Win64 => "x86_64-win7-windows-gnu",
            other => other.target(),
        }
    }

    /// Linker and the Debian package that has it; `None`: the one of this system.
    pub(crate) fn linker(self) -> Option<(&'static str, &'static str)> {
        match self {
            Platform::Win64 => Some(("x86_64-w64-mingw32-gcc", "gcc-mingw-w64-x86-64")),
            Platform::Aarch64Linux if cfg!(not(all(target_os = "linux", target_arch = "aarch64"))) => {
                Some(("aarch64-linux-gnu-gcc", "gcc-aarch64-linux-gnu libc6-dev-arm64-cross"))
            }
            _ => None,
        }
    }
}
