//! The libraries that a built Windows library imports.

use anyhow::{Context, Result, bail};
use object::LittleEndian;
use object::read::pe::PeFile64;

/// Libraries that are part of every Windows since 7; the `api-ms-win` ones are too.
const SYSTEM: [&str; 10] = [
    "advapi32.dll",
    "bcrypt.dll",
    "bcryptprimitives.dll",
    "kernel32.dll",
    "msvcrt.dll",
    "ntdll.dll",
    "ole32.dll",
    "user32.dll",
    "userenv.dll",
    "ws2_32.dll",
];

/// Names of the imported libraries, in small letters.
pub(crate) fn libraries(library: &[u8]) -> Result<Vec<String>> {
    let file = PeFile64::parse(library).context("reading the library as PE")?;
    let Some(table) = file.import_table()? else { return Ok(Vec::new()) };
    let mut names = Vec::new();
    let mut descriptors = table.descriptors()?;
    while let Some(descriptor) = descriptors.next()? {
        let name = table.name(descriptor.name.get(LittleEndian))?;
        names.push(String::from_utf8_lossy(name).to_lowercase());
    }
    Ok(names)
}

/// Checks that a Windows library imports only libraries of Windows itself, because an FMU is loaded where no
/// compiler's runtime is installed.
pub(crate) fn check(library: &[u8]) -> Result<()> {
    let foreign: Vec<String> = libraries(library)?.into_iter().filter(|name| !is_system(name)).collect();
    if !foreign.is_empty() {
        bail!("the Windows library imports {}, which does not come with Windows", foreign.join(", "));
    }
    Ok(())
}

fn is_system(name: &str) -> bool {
    SYSTEM.contains(&name) || name.starts_with("api-ms-win-")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runtimes_of_compilers_are_not_of_the_system() {
        for name in ["kernel32.dll", "api-ms-win-core-synch-l1-2-0.dll", "msvcrt.dll"] {
            assert!(is_system(name), "{name}");
        }
        for name in ["libgcc_s_seh-1.dll", "libwinpthread-1.dll", "libstdc++-6.dll", "vcruntime140.dll"] {
            assert!(!is_system(name), "{name}");
        }
    }

    #[test]
    fn what_is_no_windows_library_is_an_error() {
        assert!(libraries(b"").is_err());
        assert!(
            check(b"\x7fELF and so on, as a library of Linux begins, with some bytes behind it to be long").is_err()
        );
    }
}
