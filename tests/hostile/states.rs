//! Serialised states that are none of this scene's; damage that the checksum finds is tested in `tests/fmi_policy/states.rs`.

use scene::fnv::Fnv;
use sliding_contact::fmi2::types::Status;

use crate::run::{Call, Case, From, Level, check};
use test_support::importer::{Importer, Stage};

/// Offset of the phase in the bytes of a state.
fn phase(bytes: &[u8]) -> usize {
    20 + usize::from(u16::from_le_bytes([bytes[6], bytes[7]]))
}

fn restored(importer: &Importer, bytes: &[u8]) -> Status {
    let read = importer.deserialize(bytes).map(|mut state| {
        let status = importer.restore(state);
        assert_eq!(importer.free(&mut state), Status::Ok);
        status
    });
    read.unwrap_or_else(|refused| refused)
}

/// Restores the instance's own state after `damage`, with a length and a checksum that fit.
fn forged(importer: &Importer, damage: fn(&mut Vec<u8>)) -> Status {
    let mut bytes = importer.bytes();
    damage(&mut bytes);
    let payload = (bytes.len() - phase(&bytes)) as u32;
    bytes[8..12].copy_from_slice(&payload.to_le_bytes());
    let sum = Fnv::of(bytes[..12].iter().chain(&bytes[20..]).copied()).0;
    bytes[12..20].copy_from_slice(&sum.to_le_bytes());
    restored(importer, &bytes)
}

/// Replaces the last number of a state.
fn last_number(bytes: &mut [u8], number: f64) {
    let at = bytes.len() - 8;
    bytes[at..].copy_from_slice(&number.to_le_bytes());
}

fn case(what: &str, call: fn(&Importer) -> Status, status: Status, says: &str) -> Case {
    Case {
        what: what.to_owned(),
        levels: vec![Level::Lumped, Level::Cold, Level::Hot],
        example: String::new(),
        scene: Vec::new(),
        from: From::Stepping,
        calls: vec![Call::Other(call), Call::Steps(0.01, 1)][..if status == Status::Ok { 2 } else { 1 }].to_vec(),
        status: Some(status),
        says: (!says.is_empty()).then(|| says.to_owned()).into_iter().collect(),
    }
}

#[test]
fn forged_and_foreign_states() {
    check(&[
        case("of another FMU", |x| forged(x, |bytes| bytes[22] ^= 1), Status::Error, "of the FMU"),
        case("of an older layout", |x| forged(x, |bytes| bytes[4] = 1), Status::Error, "layout 1"),
        case("a load of NaN", |x| forged(x, |bytes| last_number(bytes, f64::NAN)), Status::Error, "state"),
        case("an infinite number", |x| forged(x, |bytes| last_number(bytes, f64::INFINITY)), Status::Error, "damaged"),
        case("a number too many", |x| forged(x, |bytes| bytes.extend([0; 8])), Status::Error, "state"),
        case(
            "of no phase",
            |x| {
                forged(x, |bytes| {
                    let at = phase(bytes);
                    bytes[at] = 3;
                })
            },
            Status::Error,
            "3 is no phase",
        ),
        case("of a lumped scene", |x| restored(x, &Importer::at(Stage::Stepping).bytes()), Status::Ok, ""),
    ]);
    let mut before = case("before initialisation", |x| restored(x, &Importer::new().bytes()), Status::Ok, "");
    before.calls.insert(1, Call::Initialise);
    check(&[before]);
}
