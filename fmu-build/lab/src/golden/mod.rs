//! `cargo fmu golden`: what the code computes, recorded to the bit, and compared with what was recorded before.

mod compare;
mod machine;
mod record;
mod run;
mod scenes;

use crate::output::print_line;
use anyhow::{Context, Result, bail};
use clap::Subcommand;
use compare::{Allowed, Differences, compare};
use record::Record;
use scene::slot::LARGEST_TOLERANCE;
use scenes::GoldenScene;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// A tolerance of a comparison as an argument; differences of rounding may be allowed alone, so it has no least value.
fn tolerance(given: &str) -> Result<f64, String> {
    match crate::arguments::number(given)? {
        value if value > 0.0 && value <= LARGEST_TOLERANCE => Ok(value),
        value => Err(format!("{value} must be above 0 and at most {LARGEST_TOLERANCE}")),
    }
}

/// Relative tolerance of all scenes on any machine; see tests/golden/README.md.
const TOLERANCE: f64 = 1e-6;

#[derive(clap::Args, Debug)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    action: Action,
}

#[derive(Subcommand, Debug)]
enum Action {
    /// Compute the golden scenes and replace their records.
    Record(Chosen),
    /// Compute the golden scenes and show where they differ first from their records.
    ///
    /// Ends with an error where any differs by more than 1e-6, and on a machine like the one that recorded where a bit of the
    /// scenes marked by `bits` differs.
    Compare {
        #[command(flatten)]
        chosen: Chosen,
        /// Compare values with this tolerance instead of bits, relative to the largest magnitude of the variable in the scene
        /// or a tenth of its nominal value; work counters and derivatives are then not compared.
        #[arg(long, value_parser = tolerance, allow_negative_numbers = true)]
        tolerance: Option<f64>,
        /// Compare the bits of all scenes, for changes that must not alter any.
        #[arg(long, conflicts_with = "tolerance")]
        bits: bool,
    },
}

#[derive(clap::Args, Debug)]
struct Chosen {
    /// Names of golden scenes; without one all of them.
    scenes: Vec<String>,
    /// Folder of the records instead of tests/golden/records.
    #[arg(long, value_name = "FOLDER")]
    folder: Option<PathBuf>,
}

impl Chosen {
    fn folder(&self) -> PathBuf {
        self.folder.clone().unwrap_or_else(|| scenes::folder().join("records"))
    }
}

pub(crate) fn execute(arguments: &Arguments) -> Result<()> {
    match &arguments.action {
        Action::Record(chosen) => record_all(chosen),
        Action::Compare { chosen, tolerance, bits } => compare_all(chosen, *tolerance, *bits),
    }
}

fn file(folder: &Path, scene: &GoldenScene) -> PathBuf {
    folder.join(format!("{}.txt", scene.name))
}

/// Where the machine is written down.
fn machine_file(folder: &Path) -> PathBuf {
    folder.join("machine")
}

fn record_all(chosen: &Chosen) -> Result<()> {
    let folder = chosen.folder();
    fs::create_dir_all(&folder).with_context(|| format!("making {}", folder.display()))?;
    let (machine, machine_file) = (machine::describe() + "\n", machine_file(&folder));
    if !chosen.scenes.is_empty()
        && let Ok(before) = fs::read_to_string(&machine_file)
        && before != machine
    {
        bail!("the other records were made on another machine, {}; record all of them", before.trim());
    }
    let golden = scenes::read(&chosen.scenes)?;
    for scene in &golden {
        let began = Instant::now();
        let record = run::record(scene)?;
        let text = record.text();
        let path = file(&folder, scene);
        let changed =
            fs::read_to_string(&path).map_or("new", |before| if before == text { "the same" } else { "changed" });
        fs::write(&path, &text).with_context(|| format!("writing {}", path.display()))?;
        print_line!(
            "{:<40} {changed:<8} {:>4} points {:>6} bytes {:>6.2} s",
            scene.name,
            record.points,
            text.len(),
            began.elapsed().as_secs_f64()
        );
    }
    if chosen.scenes.is_empty() {
        for stale in without_scene(&folder, &golden)? {
            fs::remove_file(&stale).with_context(|| format!("removing {}", stale.display()))?;
        }
    }
    fs::write(&machine_file, machine).with_context(|| format!("writing {}", machine_file.display()))?;
    print_line!("{} scenes recorded in {}", golden.len(), folder.display());
    Ok(())
}

