//! The reference solution of a scene: exact, computed now within a limit of time, or stored from a longer computation.

use super::machine;
use crate::output::print_line;
use crate::project;
use ::scene::variables::{FLAT, TABLE};
use anyhow::{Context, Result, anyhow, bail};
use std::fmt::Write as _;
use std::fs;
use std::path::PathBuf;
use verification::clock::process_seconds;
use verification::drives::{DriveProblem, Sample, Truth};

fn path(problem: &DriveProblem) -> PathBuf {
    project::root().join("docs/accuracy/truth").join(format!("{}.csv", problem.name))
}

/// Fingerprint (FNV-1a) of everything that the reference depends on: names and values of the start values other than 0, so that a new
/// variable which changes nothing does not count, times and inputs at them.
fn fingerprint(problem: &DriveProblem) -> u64 {
    let inputs = problem.samples.iter().flat_map(|&time| {
        let [velocity, load] = (problem.inputs)(time);
        [time, velocity, load]
    });
    let starts = FLAT.iter().zip(&problem.starts).filter(|(_, start)| **start != 0.0);
    let starts = starts.flat_map(|(&(row, element), start)| {
        let name = TABLE[usize::from(row)].element_name(u32::from(element));
        name.into_bytes().into_iter().chain(start.to_le_bytes())
    });
    ::scene::fnv::Fnv::of(starts.chain(inputs.flat_map(f64::to_le_bytes))).0
}

/// Samples of the reference and its origin: the stored one if it belongs to this scene, otherwise computed within `budget` s.
pub(crate) fn of(problem: &DriveProblem, budget: f64) -> Result<(String, Vec<Sample>)> {
    if matches!(problem.truth, Truth::Finest(_))
        && let Ok(text) = fs::read_to_string(path(problem))
        && let Some(known) = read(&text, problem).with_context(|| format!("reading {}", path(problem).display()))?
    {
        return Ok(known);
    }
    problem.truth(&mut |setting| problem.run(setting, &process_seconds, budget)).map_err(|text| anyhow!(text))
}

/// Computes the reference without a limit of time and stores it.
pub(crate) fn write(problem: &DriveProblem) -> Result<()> {
    if matches!(problem.truth, Truth::Exact { .. }) {
        print_line!("{}: exact, nothing to keep", problem.name);
        return Ok(());
    }
    let begin = process_seconds();
    let found = problem.truth(&mut |setting| problem.run(setting, &process_seconds, f64::INFINITY));
    let (how, samples) = found.map_err(|text| anyhow!(text))?;
    let seconds = process_seconds() - begin;
    let mut text = format!(
        "# {how}\n# written by cargo fmu chart --write-truth at commit {} in {seconds:.0} s\n# scene {:016x}\n\
         time_s,wear_depth_m,contact_temperature_K,friction_force_N,peak_pressure_Pa\n",
        machine::commit(),
        fingerprint(problem)
    );
    for (time, [wear, temperature, force, pressure]) in problem.samples.iter().zip(&samples) {
        let _ = writeln!(text, "{time:.6},{wear:.12e},{temperature:.12e},{force:.12e},{pressure:.12e}");
    }
    let path = path(problem);
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)?;
    }
    fs::write(&path, text).with_context(|| format!("writing {}", path.display()))?;
    print_line!("{}: {how}\n  {}", problem.name, path.display());
    Ok(())
}

/// Contents of a stored file; `None` where it belongs to another scene.
fn read(text: &str, problem: &DriveProblem) -> Result<Option<(String, Vec<Sample>)>> {
    let mut lines = text.lines();
    let mut line = || lines.next().context("the file is cut off");
    let how = line()?.trim_start_matches("# ").to_owned();
    let written = line()?.trim_start_matches("# written by ").to_owned();
    if line()? != format!("# scene {:016x}", fingerprint(problem)) {
        return Ok(None);
    }
    line()?;
    let samples: Vec<Sample> = lines
        .map(|line| {
            let numbers: Vec<f64> = line.split(',').skip(1).map(str::parse).collect::<Result<_, _>>()?;
            <Sample>::try_from(numbers).map_err(|numbers| anyhow!("{} numbers in {line}", numbers.len()))
        })
        .collect::<Result<_>>()?;
    if samples.len() != problem.samples.len() {
        bail!("{} samples, the scene has {}", samples.len(), problem.samples.len());
    }
    Ok(Some((format!("{how} (kept: {written})"), samples)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use verification::drives::problems;

    #[test]
    fn a_kept_truth_is_read_back_for_its_own_scene_only() {
        let mut all = problems().unwrap();
        let mut problem = all.swap_remove(1);
        let rows: String = problem.samples.iter().map(|time| format!("{time},1.5,NaN,-3e2,4\n")).collect();
        let head = format!("# the finest run\n# written by hand\n# scene {:016x}\ntime\n", fingerprint(&problem));
        let (how, samples) = read(&format!("{head}{rows}"), &problem).unwrap().unwrap();
        assert_eq!(how, "the finest run (kept: hand)");
        assert!(samples[3][1].is_nan() && samples[3][0] == 1.5 && samples[3][2] == -300.0);
        assert!(read(&format!("{head}1,2,3\n"), &problem).is_err());
        assert!(read(&head, &problem).is_err());
        problem.starts[100] += 1.0;
        assert!(read(&format!("{head}{rows}"), &problem).unwrap().is_none());
    }
}
