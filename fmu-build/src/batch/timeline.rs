//! Inputs, communication steps and recorded points of a scene.

use super::Job;
use super::tables::Inputs;
use anyhow::{Context, Result, bail};
use fmu_host::{Description, Schedule, Span};
use scene_file::division;
use scene_file::nominal::{self, Conditions};

/// Communication step of an FMU that says none, s.
const STEP: f64 = 0.1;

/// Relative excess of a time over a whole number of steps that is rounding.
const SAME_TIME: f64 = 1e-6;

/// Inputs of a scene, and the times of its results.
pub(crate) struct Timeline {
    /// Inputs over time.
    pub inputs: Inputs,
    /// Time, in communication steps.
    pub span: Span,
    /// Times of the communication points that largest values are taken from.
    pub points: Vec<f64>,
}

impl Timeline {
    /// The inputs of the job's file, or the nominal ones of a scene with these `cells` of the design; of the FMU's own scene without any.
    pub(crate) fn new(job: &Job, description: &Description, cells: &[String]) -> Result<Self> {
        let asked = job.step.as_ref().map(super::Text::value).transpose()?;
        if let Some(step) = asked.filter(|step| !(step.is_finite() && *step > 0.0)) {
            bail!("--step {step} s must be a finite number above 0 s");
        }
        let every = job.every.as_ref().map(super::Text::value).transpose()?;
        let (inputs, longest) = match &job.inputs {
            Some(path) => {
                let inputs = Inputs::read(path, description, &job.reading()?)?;
                if inputs.times.len() < 2 {
                    bail!("{} has one row; a time interval needs at least two", path.display());
                }
                let column = |at: usize| inputs.values.iter().skip(at).step_by(inputs.names.len()).copied().collect();
                let columns: Vec<Vec<f64>> = (0..inputs.names.len()).map(column).collect();
                let columns: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
                let longest = division::equal(&inputs.times, &columns);
                (inputs, longest)
            }
            None => nominal(job, description, cells, asked)?,
        };
        let source = inputs.source.clone();
        Schedule::new(&inputs.times, &inputs.values, inputs.names.len())?;
        // Rows are read at communication points, and the last one ends the last step.
        let whole = every.filter(|every| *every > 0.0).unwrap_or(inputs.stop() - inputs.start());
        let fitting = whole / (whole / longest * (1.0 - SAME_TIME)).ceil().max(1.0);
        let step = asked.filter(|_| job.inputs.is_some()).unwrap_or(fitting);
        let span = Span { start: inputs.start(), stop: inputs.stop(), step };
        span.steps().with_context(|| format!("--step {step} s, with the last time of {source} as the stop time"))?;
        let points = points(span, every.unwrap_or(step))?;
        span.indices(&points)
            .with_context(|| format!("--every {} s must be a multiple of --step {step} s", every.unwrap_or(step)))?;
        let points = if job.peak.is_empty() { vec![span.stop] } else { points };
        Ok(Self { inputs, span, points })
    }
}

/// Nominal inputs, with their longest communication step.
fn nominal(job: &Job, description: &Description, cells: &[String], asked: Option<f64>) -> Result<(Inputs, f64)> {
    let value = |name: &str| -> Result<f64> {
        let variable = description.find(name)?;
        let cell = job.columns.iter().zip(cells).find(|(column, _)| *column == name).map(|(_, cell)| cell);
        Ok(variable.parse(cell.unwrap_or(&variable.start))?)
    };
    let conditions = Conditions {
        load: value("nominal.load")?,
        velocity: value("nominal.velocity")?,
        duration: value("nominal.duration")?,
        stroke: value("nominal.stroke")?,
    };
    let step = asked.or_else(|| description.step_size.parse().ok().filter(|step| *step > 0.0)).unwrap_or(STEP);
    let nominal = conditions.inputs(step)?;
    // Those of other FMUs have no neighbours.
    let around = nominal::neighbours(|name| value(name).unwrap_or(0.0));
    let at = |row: usize| nominal.values.iter().map(move |values| values[row]);
    let ambient = || around.iter().map(|(_, ambient)| *ambient);
    let values = (0..nominal.times.len()).flat_map(|row| at(row).chain(ambient())).collect();
    let names =
        nominal::NAMES.iter().chain(around.iter().map(|(name, _)| name)).map(|name| (*name).to_owned()).collect();
    Ok((Inputs { source: nominal.description, names, times: nominal.times, values, notes: Vec::new() }, nominal.step))
}

/// Most communication points that largest values are taken from: their times and values are kept in memory.
const MOST_POINTS: f64 = 1e7;

/// Communication points that largest values are taken from: every so often, and the last.
///
/// # Errors
/// Where the interval is not above 0, or makes more than [`MOST_POINTS`].
pub fn points(span: Span, every: f64) -> Result<Vec<f64>> {
    if !(every.is_finite() && every > 0.0) {
        bail!("--every {every} must be positive");
    }
    let count = ((span.stop - span.start) / every + 1e-9).floor();
    if count.is_nan() || count > MOST_POINTS {
        bail!(
            "--every {every} s makes {count:e} points from {} s to {} s; {MOST_POINTS:e} are the most (without --every it is the \
             --step)",
            span.start,
            span.stop
        );
    }
    let count = count as usize;
    let mut points: Vec<f64> = (0..=count).map(|at| span.start + at as f64 * every).collect();
    if points[count] < span.stop - 1e-9 * every {
        points.push(span.stop);
    }
    Ok(points)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn largest_values_are_taken_to_the_very_end() {
        let span = Span { start: 1.0, stop: 2.0, step: 0.1 };
        let points = |span, every| points(span, every).unwrap();
        assert_eq!(points(span, 0.5), [1.0, 1.5, 2.0]);
        assert_eq!(points(span, 0.4), [1.0, 1.4, 1.8, 2.0]);
        assert_eq!(points(span, 7.0), [1.0, 2.0]);
        assert_eq!(points(span, 0.1).len(), 11);
    }

    #[test]
    fn intervals_that_no_memory_holds_the_points_of_are_refused() {
        let span = Span { start: 0.0, stop: 1e3, step: 1e-9 };
        for every in [1e-9, 1e-300, 5e-324, 0.0, -1.0, f64::NAN] {
            let told = points(span, every).unwrap_err().to_string();
            assert!(told.starts_with(&format!("--every {every} ")), "{told}");
        }
    }
}
