//! Saved state of the component: everything that cannot be rebuilt.

use super::{Component, FIRST_PARAMETER, Phase, Run, TUNABLES, Values, inputs_of, is_as_long, tunables_of};
use model::levels::{Model, ModelState, SavedLine};
use model::lumped::conditions::Tunables;
use model::lumped::state::LumpedState;
use model::plan::distance::Distance;
use model::run_error::{RunError, SavedRunError};
use model::{INPUTS, Inputs};
use scene::message::Number;
use scene::variables::{COUNT, Kind, ValueReference, check_parameter, lookup};

/// Parameters that differ from the start values, inputs with their derivatives, phase and states.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Snapshot {
    changed: Vec<(u16, f64)>,
    inputs: [f64; INPUTS],
    run: Run,
    /// Tunable parameters at initialisation: of those values are the states, and to that friction coefficient the wear law refers.
    built: [f64; TUNABLES.len()],
    state: Option<ModelState>,
    run_error: SavedRunError,
}

impl Component {
    /// Saves the component into `into`, reusing its memory.
    pub fn snapshot(&self, into: &mut Snapshot) {
        into.changed.clear();
        let parts =
            self.values[FIRST_PARAMETER..].chunks(TOGETHER).zip(self.starts[FIRST_PARAMETER..].chunks(TOGETHER));
        for (first, (values, starts)) in (FIRST_PARAMETER..).step_by(TOGETHER).zip(parts) {
            if different_bits(values, starts) != 0 {
                let pairs = (first..).zip(values.iter().zip(starts));
                let changed = pairs.filter(|(_, (value, start))| value.to_bits() != start.to_bits());
                into.changed.extend(changed.map(|(index, (value, _))| (index as u16, *value)));
            }
        }
        into.inputs = inputs_of(&self.values).to_array();
        into.run = self.run.clone();
        if let Some(model) = &self.model
            && let Some(prepared) = &self.prepared
            && self.run.phase == Phase::Running
        {
            into.built = Tunables::of(&prepared.requested).to_array();
            into.state = Some(model.save());
            into.run_error = self.run_error.as_ref().map(RunError::save).unwrap_or_default();
        } else {
            (into.state, into.run_error) = (None, SavedRunError::default());
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
        if let Some(tolerance) = from.run.tolerance.filter(|tolerance| !(*tolerance > 0.0 && tolerance.is_finite())) {
            return Err(format!("the saved state is damaged: its tolerance {tolerance} must be a finite number > 0"));
        }
        values[..INPUTS].copy_from_slice(&from.inputs);
        let same = from.state.is_some()
            && self.run.phase == Phase::Running
            && self.run.tolerance == from.run.tolerance
            && self.prepared.as_ref().is_some_and(|own| Tunables::of(&own.requested).to_array() == from.built)
            && different_bits(&self.values[FIRST_PARAMETER..], &values[FIRST_PARAMETER..]) == 0;
        if let Some(state) = &from.state {
            let tunables = tunables_of(&values);
            let prepared = match &self.prepared {
                Some(prepared) if same => prepared.clone(),
                known => {
                    // The scene at the end of initialisation: tunable parameters may have changed since.
                    let mut at_start = values;
                    for (&index, value) in TUNABLES.iter().zip(from.built) {
                        check_parameter(index as ValueReference, value)
                            .map_err(|refusal| format!("the saved state is damaged: {refusal}"))?;
                        at_start[index] = value;
                    }
                    let scene = self.scene_of(&at_start, from.run.tolerance)?;
                    match known.as_ref().filter(|prepared| prepared.requested == scene) {
                        Some(known) => known.clone(),
                        None => super::prepare(&scene)?,
                    }
                }
            };
            let (mut read, mut beside) = (None, None);
            let companion = RunError::companion(&from.run_error, &prepared, &mut beside);
            let (Some(state), Some(companion)) = (state.of(&prepared.operators, &mut read), companion) else {
                return Err("the saved states do not fit the scene".into());
            };
            prepared
                .operators
                .check_tunables(&tunables)
                .map_err(|refusal| format!("the saved state is damaged: {refusal}"))?;
            // Nothing has been changed up to here, and no later operation can fail.
            if !same {
                let inputs = Inputs::from_array(from.inputs);
                self.model = Some(Model::new(&prepared.operators, tunables, &inputs));
                self.run_error = Some(RunError::new(&prepared, tunables, &inputs));
                self.prepared = Some(prepared);
            }
            let model = self.model.as_mut().expect("set just before, or known to be there");
            model.set_tunables(tunables);
            model.set_state(state);
            if let Some(run_error) = &mut self.run_error {
                run_error.set_tunables(tunables);
                run_error.set(&from.run_error, companion);
            }
        } else {
            (self.model, self.run_error) = (None, None);
        }
        // Outputs are evaluated when they are read; without a model they have their start values.
        if same {
            self.values[..INPUTS].copy_from_slice(&from.inputs);
        } else {
            *self.values = values;
        }
        self.suspect = true;
        self.run = from.run.clone();
        self.sloped = super::is_sloped(&self.run.slopes);
        self.current = 0;
        self.stale = true;
        Ok(())
    }
}

/// Parameters compared at once when a state is saved: few of them differ from the start values.
const TOGETHER: usize = 32;

/// Bits in which any number differs from its partner.
fn different_bits(mine: &[f64], saved: &[f64]) -> u64 {
    mine.iter().zip(saved).fold(0, |bits, (mine, saved)| bits | (mine.to_bits() ^ saved.to_bits()))
}

/// Largest magnitude of a number of a model's state, in its SI unit: what a step makes of it is still finite.
const LARGEST_STATE: f64 = 1e60;

impl Snapshot {
    /// Appends the bytes of the snapshot to `out`.
    pub fn encode(&self, out: &mut Vec<u8>) {
        self.put_numbers(|number| out.extend(number.to_le_bytes()));
    }

