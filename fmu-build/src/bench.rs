//! `cargo fmu bench`: cost of a call compared with a component written by hand in C, both timed in the same run.
//!
//! One thread; both libraries are loaded into this process and called through the same function pointers. Steps of
//! both are timed in turns, so that disturbances by the machine affect both, and the fastest turn counts, because
//! disturbances only add time.

use crate::output::print_line;
use crate::{package, project, scenes};
use anyhow::{Context, Result, bail};
use fmu_file::archive;
use fmu_host::timing::{Component, Instance, Variables};
use std::ffi::OsString;
use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

/// Communication step, s.
pub const STEP: f64 = 0.1;
/// Turns of every timing.
pub const TURNS: usize = 30;
/// Factor by which a time may exceed its limit before a test fails, to allow for other work on the machine. The ratio to
/// the peer, measured under the same load, has no allowance.
const ALLOWANCE: f64 = 3.0;

/// Time the FMU's calls natively, beside a plain C lumped brake (benches/peers/lumped_brake.c).
#[derive(clap::Args, Debug)]
pub struct Arguments {
    /// Scene to time: a name in examples/ or the path of a scene file; by default the stock scene, whose constant
    /// coefficients are those of the C peer.
    scene: Option<String>,
    /// Time wear steps of the contact line instead, in solutions of one dense system of as many unknowns.
    #[arg(long, conflicts_with = "scene")]
    line: bool,
    /// Print the results as JSON.
    #[arg(long)]
    json: bool,
}

/// One measured cost.
#[derive(Clone, Copy, serde::Serialize, Debug)]
pub struct Cost {
    /// Measured quantity.
    pub quantity: &'static str,
    /// Its value.
    pub value: f64,
    /// Its unit.
    pub unit: &'static str,
    /// The same of the C peer, where it does the same.
    pub peer: Option<f64>,
    /// The most it should be on a quiet core.
    pub limit: f64,
    /// Whether exceeding the limit is a failure; otherwise the limit is a target that the value is shown beside.
    pub gated: bool,
}

impl Cost {
    /// Whether it is within its limit, times an allowance for a busy machine where it is a time.
    pub(crate) fn is_tolerable(&self) -> bool {
        let allowance = if matches!(self.unit, "1" | "byte") { 1.0 } else { ALLOWANCE };
        !self.gated || self.value <= allowance * self.limit
    }
}

impl fmt::Display for Cost {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let peer = self.peer.map_or(String::new(), |peer| format!("  (C peer {peer:.3})"));
        let Cost { quantity, value, unit, limit, gated, .. } = self;
        let kind = if *gated { "limit" } else { "target" };
        let unit = if *unit == "1" { "" } else { unit };
        write!(formatter, "{quantity:48} {value:10.3} {unit:4} {kind:6} {limit:7} {unit:4}{peer}")
    }
}

/// The FMU of a scene at the lumped level, for comparison with a plain C lumped brake.
pub(crate) fn lumped(scene: Option<&str>) -> Result<PathBuf> {
    let mut scene = scenes::load(scene)?;
    scenes::assign(&mut scene, "solver.fidelity=lumped")?;
    let output = Some(project::target().join("bench").join(format!("{}.fmu", scene.packaged.name)));
    package::build_scene(&scene, &package::Options { output, ..package::Options::default() })
}

/// Runs the command.
///
/// # Errors
/// Where something cannot be built or loaded, or a cost exceeds its limit with the allowance.
pub fn execute(arguments: &Arguments) -> Result<()> {
    if arguments.line {
        let json = arguments.json.then_some("--json");
        let all: Vec<OsString> = ["bench", "--line"].into_iter().chain(json).map(OsString::from).collect();
        return crate::native::forward(&all);
    }
    report(&measure(&lumped(arguments.scene.as_deref())?)?, arguments.json)
}

/// Prints costs.
pub fn report(costs: &[Cost], json: bool) -> Result<()> {
    if json {
        print_line!("{}", serde_json::to_string_pretty(costs)?);
    } else {
        costs.iter().for_each(|cost| print_line!("{cost}"));
    }
    match costs.iter().find(|cost| !cost.is_tolerable()) {
        Some(cost) => bail!("too slow or too large: {cost}"),
        None => Ok(()),
    }
}

