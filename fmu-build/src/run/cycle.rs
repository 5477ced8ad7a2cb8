//! Drive cycles of a car: read by the names of their columns, in any unit, and checked before anything is driven.
//! A column `trip` divides the cycle.

use crate::columns::{self, Column, Reading, Table};
use crate::output::would_replace;
use crate::project;
use anyhow::{Context, Result, bail};
use scene::variables::units::METRE_PER_SECOND;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

/// Highest speed of a road car, m/s: 360 km/h.
const HIGHEST_SPEED: f64 = 100.0;
/// Implausible speed of a cycle, m/s: 252 km/h. The unit may be wrong.
const UNUSUAL_SPEED: f64 = 70.0;
/// Implausible acceleration for tyres, m/s2.
const UNUSUAL_ACCELERATION: f64 = 12.0;

/// A cycle as a file with the columns time_s and speed_m_per_s.
#[derive(Debug)]
pub(crate) struct Cycle {
    path: PathBuf,
    /// Folder of a converted file, which goes with it.
    converted: Option<PathBuf>,
}

impl Cycle {
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }
}

impl Drop for Cycle {
    fn drop(&mut self) {
        if let Some(folder) = &self.converted {
            let _ = fs::remove_dir_all(folder);
        }
    }
}

/// A cycle of the project by its name, or any other by its path, converted from its units for as long as the [`Cycle`] lives.
/// Results have the name of its file, so the converted one has it too, in a folder of its own in cargo's target folder. `reading`: how
/// its columns are read.
pub(crate) fn file(name: &str, reading: &Reading, output: &Path) -> Result<Cycle> {
    let folder = project::root().join("examples/data");
    let own = folder.join(format!("{name}.csv"));
    if own.is_file() {
        read(&own, reading)?;
        return Ok(Cycle { path: own, converted: None });
    }
    let path = Path::new(name);
    if !path.is_file() {
        bail!(
            "--cycle {name} is neither a file nor one of the cycles in {}: udds, hwfet, us06, wltc_3b",
            folder.display()
        );
    }
    let table = read(path, reading)?;
    let result = output.join(path.file_stem().unwrap_or_default()).with_extension("csv");
    if would_replace(&result, path) {
        bail!("--cycle {name}: the results in {} would replace it; name another --output", output.display());
    }
    table.notes.iter().for_each(|note| eprintln!("note: {note}"));
    for text in warnings(&table) {
        eprintln!("warning: {text}");
    }
    let folder = project::target().join("cycle").join(std::process::id().to_string());
    let converted = folder.join(path.file_stem().unwrap_or_default()).with_extension("csv");
    let cycle = Cycle { path: converted, converted: Some(folder.clone()) };
    fs::create_dir_all(&folder)
        .and_then(|()| fs::write(&cycle.path, text(&table)))
        .with_context(|| format!("writing {}", cycle.path.display()))?;
    Ok(cycle)
}

fn read(path: &Path, reading: &Reading) -> Result<Table> {
    let speed = Column { required: true, unit_required: true, ..Column::optional("speed", &METRE_PER_SECOND) };
    let table = columns::read(path, &[speed, Column::trip()], reading)?;
    reading.check(&[&table.headers])?;
    if let Some((trip, line)) =
        table.column("trip").into_iter().flatten().zip(&table.lines).find(|(trip, _)| trip.fract() != 0.0)
    {
        bail!("{}, line {line}: trip {trip} must be a whole number", path.display());
    }
    if table.times.len() < 2 {
        bail!("{}: a cycle needs at least two rows", path.display());
    }
    for (speed, line) in table.column("speed").into_iter().flatten().zip(&table.lines) {
        if !(0.0..=HIGHEST_SPEED).contains(&speed) {
            bail!(
                "{}, line {line}: a speed of {speed} m/s ({:.0} km/h) is none of a road car, whose speeds are from 0 to \
                 {HIGHEST_SPEED} m/s; is the unit in the header right?",
                path.display(),
                3.6 * speed
            );
        }
    }
    Ok(table)
}

/// Warnings about possible but implausible values.
fn warnings(table: &Table) -> Vec<String> {
    let file = table.path.display();
    let mut warnings = Vec::new();
    let speeds: Vec<f64> = table.column("speed").into_iter().flatten().collect();
    if let Some(at) = speeds.iter().position(|&speed| speed > UNUSUAL_SPEED) {
        let (line, speed) = (table.lines[at], speeds[at]);
        warnings.push(format!(
            "{file}, line {line}: {speed} m/s is {:.0} km/h, above {UNUSUAL_SPEED} m/s; is the unit in the header right?",
            3.6 * speed
        ));
    }
    let acceleration = |at: usize| (speeds[at] - speeds[at - 1]) / (table.times[at] - table.times[at - 1]);
    if let Some(at) = (1..table.times.len()).find(|&at| acceleration(at).abs() > UNUSUAL_ACCELERATION) {
        warnings.push(format!(
            "{file}, line {}: the speed changes by {:.3} m/s2, more than the {UNUSUAL_ACCELERATION} m/s2 that tyres give; are \
             the units in the header right?",
            table.lines[at],
            acceleration(at)
        ));
    }
    warnings
}