    /// Number of bytes that [`Snapshot::encode`] appends.
    pub fn encoded_size(&self) -> usize {
        let mut count = 0;
        self.put_numbers(|_| count += 1);
        8 * count
    }

    fn put_numbers(&self, mut put: impl FnMut(f64)) {
        let Run { slopes, phase, tolerance, reported, at_end, last_step, behind } = &self.run;
        put(f64::from(*phase as u8));
        put(f64::from(*reported));
        put(f64::from(u8::from(*at_end)));
        put(*last_step);
        put(*behind);
        put(tolerance.unwrap_or(f64::NAN));
        put(self.changed.len() as f64);
        for &(index, value) in &self.changed {
            put(f64::from(index));
            put(value);
        }
        self.inputs.iter().chain(slopes).chain(&self.built).for_each(|&number| put(number));
        let SavedRunError { is_beyond, distance, companion } = &self.run_error;
        put(f64::from(u8::from(*is_beyond)));
        put(f64::from(u8::from(distance.is_some())));
        let distance = distance.unwrap_or_default();
        distance.apart.into_iter().chain(distance.largest).for_each(&mut put);
        for state in [&self.state, companion] {
            let Some(ModelState { mean, line }) = state else {
                put(0.0);
                continue;
            };
            put(if line.is_some() { 2.0 } else { 1.0 });
            mean.numbers().into_iter().for_each(&mut put);
            if let Some(line) = line.as_ref().map(SavedLine::numbers) {
                put(line.len() as f64);
                line.iter().copied().for_each(&mut put);
            }
        }
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
        let states = [&snapshot.state, &snapshot.run_error.companion];
        if let Some((name, value)) = states.into_iter().flatten().find_map(|state| state.larger_than(LARGEST_STATE)) {
            return Err(format!(
                "the saved state is damaged or out of range: {name} is {}, its magnitude must be at most {LARGEST_STATE:e}",
                Number(value)
            ));
        }
        Ok(snapshot)
    }

    fn from_numbers(numbers: &mut std::slice::Iter<'_, f64>) -> Option<Snapshot> {
        let mut next = || numbers.next().copied();
        let (phase, reported, at_end, last_step, behind) = (next()?, next()?, next()?, next()?, next()?);
        let (tolerance, count) = (next()?, next()?);
        if !(0.0..=COUNT as f64).contains(&count)
            || !(0.0..=2.0).contains(&phase)
            || !(0.0..256.0).contains(&reported)
            || !is_as_long(last_step + behind, last_step)
        {
            return None;
        }
        let run = Run {
            slopes: [0.0; INPUTS],
            phase: [Phase::Instantiated, Phase::Initializing, Phase::Running][phase as usize],
            tolerance: (!tolerance.is_nan()).then_some(tolerance),
            reported: reported as u8,
            at_end: at_end != 0.0,
            last_step,
            behind,
        };
        let mut snapshot = Snapshot { run, ..Snapshot::default() };
        for _ in 0..count as usize {
            let (index, value) = (next()?, next()?);
            if !(0.0..COUNT as f64).contains(&index) {
                return None;
            }
            snapshot.changed.push((index as u16, value));
        }
        for slot in snapshot.inputs.iter_mut().chain(&mut snapshot.run.slopes).chain(&mut snapshot.built) {
            *slot = next()?;
        }
        snapshot.run_error.is_beyond = next()? != 0.0;
        let is_measured = next()? != 0.0;
        let mut distance = Distance::default();
        for slot in distance.apart.iter_mut().chain(&mut distance.largest) {
            *slot = next().filter(|number| (0.0..=LARGEST_STATE).contains(number))?;
        }
        snapshot.run_error.distance = is_measured.then_some(distance);
        snapshot.state = model_state(numbers)?;
        snapshot.run_error.companion = model_state(numbers)?;
        numbers.next().is_none().then_some(snapshot)
    }
}

/// Reads the state of a model, which may be none; the outer `None`: the numbers are not one.
fn model_state(numbers: &mut std::slice::Iter<'_, f64>) -> Option<Option<ModelState>> {
    let kind = *numbers.next()?;
    if kind == 0.0 {
        return Some(None);
    }
    if ![1.0, 2.0].contains(&kind) {
        return None;
    }
    let mean = LumpedState::from_numbers(numbers)?;
    let mut line = None;
    if kind == 2.0 {
        let count = *numbers.next()?;
        if !(0.0..=numbers.len() as f64).contains(&count) {
            return None;
        }
        line = Some(SavedLine::Numbers(numbers.by_ref().take(count as usize).copied().collect()));
    }
    Some(Some(ModelState { mean, line }))
}
