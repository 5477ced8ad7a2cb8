//! What each error may reach of `solver.tolerance`.
//!
//! Theory: docs/theory.md, section 7.

use scene::Scene;

/// Finest tolerance of a reduction: a few states are not more accurate, and no step requires it.
const FINEST_REDUCTION: f64 = 2e-5;

/// Budget of the tolerance of a scene.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct ToleranceBudget {
    /// Reduction of the bodies, relative to their rise.
    pub reduction: Reductions,
    /// Time steps.
    pub steps: Steps,
    /// Remaining errors of the iterations of a stage.
    pub iteration: Iterations,
    /// Neglected elastic slip that is not stated, over a nominal stroke.
    pub unstated_slip: f64,
}

/// See [`ToleranceBudget::reduction`].
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Reductions {
    tolerance: f64,
}

impl Reductions {
    /// Bodies of the lumped level.
    pub(crate) fn whole(&self) -> f64 {
        self.tolerance.max(FINEST_REDUCTION)
    }

    /// Punch on the line, where its error counts with `weight`: a quarter, at fluxes of every frequency. The strip has an error measure of
    /// its own, for all Fourier modes together.
    pub(crate) fn punch(&self, weight: f64) -> f64 {
        (0.25 * weight * self.tolerance).max(FINEST_REDUCTION)
    }

    /// Strip on the line, where its error counts with `weight`.
    pub(crate) fn strip(&self, weight: f64) -> f64 {
        (weight * self.tolerance).max(FINEST_REDUCTION)
    }
}

/// See [`ToleranceBudget::steps`].
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Steps {
    /// Wear on the line over its displacement scale, temperature there over the rise; cooled faces and flash temperature of the lumped level
    /// over the rise.
    pub whole: f64,
    /// Residual of the flux at the lumped level over the flux scale. It and the next overestimate the error of the quadrature.
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
    pub(crate) fn of(scene: &Scene) -> ToleranceBudget {
        let tolerance = scene.reduction_share * scene.tolerance;
        ToleranceBudget { reduction: Reductions { tolerance }, ..ToleranceBudget::new(scene.tolerance) }
    }

    /// Budget of a tolerance.
    pub(crate) fn new(tolerance: f64) -> ToleranceBudget {
        ToleranceBudget {
            reduction: Reductions { tolerance },
            steps: Steps { whole: tolerance, lumped_flux: 2.0 * tolerance, lumped_wear: 5.0 * tolerance },
            iteration: Iterations {
                line_stage: (1e-3 * tolerance).clamp(1e-9, 1e-6),
                lumped_stage: 1e-6 * tolerance,
                lumped_radiation: 1e-3 * tolerance,
            },
            unstated_slip: 0.1 * tolerance,
        }
    }
}

/// Gives the companion with the scene of a run twice its tolerance, and a tenth of it for reductions. With the same ones
/// both would share the errors of time steps and reductions, and their difference would not show them. The error of a reduction falls by
/// whole states, so twice its tolerance is often the same one.
pub(crate) fn set_companion(scene: &mut Scene) {
    scene.tolerance *= 2.0;
    scene.reduction_share = 0.1 / 2.0;
}

/// Change of a property up to which its bound is enough: at this `deviation` (K) of the contact from the mean, a tenth of the error that a step
/// is `allowed` (K).
pub(crate) fn enough_of_property(allowed: f64, deviation: f64) -> f64 {
    0.1 * allowed / deviation.max(1e-9)
}
