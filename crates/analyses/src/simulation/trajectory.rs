//! Inputs over time: of a file, or nominal ones; and the communication points.

use anyhow::{Result, anyhow, bail};
use scene::message::{Number, apart, listed};
use scene::variables::{COUNT, Kind, ValueReference, find, lookup, reference};
use scene::{Scene, value};
use scene_file::SceneFile;
use scene_file::columns::Table;
use scene_file::division;
use scene_file::nominal::{self, Conditions, Inputs, MOST_POINTS};
use sliding_contact::component::LARGEST_INPUT;
use std::path::PathBuf;

/// Times of a record that are communication points, at most.
const OBSERVED: usize = 1000;

/// Distance over the whole time between two times that are one.
const SAME_TIME: f64 = 1e-9;

/// Inputs at given times, linear between them.
#[derive(Clone, PartialEq, Debug)]
pub struct Trajectory {
    /// Their description, for the table.
    pub description: String,
    /// The file with the line of every time; `None`: nominal inputs.
    pub file: Option<(PathBuf, Vec<u64>)>,
    /// Times, increasing, s; the same twice where inputs jump.
    pub times: Vec<f64>,
    /// Values of an input at the times.
    pub inputs: Vec<(ValueReference, Vec<f64>)>,
    /// Numbers of the trips into which a column `trip` divides the times, and the times of their first rows, s.
    pub trips: Vec<(f64, f64)>,
    /// Longest communication step, s.
    pub step: f64,
    /// Whether steps are shorter where the inputs need it: not where a step is given.
    pub follows: bool,
    /// Times of a record, which are communication points too, s.
    pub observed: Vec<f64>,
}

impl Trajectory {
    /// The inputs of a table, or nominal ones.
    ///
    /// # Errors
    /// A scene that is refused; as [`Trajectory::of_table`] and [`Trajectory::nominal`].
    pub fn new(file: &SceneFile, inputs: Option<Table>, step: Option<f64>) -> Result<Self> {
        let packaged = &file.packaged;
        let scene = Scene::new(&packaged.starts, Some(packaged.experiment.tolerance))
            .map_err(|broken| anyhow!("the scene {}: {broken}", packaged.name))?;
        match inputs {
            Some(table) => Self::of_table(table, &packaged.starts, step),
            None => Self::nominal(file, &scene, step),
        }
    }

    /// The inputs of a table; an input without a column keeps the scene's start value.
    fn of_table(table: Table, starts: &[f64; COUNT], step: Option<f64>) -> Result<Self> {
        let file = table.path.display();
        if table.times.len() < 2 {
            bail!("{file} has one row; a time interval needs at least two");
        }
        if let [first, .., last] = table.times[..]
            && last <= first
        {
            bail!(
                "{file}, line {}: the last time is {last} s, as the first; a run needs a time interval",
                table.lines[1]
            );
        }
        let has = |name: &str| table.names.iter().any(|own| own == name);
        if !has("sliding_velocity") && !has("angular_velocity") {
            bail!(
                "{file} has neither a column sliding_velocity [m/s] nor angular_velocity [rad/s]; found are {}; --column or columns \
                 names another one, as \"shaft=angular_velocity [rpm]\"",
                listed(table.headers.iter().map(String::as_str))
            );
        }
        if !has("sliding_velocity") && value!(starts, "contact.mean_radius") == 0.0 {
            bail!(
                "{file}: its column angular_velocity turns nothing, as contact.mean_radius = 0 m; set contact.mean_radius, or give a \
                 column sliding_velocity [m/s]"
            );
        }
        let load = value!(starts, "normal_load");
        if !has("normal_load") && load == 0.0 {
            bail!(
                "{file} has no column normal_load [N], and the scene's own start value is {load} N; found are {}; --column or columns \
                 names another one, as \"force=normal_load\"",
                listed(table.headers.iter().map(String::as_str))
            );
        }
        let mut inputs = Vec::new();
        for name in &table.names {
            let (Some(input), Some(values)) = (find(name), table.column(name)) else { continue };
            let values: Vec<f64> = values.collect();
            if let Some(row) = values.iter().position(|value| value.abs() > LARGEST_INPUT) {
                let unit = unit_of(input);
                let [found, limit] = apart([values[row], values[row].signum() * LARGEST_INPUT], unit);
                bail!("{file}, line {}: {name} = {found} is beyond {limit}", table.lines[row]);
            }
            inputs.push((input, values));
        }
        let mut trips: Vec<(f64, f64)> = Vec::new();
        for (trip, time) in table.column("trip").into_iter().flatten().zip(&table.times) {
            if trips.last().is_none_or(|(last, _)| *last != trip) {
                trips.push((trip, *time));
            }
        }
        Ok(Self {
            trips,
            description: format!("{file}, {} rows{}", table.times.len(), left_out(&table.left_out)),
            step: step.unwrap_or_else(|| division::longest(&table.times)),
            follows: step.is_none(),
            file: Some((table.path, table.lines)),
            observed: Vec::new(),
            times: table.times,
            inputs,
        })
    }

