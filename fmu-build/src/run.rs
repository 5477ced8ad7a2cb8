//! `cargo fmu run`: the FMU of a disc brake through a real drive cycle, driven from fmpy; also the coupled examples, in
//! which the FMU's force decides the speed that is its input, and the reciprocating punch beside its steady states.

mod car;
mod cycle;
mod scene;

use crate::columns::Reading;
use crate::output::{self, Interrupted, print_text};
use crate::{arguments, native, package, project, python, scenes};
use anyhow::{Context, Result, bail};
use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};

/// Run an example: CSV, plots and a table of results.
///
/// Builds the FMU and the Python environment where they are not there yet. The car's road load and the brake's share
/// of it are in examples/disc_brake/road_load.py; the coupled examples are in folders of their own names.
#[derive(clap::Args, Debug)]
pub struct Arguments {
    /// Example to run; without a name the drive cycle of disc_brake alone.
    #[arg(value_enum)]
    example: Option<Example>,
    /// Scene: a name in examples/ or the path of a scene file; the default is the example's own.
    #[arg(long)]
    scene: Option<String>,
    /// Another value of a variable of the scene, as punch.width="80 mm", or of the car of disc_brake and vehicle_brake, as
    /// car.mass="1800 kg", car.front_share=0.65, car.wheel_radius="330 mm"; may be repeated.
    #[arg(short, long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Drive an .fmu that is there already instead of packaging the scene.
    #[arg(long, value_name = "FILE", conflicts_with = "scene")]
    fmu: Option<PathBuf>,
    /// Drive cycle of the brakes: udds (the default), hwfet, us06, wltc_3b or the path of a CSV file with the columns time and
    /// speed, each with its unit in the header: "time [s], speed [km/h]", or time_s, speed_m_per_s; and, if it has trips, the column trip
    /// with their numbers.
    #[arg(long)]
    cycle: Option<String>,
    #[command(flatten)]
    columns: arguments::Columns,
    /// Communication step of disc_brake in seconds [default: 0.1]; the coupled examples choose their own.
    #[arg(long, value_parser = arguments::number, allow_negative_numbers = true)]
    step: Option<f64>,
    /// Folder for CSV and plots; the default is run in cargo's target folder, for the coupled examples a folder in it.
    #[arg(long, short, value_name = "FOLDER")]
    output: Option<PathBuf>,
    /// Print the results as JSON.
    #[arg(long)]
    json: bool,
}

/// The examples.
#[derive(clap::ValueEnum, Clone, Copy, PartialEq, Eq, Debug)]
#[value(rename_all = "snake_case")]
enum Example {
    /// One front brake, its speed and load computed beforehand from a drive cycle; then stops from 100 km/h, one and fifteen,
    /// at the lumped level and on the contact line.
    DiscBrake,
    /// A car on four contacts that decide its speed: a cycle, a descent, stops, a hill; with libcosim too.
    VehicleBrake,
    /// Engine, clutch and vehicle: engagement with stick under explicit and implicit masters, a hill, judder.
    Clutch,
    /// A reciprocating punch until its wear is steady, in two holders, beside the direct steady states; with heat too.
    ReciprocatingPunch,
    /// A pin on a disk after ASTM G99, at three speeds over the same distance: wear, temperatures, heat.
    PinOnDisk,
    /// A ring on a turning ring, below and above the critical speed of thermoelastic instability.
    HotSpots,
    /// Cases from the literature: published solutions beside the model's, by `simulate`.
    Published,
}

impl Example {
    /// Its folder and its scene in examples/.
    fn names(self) -> [&'static str; 2] {
        match self {
            Example::DiscBrake => ["disc_brake"; 2],
            Example::VehicleBrake => ["vehicle_brake", "disc_brake"],
            Example::Clutch => ["clutch"; 2],
            Example::ReciprocatingPunch => ["reciprocating_punch"; 2],
            Example::PinOnDisk => ["pin_on_disk"; 2],
            Example::HotSpots => ["hot_spots"; 2],
            Example::Published => ["published", "published/single_stop"],
        }
    }

