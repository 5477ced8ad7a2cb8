//! `cargo fmu realtime`: the line level at 1 kHz, every step timed.

mod histogram;

use crate::output::{self, print_line, print_text};
use crate::plot::{Axis, Figure, Panel, Series};
use crate::{arguments, bench, package, project};
use anyhow::{Context, Result, bail, ensure};
use fmu_host::timing::{Component, Instance, Variables};
use histogram::Histogram;
use scene::message::Number;
use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Communication step, s.
const STEP: f64 = 1e-3;
/// No step may take longer, microseconds.
const LONGEST: f64 = 1000.0;
/// Largest factor on the velocity of the drive.
const FASTEST: f64 = 100.0;
/// Runs of the same steps, back to back: the faster one counts, since what interrupts a step only adds time, and seldom the same step twice.
const RUNS: usize = 2;
/// Residual drag load of the pads without resolved heat, N: every step has a contact to solve.
const DRAG: f64 = 100.0;
/// Steps before the timing starts: caches, branch prediction, the clock of the processor.
const WARM_UP: usize = 2000;

/// Step the contact line at 1 kHz through ten minutes of the UDDS, time every step, and print the histogram.
///
/// The scene is the stock front disc brake at the line level. Back to back the steps are made twice: the shorter time of each is its own,
/// the rest was taken by the machine. Cold, its pads never off the disc, 99.9 % of the steps must take less than 100 µs; with heat, brakes on
/// and off, 99.99 % less than 500 µs; none may take more than 1 ms. Paced steps are made once, and only reported.
#[derive(clap::Args, Debug)]
pub struct Arguments {
    /// Bodies that do not expand, or resolved heat with thermal distortion.
    #[arg(long, value_enum, default_value = "cold")]
    contact: Contact,
    /// Cells of the contact line.
    #[arg(long, default_value_t = 33, value_parser = arguments::whole::<u16>(3..=1025), allow_negative_numbers = true)]
    cells: u16,
    /// Simulated time in seconds.
    #[arg(long, default_value_t = 600.0, value_parser = arguments::number, allow_negative_numbers = true)]
    seconds: f64,
    /// Factor on the sliding velocity of the drive, at most 100.
    #[arg(long, default_value_t = 1.0, value_parser = arguments::number, allow_negative_numbers = true)]
    speed: f64,
    /// Wait for the clock's next millisecond before every step, as a real-time host does, instead of stepping back to
    /// back.
    #[arg(long)]
    paced: bool,
    /// Folder for the histogram as CSV and SVG; by default realtime in cargo's target folder.
    #[arg(long, short, value_name = "FOLDER")]
    output: Option<PathBuf>,
    /// Print the results as JSON.
    #[arg(long)]
    json: bool,
}

/// Variant of the contact line.
#[derive(clap::ValueEnum, Clone, Copy, PartialEq, Eq, Debug, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Contact {
    /// Pressure and wear along the line; mean heat.
    Cold,
    /// Pressure, wear and heat along the line, with thermal distortion.
    Heat,
}

impl Contact {
    fn name(self) -> &'static str {
        match self {
            Contact::Cold => "cold",
            Contact::Heat => "heat",
        }
    }

    /// Share of the steps that must take less than a time, and that time, microseconds.
    fn limit(self) -> (f64, f64) {
        match self {
            Contact::Cold => (0.999, 100.0),
            Contact::Heat => (0.9999, 500.0),
        }
    }
}

/// Runs the command.
///
/// # Errors
/// Where the FMU cannot be built or refuses a step, a file cannot be written, or a limit is exceeded that is enforced.
pub fn execute(arguments: &Arguments) -> Result<()> {
    output::check_folder(arguments.output.as_deref())?;
    let Arguments { contact, cells, seconds, speed, paced, .. } = *arguments;
    let run = measure(&Case { contact, cells, seconds, speed, paced })?;
    let folder = arguments.output.clone().unwrap_or_else(|| project::target().join("realtime"));
    fs::create_dir_all(&folder).with_context(|| format!("making the folder {}", folder.display()))?;
    let name = format!("{}{}", run.case.contact.name(), if run.case.paced { "-paced" } else { "" });
    let (csv, svg) = (folder.join(format!("{name}.csv")), folder.join(format!("{name}.svg")));
    fs::write(&csv, run.table()).with_context(|| format!("writing {}", csv.display()))?;
    run.figure().write(&svg)?;
    if arguments.json {
        print_line!("{:#}", run.record());
    } else {
        print_text!("{run}");
        print_line!("  {}\n  {}", csv.display(), svg.display());
    }
    ensure!(run.is_tolerable(), "too slow for real time: {}", run.summary());
    Ok(())
}

#[derive(Clone, Copy, Debug, serde::Serialize)]
pub(crate) struct Case {
    /// Variant of the contact line.
    pub contact: Contact,
    /// Its cells.
    pub cells: u16,
    /// Simulated time, s.
    pub seconds: f64,
    /// Factor on the sliding velocity of the drive, at most 100.
    pub speed: f64,
    /// One step every millisecond of the clock, or back to back.
    pub paced: bool,
}