    /// The inputs of [`Conditions::inputs`].
    pub(crate) fn nominal(file: &SceneFile, scene: &Scene, step: Option<f64>) -> Result<Self> {
        let conditions = Conditions {
            load: scene.nominal_load,
            velocity: scene.nominal_velocity,
            duration: scene.nominal_duration,
            stroke: scene.nominal_stroke,
        };
        let nominal = conditions.inputs(step.unwrap_or(file.packaged.experiment.step))?;
        let Inputs { description, times, values, step } = nominal;
        let mut inputs: Vec<_> = nominal::NAMES.map(reference).into_iter().zip(values).collect();
        let around = nominal::neighbours(|name| file.packaged.starts[reference(name) as usize]);
        inputs.extend(around.into_iter().map(|(name, ambient)| (reference(name), vec![ambient; times.len()])));
        Ok(Self {
            description,
            file: None,
            times,
            inputs,
            trips: Vec::new(),
            step,
            follows: false,
            observed: Vec::new(),
        })
    }

    /// Takes the times of a record as communication points, of more than [`OBSERVED`] every second, third and so on.
    pub fn observe(&mut self, record: &Table) {
        let (first, last) = self.span();
        let within = record.times.iter().copied().filter(|time| (first..=last).contains(time));
        let within: Vec<f64> = within.collect();
        self.observed = within.iter().copied().step_by(within.len().div_ceil(OBSERVED).max(1)).collect();
    }

    /// First and last time, s.
    pub fn span(&self) -> (f64, f64) {
        (self.times[0], self.times[self.times.len() - 1])
    }

    /// The times `at` (s); one beyond an end by rounding is that end.
    pub(crate) fn within(&self, at: &[f64]) -> Result<Vec<f64>> {
        let (first, last) = self.span();
        let rounding = 1e-12 * first.abs().max(last.abs());
        if let Some(outside) = at.iter().find(|time| !(first - rounding..=last + rounding).contains(*time)) {
            let [outside, first, last] = [*outside, first, last].map(Number);
            bail!("at = {outside} s is outside of the simulated time, {first} s to {last} s");
        }
        Ok(at.iter().map(|time| time.clamp(first, last)).collect())
    }

    /// Communication points: all times, those of `also` and of the record, and between them those of [`division`]: where no step is given they follow the
    /// inputs, else no step is longer than it.
    pub(crate) fn points(&self, also: &[f64]) -> Result<Vec<f64>> {
        let (first, last) = self.span();
        let mut more = also.to_vec();
        more.sort_unstable_by(f64::total_cmp);
        more.dedup();
        more.retain(|time| self.times.binary_search_by(|own| own.total_cmp(time)).is_err());
        let mut instants = [self.times.as_slice(), &more].concat();
        instants.sort_by(f64::total_cmp);
        if self.follows {
            // Of a time that stands twice the first is before the jump.
            let at = |values: &[f64]| {
                let value = |(place, time): (usize, &f64)| {
                    let is_before = instants.get(place + 1) == Some(time);
                    let after = self.times.partition_point(|own| *own < *time);
                    self.at(values, if is_before { after.max(1) } else { self.interval(*time) }, *time)
                };
                instants.iter().enumerate().map(value).collect()
            };
            let inputs: Vec<Vec<f64>> = self.inputs.iter().map(|(_, values)| at(values)).collect();
            let inputs: Vec<&[f64]> = inputs.iter().map(Vec::as_slice).collect();
            return Ok(self.with_observed(division::points(&instants, &inputs)));
        }
        let count = division::count(&instants, self.step);
        if count > MOST_POINTS {
            bail!(
                "{} s in steps of at most {} s are {count:.3e} communication steps; at most {MOST_POINTS:e} are kept",
                Number(last - first),
                Number(self.step)
            );
        }
        Ok(self.with_observed(division::regular(&instants, self.step)))
    }