/// The cycle in SI units, numbers as the shortest texts that are read back as the same.
fn text(table: &Table) -> String {
    let column = |name| table.column(name).map(Iterator::collect::<Vec<f64>>);
    let (speeds, trips) = (column("speed").unwrap_or_default(), column("trip"));
    let mut text = format!("time_s,speed_m_per_s{}\n", if trips.is_some() { ",trip" } else { "" });
    for (row, (time, speed)) in table.times.iter().zip(&speeds).enumerate() {
        let trip = trips.as_ref().map_or_else(String::new, |trips| format!(",{}", trips[row]));
        let _ = writeln!(text, "{time},{speed}{trip}");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cycle(name: &str, text: &str) -> Result<Table> {
        named(name, text, &[])
    }

    fn named(name: &str, text: &str, columns: &[&str]) -> Result<Table> {
        let path = std::env::temp_dir().join(format!("run-cycle-{}-{name}.csv", std::process::id()));
        fs::write(&path, text).unwrap();
        let columns = columns.iter().map(|named| named.parse().unwrap()).collect();
        let result = read(&path, &Reading { columns, ..Reading::default() });
        fs::remove_file(&path).unwrap();
        result
    }

    fn own(name: &str) -> Result<Cycle> {
        file(name, &Reading::default(), Path::new("unused"))
    }

    #[test]
    fn kilometres_per_hour_are_driven_as_such() {
        let driven = cycle("km_per_h", "speed [km/h],time [s]\n0,0\n36,10\n").unwrap();
        assert_eq!(text(&driven), "time_s,speed_m_per_s\n0,0\n10,10\n");
        assert!(warnings(&driven).is_empty());
        let si = text(&driven);
        assert_eq!(text(&cycle("si", &si).unwrap()), si);
    }

    #[test]
    fn semicolons_separate_and_trips_stay() {
        let text_of = |name, own| text(&cycle(name, own).unwrap());
        let expected = "time_s,speed_m_per_s,trip\n0,0,1\n0.5,10,2\n";
        assert_eq!(text_of("semicolons", "# WLTP\ntime [s];trip;speed [km/h]\n0;1;0\n0,5;2;36\n"), expected);
        assert_eq!(text_of("commas", "time [s],speed [km/h],trip\n0,0,1\n0.5,36,2\n"), expected);
        // As rigs write the WLTP brake cycle.
        for header in
            ["Time [s];Linear Speed [km/h];Trip #;Brake Event #", "Time (s);Vehicle speed (km/h);Trip No.;Stop"]
        {
            let file = format!("{header}\n0,0;0,0;1;0\n0,5;36,0;2;1\n");
            assert_eq!(text(&cycle("rig", &file).unwrap()), expected, "{header}");
        }
        assert_eq!(text_of("two", "time [s];speed [km/h]\n0;0\n1;1,8\n"), "time_s,speed_m_per_s\n0,0\n1,0.5\n");
        let german = named("german", "Zeit;v_Ist\n0;0\n0,5;36\n", &["Zeit=time [s]", "v_Ist=speed [km/h]"]).unwrap();
        assert_eq!(text(&german), "time_s,speed_m_per_s\n0,0\n0.5,10\n");
        let missing =
            named("missing", "time_s,speed_m_per_s\n0,0\n1,1\n", &["v=speed [km/h]"]).unwrap_err().to_string();
        assert!(missing.contains("there is no column \"v\""), "{missing}");
        let half = cycle("half", "time [s],speed [km/h],trip\n0,0,1\n1,36,1.5\n").unwrap_err().to_string();
        assert!(half.contains("line 3: trip 1.5 must be a whole number"), "{half}");
    }

    #[test]
    fn a_speed_without_unit_or_of_no_car_is_refused() {
        let told = |name, text| format!("{:#}", cycle(name, text).unwrap_err());
        assert!(told("bare", "time,speed\n0,0\n1,50\n").contains("\"speed\" does not say its unit"));
        let fast = told("fast", "time_s,speed_m_per_s\n0,0\n30,108\n");
        assert!(fast.contains("line 3: a speed of 108 m/s (389 km/h)") && fast.contains("100 m/s"), "{fast}");
        assert!(told("back", "time_s,speed_m_per_s\n0,0\n1,-1\n").contains("a speed of -1 m/s"));
        assert!(told("one", "time_s,speed_m_per_s\n0,0\n").contains("two rows"));
    }

    #[test]
    fn what_is_hardly_meant_is_told() {
        let told = |name, text| warnings(&cycle(name, text).unwrap()).join("; ");
        assert_eq!(told("usual", "time_s,speed_m_per_s\n0,0\n10,70\n"), "");
        assert!(told("high", "time_s,speed_m_per_s\n0,0\n10,71\n").contains("line 3: 71 m/s is 256 km/h"));
        assert!(
            told("jump", "time_s,speed_m_per_s\n0,20\n1,7\n").contains("line 3: the speed changes by -13.000 m/s2")
        );
        for name in ["udds", "hwfet", "us06", "wltc_3b"] {
            let path = own(name).unwrap().path().to_owned();
            assert!(path.is_file() && warnings(&read(&path, &Reading::default()).unwrap()).is_empty(), "{name}");
        }
    }

    #[test]
    fn a_converted_cycle_leaves_nothing_behind() {
        let path = std::env::temp_dir().join(format!("run-cycle-{}-town.csv", std::process::id()));
        fs::write(&path, "time [s],speed [km/h]\n0,0\n10,36\n").unwrap();
        let converted = own(path.to_str().unwrap()).unwrap();
        assert_eq!(fs::read_to_string(converted.path()).unwrap(), "time_s,speed_m_per_s\n0,0\n10,10\n");
        assert_eq!(converted.path().file_stem(), path.file_stem());
        let folder = converted.path().parent().unwrap().to_owned();
        drop(converted);
        assert!(!folder.exists() && path.is_file());
        let told = file(path.to_str().unwrap(), &Reading::default(), path.parent().unwrap()).unwrap_err().to_string();
        assert!(told.contains("would replace it"), "{told}");
        fs::remove_file(&path).unwrap();
        // One of the project is no file of the run's own.
        drop(own("udds").unwrap());
        assert!(own("udds").is_ok());
    }
}