/// Records of which there is no scene any more.
fn without_scene(folder: &Path, golden: &[GoldenScene]) -> Result<Vec<PathBuf>> {
    let mut stale = Vec::new();
    for entry in fs::read_dir(folder).with_context(|| format!("reading {}", folder.display()))? {
        let path = entry?.path();
        if path.extension().is_some_and(|ending| ending == "txt")
            && !golden.iter().any(|scene| file(folder, scene) == path)
        {
            stale.push(path);
        }
    }
    stale.sort();
    Ok(stale)
}

fn compare_all(chosen: &Chosen, tolerance: Option<f64>, all_bits: bool) -> Result<()> {
    let folder = chosen.folder();
    let golden = scenes::read(&chosen.scenes)?;
    let recorded_on = fs::read_to_string(machine_file(&folder))
        .with_context(|| format!("reading {}; cargo fmu golden record writes it", machine_file(&folder).display()))?;
    let machine = machine::describe();
    let same_machine = recorded_on.trim() == machine;
    let most = tolerance.unwrap_or(TOLERANCE);
    let (mut differing, mut in_bits, mut other_bits) = (Vec::new(), 0, 0);
    let mut largest = (0.0, String::new());
    for scene in &golden {
        let path = file(&folder, scene);
        let text = fs::read_to_string(&path)
            .with_context(|| format!("reading {}; cargo fmu golden record writes it", path.display()))?;
        let recorded = Record::parse(&text).with_context(|| format!("reading {}", path.display()))?;
        let now = run::record(scene)?;
        let mut found = compare(&recorded, &now, Allowed::Nothing);
        other_bits += usize::from(!found.is_none());
        if all_bits || (scene.bits && same_machine && tolerance.is_none()) {
            in_bits += 1;
        } else {
            found = compare(&recorded, &now, Allowed::Relative(most));
        }
        if found.largest.0 > largest.0 {
            largest = (found.largest.0, format!("{} of {}", found.largest.1, scene.name));
        }
        if !found.is_none() {
            differing.push(scene.name.as_str());
            show(scene, &now, &found);
        }
    }
    if !same_machine {
        print_line!("recorded on {}", recorded_on.trim());
        print_line!("now on      {machine}");
    }
    print_line!(
        "{in_bits} compared to the bit, {} with the relative tolerance {most:e}; {other_bits} scenes have other bits",
        golden.len() - in_bits
    );
    if largest.0 > 0.0 {
        print_line!("largest relative difference {:.1e}: {}", largest.0, largest.1);
    }
    if chosen.scenes.is_empty()
        && let Some(stale) = without_scene(&folder, &golden)?.first()
    {
        bail!("{} is the record of no golden scene", stale.display());
    }
    print_line!("{} of {} golden scenes differ", differing.len(), golden.len());
    if !differing.is_empty() {
        bail!("{} of {} golden scenes differ: {}", differing.len(), golden.len(), differing.join(", "));
    }
    Ok(())
}

fn show(scene: &GoldenScene, now: &Record, found: &Differences) {
    print_line!("{}: {}", scene.name, scene.what);
    for text in &found.structure {
        print_line!("  {text}");
    }
    if let Some(first) = &found.first {
        print_line!("  first: {first}");
    }
    if let Some(point) = found.from {
        let before = now.kept.iter().rev().find(|kept| kept.0 <= point);
        let place = before.map_or_else(String::new, |(kept, time)| format!(" (kept before it: {kept} at {time} s)"));
        print_line!("  something differs from communication point {point} of {} on{place}", now.points);
    }
    if !found.between.is_empty() {
        print_line!("  only between the kept communication points: {}", found.between.join(", "));
    }
    for value in &found.work {
        print_line!("  {}: recorded {}, now {}", value.name, value.recorded, value.now);
    }
    if found.count > 0 {
        let (largest, variable) = &found.largest;
        print_line!(
            "  {} of {} series differ, most {variable}: {largest:.1e} of its scale",
            found.count,
            now.series.len()
        );
    }
}
