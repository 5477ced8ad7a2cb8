//! Exported symbols of the shared library: the functions of the standard and nothing else.

use std::collections::BTreeSet;
use std::path::PathBuf;

use super::sequences::GRID;

/// Cargo builds the library beside the tests: `target/PROFILE/deps/fmi_policy-...`.
fn library() -> PathBuf {
    std::env::current_exe().unwrap().parent().unwrap().join("libsliding_contact.so")
}

fn number(bytes: &[u8], at: usize, width: usize) -> usize {
    bytes[at..at + width].iter().rev().fold(0, |number, &byte| number << 8 | usize::from(byte))
}

/// Names of the defined dynamic symbols of a 64-bit little-endian ELF file.
fn exported(elf: &[u8]) -> BTreeSet<String> {
    const DYNAMIC_SYMBOLS: usize = 11;
    assert_eq!(&elf[..6], b"\x7fELF\x02\x01");
    let (table, entry, count) = (number(elf, 0x28, 8), number(elf, 0x3a, 2), number(elf, 0x3c, 2));
    // Type, offset, size, link.
    let section = |index| {
        let at: usize = table + entry * index;
        (number(elf, at + 4, 4), number(elf, at + 24, 8), number(elf, at + 32, 8), number(elf, at + 40, 4))
    };
    let (_, symbols, size, link) = (0..count).map(section).find(|section| section.0 == DYNAMIC_SYMBOLS).unwrap();
    let names = section(link).1;
    (symbols..symbols + size)
        .step_by(24)
        .filter(|&symbol| number(elf, symbol + 6, 2) != 0)
        .map(|symbol| {
            let name = &elf[names + number(elf, symbol, 4)..];
            String::from_utf8(name.iter().copied().take_while(|&byte| byte != 0).collect()).unwrap()
        })
        .collect()
}

#[test]
fn the_library_exports_the_standards_functions_and_nothing_else() {
    let exported = exported(&std::fs::read(library()).unwrap());
    // Some importers look up the functions of model exchange in an FMU for co-simulation too.
    let others = ["fmi2GetTypesPlatform", "fmi2GetVersion", "fmi2Instantiate", "fmi2FreeInstance"];
    let expected: BTreeSet<_> = GRID.iter().map(|row| row.0).chain(others).map(str::to_owned).collect();
    assert_eq!(expected.len(), 44);
    assert_eq!(exported, expected);
}