impl Case {
    /// Ten minutes of the brake, back to back.
    pub(crate) fn new(contact: Contact) -> Self {
        Self { contact, cells: 33, seconds: 600.0, speed: 1.0, paced: false }
    }
}

pub(crate) struct Run {
    case: Case,
    /// Of every step, inputs and outputs included: the shortest of all runs.
    steps: Histogram,
    /// What the longest takes beyond it.
    taken: Histogram,
    /// Of a paced run: how late the steps started.
    late: Option<Histogram>,
}

pub(crate) fn measure(case: &Case) -> Result<Run> {
    let Case { contact, cells, seconds, speed, paced } = *case;
    ensure!(speed > 0.0 && speed <= FASTEST, "--speed {} must be above 0 and at most {FASTEST}", Number(speed));
    let count = (seconds / STEP).round();
    ensure!((1.0..=1e8).contains(&count), "--seconds {} must be from {STEP} to {}", Number(seconds), 1e8 * STEP);
    let count = count as usize;
    let folder = project::target().join("realtime");
    let fmu = build(contact, cells, &folder)?;
    let (library, guid) = bench::unpack(&fmu, &folder)?;
    let component = Component::load(&library, &guid)?;
    let variables = bench::variables()?;

    let drive = bench::drive(STEP)?;
    // All buffers written during a run are allocated and touched before it starts.
    let (mut fastest, mut slowest, mut late) = (vec![u32::MAX; count], vec![0; count], vec![u32::MAX; count]);
    for _ in 0..if paced { 1 } else { RUNS } {
        // What is computed on first use is computed in each run.
        let mut instance = component.instantiate()?;
        instance.initialise()?;
        let least = if contact == Contact::Cold { DRAG } else { 0.0 };
        let loaded = |&[velocity, load]: &[f64; 2]| [speed * velocity, load.max(least)];
        let mut inputs = drive.iter().cycle().map(loaded);
        let mut next = || inputs.next().expect("a drive has steps");
        for _ in 0..WARM_UP.min(count) {
            exchange(&mut instance, &variables, next())?;
        }
        let begin = Instant::now();
        for index in 0..count {
            let pair = next();
            if paced {
                late[index] = nanoseconds(wait(begin + Duration::from_millis(1) * (index as u32 + 1)));
            }
            let start = Instant::now();
            exchange(&mut instance, &variables, pair)?;
            let time = nanoseconds(start.elapsed());
            fastest[index] = time.min(fastest[index]);
            slowest[index] = time.max(slowest[index]);
        }
    }
    slowest.iter_mut().zip(&fastest).for_each(|(slowest, fastest)| *slowest -= fastest);
    Ok(Run {
        case: *case,
        steps: Histogram::of(fastest),
        taken: Histogram::of(slowest),
        late: paced.then(|| Histogram::of(late)),
    })
}

fn build(contact: Contact, cells: u16, folder: &Path) -> Result<PathBuf> {
    let cold = ["solver.heat=mean", "punch.thermal_expansion=0", "strip.thermal_expansion=0"];
    let mut changes = vec!["solver.fidelity=line".to_owned(), format!("solver.cells={cells}")];
    changes.extend(cold.into_iter().filter(|_| contact == Contact::Cold).map(str::to_owned));
    package::build_changed(None, &changes, folder.join(format!("SlidingContact.{}.fmu", contact.name())))
}

fn exchange(instance: &mut Instance<'_>, variables: &Variables, pair: [f64; 2]) -> Result<()> {
    let outputs = instance.exchange(variables, &pair, None, STEP)?;
    if outputs.iter().any(|value| !value.is_finite()) {
        bail!("the outputs are not finite: {outputs:?}");
    }
    Ok(())
}

/// Waits for a point in time and returns how long ago it is: sleeps while there is time for it, then looks at the
/// clock.
fn wait(tick: Instant) -> Duration {
    const BEFORE: Duration = Duration::from_micros(150);
    if let Some(left) = tick.checked_duration_since(Instant::now() + BEFORE) {
        std::thread::sleep(left);
    }
    loop {
        if let Some(late) = Instant::now().checked_duration_since(tick) {
            return late;
        }
        std::hint::spin_loop();
    }
}

fn nanoseconds(time: Duration) -> u32 {
    u32::try_from(time.as_nanos()).unwrap_or(u32::MAX)
}

impl Run {
    /// The limited share of the steps takes no longer, microseconds.
    fn usual(&self) -> f64 {
        self.steps.quantile(self.case.contact.limit().0)
    }

    fn times(&self) -> String {
        format!(
            "median {:.1} µs, {} % below {:.1} µs, longest {:.0} µs",
            self.steps.quantile(0.5),
            Number(100.0 * self.case.contact.limit().0),
            self.usual(),
            self.steps.longest(),
        )
    }

    fn is_within(&self) -> bool {
        self.usual() < self.case.contact.limit().1 && self.steps.longest() < LONGEST
    }

    /// Whether the limits hold, or are not enforced.
    pub(crate) fn is_tolerable(&self) -> bool {
        self.is_within() || self.case.paced
    }