pub(crate) fn measure(fmu: &Path) -> Result<Vec<Cost>> {
    let folder = project::target().join("bench");
    fs::create_dir_all(&folder)?;
    let (library, guid) = unpack(fmu, &folder)?;
    let own = Component::load(&library, &guid)?;
    let peer = Component::load(&compile_peer(&folder)?, "")?;
    let own_variables = variables()?;
    let peer_variables = Variables { inputs: [0, 1], outputs: [2, 3, 4] };
    let drive = Drive::udds()?;
    let sloped = Drive { slopes: Some(drive.speed_slopes()), ..drive.clone() };
    // One long braking at constant inputs, and a drive whose inputs change at every step; each from cold.
    let steady = Drive { inputs: vec![[9.0, 2000.0]; drive.inputs.len()], slopes: None };

    let mut own_instance = own.instantiate()?;
    own_instance.initialise()?;
    let mut peer_instance = peer.instantiate()?;
    peer_instance.initialise()?;
    let mut own_times = [(); 3].map(|()| Fastest::default());
    let mut peer_times = [(); 2].map(|()| Fastest::default());
    for _ in 0..TURNS {
        for (drive, times) in [&steady, &drive, &sloped].into_iter().zip(&mut own_times) {
            own_instance.reset()?;
            own_instance.initialise()?;
            times.turn(&mut own_instance, &own_variables, drive)?;
        }
        for (drive, times) in [&steady, &drive].into_iter().zip(&mut peer_times) {
            peer_instance.reset()?;
            peer_instance.initialise()?;
            times.turn(&mut peer_instance, &peer_variables, drive)?;
        }
    }
    let [own_step, own_drive, own_sloped] = own_times.map(|times| times.seconds());
    let [peer_step, peer_drive] = peer_times.map(|times| times.seconds());

    let life = |component: &Component| fastest(1, || component.instantiate()?.initialise());
    let (own_life, peer_life) = (life(&own)?, life(&peer)?);
    let own_reset = fastest(50, || own_instance.reset().and_then(|()| own_instance.initialise()))?;
    let peer_reset = fastest(50, || peer_instance.reset().and_then(|()| peer_instance.initialise()))?;
    Fastest::default().turn(&mut own_instance, &own_variables, &drive)?;
    let mut state = own_instance.state()?;
    let kept = fastest(1000, || state.update().and_then(|()| state.restore()))?;
    let size = state.size()?;

    let cost = |quantity, value, unit, peer, limit| Cost { quantity, value, unit, peer, limit, gated: true };
    let shown = |quantity, value, unit, peer, limit| Cost { quantity, value, unit, peer, limit, gated: false };
    Ok(vec![
        cost("set 2 inputs, step, get 3 outputs", 1e9 * own_step, "ns", Some(1e9 * peer_step), 200.0),
        cost("the same over that of the C peer", own_step / peer_step, "1", None, 12.0),
        cost("the same, inputs changing at every step", 1e9 * own_drive, "ns", Some(1e9 * peer_drive), 200.0),
        cost("the same over that of the C peer", own_drive / peer_drive, "1", None, 12.0),
        shown("the same, and the derivative of the velocity", 1e9 * own_sloped, "ns", None, 600.0),
        shown("the same over held inputs", own_sloped / own_drive, "1", None, 4.0),
        cost("instantiate, initialise, free", 1e3 * own_life, "ms", Some(1e3 * peer_life), 2.0),
        cost("reset, initialise (geometry unchanged)", 1e3 * own_reset, "ms", Some(1e3 * peer_reset), 0.3),
        cost("get and set the state", 1e6 * kept, "us", None, 2.0),
        cost("size of the serialised state", size as f64, "byte", None, 2048.0),
    ])
}

/// Inputs of an instance, step by step.
#[derive(Clone, Debug)]
pub(crate) struct Drive {
    /// Sliding velocity, m/s, and load, N.
    pub inputs: Vec<[f64; 2]>,
    /// Their derivatives by time, where they do not stay as they are during a step.
    pub slopes: Option<Vec<[f64; 2]>>,
}

/// Variables of this project's FMU that are exchanged in a step.
pub(crate) fn variables() -> Result<Variables> {
    let reference = |name| scene::variables::find(name).with_context(|| format!("no variable {name}"));
    Ok(Variables {
        inputs: [reference("sliding_velocity")?, reference("normal_load")?],
        outputs: [reference("wear_depth")?, reference("contact_temperature")?, reference("friction_force")?],
    })
}

/// Exchanges timed together: few, so that other work on the machine seldom falls between.
const CHUNK: usize = 100;

/// The fastest times of every chunk of exchanges, s.
#[derive(Default)]
struct Fastest {
    chunks: Vec<f64>,
    exchanges: usize,
}

