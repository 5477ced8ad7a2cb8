//! Saved state of the component: everything that cannot be rebuilt.

use super::{Component, FIRST_PARAMETER, Phase, Values, inputs_of};
use model::INPUTS;
use model::levels::{Model, ModelState};
use model::lumped::state::LumpedState;
use model::plan::course::Course;
use model::plan::distance::LevelDistance;
use scene::message::Number;
use scene::value;
use scene::variables::{COUNT, Kind, check_parameter, lookup};

/// Parameters that differ from the start values, inputs with their derivatives, phase and states.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Snapshot {
    changed: Vec<(u16, f64)>,
    inputs: [f64; INPUTS],
    slopes: [f64; INPUTS],
    phase: u8,
    tolerance: Option<f64>,
    /// Duration of the run, s.
    run_duration: Option<f64>,
    reported: u8,
    at_end: bool,
    last_step: f64,
    /// See [`Course`].
    course: Course,
    /// Tunable parameters (friction coefficient and others) at which the model was built, to which the wear law refers.
    built: [f64; 3],
    state: Option<ModelState>,
    /// State of the lumped level in parallel with a contact line.
    parallel: Option<LumpedState>,
}

impl Component {
    /// Saves the component into `into`, reusing its memory.
    pub fn snapshot(&self, into: &mut Snapshot) {
        into.changed.clear();
        for index in FIRST_PARAMETER..COUNT {
            if self.values[index].to_bits() != self.starts[index].to_bits() {
                into.changed.push((index as u16, self.values[index]));
            }
        }
        into.inputs = inputs_of(&self.values);
        into.slopes = self.slopes;
        into.phase = match self.phase {
            Phase::Instantiated => 0,
            Phase::Initializing => 1,
            Phase::Running => 2,
        };
        (into.tolerance, into.run_duration) = (self.tolerance, self.run_duration);
        into.reported = self.reported;
        into.at_end = self.at_end;
        into.last_step = self.last_step;
        into.course = self.course;
        into.state = None;
        into.parallel = None;
        if let Some(model) = &self.model
            && self.phase == Phase::Running
        {
            let scene = model.scene();
            into.built = [scene.friction_coefficient, scene.ambient_temperature, scene.wear_acceleration];
            into.state = Some(model.save());
            into.parallel = self.parallel.as_ref().and_then(|parallel| parallel.save());
        }
    }

