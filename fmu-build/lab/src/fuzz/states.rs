//! Target `states`: serialised states with flipped bits, cut, spliced, of wrong lengths, with and without a checksum that fits.

use std::sync::LazyLock;

use scene::variables::{ValueReference, reference};
use sliding_contact::fmi2::types::Status;

use super::importer::{Importer, forge, guid_length};
use super::invariants::{OUTPUTS, Outputs};
use super::random::Random;
use super::{Kinds, Verdict};

/// Scenes whose states are damaged, by their parameters: two lumped ones, and contact lines of five cells.
const SCENES: [&[(&str, f64)]; 6] = [
    &[("solver.fidelity", 2.0)],
    &[("solver.fidelity", 2.0), ("contact.geometry", 2.0), ("contact.stick_stiffness", 1e7)],
    &[("solver.fidelity", 3.0), ("solver.cells", 5.0)],
    &[("solver.fidelity", 3.0), ("solver.cells", 5.0), ("punch.conductivity", 0.0)],
    &[("solver.fidelity", 3.0), ("solver.cells", 5.0), ("contact.geometry", 2.0)],
    &[("solver.fidelity", 3.0), ("solver.cells", 5.0), ("holder.constraint", 2.0), ("strip.path", 1.0)],
];

/// Whole states, of every phase of every scene.
static WHOLE: LazyLock<Vec<Vec<u8>>> = LazyLock::new(|| BY_SCENE.concat());

static BY_SCENE: LazyLock<Vec<Vec<Vec<u8>>>> = LazyLock::new(|| SCENES.iter().map(|scene| states_of(scene)).collect());

fn states_of(scene: &[(&str, f64)]) -> Vec<Vec<u8>> {
    let Some(importer) = Importer::new(false) else { return Vec::new() };
    for &(name, value) in scene {
        if let Some(reference) = scene::variables::find(name) {
            let is_real = importer.set_reals(&[reference], &[value]) == Status::Ok;
            let _ = is_real || importer.set_integer(reference, value as i32) == Status::Ok;
        }
    }
    let mut states = vec![importer.bytes()];
    let _ = importer.setup(Some(1e-3), 0.0, None);
    let _ = importer.enter();
    states.push(importer.bytes());
    if importer.exit() == Status::Ok {
        states.push(importer.bytes());
        for step in 0..3 {
            let _ = importer.set_reals(&[0, 1], &[3.0 - f64::from(step), 1000.0]);
            let _ = importer.step(importer.time(), 0.1);
        }
        states.push(importer.bytes());
    }
    states
}

fn damage(bytes: &mut Vec<u8>, random: &mut Random) {
    if bytes.is_empty() {
        return;
    }
    match random.below(8) {
        0 => {
            let at = random.below(bytes.len());
            bytes[at] ^= 1 << random.below(8);
        }
        1 => {
            let at = random.below(bytes.len());
            bytes[at] = random.bits() as u8;
        }
        2 => bytes.truncate(random.below(bytes.len() + 1)),
        3 => {
            let more = random.below(40);
            bytes.extend((0..more).map(|_| random.bits() as u8));
        }
        4 => {
            // A number of its own in place of one of the payload.
            let begin = 20 + guid_length(bytes) + 2;
            let count = bytes.len().saturating_sub(begin) / 8;
            if count > 0 {
                let at = begin + 8 * random.below(count);
                let value = random.any();
                bytes[at..at + 8].copy_from_slice(&value.to_le_bytes());
            }
        }
        5 => {
            // A piece of another state, or of this one.
            let other = random.pick(&WHOLE).clone();
            let from = random.below(other.len());
            let length = random.below(other.len() - from).min(random.below(200));
            let at = random.below(bytes.len());
            let end = (at + if random.one_in(2) { length } else { 0 }).min(bytes.len());
            bytes.splice(at..end, other[from..from + length].iter().copied());
        }
        6 => {
            let at = random.below(bytes.len());
            let end = (at + random.below(64)).min(bytes.len());
            bytes.drain(at..end);
        }
        _ => {
            // Lengths in the header.
            let at = 4 + random.below(8);
            if at < bytes.len() {
                bytes[at] = random.bits() as u8;
            }
        }
    }
}

pub(crate) fn run(seed: u64, kinds: &mut Kinds) -> Verdict {
    let mut random = Random::new(seed, 0);
    thread_local! {
        /// One for every scene, whose operators it keeps.
        static IMPORTERS: Vec<Option<Importer>> = SCENES.iter().map(|_| Importer::new(false)).collect();
    }
    let which = random.below(SCENES.len());
    let mut bytes = random.pick(&BY_SCENE[which]).clone();
    for _ in 0..1 + random.below(3) {
        damage(&mut bytes, &mut random);
    }
    let is_forged = random.below(3) > 0;
    if is_forged {
        forge(&mut bytes);
    }
    let is_whole = WHOLE.contains(&bytes);
    IMPORTERS.with(|importers| {
        let importer = importers[which].as_ref().ok_or("fmi2Instantiate gives no instance")?;
        let verdict = read(importer, &bytes, is_forged || is_whole, &mut random);
        for (_, text) in importer.take_log() {
            if text.contains("defect of this FMU") {
                return Err(text);
            }
            kinds.note(&text);
        }
        verdict
    })
}

fn read(importer: &Importer, bytes: &[u8], may_be_accepted: bool, random: &mut Random) -> Verdict {
    let Ok(mut state) = importer.deserialize(bytes) else {
        return if importer.has_refused() { Ok(()) } else { Err("bytes are refused without a message".into()) };
    };
    if !may_be_accepted {
        return Err("damaged bytes are accepted".into());
    }
    let status = importer.reset();
    if status != Status::Ok {
        return Err("fmi2Reset fails".into());
    }
    let _ = importer.set_integer(reference("solver.fidelity"), 2);
    let verdict = match importer.restore(state) {
        Status::Ok => use_restored(importer, random),
        Status::Error if importer.has_refused() => Ok(()),
        status => Err(format!("fmi2SetFMUstate returns {status:?} without a message")),
    };
    if importer.free(&mut state) != Status::Ok {
        return Err("a state cannot be freed".into());
    }
    verdict
}

/// A forged state that was accepted: what a step makes of it is finite, or an error.
fn use_restored(importer: &Importer, random: &mut Random) -> Verdict {
    let _ = importer.get_reals(&OUTPUTS);
    let references: [ValueReference; 2] = [0, 1];
    if random.one_in(2) {
        let _ = importer.set_reals(&references, &[random.sign() * random.power(-2.0, 1.5), random.power(0.0, 4.0)]);
    }
    let length = *random.pick(&[1e-3, 0.1, 1.0]);
    for _ in 0..2 {
        if importer.step(importer.time(), length) == Status::Ok {
            let values = importer.get_reals(&OUTPUTS).map_err(|status| format!("fmi2GetReal returns {status:?}"))?;
            Outputs::new(values, importer.limits())
                .check_finite()
                .map_err(|text| format!("after a step from a forged state: {text}"))?;
        }
    }
    Ok(())
}