    pub(crate) fn summary(&self) -> String {
        let verdict = if self.is_within() { "within the limits" } else { "beyond the limits" };
        format!(
            "{} steps of the line ({}, N = {}), {}; the machine took up to {:.0} µs: {verdict}",
            self.steps.count(),
            self.case.contact.name(),
            self.case.cells,
            self.times(),
            self.taken.longest()
        )
    }

    /// The histogram: bounds in microseconds, steps, what the machine took.
    fn table(&self) -> String {
        let mut text = String::from("from_us,to_us,steps,taken_by_machine\n");
        for ((from, to, steps), (.., taken)) in self.steps.fine().zip(self.taken.fine()) {
            if steps + taken > 0 {
                text.push_str(&format!("{from:.3},{to:.3},{steps},{taken}\n"));
            }
        }
        text
    }

    fn figure(&self) -> Figure {
        let tail = |name: &str, times: &Histogram| Series::line(name, times.tail());
        let mut series = vec![tail("step", &self.steps), tail("taken by the machine", &self.taken)];
        series.extend(self.late.as_ref().map(|late| tail("late start", late)));
        let lowest = 0.5 / self.steps.count() as f64;
        let (share, usual) = self.case.contact.limit();
        let rest = 1.0 - share;
        series.push(
            Series::line("limits", vec![(usual, 1.0), (usual, rest), (LONGEST, rest), (LONGEST, lowest)]).coloured(6),
        );
        let axis = Axis::logarithmic("time (µs)");
        let share = Axis::logarithmic("share that takes longer").over(lowest, 1.0);
        let panel = Panel::new("How many steps take longer", axis, share, series);
        let how = if self.case.paced { "one every millisecond of the clock" } else { "back to back" };
        let pads = match self.case.contact {
            Contact::Cold => "pads never off the disc",
            Contact::Heat => "brakes on and off",
        };
        let title = format!("Contact line ({}), N = {}, at 1 kHz", self.case.contact.name(), self.case.cells);
        Figure { height: 2.8, ..Figure::new(title, vec![panel]) }.with_header(vec![
            format!(
                "Front disc brake, UDDS at {} times its speed, {pads}, {} steps of 1 ms {how}",
                self.case.speed,
                self.steps.count()
            ),
            format!("{}; taken by the machine: up to {:.0} µs", self.times(), self.taken.longest()),
        ])
    }

    fn record(&self) -> serde_json::Value {
        let times = |times: &Histogram| {
            serde_json::json!({
                "median_us": times.quantile(0.5),
                "p99_us": times.quantile(0.99),
                "p999_us": times.quantile(0.999),
                "p9999_us": times.quantile(0.9999),
                "longest_us": times.longest(),
                "histogram": times.coarse().collect::<Vec<_>>(),
            })
        };
        serde_json::json!({
            "case": self.case,
            "steps": self.steps.count(),
            "step": times(&self.steps),
            "taken_by_machine": times(&self.taken),
            "late_start": self.late.as_ref().map(times),
            "within_limits": self.is_within(),
            "enforced": !self.case.paced,
        })
    }
}

impl fmt::Display for Run {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let late = self.late.as_ref();
        let head = if late.is_some() { "late start" } else { "" };
        writeln!(formatter, "  {:>20} {:>10} {:>18} {head:>11}", "time, us", "steps", "taken by machine")?;
        let late: Vec<u64> = late.map(|late| late.coarse().map(|(.., count)| count).collect()).unwrap_or_default();
        let rows = self.steps.coarse().zip(self.taken.coarse());
        for (at, ((from, to, steps), (.., taken))) in rows.enumerate() {
            let late = late.get(at).map(u64::to_string).unwrap_or_default();
            writeln!(formatter, "  {from:>8} ... {to:>7} {steps:>10} {taken:>18} {late:>11}")?;
        }
        writeln!(formatter, "  {}", self.summary())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(steps: Vec<u32>, taken: u32) -> Run {
        let count = steps.len();
        Run {
            case: Case::new(Contact::Cold),
            steps: Histogram::of(steps),
            taken: Histogram::of(vec![taken; count]),
            late: None,
        }
    }

    #[test]
    fn limits_count_in_steps_back_to_back() {
        let with = |slow: usize, time: u32| {
            let mut steps = vec![5_000; 10_000];
            steps[..slow].fill(time);
            steps
        };
        // One in a thousand may take longer than 100 µs, none longer than 1 ms.
        for (slow, time, within) in
            [(9, 500_000, true), (11, 500_000, false), (1, 1_100_000, false), (11, 99_000, true)]
        {
            let mut run = run(with(slow, time), 250_000);
            assert_eq!((run.is_within(), run.is_tolerable()), (within, within), "{slow} {time}");
            run.case.paced = true;
            assert!(run.is_tolerable(), "{slow} {time}");
        }
        // With heat one in ten thousand may take longer than 500 µs.
        for (slow, time, within) in [(1, 900_000, true), (2, 900_000, false), (9, 400_000, true)] {
            let hot = Run { case: Case::new(Contact::Heat), ..run(with(slow, time), 150_000) };
            assert_eq!(hot.is_within(), within, "{slow} {time}");
        }
    }
}