    /// The points and the times of the record, apart from those that rounding alone tells from a point.
    fn with_observed(&self, points: Vec<f64>) -> Vec<f64> {
        let (first, last) = self.span();
        let same = SAME_TIME * (last - first);
        let is_new = |time: &&f64| {
            let after = points.partition_point(|own| own < *time);
            points[after.saturating_sub(1)..(after + 1).min(points.len())].iter().all(|own| (own - **time).abs() > same)
        };
        let mut all: Vec<f64> = self.observed.iter().filter(is_new).copied().collect();
        all.dedup_by(|later, earlier| *later - *earlier <= same);
        all.extend(points);
        all.sort_unstable_by(f64::total_cmp);
        all
    }

    /// The communication step, s; where steps follow the inputs, the one of the same resolution if all have to be equal.
    pub fn equal_step(&self) -> f64 {
        let inputs: Vec<&[f64]> = self.inputs.iter().map(|(_, values)| values.as_slice()).collect();
        if self.follows { division::equal(&self.times, &inputs) } else { self.step }
    }

    /// Number of times up to `time`, at least 1: the interval after the last of them.
    pub(crate) fn interval(&self, time: f64) -> usize {
        self.times.partition_point(|own| *own <= time).clamp(1, self.times.len() - 1)
    }

    /// Value of the input with these `values` at `time` in an interval of [`Trajectory::interval`].
    pub(crate) fn at(&self, values: &[f64], interval: usize, time: f64) -> f64 {
        let (from, to) = (self.times[interval - 1], self.times[interval]);
        if time == to {
            return values[interval];
        }
        values[interval - 1] + (values[interval] - values[interval - 1]) * ((time - from) / (to - from))
    }

    /// Line of an interval in the file, for messages; empty for nominal inputs.
    pub(crate) fn place(&self, interval: usize) -> String {
        match &self.file {
            Some((path, lines)) => {
                format!(" ({}, lines {} and {})", path.display(), lines[interval - 1], lines[interval])
            }
            None => String::new(),
        }
    }
}

/// Words about columns that are no inputs.
fn left_out(names: &[String]) -> String {
    match names {
        [] => String::new(),
        [only] => format!("; {only} is an output and left out"),
        [first, second] => format!("; {first} and {second} are outputs and left out"),
        [first, rest @ ..] => format!("; {first} and {} other outputs are left out", rest.len()),
    }
}

