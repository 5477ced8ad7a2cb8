//! Target `batch`: designs and schedules of inputs as CSV, up to the point where the FMU would be asked.

use std::path::Path;
use std::sync::LazyLock;

use fmu_build::batch::{Inputs, Table, points};
use fmu_build::columns::Reading;
use fmu_host::{Causality, Description, Schedule, Span};
use scene::slot::Packaged;
use scene::variables::TABLE;

use super::random::Random;
use super::text;
use super::watchdog::enter;
use super::{Kinds, Verdict};

static DESCRIPTION: LazyLock<Result<Description, String>> = LazyLock::new(|| {
    let xml = fmu_build::package::model_description(&Packaged::stock(), "");
    Description::parse(&xml).map_err(|failure| failure.reason)
});

/// Designs that are as they should be.
const DESIGNS: [&str; 4] = [
    "# a note\npunch.width, solver.fidelity\n0.1, lumped\n0.2,auto\n",
    "punch.height,contact.faces,contact.shear_coupling,normal_load.factor\n0.012,2,true,1.5\n0.01,1,false,0\n",
    "solver.tolerance,strip.body\n1e-3,elastic\n1e-2,4\n",
    "\"contact.initial_gap[1]\",\"ambient_temperature\"\n0,\"293.15\"\n1e-6,300\n",
];

/// Schedules that are as they should be.
const SCHEDULES: [&str; 4] = [
    "time,normal_load,sliding_velocity [km/h]\n0,1,36\n2.5,3e3,72\n",
    "\u{feff}# a note\ntime [min],normal_load[kN],ambient_temperature_offset\n0,3,0\n1,4,-5\n1.5,4,20\n",
    "time,sliding_velocity,angular_velocity [rev/min],cooling_velocity\n0,0,0,0\n1,1,2,3\n2,-1,-2,3\n",
    "time_s,strip.external_temperature [degC]\n0,20\n10,200\n",
];

static SAMPLES: LazyLock<Vec<String>> =
    LazyLock::new(|| DESIGNS.iter().chain(&SCHEDULES).map(|text| (*text).to_owned()).collect());

fn change(text: &mut String, random: &mut Random) {
    let mut lines: Vec<Vec<String>> = text.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect();
    if lines.is_empty() || random.one_in(3) {
        return text::change(text, &SAMPLES, random);
    }
    let row = random.below(lines.len());
    let column = random.below(lines[row].len());
    match random.below(6) {
        0 | 1 => lines[row][column] = format!("{}", random.any()),
        2 => {
            lines[row][column] =
                (*random.pick(&["", "nan", "inf", "true", "lumped", "1e400", "1,0", "\"", " 7 "])).to_owned()
        }
        3 => {
            let name = random.pick(TABLE).name;
            let unit = random.pick(&["", " [mm]", "[kN]", " [degC]", "_m_per_s", ".factor", ".factor.factor", "[1]"]);
            let at = column.min(lines[0].len() - 1);
            lines[0][at] = format!("{name}{unit}");
        }
        4 => {
            let line = lines[row].clone();
            let at = random.below(lines.len());
            lines.insert(at, line);
        }
        _ => {
            for line in &mut lines {
                let at = column.min(line.len().saturating_sub(1));
                if let Some(cell) = line.get(at).cloned() {
                    line.insert(at, cell);
                }
            }
        }
    }
    *text = lines.iter().map(|line| line.join(",")).collect::<Vec<_>>().join("\n");
}

pub(crate) fn run(seed: u64, kinds: &mut Kinds) -> Verdict {
    let mut random = Random::new(seed, 0);
    let mut texts = [(*random.pick(&DESIGNS)).to_owned(), (*random.pick(&SCHEDULES)).to_owned()];
    for _ in 0..random.below(5) {
        let which = random.below(2);
        change(&mut texts[which], &mut random);
    }
    let [design, schedule] = texts;
    let [step, every] = [(); 2].map(|()| match random.below(4) {
        0 => random.any(),
        1 => random.power(-9.0, 3.0),
        _ => *random.pick(&[0.1, 0.5, 1.0]),
    });
    check(&design, &schedule, step, every, kinds)
}

/// Reads a design and a schedule, and does what `cargo fmu batch` does with them before it starts the FMU.
pub(crate) fn check(design: &str, schedule: &str, step: f64, every: f64, kinds: &mut Kinds) -> Verdict {
    let description = DESCRIPTION.as_ref().map_err(Clone::clone)?;
    let told = |error: anyhow::Error, kinds: &mut Kinds| {
        let text = format!("{error:#}");
        kinds.note(&text);
        if text.contains("fuzz.csv") { Ok(()) } else { Err(format!("a message without the file: {text}")) }
    };
    enter("Table::read");
    let table = match Table::parse(design.as_bytes(), Path::new("fuzz.csv")) {
        Ok(table) => Some(table),
        Err(error) => {
            told(error, kinds)?;
            None
        }
    };
    enter("Inputs::read");
    let inputs = match Inputs::parse(schedule.as_bytes(), Path::new("fuzz.csv"), description, &Reading::strict()) {
        Ok(inputs) => inputs,
        Err(error) => return told(error, kinds),
    };
    let width = inputs.names.len();
    enter("Schedule::new");
    Schedule::new(&inputs.times, &inputs.values, width)
        .map_err(|failure| format!("inputs are accepted, but not as a schedule: {}", failure.reason))?;
    for row in table.iter().flat_map(|table| &table.rows) {
        for (column, cell) in table.iter().flat_map(|table| &table.columns).zip(row) {
            match description.find_as(column, Causality::Parameter).and_then(|variable| variable.parse(cell)) {
                Ok(_) => {}
                Err(failure) if failure.reason.is_empty() => return Err("a failure without a reason".into()),
                Err(failure) => kinds.note(&failure.reason),
            }
        }
    }
    enter("Span::steps");
    let span = Span { start: inputs.start(), stop: inputs.stop(), step };
    if let Err(failure) = span.steps() {
        kinds.note(&failure.reason);
        return Ok(());
    }
    enter("points");
    match points(span, every) {
        Ok(points) => {
            if let Err(failure) = span.indices(&points) {
                kinds.note(&failure.reason);
            }
        }
        Err(error) => kinds.note(&format!("{error:#}")),
    }
    Ok(())
}
