//! What each error may reach of `solver.tolerance`.
//!
//! Theory: docs/theory.md, section 7.

use scene::Scene;

/// Finest tolerance of a reduction: a few states are not more accurate, and no step requires it.
const FINEST: f64 = 2e-5;

/// Part for the punch's mean temperature at fluxes of every frequency. The strip has an error measure of its own, for all Fourier
/// modes together.
const PUNCH_MEAN: f64 = 0.25;

/// Part that the step errors of temperature and distortion on the line may reach. Where edges of the contact move, the error of
/// the steps falls more slowly than these: it is 0.3 of a tolerance of 1e-2 and 1 of one of 1e-3 where they may reach all of it.
const LINE_HEAT: f64 = 0.5;

/// Multiples for the lumped residuals of the flux and the third difference of the wear rate, which overestimate the errors of the
/// quadrature.
const LUMPED_FLUX: f64 = 2.0;
const LUMPED_WEAR: f64 = 5.0;

/// Remaining errors of iterations: of a stage on the line, with its bounds, of a lumped stage, and of radiation in its common form.
const LINE_STAGE: f64 = 1e-3;
const LINE_STAGE_BOUNDS: [f64; 2] = [1e-9, 1e-6];
const LUMPED_STAGE: f64 = 1e-6;
const LUMPED_RADIATION: f64 = 1e-3;

/// Budget of the tolerance of a scene.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct ToleranceBudget {
    /// Reduction of the bodies, relative to their rise.
    pub reduction: Reductions,
    /// Time steps.
    pub steps: Steps,
    /// Remaining errors of the iterations of a stage.
    pub iteration: Iterations,
}

/// See [`ToleranceBudget::reduction`].
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Reductions {
    tolerance: f64,
}

impl Reductions {
    /// Bodies of the lumped level, and the punch on the line.
    pub fn whole(&self) -> f64 {
        self.tolerance.max(FINEST)
    }

    /// Mean temperature of the punch on the line, where its error counts with `weight`.
    pub fn punch_mean(&self, weight: f64) -> f64 {
        (PUNCH_MEAN * weight * self.tolerance).max(FINEST)
    }

    /// Strip on the line, where its error counts with `weight`.
    pub fn strip(&self, weight: f64) -> f64 {
        (weight * self.tolerance).max(FINEST)
    }
}

/// See [`ToleranceBudget::steps`].
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Steps {
    /// Wear on the line over its displacement scale; cooled faces and flash temperature of the lumped level over the rise.
    pub whole: f64,
    /// Temperature on the line over the rise.
    pub line_heat: f64,
    /// Residual of the flux at the lumped level over the flux scale.
    pub lumped_flux: f64,
    /// Third difference of the wear rate at the lumped level over its scale.
    pub lumped_wear: f64,
}

/// See [`ToleranceBudget::iteration`].
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Iterations {
    /// Stage on the line: pressure over the largest, contact temperature over its absolute value.
    pub line_stage: f64,
    /// Lumped stage, over the rise.
    pub lumped_stage: f64,
    /// Flux by radiation in the common form of the lumped step, over the rise.
    pub lumped_radiation: f64,
}

impl ToleranceBudget {
    /// Budget of `scene`.
    pub fn of(scene: &Scene) -> ToleranceBudget {
        ToleranceBudget::new(scene.tolerance)
    }

    /// Budget of a tolerance.
    pub fn new(tolerance: f64) -> ToleranceBudget {
        let [least, most] = LINE_STAGE_BOUNDS;
        ToleranceBudget {
            reduction: Reductions { tolerance },
            steps: Steps {
                whole: tolerance,
                line_heat: LINE_HEAT * tolerance,
                lumped_flux: LUMPED_FLUX * tolerance,
                lumped_wear: LUMPED_WEAR * tolerance,
            },
            iteration: Iterations {
                line_stage: (LINE_STAGE * tolerance).clamp(least, most),
                lumped_stage: LUMPED_STAGE * tolerance,
                lumped_radiation: LUMPED_RADIATION * tolerance,
            },
        }
    }
}