/// Unit of a variable; `1` of one without.
pub(crate) fn unit_of(variable: ValueReference) -> &'static str {
    match lookup(variable).map(|(row, _)| row.kind) {
        Some(Kind::Real { unit, .. }) => unit.name,
        _ => "1",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp(step: f64) -> Trajectory {
        let inputs = vec![(0, vec![0.0, 4.0, 4.0])];
        Trajectory {
            description: String::new(),
            file: None,
            times: vec![1.0, 3.0, 3.5],
            inputs,
            trips: Vec::new(),
            step,
            follows: false,
            observed: Vec::new(),
        }
    }

    #[test]
    fn rows_and_wanted_times_are_communication_points_and_steps_between_them_are_equal() {
        assert_eq!(ramp(0.5).points(&[]).unwrap(), [1.0, 1.5, 2.0, 2.5, 3.0, 3.5]);
        assert_eq!(ramp(10.0).points(&[1.0, 1.25]).unwrap(), [1.0, 1.25, 3.0, 3.5]);
        for (also, wanted) in [(0.5, "1 s to 3.5 s"), (4.0, "at = 4 s")] {
            let told = ramp(1.0).within(&[also]).unwrap_err().to_string();
            assert!(told.contains(wanted), "{told}");
        }
        assert_eq!(ramp(1.0).within(&[1.0 - 1e-15, 2.0, 3.5 * (1.0 + 1e-15)]).unwrap(), [1.0, 2.0, 3.5]);
        let told = ramp(1e-9).points(&[]).unwrap_err().to_string();
        assert!(told.contains("2.500e9 communication steps"), "{told}");
    }

    #[test]
    fn without_a_step_the_points_follow_the_inputs_and_hold_wanted_times() {
        let ramp = Trajectory { follows: true, ..ramp(0.002) };
        let points = ramp.points(&[1.25]).unwrap();
        assert!(ramp.times.iter().chain(&[1.25]).all(|time| points.contains(time)));
        assert!(points.len() > 1200 && points.windows(2).all(|pair| pair[0] < pair[1] && pair[1] - pair[0] < 0.0021));
        assert_eq!((ramp.equal_step(), self::ramp(0.5).equal_step()), (0.002, 0.5));
    }

    #[test]
    fn inputs_jump_at_a_time_that_stands_twice() {
        let inputs = vec![(0, vec![2.0, 2.0, 6.0, 8.0])];
        let (times, follows) = (vec![0.0, 1.0, 1.0, 2.0], true);
        let jump = Trajectory { times, inputs, follows, ..ramp(1.0) };
        let at = |time: f64| jump.at(&jump.inputs[0].1, jump.interval(time), time);
        assert_eq!([at(0.5), at(1.0), at(1.5)], [2.0, 6.0, 7.0]);
        // The step up to the jump has the values before it.
        assert_eq!(jump.at(&jump.inputs[0].1, jump.interval(0.999), 1.0), 2.0);
        let points = jump.points(&[1.0]).unwrap();
        assert!(points.windows(2).all(|pair| pair[1] > pair[0]) && points.contains(&1.0));
        assert!(jump.equal_step() > 1e-3, "{}", jump.equal_step());
    }

    #[test]
    fn times_of_a_record_are_communication_points_without_a_step() {
        let record = |count: usize| Table {
            path: PathBuf::new(),
            times: (0..count).map(|at| 5.0 * (at as f64 + 0.5) / count as f64).collect(),
            names: Vec::new(),
            values: Vec::new(),
            lines: Vec::new(),
            left_out: Vec::new(),
            headers: Vec::new(),
            notes: Vec::new(),
        };
        let mut observed = ramp(1.0);
        observed.observe(&record(8));
        // From 1 s to 3.5 s.
        assert_eq!(observed.observed, [1.5625, 2.1875, 2.8125, 3.4375]);
        assert!(observed.observed.iter().all(|time| observed.points(&[]).unwrap().contains(time)));
        observed.observe(&record(100_000));
        assert!((500..=OBSERVED).contains(&observed.observed.len()), "{}", observed.observed.len());
    }

    #[test]
    fn inputs_are_linear_between_rows_and_exact_at_them() {
        let ramp = ramp(1.0);
        let at = |time: f64| ramp.at(&ramp.inputs[0].1, ramp.interval(time), time);
        assert_eq!([at(1.0), at(1.5), at(3.0), at(3.25), at(3.5)], [0.0, 1.0, 4.0, 4.0, 4.0]);
    }

    #[test]
    fn rounding_of_nominal_times_divides_no_interval() {
        let file = crate::tests::shipped("reciprocating_punch");
        let mut scene = Scene::new(&file.packaged.starts, None).unwrap();
        // A difference of large times is not exactly the step.
        scene.nominal_duration = 754.0;
        let whole = Trajectory::nominal(&file, &scene, None).unwrap();
        assert_eq!(whole.points(&[]).unwrap(), whole.times);
    }
}