    fn folder(self) -> &'static str {
        self.names()[0]
    }

    fn scene(self) -> &'static str {
        self.names()[1]
    }

    /// Where its results go in cargo's target folder.
    fn output(self) -> PathBuf {
        let run = project::target().join("run");
        if self == Example::DiscBrake { run } else { run.join(self.folder()) }
    }
}

/// The cycle and the communication step (s) where none is given.
const CYCLE: &str = "udds";
const STEP: f64 = 0.1;

/// Cells of the reciprocating punch's contact line.
const PUNCH_CELLS: u16 = 65;
/// Its holders: name and changes to the scene. At a pivot 30 mm high mu H is a quarter of the half-width, half of
/// the limit for a steady cycle.
const HOLDERS: [(&str, &[&str]); 2] = [
    ("translate", &["holder.constraint=translate"]),
    ("rotate", &["holder.constraint=translate_and_rotate", "holder.pivot_height=30 mm"]),
];

/// Runs the command.
pub fn execute(arguments: &Arguments) -> Result<()> {
    let example = arguments.example.unwrap_or(Example::DiscBrake);
    check_options(example, arguments)?;
    if example == Example::Published {
        return compare(arguments);
    }
    let mut changed = scenes::load(Some(arguments.scene.as_deref().unwrap_or(example.scene())))?;
    let before = changed.clone();
    let car = car::apply(example, &arguments.set, &mut changed)?;
    match &arguments.fmu {
        None => scene::check_scene(example, &changed.packaged)?,
        Some(file) if changed != before => {
            bail!("--fmu {}: it has its scene; --set changes the car alone", file.display())
        }
        Some(file) if file.is_file() => scene::check_fmu(example, file)?,
        Some(file) => bail!("--fmu {}: there is no such file", file.display()),
    }
    let output = arguments.output.clone().unwrap_or_else(|| example.output());
    let cycle = cycle::file(arguments.cycle.as_deref().unwrap_or(CYCLE), &arguments.columns.reading(), &output)?;
    let (python, fmu) = match &arguments.fmu {
        Some(file) => (python::environment()?, file.clone()),
        None => {
            // Beside the FMU of the scene as it is.
            let file = || output.join(format!("{}.fmu", changed.packaged.name));
            let options = package::Options { output: (changed != before).then(file), ..package::Options::default() };
            python::environment_beside(|| package::build_scene(&changed, &options))?
        }
    };
    let mut command = script(example, &python, &fmu, &output);
    match example {
        Example::DiscBrake => {
            command.arg("--cycle").arg(cycle.path()).arg("--step").arg(arguments.step.unwrap_or(STEP).to_string())
        }
        Example::VehicleBrake => command.arg("--cycle").arg(cycle.path()),
        Example::Clutch | Example::PinOnDisk | Example::HotSpots | Example::Published => &mut command,
        Example::ReciprocatingPunch => {
            let scene = arguments.scene.as_deref().unwrap_or(example.scene());
            command.arg("--steady").args(steady_states(scene, &arguments.set, &output)?)
        }
    };
    command.args(car.iter().flat_map(|property| ["--car", property]));
    if arguments.example == Some(Example::DiscBrake) {
        command.arg("--stops");
    }
    if arguments.json {
        command.arg("--json");
    }
    let status = follow(command).with_context(|| format!("starting {}", python.display()))?;
    // Before this process ends with the status of the script.
    drop(cycle);
    end(status, &output)
}

