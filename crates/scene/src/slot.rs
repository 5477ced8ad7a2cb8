//! The scene embedded in the library: a static array (the slot) that packaging fills.
//!
//! One compiled library serves every scene: the start values, the scene's name and its default
//! experiment are stored in a static array of known layout, which packaging overwrites in the built
//! file ([`fill`]). Nothing is read from disk at run time and nothing is recompiled.
//! A library whose slot was never filled has the table's own start values under the name
//! [`STOCK_NAME`].
//!
//! Layout, little endian:
//!
//! | bytes | content |
//! |---|---|
//! | 0..16 | magic |
//! | 16..20 | version of this layout |
//! | 20..24 | length of the whole slot in bytes |
//! | 24..32 | checksum (FNV-1a, 64 bit) of all bytes from 32 on |
//! | 32..36 | number of start values, [`COUNT`] |
//! | 36..40 | length of the name in bytes |
//! | 40..104 | name, ASCII, padded with zeros |
//! | 104..136 | start, stop, step, tolerance of the default experiment |
//! | 136.. | the start values in the order of the value references |

use crate::fnv::Fnv;

use crate::variables::{COUNT, Kind, STARTS, Start, TABLE};

/// Name of the scene in a library whose slot was not filled.
pub const STOCK_NAME: &str = "stock";

/// Most bytes a scene's name may have.
pub const NAME_CAPACITY: usize = 64;

/// Largest admissible relative tolerance of a run.
pub const LARGEST_TOLERANCE: f64 = 0.5;

/// Version of the layout of the module, and places of its parts in bytes.
const LAYOUT_VERSION: u32 = 1;
const CHECKSUM_AT: usize = 24;
const BODY_AT: usize = 32;
const NAME_AT: usize = 40;
const EXPERIMENT_AT: usize = NAME_AT + NAME_CAPACITY;
const STARTS_AT: usize = EXPERIMENT_AT + 32;
const LENGTH: usize = STARTS_AT + 8 * COUNT;
const MAGIC_LENGTH: usize = 16;

/// Default experiment of a scene. Times in seconds.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Experiment {
    /// Start time.
    pub start: f64,
    /// Stop time, after the start.
    pub stop: f64,
    /// Communication step size, > 0.
    pub step: f64,
    /// Relative tolerance, > 0.
    pub tolerance: f64,
}

/// The default experiment of a library whose slot was not filled. Its tolerance is one per cent, because wear coefficients
/// and conductances are seldom known better.
pub const STOCK_EXPERIMENT: Experiment = Experiment { start: 0.0, stop: 1370.0, step: 0.1, tolerance: 1e-2 };

/// A scene as it is packaged.
#[derive(Clone, PartialEq, Debug)]
pub struct Packaged {
    /// Name: a letter or underscore, then letters, digits and underscores; at most [`NAME_CAPACITY`].
    pub name: String,
    /// Start value of every value reference; 0 where the FMU calculates it.
    pub starts: [f64; COUNT],
    /// Default experiment.
    pub experiment: Experiment,
}

impl Packaged {
    /// The scene of the variable table itself.
    pub fn stock() -> Packaged {
        Packaged { name: STOCK_NAME.into(), starts: STARTS, experiment: STOCK_EXPERIMENT }
    }

    /// The GUID of this scene, see [`guid`].
    pub fn guid(&self) -> String {
        guid(&self.name, &self.starts)
    }
}

#[repr(C, align(16))]
struct Slot([u8; LENGTH]);

// `#[used]`: the library must contain these bytes even though every read of them is volatile.
// The magic occurs only here, in a constant evaluated by the compiler, so the built file contains
// it exactly once; `fill` takes its search pattern from this same slot.
#[used]
static SLOT: Slot = Slot(stock_bytes());

const fn put<const N: usize>(bytes: &mut [u8; LENGTH], at: usize, value: [u8; N]) {
    let mut index = 0;
    while index < N {
        bytes[at + index] = value[index];
        index += 1;
    }
}

