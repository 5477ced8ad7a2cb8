//! Properties of a body at its own mean temperature.
//!
//! With conductivity K and heat capacity C by volume uniform in the body, and functions of time through its mean temperature, the
//! deviation from the mean obeys `dT/dt = (K/C) T''` with the flux `-K T'` at the faces. It is the problem of the constants K0 and
//! C0 in the body's own time, under a scaled flux:
//!
//! ```text
//! dtau = (kd/kd0) dt,   q' = (K0/K) q,   kd = K/C
//! ```
//!
//! So a reduced body keeps its states and its operators: its decay rates are multiplied by kd/kd0 and the weights of fluxes by K0/K.
//! A prescribed temperature is not scaled, and a heat transfer coefficient H within the states acts as H K/K0. Temperatures are
//! continuous when properties change. The mean itself is an enthalpy: the heat that enters is the exact integral of C.
//!
//! Validity: deviations from the mean over which K and C change little; measured against the nonlinear problem in the section below.
//!
//! Theory: docs/theory.md, section 4.14.

use scene::{Body, PropertyTable};

/// Factors from the constants of a reduced body to its properties at another temperature.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Scales {
    /// K0/K: factor of every flux.
    pub flux: f64,
    /// kd/kd0: factor of every decay rate.
    pub pace: f64,
}

impl Scales {
    /// Those of the constants.
    pub const ONE: Scales = Scales { flux: 1.0, pace: 1.0 };

    /// Factor from heat and flows as the reduced body counts them in its own time to joules: C/C0.
    pub fn capacity(&self) -> f64 {
        1.0 / (self.flux * self.pace)
    }
}

/// Conductivity and heat capacity of a body over its mean temperature, relative to the constants of its reduced model.
#[derive(Clone, PartialEq, Debug)]
pub struct Properties {
    /// The table of the body.
    pub table: PropertyTable,
    /// Conductivity (W/(m K)) and specific heat (J/(kg K)) of the reduced model.
    constants: [f64; 2],
    /// Largest relative change of a property per kelvin, 1/K.
    steepest: f64,
}

impl Properties {
    /// Of a body with a table; `None` for constants, and for an insulator.
    pub fn of(body: &Body) -> Option<Properties> {
        let table = body.properties.filter(|_| body.conductivity > 0.0)?;
        let steepest = (1..table.points).flat_map(|i| {
            let width = table.temperature[i] - table.temperature[i - 1];
            [&table.conductivity, &table.specific_heat]
                .map(|row| (row[i] - row[i - 1]).abs() / (width * row[i].min(row[i - 1])))
        });
        let steepest = steepest.fold(0.0, f64::max);
        Some(Properties { table, constants: [body.conductivity, body.specific_heat], steepest })
    }

    /// Specific heat of the reduced model, J/(kg K).
    pub fn specific_heat(&self) -> f64 {
        self.constants[1]
    }

    /// Factors at the mean temperature `temperature`, K.
    #[inline]
    pub fn at(&self, temperature: f64) -> Scales {
        let [conductivity, specific_heat] = self.table.at(temperature);
        let flux = self.constants[0] / conductivity;
        Scales { flux, pace: self.constants[1] / (specific_heat * flux) }
    }

    /// Larger relative change of conductivity and specific heat between two temperatures, K; its bound by the steepest part of the table
    /// where that is below `enough`.
    pub fn change(&self, [from, to]: [f64; 2], enough: f64) -> f64 {
        let bound = self.steepest * (to - from).abs();
        if bound <= enough {
            return bound;
        }
        let (from, to) = (self.table.at(from), self.table.at(to));
        (0..2).map(|i| (to[i] - from[i]).abs() / from[i].min(to[i])).fold(0.0, f64::max)
    }
}