    /// Restores the component to `from`. Operators are rebuilt where fixed parameters differ.
    ///
    /// # Errors
    /// If the saved parameters are no valid scene or the saved states do not fit it.
    pub fn restore(&mut self, from: &Snapshot) -> Result<(), String> {
        let mut values: Values = *self.starts;
        for &(index, value) in &from.changed {
            let slot = values.get_mut(index as usize).filter(|_| index as usize >= FIRST_PARAMETER);
            *slot.ok_or("a saved parameter is unknown")? = value;
            let is_real = lookup(index.into()).is_some_and(|(row, _)| matches!(row.kind, Kind::Real { .. }));
            if !is_real && value.fract() != 0.0 {
                return Err(format!("the saved state is damaged: the parameter of value reference {index} is {value}"));
            }
            check_parameter(index.into(), value).map_err(|refusal| format!("the saved state is damaged: {refusal}"))?;
        }
        if let Some(tolerance) = from.tolerance.filter(|tolerance| !(*tolerance > 0.0 && tolerance.is_finite())) {
            return Err(format!("the saved state is damaged: its tolerance {tolerance} must be a finite number > 0"));
        }
        if let Some(duration) = from.run_duration.filter(|duration| *duration < 0.0) {
            return Err(format!("the saved state is damaged: the duration {duration} s of its run must be >= 0"));
        }
        values[..INPUTS].copy_from_slice(&from.inputs);
        if let Some(state) = &from.state {
            // The scene at the end of initialisation: tunable parameters may have changed since.
            let mut at_start = values;
            value!(at_start, "contact.friction_coefficient") = from.built[0];
            value!(at_start, "ambient_temperature") = from.built[1];
            value!(at_start, "wear_acceleration") = from.built[2];
            let same = self.phase == Phase::Running
                && (self.tolerance, self.run_duration) == (from.tolerance, from.run_duration)
                && self.model.as_ref().is_some_and(|model| {
                    let scene = model.scene();
                    [scene.friction_coefficient, scene.ambient_temperature, scene.wear_acceleration] == from.built
                })
                && self.values[FIRST_PARAMETER..]
                    .iter()
                    .zip(&values[FIRST_PARAMETER..])
                    .all(|(mine, saved)| mine.to_bits() == saved.to_bits());
            let prepared = match &self.prepared {
                Some(prepared) if same => prepared.clone(),
                known => {
                    let scene = self.scene_of(&at_start, from.tolerance, from.run_duration)?;
                    match known.as_ref().filter(|prepared| prepared.requested == scene) {
                        Some(known) => known.clone(),
                        None => super::prepare(&scene)?,
                    }
                }
            };
            let fits = match (&from.parallel, &prepared.lumped) {
                (None, None) => from.course.distance.is_none(),
                (Some(own), Some(operators)) => own.fits(operators.mean()),
                _ => false,
            };
            if !(fits && state.fits(&prepared.operators)) {
                return Err("the saved states do not fit the scene".into());
            }
            // Nothing has been changed up to here, and no later operation can fail.
            if !same {
                let tunables = super::tunables_of(&values);
                self.model = Some(Model::new(&prepared.operators, tunables, &from.inputs));
                self.parallel = prepared.parallel(tunables, &from.inputs).map(Box::new);
                self.planned = prepared.was_compared();
                self.prepared = Some(prepared);
            }
            let model = self.model.as_mut().expect("set just before, or known to be there");
            model.set_tunables(super::tunables_of(&values));
            model.set_state(state);
            if let (Some(parallel), Some(own)) = (&mut self.parallel, &from.parallel) {
                parallel.set_tunables(super::tunables_of(&values));
                parallel.set_state(own.clone());
            }
        } else {
            (self.model, self.parallel) = (None, None);
        }
        // Outputs are evaluated when they are read; without a model they have their start values.
        *self.values = values;
        self.suspect = true;
        self.slopes = from.slopes;
        self.sloped = super::is_sloped(&from.slopes);
        self.phase = match from.phase {
            0 => Phase::Instantiated,
            1 => Phase::Initializing,
            _ => Phase::Running,
        };
        (self.tolerance, self.run_duration) = (from.tolerance, from.run_duration);
        self.reported = from.reported;
        self.at_end = from.at_end;
        self.last_step = from.last_step;
        self.course = from.course;
        self.current = 0;
        self.stale = true;
        Ok(())
    }
}

/// Largest magnitude of a number of a model's state, in its SI unit: what a step makes of it is still finite.
const LARGEST_STATE: f64 = 1e60;

impl Snapshot {
    /// Appends the bytes of the snapshot to `out`.
    pub fn encode(&self, out: &mut Vec<u8>) {
        let mut put = |number: f64| out.extend(number.to_le_bytes());
        put(f64::from(self.phase));
        put(f64::from(self.reported));
        put(f64::from(u8::from(self.at_end)));
        put(self.last_step);
        put(self.course.severity);
        put(self.course.relative_bow);
        put(self.course.growth);
        put(f64::from(u8::from(self.course.is_released)));
        put(self.course.largest_load);
        put(f64::from(u8::from(self.course.distance.is_some())));
        let distance = self.course.distance.unwrap_or_default();
        distance.apart.into_iter().flatten().chain(distance.largest).for_each(&mut put);
        put(self.tolerance.unwrap_or(f64::NAN));
        put(self.run_duration.unwrap_or(f64::NAN));
        put(self.changed.len() as f64);
        for &(index, value) in &self.changed {
            put(f64::from(index));
            put(value);
        }
        self.inputs.iter().chain(&self.slopes).chain(&self.built).for_each(|&number| put(number));
        match &self.state {
            None => put(0.0),
            Some(ModelState::Lumped(mean)) => {
                put(1.0);
                mean.numbers().into_iter().for_each(put);
            }
            Some(ModelState::Line(mean, line)) => {
                put(if self.parallel.is_some() { 3.0 } else { 2.0 });
                self.parallel.iter().flat_map(LumpedState::numbers).for_each(&mut put);
                mean.numbers().into_iter().for_each(&mut put);
                line.iter().copied().for_each(put);
            }
        }
    }

