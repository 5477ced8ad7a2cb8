//! The glibc version that a built library requires.

use anyhow::{Context, Result};
use object::Endianness;
use object::elf::FileHeader64;
use object::read::elf::FileHeader;

/// A version of glibc, such as 2.17.
pub(crate) type Version = (u32, u32);

/// The newest version that the library may require: that of the oldest distributions still in use.
pub(crate) const WANTED: Version = (2, 17);

/// The highest glibc version among the symbols that an ELF library imports; `None` where it imports none.
pub(crate) fn highest(library: &[u8]) -> Result<Option<Version>> {
    let header = FileHeader64::<Endianness>::parse(library).context("reading the library as ELF")?;
    let endian = header.endian()?;
    let sections = header.sections(endian, library)?;
    let Some((mut files, strings)) = sections.gnu_verneed(endian, library)? else { return Ok(None) };
    let strings = sections.strings(endian, library, strings)?;
    let mut highest = None;
    while let Some((_, mut versions)) = files.next()? {
        while let Some(version) = versions.next()? {
            highest = highest.max(parse(version.name(endian, strings)?));
        }
    }
    Ok(highest)
}

/// `GLIBC_2.17` and `GLIBC_2.2.5` as versions; other names (`GCC_3.0`) are of other libraries.
fn parse(name: &[u8]) -> Option<Version> {
    let mut numbers = std::str::from_utf8(name).ok()?.strip_prefix("GLIBC_")?.split('.');
    Some((numbers.next()?.parse().ok()?, numbers.next()?.parse().ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn version_names_are_understood() {
        assert_eq!(parse(b"GLIBC_2.17"), Some((2, 17)));
        assert_eq!(parse(b"GLIBC_2.2.5"), Some((2, 2)));
        assert_eq!(parse(b"GCC_3.0"), None);
        assert_eq!(parse(b"GLIBC_PRIVATE"), None);
        assert!((2, 4) < WANTED && (2, 28) > WANTED);
    }

    #[cfg(all(target_os = "linux", target_env = "gnu", target_pointer_width = "64"))]
    #[test]
    fn this_very_program_needs_a_glibc_not_newer_than_the_one_it_runs_on() {
        let program = std::fs::read(std::env::current_exe().unwrap()).unwrap();
        let found = highest(&program).unwrap().expect("a Rust program imports from glibc");
        assert!(((2, 2)..(2, 100)).contains(&found), "{found:?}");
    }

    #[test]
    fn what_is_no_library_is_an_error() {
        assert!(highest(b"MZ not an ELF file, but long enough to hold the header of one, which is 64 bytes").is_err());
        assert!(highest(b"").is_err());
    }
}