impl Fastest {
    /// Drives an instance once.
    fn turn(&mut self, instance: &mut Instance<'_>, variables: &Variables, drive: &Drive) -> Result<()> {
        let mut outputs = [0.0; 3];
        self.exchanges = drive.inputs.len();
        self.chunks.resize(self.exchanges.div_ceil(CHUNK), f64::INFINITY);
        for (number, (inputs, fastest)) in drive.inputs.chunks(CHUNK).zip(&mut self.chunks).enumerate() {
            let slopes = drive.slopes.as_deref().map(|slopes| &slopes[CHUNK * number..][..inputs.len()]);
            let begin = Instant::now();
            outputs = instance.exchanges(variables, inputs, slopes, STEP)?;
            *fastest = fastest.min(begin.elapsed().as_secs_f64());
        }
        if outputs.iter().any(|value| !value.is_finite()) {
            bail!("the outputs are not finite: {outputs:?}");
        }
        Ok(())
    }

    /// Seconds per exchange.
    fn seconds(&self) -> f64 {
        self.chunks.iter().sum::<f64>() / self.exchanges as f64
    }
}

/// Fastest of `calls` calls per turn, in seconds.
fn fastest(calls: usize, mut call: impl FnMut() -> Result<()>) -> Result<f64> {
    let mut best = f64::INFINITY;
    for _ in 0..TURNS {
        let begin = Instant::now();
        for _ in 0..calls {
            call()?;
        }
        best = best.min(begin.elapsed().as_secs_f64() / calls as f64);
    }
    Ok(best)
}

/// Sliding velocity and load of a brake over the UDDS, one pair per communication step of `step` s. The load here is 2 kN for every 1 m/s2 of
/// deceleration: what matters is that both change as they do in a drive.
pub fn drive(step: f64) -> Result<Vec<[f64; 2]>> {
    let path = project::root().join("examples/data/udds.csv");
    let text = fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    let speeds: Vec<f64> = text
        .lines()
        .skip(1)
        .map(|line| line.split_once(',').and_then(|(_, speed)| speed.trim().parse().ok()))
        .collect::<Option<_>>()
        .with_context(|| format!("{} has a row without a speed", path.display()))?;
    let steps_per_second = (1.0 / step).round() as usize;
    let mut inputs = Vec::with_capacity(speeds.len() * steps_per_second);
    for pair in speeds.windows(2) {
        let acceleration = pair[1] - pair[0];
        for at in 0..steps_per_second {
            let speed = pair[0] + acceleration * at as f64 * step;
            inputs.push([speed * 0.1175 / 0.31, 2000.0 * (-acceleration).max(0.0)]);
        }
    }
    Ok(inputs)
}

impl Drive {
    /// A brake over the UDDS, its inputs held during a step; see [`drive`].
    pub(crate) fn udds() -> Result<Self> {
        Ok(Self { inputs: drive(STEP)?, slopes: None })
    }

    /// Derivatives with which the velocity goes straight from one step to the next; the load stays.
    fn speed_slopes(&self) -> Vec<[f64; 2]> {
        let next = self.inputs.iter().skip(1).chain(self.inputs.last());
        self.inputs.iter().zip(next).map(|(now, next)| [(next[0] - now[0]) / STEP, 0.0]).collect()
    }
}

/// Takes library and GUID out of an .fmu.
pub(crate) fn unpack(fmu: &Path, folder: &Path) -> Result<(PathBuf, String)> {
    let library = archive::entry(fmu, "binaries/linux64/SlidingContact.so")?;
    let path = folder.join("SlidingContact.so");
    // Put in place as a whole: a run that has loaded the one before keeps it.
    let partial = folder.join(format!("SlidingContact.so.{}", std::process::id()));
    fs::write(&partial, library)
        .and_then(|()| fs::rename(&partial, &path))
        .with_context(|| format!("writing {}", path.display()))?;
    let description = String::from_utf8(archive::entry(fmu, "modelDescription.xml")?)?;
    let guid = description
        .split_once("guid=\"")
        .and_then(|(_, rest)| rest.split_once('"'))
        .with_context(|| format!("{} has no GUID", fmu.display()))?
        .0;
    Ok((path, guid.to_owned()))
}

/// Builds the peer with the system's C compiler.
fn compile_peer(folder: &Path) -> Result<PathBuf> {
    let source = project::root().join("benches/peers/lumped_brake.c");
    let library = folder.join("lumped_brake.so");
    let mut compiler = Command::new("cc");
    compiler
        .args(["-O3", "-std=c99", "-shared", "-fPIC", "-fvisibility=hidden", "-o"])
        .arg(&library)
        .arg(&source)
        .arg("-lm");
    project::printed(&mut compiler, "the C compiler cc", &format!("{} does not compile:\n", source.display()))?;
    Ok(library)
}