    /// Number of bytes that [`Snapshot::encode`] appends.
    pub fn encoded_size(&self) -> usize {
        let state = match &self.state {
            None => 0,
            Some(ModelState::Lumped(mean)) => mean.numbers().len(),
            Some(ModelState::Line(mean, line)) => mean.numbers().len() + line.len(),
        };
        let parallel = self.parallel.as_ref().map_or(0, |parallel| parallel.numbers().len());
        8 * (22 + parallel + 2 * self.changed.len() + 2 * INPUTS + 3 + 1 + state)
    }

    /// Reads what [`Snapshot::encode`] wrote.
    ///
    /// # Errors
    /// If the bytes are not a snapshot. Further checks follow in [`Component::restore`].
    pub fn decode(bytes: &[u8]) -> Result<Snapshot, String> {
        if !bytes.len().is_multiple_of(8) {
            return Err(format!("{} bytes of saved state are not a whole number of values", bytes.len()));
        }
        let numbers: Vec<f64> =
            bytes.chunks_exact(8).map(|chunk| f64::from_le_bytes(std::array::from_fn(|i| chunk[i]))).collect();
        let snapshot = Snapshot::from_numbers(&mut numbers.iter()).ok_or("the saved state is cut short or damaged")?;
        let parallel = snapshot.parallel.iter().find_map(|parallel| parallel.larger_than(LARGEST_STATE));
        let state = snapshot.state.iter().find_map(|state| state.larger_than(LARGEST_STATE));
        match state.or(parallel) {
            None => Ok(snapshot),
            Some((name, value)) => Err(format!(
                "the saved state is damaged or out of range: {name} is {}, its magnitude must be at most {LARGEST_STATE:e}",
                Number(value)
            )),
        }
    }

    fn from_numbers(numbers: &mut std::slice::Iter<'_, f64>) -> Option<Snapshot> {
        let mut next = || numbers.next().copied();
        let (phase, reported, at_end, last_step) = (next()?, next()?, next()?, next()?);
        let mut course = Course {
            severity: next()?,
            relative_bow: next()?,
            growth: next()?,
            is_released: next()? != 0.0,
            largest_load: next()?,
            ..Course::default()
        };
        let is_followed = next()? != 0.0;
        let mut distance = LevelDistance::default();
        for slot in distance.apart.iter_mut().flatten().chain(&mut distance.largest) {
            *slot = next()?;
            if !(0.0..=LARGEST_STATE).contains(slot) {
                return None;
            }
        }
        course.distance = is_followed.then_some(distance);
        let (tolerance, run_duration, count) = (next()?, next()?, next()?);
        if !(0.0..=COUNT as f64).contains(&count)
            || !(0.0..=2.0).contains(&phase)
            || !(0.0..256.0).contains(&reported)
            || !(0.0..=LARGEST_STATE).contains(&course.largest_load)
            || !(0.0..=f64::INFINITY).contains(&course.severity)
            || !(0.0..=1.0).contains(&course.relative_bow)
            // Infinite where a mode grew that no level contains.
            || !(0.0..=f64::INFINITY).contains(&course.growth)
        {
            return None;
        }
        let mut snapshot = Snapshot {
            phase: phase as u8,
            reported: reported as u8,
            at_end: at_end != 0.0,
            last_step,
            course,
            tolerance: (!tolerance.is_nan()).then_some(tolerance),
            run_duration: (!run_duration.is_nan()).then_some(run_duration),
            ..Snapshot::default()
        };
        for _ in 0..count as usize {
            let (index, value) = (next()?, next()?);
            if !(0.0..COUNT as f64).contains(&index) {
                return None;
            }
            snapshot.changed.push((index as u16, value));
        }
        for slot in snapshot.inputs.iter_mut().chain(&mut snapshot.slopes).chain(&mut snapshot.built) {
            *slot = next()?;
        }
        let kind = next()?;
        match kind {
            0.0 => {}
            1.0 => snapshot.state = Some(ModelState::Lumped(LumpedState::from_numbers(numbers)?)),
            2.0 | 3.0 => {
                if kind == 3.0 {
                    snapshot.parallel = Some(LumpedState::from_numbers(numbers)?);
                }
                let mean = LumpedState::from_numbers(numbers)?;
                snapshot.state = Some(ModelState::Line(mean, numbers.by_ref().copied().collect()));
            }
            _ => return None,
        }
        numbers.next().is_none().then_some(snapshot)
    }
}