const fn stock_bytes() -> [u8; LENGTH] {
    let mut bytes = [0; LENGTH];
    put(&mut bytes, 0, *b"\x89scene slot\r\n\x1a\n\0");
    put(&mut bytes, 16, LAYOUT_VERSION.to_le_bytes());
    put(&mut bytes, 20, (LENGTH as u32).to_le_bytes());
    put(&mut bytes, BODY_AT, (COUNT as u32).to_le_bytes());
    put(&mut bytes, 36, (STOCK_NAME.len() as u32).to_le_bytes());
    let mut index = 0;
    while index < STOCK_NAME.len() {
        bytes[NAME_AT + index] = STOCK_NAME.as_bytes()[index];
        index += 1;
    }
    put(&mut bytes, EXPERIMENT_AT, STOCK_EXPERIMENT.start.to_le_bytes());
    put(&mut bytes, EXPERIMENT_AT + 8, STOCK_EXPERIMENT.stop.to_le_bytes());
    put(&mut bytes, EXPERIMENT_AT + 16, STOCK_EXPERIMENT.step.to_le_bytes());
    put(&mut bytes, EXPERIMENT_AT + 24, STOCK_EXPERIMENT.tolerance.to_le_bytes());
    let mut reference = 0;
    while reference < COUNT {
        put(&mut bytes, STARTS_AT + 8 * reference, STARTS[reference].to_le_bytes());
        reference += 1;
    }
    let checksum = checksum(&bytes);
    put(&mut bytes, CHECKSUM_AT, checksum.to_le_bytes());
    bytes
}

/// FNV-1a over everything behind the checksum. Each step is a bijection of the running value, so
/// every change of a single byte is detected.
const fn checksum(bytes: &[u8; LENGTH]) -> u64 {
    let mut hash = Fnv::new();
    let mut index = BODY_AT;
    while index < LENGTH {
        hash = hash.with(bytes[index]);
        index += 1;
    }
    hash.0
}

/// The slot's bytes as they are in the loaded library.
fn loaded() -> [u8; LENGTH] {
    // SAFETY: `SLOT` is an initialised static, valid for reads, and never written to. The read is
    // volatile because the file's bytes differ from those at compile time and must not be constant-folded.
    unsafe { std::ptr::read_volatile(&raw const SLOT.0) }
}

fn integer(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
}

fn real(bytes: &[u8], at: usize) -> f64 {
    f64::from_le_bytes(std::array::from_fn(|index| bytes[at + index]))
}

fn check_name(name: &str) -> Result<(), String> {
    let first = name.bytes().next();
    if !first.is_some_and(|byte| byte.is_ascii_alphabetic() || byte == b'_')
        || !name.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_')
        || name.len() > NAME_CAPACITY
    {
        return Err(format!(
            "the scene name {} must be a letter or underscore followed by letters, digits and underscores, \
             at most {NAME_CAPACITY} in all",
            crate::message::Quoted(name)
        ));
    }
    Ok(())
}

/// Checks a packaged scene by itself: its name, finite values and the experiment.
///
/// # Errors
/// A sentence that names the wrong entry, its value and the limit.
pub fn check(scene: &Packaged) -> Result<(), String> {
    check_name(&scene.name)?;
    let Experiment { start, stop, step, tolerance } = scene.experiment;
    if !(start.is_finite() && stop.is_finite() && stop > start) {
        return Err(format!("experiment: the stop time {stop} s must be finite and after the start time {start} s"));
    }
    if !(step > 0.0 && step <= stop - start) {
        return Err(format!("experiment: the step {step} s must be > 0 and at most the duration {} s", stop - start));
    }
    if !(tolerance > 0.0 && tolerance <= LARGEST_TOLERANCE) {
        return Err(format!("experiment: the tolerance {tolerance} must be > 0 and at most {LARGEST_TOLERANCE}"));
    }
    match scene.starts.iter().position(|value| !value.is_finite()) {
        Some(reference) => {
            Err(format!("the start value of value reference {reference} is {}, not finite", scene.starts[reference]))
        }
        None => Ok(()),
    }
}

