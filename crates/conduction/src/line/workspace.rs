//! Memory of the steps of a body, which belongs to the caller, and steps on their own.
//!
//! Theory: docs/theory.md, section 5.3.

use super::{FACES, Stage, Surroundings, ThermalBody, reduced, strip};

/// Memory for the steps and observations of one body ([`Observed::workspace`](super::Observed::workspace)): what a stage leaves for the next, and
/// intermediate results. Observations and preparations leave the former as it is.
#[derive(Clone, Debug)]
pub struct Workspace(pub(super) Memory);

/// Memory by the kind of body.
#[derive(Clone, Debug)]
pub(super) enum Memory {
    Reduced(Box<reduced::StepMemory>),
    Strip(Box<strip::Scratch>),
    /// Of a body of constants, and two fluxes in its time.
    Scaled(Box<(Workspace, [Vec<f64>; 2])>),
}

/// Reason of the panics below.
const STRANGER: &str = "the workspace was made by a body of another kind";

impl Workspace {
    pub(super) fn reduced(&mut self) -> &mut reduced::StepMemory {
        match &mut self.0 {
            Memory::Reduced(memory) => memory,
            _ => panic!("{STRANGER}"),
        }
    }

    pub(super) fn scaled(&mut self) -> (&mut Workspace, &mut [Vec<f64>; 2]) {
        match &mut self.0 {
            Memory::Scaled(memory) => {
                let (constant, fluxes) = &mut **memory;
                (constant, fluxes)
            }
            _ => panic!("{STRANGER}"),
        }
    }

    pub(super) fn strip(&mut self) -> &mut strip::Scratch {
        match &mut self.0 {
            Memory::Strip(memory) => memory,
            _ => panic!("{STRANGER}"),
        }
    }
}

/// Prepared steps on their own, outside of a simulation: with memory of their own, and without a deviation of the fluxes at the start.
pub trait SingleStep: ThermalBody {
    /// Free response of `stage`: temperature and distortion of the N cells, and mean temperatures of the cooled faces. `known`, W/m2:
    /// in the first stage the deviation at the start, at the end the fluxes of the first stage.
    fn free_response(
        &self,
        state: &[f64],
        surroundings: &Surroundings,
        stage: Stage,
        known: &[f64],
        temperature: &mut [f64],
        distortion: &mut [f64],
    ) -> [f64; FACES] {
        let work = &mut self.workspace();
        if stage == Stage::First {
            return self.first(state, surroundings, known, [temperature, distortion], work).faces;
        }
        let zeros = vec![0.0; known.len()];
        let first = self.first(state, surroundings, &zeros, [&mut *temperature, &mut *distortion], work);
        self.end(first, state, surroundings, known, [temperature, distortion], work).faces
    }

    /// Propagates the state over the step with the fluxes of both stages.
    fn step(&self, state: &mut [f64], surroundings: &Surroundings, first: &[f64], end: &[f64]) {
        let (work, before, zeros) = (&mut self.workspace(), state.to_vec(), vec![0.0; first.len()]);
        let (mut temperature, mut distortion) = (zeros.clone(), zeros.clone());
        let early = self.first(&before, surroundings, &zeros, [&mut temperature, &mut distortion], work);
        let late = self.end(early, &before, surroundings, first, [&mut temperature, &mut distortion], work);
        self.advance(late, (&before, state), surroundings, [first, end], work);
    }
}

impl<B: ThermalBody + ?Sized> SingleStep for B {}
