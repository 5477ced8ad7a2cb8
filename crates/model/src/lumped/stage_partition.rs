//! Heat partition of both stages of a lumped step.
//!
//! Theory: docs/theory.md, sections 6.8, 2.4.

use super::stage_body::StageBody;

/// Linear map from the friction heats of both stages to the fluxes and the contact temperatures.
#[derive(Clone, Copy)]
pub(super) struct StageHeatPartition {
    punch_level: [f64; 2],
    strip_level: [f64; 2],
    punch_gain: [[f64; 2]; 2],
    strip_gain: [[f64; 2]; 2],
    inverse: [[f64; 2]; 2],
    half_resistance: f64,
    conducts: (bool, bool),
    pub conductance: f64,
    pub closed: bool,
}

impl StageHeatPartition {
    /// Map for bodies with these responses; `strip_gain` is that of the strip with the moving source.
    pub fn new(
        punch: &StageBody,
        strip: &StageBody,
        strip_gain: &[[f64; 2]; 3],
        conductance: f64,
        closed: bool,
    ) -> Self {
        let punch_gain = [punch.gain(0), punch.gain(2)];
        let strip_gain = [strip_gain[0], strip_gain[2]];
        let half_resistance = if conductance > 0.0 { 0.5 / conductance } else { 0.0 };
        let mut matrix = [[0.0; 2]; 2];
        for i in 0..2 {
            for j in 0..2 {
                let own = if i == j { 2.0 * half_resistance } else { 0.0 };
                matrix[i][j] = if closed {
                    punch_gain[i][j] + strip_gain[i][j] + own
                } else {
                    // Open contact: no exchange, the flux into the punch is half of the heat that a bristle leaves.
                    f64::from(u8::from(i == j))
                };
            }
        }
        let determinant = matrix[0][0] * matrix[1][1] - matrix[0][1] * matrix[1][0];
        let inverse = [
            [matrix[1][1] / determinant, -matrix[0][1] / determinant],
            [-matrix[1][0] / determinant, matrix[0][0] / determinant],
        ];
        StageHeatPartition {
            punch_level: [0.0; 2],
            strip_level: [0.0; 2],
            punch_gain,
            strip_gain,
            inverse,
            half_resistance,
            conducts: (punch.propagator.is_some(), strip.propagator.is_some()),
            conductance,
            closed,
        }
    }

    /// Sets the temperatures without contact flux, which change with the cooling from iteration to iteration.
    pub fn levels(&mut self, punch: &StageBody, strip: &StageBody) {
        self.punch_level = [punch.contact_level(0), punch.contact_level(2)];
        self.strip_level = [strip.contact_level(0), strip.contact_level(2)];
    }

    /// Fluxes into punch and strip at both stages for the friction heats `heat`.
    pub fn fluxes(&self, heat: [f64; 2]) -> [(f64, f64); 2] {
        match self.conducts {
            (true, true) if self.conductance > 0.0 => {
                let mut right = [0.0; 2];
                for i in 0..2 {
                    right[i] = if self.closed {
                        self.strip_level[i] - self.punch_level[i]
                            + self.strip_gain[i][0] * heat[0]
                            + self.strip_gain[i][1] * heat[1]
                            + self.half_resistance * heat[i]
                    } else {
                        0.5 * heat[i]
                    };
                }
                [0, 1].map(|i| {
                    let into_punch = self.inverse[i][0] * right[0] + self.inverse[i][1] * right[1];
                    (into_punch, heat[i] - into_punch)
                })
            }
            (true, true) => heat.map(|heat| (0.5 * heat, 0.5 * heat)),
            (true, false) => heat.map(|heat| (heat, 0.0)),
            (false, true) => heat.map(|heat| (0.0, heat)),
            (false, false) => [(0.0, 0.0); 2],
        }
    }

    /// Change of the fluxes into the punch at both stages per temperature of the strip above the punch, W/(m2 K); `None` where the
    /// bodies do not exchange heat.
    pub fn exchange(&self) -> Option<[[f64; 2]; 2]> {
        (self.conducts == (true, true) && self.conductance > 0.0 && self.closed).then_some(self.inverse)
    }

    /// Contact temperatures at both stages, K above the reference.
    pub fn temperatures(&self, fluxes: &[(f64, f64); 2]) -> [f64; 2] {
        [0, 1].map(|i| {
            let [punch, strip] = self.surfaces(i, fluxes);
            0.5 * (punch + strip)
        })
    }

    /// Temperatures of punch and strip at a stage, K above the reference.
    pub fn surfaces(&self, i: usize, fluxes: &[(f64, f64); 2]) -> [f64; 2] {
        let punch = self.punch_level[i] + self.punch_gain[i][0] * fluxes[0].0 + self.punch_gain[i][1] * fluxes[1].0;
        let strip = self.strip_level[i] + self.strip_gain[i][0] * fluxes[0].1 + self.strip_gain[i][1] * fluxes[1].1;
        self.beside_insulator([punch, strip], fluxes[i])
    }

    /// Surface temperature of an insulator: that of the other surface and the jump across the contact resistance.
    pub fn beside_insulator(&self, [punch, strip]: [f64; 2], into: (f64, f64)) -> [f64; 2] {
        match self.conducts {
            (true, false) => [punch, punch + self.half_resistance * into.0],
            (false, true) => [strip + self.half_resistance * into.1, strip],
            _ => [punch, strip],
        }
    }
}
