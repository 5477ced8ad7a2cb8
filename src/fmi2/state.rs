//! FMU states: contents and serialisation.
//!
//! A state holds everything that the continuation depends on: the component's own snapshot (parameters,
//! inputs and their derivatives, states, memory of the solver), the phase and the times. Logging settings are
//! not part of it. Layout in bytes, little endian:
//!
//! | bytes | content |
//! |---|---|
//! | 0..4 | magic `SCfs` |
//! | 4..6 | version of this layout |
//! | 6..8 | length of the GUID |
//! | 8..12 | length of the payload |
//! | 12..20 | checksum (FNV-1a, 64 bit) of all other bytes |
//! | 20.. | GUID of the FMU |
//! | then | payload: phase, flags (1: stop time, 2: tolerance), time, stop time, tolerance, snapshot |
//!
//! Every step of the checksum is a bijection of the running value, so a change of any one byte is
//! detected.

#![forbid(unsafe_code)]

use super::policy::Phase;
use super::registry::Registry;
use crate::component::Snapshot;
use scene::fnv::Fnv;

/// Start of every state, and the version of the layout: see the module.
const MAGIC: [u8; 4] = *b"SCfs";
const VERSION: u16 = 11;
/// Every living FMU state. A state that is not freed lives until the process ends, possibly longer than its
/// instance, and may be restored into any instance of this library.
pub(crate) static STATES: Registry<Saved> = Registry::new(3);

/// Bytes before the GUID.
pub(crate) const HEADER: usize = 20;
const CHECKSUM: core::ops::Range<usize> = 12..20;
/// Payload before the snapshot.
const FRAME: usize = 2 + 3 * 8;
/// Flags of the payload.
const HAS_STOP: u8 = 1;
const HAS_TOLERANCE: u8 = 2;

/// The importer's time and what it announced in `fmi2SetupExperiment`.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub(crate) struct Clock {
    /// Communication point: the end of the last step, in seconds.
    pub time: f64,
    /// Stop time, in seconds.
    pub stop: Option<f64>,
    /// Relative tolerance.
    pub tolerance: Option<f64>,
}

/// An FMU state.
pub(crate) struct Saved {
    /// Phase of the instance.
    pub phase: Phase,
    /// Times.
    pub clock: Clock,
    /// The component.
    pub component: Snapshot,
}

impl Saved {
    /// Number of bytes that [`Saved::encode`] writes.
    pub(crate) fn encoded_size(&self, guid: &str) -> usize {
        HEADER + guid.len() + FRAME + self.component.encoded_size()
    }

    /// The state as bytes, for an FMU with this GUID.
    ///
    /// # Errors
    /// A sentence, where the state is too long for the layout.
    pub(crate) fn encode(&self, guid: &str) -> Result<Vec<u8>, String> {
        let mut bytes = Vec::with_capacity(self.encoded_size(guid));
        bytes.resize(HEADER, 0);
        bytes.extend_from_slice(guid.as_bytes());
        let Clock { time, stop, tolerance } = self.clock;
        let flag = |option: Option<f64>, flag| if option.is_some() { flag } else { 0 };
        bytes.extend([self.phase as u8, flag(stop, HAS_STOP) | flag(tolerance, HAS_TOLERANCE)]);
        for real in [time, stop.unwrap_or(0.0), tolerance.unwrap_or(0.0)] {
            bytes.extend(real.to_le_bytes());
        }
        self.component.encode(&mut bytes);
        let too_long = |_| format!("the FMU state has {} bytes, more than the layout can hold", bytes.len());
        let guid_length = u16::try_from(guid.len()).map_err(too_long)?;
        let payload = u32::try_from(bytes.len() - HEADER - guid.len()).map_err(too_long)?;
        bytes[..4].copy_from_slice(&MAGIC);
        bytes[4..6].copy_from_slice(&VERSION.to_le_bytes());
        bytes[6..8].copy_from_slice(&guid_length.to_le_bytes());
        bytes[8..12].copy_from_slice(&payload.to_le_bytes());
        let sum = checksum(&bytes);
        bytes[CHECKSUM].copy_from_slice(&sum.to_le_bytes());
        Ok(bytes)
    }

    /// The state of bytes that an FMU with this GUID wrote.
    ///
    /// # Errors
    /// A sentence that says what is wrong with the bytes.
    pub(crate) fn decode(bytes: &[u8], guid: &str) -> Result<Saved, String> {
        let header = bytes.first_chunk().ok_or_else(|| shorter_than_header(bytes.len()))?;
        let announced = announced_size(header)?;
        if announced != bytes.len() {
            return Err(wrong_length(announced, bytes.len()));
        }
        if field::<8>(bytes, CHECKSUM.start).map(u64::from_le_bytes) != Some(checksum(bytes)) {
            return Err("the serialised FMU state is damaged: its checksum differs".into());
        }
        let guid_length = field(bytes, 6).map_or(0, u16::from_le_bytes).into();
        let (writer, payload) = bytes[HEADER..].split_at_checked(guid_length).ok_or("the GUID is cut off")?;
        if writer != guid.as_bytes() {
            let writer = String::from_utf8_lossy(writer);
            return Err(format!("the serialised FMU state is of the FMU {writer}, this is {guid}"));
        }
        let (&[phase, flags], reals) = payload.split_first_chunk().ok_or("the phase is missing")?;
        let phase = Phase::from_bit(phase).ok_or_else(|| format!("{phase} is no phase"))?;
        let real = |index: usize| field(reals, 8 * index).map(f64::from_le_bytes).ok_or("the times are missing");
        let optional = |index, flag| real(index).map(|value| (flags & flag != 0).then_some(value));
        let clock = Clock { time: real(0)?, stop: optional(1, HAS_STOP)?, tolerance: optional(2, HAS_TOLERANCE)? };
        let component = Snapshot::decode(&payload[FRAME..]).map_err(|reason| reason.to_string())?;
        Ok(Saved { phase, clock, component })
    }
}

/// Total length according to the header, to detect an importer's wrong length before
/// more than the header is read.
///
/// # Errors
/// A sentence, where the bytes are not of this layout.
pub(crate) fn announced_size(header: &[u8; HEADER]) -> Result<usize, String> {
    if header[..4] != MAGIC {
        return Err("these bytes are no serialised FMU state of this FMU".into());
    }
    let version = field(header, 4).map_or(0, u16::from_le_bytes);
    if version != VERSION {
        return Err(format!("the serialised FMU state has layout {version}, this FMU reads layout {VERSION}"));
    }
    let guid = field(header, 6).map_or(0, u16::from_le_bytes) as usize;
    let payload = field(header, 8).map_or(0, u32::from_le_bytes) as usize;
    Ok(HEADER + guid + payload)
}

/// For a length that is not the announced one.
pub(crate) fn wrong_length(announced: usize, given: usize) -> String {
    format!("the serialised FMU state has {announced} bytes, {given} were given")
}

/// For a length below that of the header.
pub(crate) fn shorter_than_header(given: usize) -> String {
    format!("a serialised FMU state has at least {HEADER} bytes, {given} were given")
}

fn field<const N: usize>(bytes: &[u8], at: usize) -> Option<[u8; N]> {
    bytes.get(at..)?.first_chunk().copied()
}

/// FNV-1a over all bytes but its own.
fn checksum(bytes: &[u8]) -> u64 {
    Fnv::of(bytes[..CHECKSUM.start].iter().chain(&bytes[CHECKSUM.end..]).copied()).0
}