/// Compares the published cases with the model, which this program simulates.
fn compare(arguments: &Arguments) -> Result<()> {
    if arguments.scene.is_some() || arguments.fmu.is_some() || !arguments.set.is_empty() {
        bail!("--scene, --set and --fmu do not apply to published: every case has a scene of its own");
    }
    let python = python::environment()?;
    let output = arguments.output.clone().unwrap_or_else(|| Example::Published.output());
    let mut command = python::script(&python, "python", "published/drive.py");
    command.arg("--command").arg(project::program()?).arg("--output").arg(&output);
    if arguments.json {
        command.arg("--json");
    }
    let status = follow(command).with_context(|| format!("starting {}", python.display()))?;
    end(status, &output)
}

/// Ends as the script of an example has ended.
fn end(status: ExitStatus, output: &Path) -> Result<()> {
    if project::interrupted(status) {
        let output = output.display();
        bail!(Interrupted(format!(
            "interrupted; {output} has the files that were finished, the same command begins again"
        )));
    }
    if status.success() { Ok(()) } else { project::leave(status, "the example") }
}

/// Runs a script to its end and forwards its output; a closed output pipe does not reach the script.
fn follow(mut command: Command) -> Result<ExitStatus> {
    project::leave_ctrl_c()?;
    let mut child = command.stdout(Stdio::piped()).spawn()?;
    if let Some(out) = child.stdout.take() {
        let mut out = BufReader::new(out);
        let mut line = Vec::new();
        while out.read_until(b'\n', &mut line)? > 0 {
            print_text!("{}", String::from_utf8_lossy(&line));
            line.clear();
        }
    }
    Ok(child.wait()?)
}

fn check_options(example: Example, arguments: &Arguments) -> Result<()> {
    output::check_folder(arguments.output.as_deref())?;
    let name = example.folder();
    let drives_a_cycle = matches!(example, Example::DiscBrake | Example::VehicleBrake);
    if let Some(cycle) = arguments.cycle.as_ref().filter(|_| !drives_a_cycle) {
        bail!("--cycle {cycle} does not apply to {name}: disc_brake and vehicle_brake drive a cycle");
    }
    if let Some(step) = arguments.step {
        if example != Example::DiscBrake {
            bail!("--step {step} does not apply to {name}: disc_brake takes it, the coupled examples choose their own");
        }
        if !(step.is_finite() && step > 0.0) {
            bail!("--step {step} s must be a finite number above 0 s");
        }
    }
    Ok(())
}

/// Writes the punch's direct steady state in every holder as JSON into `folder` and returns the files.
fn steady_states(scene: &str, changes: &[String], folder: &Path) -> Result<Vec<PathBuf>> {
    fs::create_dir_all(folder).with_context(|| format!("creating {}", folder.display()))?;
    let write = |&(name, set): &(&str, &[&str])| {
        let path = folder.join(format!("steady_{name}.json"));
        let cells = PUNCH_CELLS.to_string();
        let changes = changes.iter().map(String::as_str).chain(set.iter().copied());
        let set = changes.flat_map(|assignment| ["--set", assignment]);
        let state = native::printed(
            ["steady", "--json", "--cold", "--cells", &cells].into_iter().chain(set).chain(["--", scene]),
        )?;
        fs::write(&path, state).with_context(|| format!("writing {}", path.display()))?;
        Ok(path)
    };
    HOLDERS.iter().map(write).collect()
}

/// Drives an .fmu through the UDDS without printing anything and returns the recording.
pub(crate) fn record(python: &Path, fmu: &Path, folder: &Path) -> Result<PathBuf> {
    let udds = cycle::file(CYCLE, &Reading::default(), folder)?;
    let mut command = script(Example::DiscBrake, python, fmu, folder);
    command.arg("--one-level").arg("--cycle").arg(udds.path());
    project::printed(&mut command, &python.display().to_string(), "the drive did not finish: ")?;
    Ok(folder.join("udds.csv"))
}

fn script(example: Example, python: &Path, fmu: &Path, output: &Path) -> Command {
    let mut command = python::script(python, "python", &format!("{}/drive.py", example.folder()));
    command.arg("--fmu").arg(fmu).arg("--output").arg(output);
    command
}