fn encode(scene: &Packaged) -> Result<[u8; LENGTH], String> {
    check(scene)?;
    let mut bytes = loaded();
    put(&mut bytes, 36, (scene.name.len() as u32).to_le_bytes());
    bytes[NAME_AT..EXPERIMENT_AT].fill(0);
    bytes[NAME_AT..NAME_AT + scene.name.len()].copy_from_slice(scene.name.as_bytes());
    let Experiment { start, stop, step, tolerance } = scene.experiment;
    let reals = [start, stop, step, tolerance].into_iter().chain(scene.starts);
    for (bytes, value) in bytes[EXPERIMENT_AT..].chunks_exact_mut(8).zip(reals) {
        bytes.copy_from_slice(&value.to_le_bytes());
    }
    let checksum = checksum(&bytes);
    put(&mut bytes, CHECKSUM_AT, checksum.to_le_bytes());
    Ok(bytes)
}

fn decode(bytes: &[u8; LENGTH]) -> Result<Packaged, String> {
    let damaged = |what: &str| Err(format!("the scene in the library is damaged: {what}; package the FMU again"));
    if integer(bytes, 16) != LAYOUT_VERSION {
        return damaged("another version of its layout");
    }
    if integer(bytes, 20) as usize != LENGTH || integer(bytes, BODY_AT) as usize != COUNT {
        return damaged("its length differs from the variable table");
    }
    let mut stored = [0; 8];
    stored.copy_from_slice(&bytes[CHECKSUM_AT..BODY_AT]);
    if u64::from_le_bytes(stored) != checksum(bytes) {
        return damaged("the checksum differs");
    }
    let Some(name) = bytes[NAME_AT..EXPERIMENT_AT]
        .get(..integer(bytes, 36) as usize)
        .and_then(|name| std::str::from_utf8(name).ok())
    else {
        return damaged("its name cannot be read");
    };
    let scene = Packaged {
        name: name.to_owned(),
        starts: std::array::from_fn(|reference| real(bytes, STARTS_AT + 8 * reference)),
        experiment: Experiment {
            start: real(bytes, EXPERIMENT_AT),
            stop: real(bytes, EXPERIMENT_AT + 8),
            step: real(bytes, EXPERIMENT_AT + 16),
            tolerance: real(bytes, EXPERIMENT_AT + 24),
        },
    };
    match check(&scene) {
        Ok(()) => Ok(scene),
        Err(reason) => damaged(&reason),
    }
}

/// The scene of this library, read and verified. It is not kept: memory that a static holds is lost when an importer unloads the
/// library.
///
/// # Errors
/// A sentence that describes the damage of the slot.
pub fn current() -> Result<Packaged, String> {
    decode(&loaded())
}

/// Writes a scene into the bytes of a built library.
///
/// # Errors
/// A sentence that says why, and the library is unchanged: the scene breaks a rule of [`check`], or
/// the library has no slot of this version and length, or more than one.
pub fn fill(library: &mut [u8], scene: &Packaged) -> Result<(), String> {
    let bytes = encode(scene)?;
    let magic = &bytes[..MAGIC_LENGTH];
    let mut found = (0..library.len().saturating_sub(MAGIC_LENGTH - 1))
        .filter(|&at| library[at] == magic[0] && &library[at..at + MAGIC_LENGTH] == magic);
    let at = found.next().ok_or("the library has no scene slot")?;
    if found.next().is_some() {
        return Err("the library has more than one scene slot".into());
    }
    let Some(slot) = library.get_mut(at..at + LENGTH) else {
        return Err("the library ends inside its scene slot".into());
    };
    if slot[16..CHECKSUM_AT] != bytes[16..CHECKSUM_AT] || slot[BODY_AT..36] != bytes[BODY_AT..36] {
        return Err("the library's scene slot is of another version of the variable table; build it again".into());
    }
    slot.copy_from_slice(&bytes);
    Ok(())
}

