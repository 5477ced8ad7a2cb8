//! A long wear run that saves its state to a file every simulated hour is killed at random moments and resumed from the last file by
//! a new process: it gives the bits of a run that was never interrupted.

#![cfg(unix)]

use std::env;
use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use scene::fnv::Fnv;
use sliding_contact::fmi2::types::Status::Ok as OK;
use test_support::importer::Importer;
use test_support::{Random, real_outputs};

/// Simulated hours of a run.
const HOURS: u32 = 24;
/// Times that a run is killed.
const KILLS: usize = 4;

/// Name of the test, which is also what a run in a process of its own executes, and the file that tells it so.
const TEST: &str = "a_run_that_is_killed_and_resumed_gives_the_bits_of_one_that_is_not";
const FILE: &str = "SLIDING_CONTACT_RESTART_FILE";

/// Level of the model, as the item of `solver.fidelity`, and communication step, s.
#[derive(Clone, Copy)]
struct Level {
    name: &'static str,
    fidelity: i32,
    step: f64,
}

const LEVELS: [Level; 2] =
    [Level { name: "lumped", fidelity: 2, step: 1.0 }, Level { name: "line", fidelity: 3, step: 40.0 }];

/// Saved data of a run: the hours so far, each with a digest of every output behind each of its steps, and the state of the FMU.
struct Saved {
    digests: Vec<u64>,
    state: Vec<u8>,
}

impl Saved {
    /// Writes the file as a whole: whoever is killed on the way leaves the file before.
    fn write(&self, file: &Path) {
        let mut bytes = (self.digests.len() as u64).to_le_bytes().to_vec();
        bytes.extend(self.digests.iter().flat_map(|digest| digest.to_le_bytes()));
        bytes.extend(&self.state);
        let partial = file.with_extension("partial");
        fs::write(&partial, bytes).and_then(|()| fs::rename(&partial, file)).unwrap();
    }

    fn read(file: &Path) -> Option<Saved> {
        let bytes = fs::read(file).ok()?;
        let number = |at: usize| u64::from_le_bytes(bytes[8 * at..8 * at + 8].try_into().unwrap());
        let count = number(0) as usize;
        Some(Saved { digests: (1..=count).map(number).collect(), state: bytes[8 * (count + 1)..].to_vec() })
    }
}

/// A pad that drags, from the file where there is one: saved every hour, after which the hour is printed.
fn run(file: &Path, level: Level) {
    let importer = Importer::with_logging(false);
    assert_eq!(importer.set_integer("solver.fidelity", level.fidelity), OK);
    assert_eq!(importer.set_integer("solver.cells", 9), OK);
    let mut digests = Vec::new();
    if let Some(saved) = Saved::read(file) {
        let mut state = importer.deserialize(&saved.state).unwrap_or_else(|_| panic!("{:?}", importer.take_log()));
        assert_eq!((importer.restore(state), importer.free(&mut state)), (OK, OK), "{:?}", importer.take_log());
        digests = saved.digests;
    } else {
        assert_eq!(importer.setup(None, 0.0, None), OK);
        assert_eq!((importer.enter(), importer.exit()), (OK, OK));
    }
    let references = real_outputs();
    let steps = (3600.0 / level.step) as u32;
    while digests.len() < HOURS as usize {
        let mut digest = Fnv::new();
        for step in 0..steps {
            let time = level.step * f64::from(digests.len() as u32 * steps + step);
            let inputs = [2.0 + (1e-3 * time).sin(), 200.0 + 100.0 * (7e-4 * time).cos()];
            assert_eq!(importer.set_real(&["sliding_velocity", "normal_load"], &inputs), OK);
            assert_eq!(importer.step(time, level.step), OK, "{:?}", importer.take_log());
            let values = importer.get_reals(&references).unwrap();
            digest = values.iter().flat_map(|value| value.to_bits().to_le_bytes()).fold(digest, Fnv::with);
        }
        digests.push(digest.0);
        Saved { digests: digests.clone(), state: importer.bytes() }.write(file);
        println!("hour {}", digests.len());
    }
}

fn process(file: &Path) -> Child {
    let mut command = Command::new(env::current_exe().unwrap());
    command.args(["--exact", TEST, "--nocapture", "--test-threads", "1"]).env(FILE, file);
    command.stdin(Stdio::null()).stdout(Stdio::piped()).spawn().unwrap()
}

/// Runs in processes that are killed, a random time behind a random hour, and in one that is not at last; the number that were.
fn interrupted(file: &Path, random: &mut Random) -> usize {
    let mut killed = 0;
    for number in 0..=KILLS {
        let mut child = process(file);
        let lines = BufReader::new(child.stdout.take().unwrap()).lines().map_while(Result::ok);
        let mut hours = lines.filter(|line| line.contains("hour "));
        if number < KILLS {
            // Hours until the end, spread over the kills that are left.
            for _ in 0..1 + (random.next() * 4.0) as usize {
                hours.next();
            }
            sleep(Duration::from_micros((random.next() * 6e3) as u64));
            child.kill().unwrap();
        } else {
            hours.for_each(drop);
        }
        let status = child.wait().unwrap();
        killed += usize::from(status.code().is_none());
        assert!(status.success() || number < KILLS, "{status}");
    }
    killed
}

fn level_of(file: &Path) -> Level {
    let name = file.file_stem().unwrap().to_string_lossy();
    *LEVELS.iter().find(|level| name.contains(level.name)).unwrap()
}

#[test]
fn a_run_that_is_killed_and_resumed_gives_the_bits_of_one_that_is_not() {
    if let Some(file) = env::var_os(FILE) {
        let file = PathBuf::from(file);
        return run(&file, level_of(&file));
    }
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    for level in LEVELS {
        let [whole, parts] =
            ["whole", "parts"].map(|name| folder.join(format!("{name}.{}.{}", level.name, std::process::id())));
        assert!(process(&whole).wait_with_output().unwrap().status.success());
        let expected = fs::read(&whole).unwrap();
        let mut random = Random(7);
        let killed = interrupted(&parts, &mut random);
        assert!(killed >= KILLS - 1, "{}: {killed} of {KILLS} killed", level.name);
        let got = fs::read(&parts).unwrap();
        let [first, second] = [&whole, &parts].map(|file| Saved::read(file).unwrap());
        let differs = first.digests.iter().zip(&second.digests).position(|(one, other)| one != other);
        assert_eq!(differs, None, "{}: the hour, from 0, that differs first", level.name);
        assert_eq!(first.digests.len(), HOURS as usize);
        assert!(got == expected, "{}: the final states differ", level.name);
        for file in [whole, parts] {
            fs::remove_file(file).unwrap();
        }
    }
}