/// 128-bit FNV-1a. Not a cryptographic hash: it tells builds and scenes apart, it does not resist
/// someone who constructs a collision.
struct Fingerprint(u128);

impl Fingerprint {
    fn bytes(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u128::from(byte)).wrapping_mul(0x0000_0000_0100_0000_0000_0000_0000_013b);
        }
    }

    /// With its length, so that neighbouring texts cannot run into each other.
    fn text(&mut self, text: &str) {
        self.bytes(&(text.len() as u64).to_le_bytes());
        self.bytes(text.as_bytes());
    }

    fn real(&mut self, value: f64) {
        self.bytes(&value.to_bits().to_le_bytes());
    }

    fn optional(&mut self, value: Option<f64>) {
        self.bytes(&[u8::from(value.is_some())]);
        self.real(value.unwrap_or(0.0));
    }
}

/// GUID of a scene: a fingerprint of its name, of every attribute of every row of the variable table
/// and of every start value, as `{8-4-4-4-12}` hexadecimal digits.
///
/// The XML and the library both call this function, so their GUIDs agree if and only if interface and
/// scene are the same.
pub(crate) fn guid(name: &str, starts: &[f64; COUNT]) -> String {
    let mut hash = Fingerprint(0x6c62_272e_07bb_0142_62b8_2175_6295_c58d);
    hash.text(env!("CARGO_PKG_VERSION"));
    hash.text(name);
    for row in TABLE {
        hash.text(row.name);
        hash.text(row.description);
        hash.bytes(&[
            row.causality as u8,
            row.variability as u8,
            row.initial.map_or(0, |initial| 1 + initial as u8),
            row.depends as u8,
            u8::from(matches!(row.start, Start::None)),
        ]);
        hash.bytes(&row.elements.to_le_bytes());
        let (min, max) = row.bounds();
        hash.optional(min);
        hash.optional(max);
        match row.kind {
            Kind::Real { unit, display, nominal, .. } => {
                hash.text("Real");
                hash.text(unit.name);
                hash.text(row.type_name);
                hash.text(display);
                hash.real(nominal);
            }
            Kind::Integer { .. } => hash.text("Integer"),
            Kind::Boolean => hash.text("Boolean"),
            Kind::Enumeration(kind) => {
                hash.text(kind.name);
                hash.text(kind.description);
                for (item, description) in kind.items {
                    hash.text(item);
                    hash.text(description);
                }
            }
        }
    }
    for &value in starts {
        hash.real(value);
    }
    let digits = format!("{:032x}", hash.0);
    format!("{{{}-{}-{}-{}-{}}}", &digits[..8], &digits[8..12], &digits[12..16], &digits[16..20], &digits[20..])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::variables::reference;

    fn brake() -> Packaged {
        let mut scene = Packaged::stock();
        scene.name = "brake_2".into();
        scene.starts[reference("punch.width") as usize] = 0.06;
        scene.experiment = Experiment { start: 1.0, stop: 9.0, step: 0.5, tolerance: 1e-4 };
        scene
    }

    fn library() -> Vec<u8> {
        let mut library = vec![0x89; 777];
        library.extend(loaded());
        library.extend([7; 100]);
        library
    }

    fn slot_of(library: &[u8]) -> [u8; LENGTH] {
        library[777..777 + LENGTH].try_into().unwrap()
    }

    #[test]
    fn an_unfilled_slot_is_the_stock_scene() {
        assert_eq!(current(), Ok(Packaged::stock()));
    }

    #[test]
    fn a_filled_slot_reads_back_and_the_rest_of_the_library_stays() {
        let mut library = library();
        fill(&mut library, &brake()).unwrap();
        assert_eq!(decode(&slot_of(&library)), Ok(brake()));
        assert!(library[..777].iter().all(|&byte| byte == 0x89));
        assert!(library[777 + LENGTH..].iter().all(|&byte| byte == 7));
        fill(&mut library, &Packaged::stock()).unwrap();
        assert_eq!(slot_of(&library), loaded(), "a longer name leaves no trace");
    }

    #[test]
    fn every_damaged_byte_is_noticed() {
        let mut library = library();
        fill(&mut library, &brake()).unwrap();
        let slot = slot_of(&library);
        for at in 16..LENGTH {
            for flip in [1, 0x80] {
                let mut damaged = slot;
                damaged[at] ^= flip;
                assert!(decode(&damaged).unwrap_err().contains("damaged"), "byte {at}");
            }
        }
    }

    #[test]
    fn a_library_without_exactly_one_whole_slot_is_refused() {
        let refused = |mut library: Vec<u8>| {
            let before = library.clone();
            let reason = fill(&mut library, &brake()).unwrap_err();
            assert_eq!(library, before);
            reason
        };
        assert!(refused(vec![]).contains("no scene slot"));
        assert!(refused(vec![0; 9000]).contains("no scene slot"));
        assert!(refused([loaded(), loaded()].concat()).contains("more than one"));
        assert!(refused(loaded()[..LENGTH - 1].to_vec()).contains("ends inside"));
        let mut other = loaded().to_vec();
        other[16] += 1;
        assert!(refused(other).contains("another version"));
    }

    #[test]
    fn an_illegal_scene_is_refused() {
        let refused = |change: fn(&mut Packaged)| {
            let mut scene = brake();
            change(&mut scene);
            fill(&mut library(), &scene).unwrap_err()
        };
        for name in ["", "2fast", "with space", "dot.dot", "ümlaut"] {
            let mut scene = brake();
            scene.name = name.into();
            assert!(check(&scene).unwrap_err().contains(&format!("{name:?}")));
        }
        assert!(refused(|scene| scene.name = "a".repeat(NAME_CAPACITY + 1)).contains("at most 64"));
        assert!(refused(|scene| scene.experiment.stop = 1.0).contains("stop time 1 s"));
        assert!(refused(|scene| scene.experiment.step = 0.0).contains("step 0 s"));
        assert!(refused(|scene| scene.experiment.tolerance = f64::NAN).contains("tolerance NaN"));
        assert!(refused(|scene| scene.starts[3] = f64::INFINITY).contains("value reference 3 is inf"));
    }

    #[test]
    fn the_guid_tells_names_and_every_start_value_apart() {
        let stock = Packaged::stock();
        let mut seen = std::collections::HashSet::from([stock.guid()]);
        for at in 0..COUNT {
            let mut scene = stock.clone();
            scene.starts[at] += 1.0;
            assert!(seen.insert(scene.guid()), "start {at} does not count");
        }
        assert!(seen.insert(guid("stocks", &stock.starts)));
        let guid = stock.guid();
        assert_eq!(guid.len(), 38);
        let lengths: Vec<usize> = guid.trim_matches(['{', '}']).split('-').map(str::len).collect();
        assert_eq!(lengths, [8, 4, 4, 4, 12]);
    }

    #[test]
    fn the_fingerprint_is_fnv_1a_of_128_bits() {
        // Published test vectors of the FNV authors.
        for (text, expected) in [
            ("a", 0xd228_cb69_6f1a_8caf_7891_2b70_4e4a_8964_u128),
            ("foobar", 0x343e_1662_793c_64bf_6f0d_3597_ba44_6f18),
        ] {
            let mut hash = Fingerprint(0x6c62_272e_07bb_0142_62b8_2175_6295_c58d);
            hash.bytes(text.as_bytes());
            assert_eq!(hash.0, expected, "{text}");
        }
    }
}
