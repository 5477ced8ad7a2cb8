//! Inputs. Every optional one is neutral at 0, because importers ground open ports.
//!
//! Theory: docs/theory.md, section 1.3.

use super::super::units::*;
use super::{Kind, Row, real};

const fn load() -> Row {
    let row = real(
        "normal_load",
        &NEWTON,
        1e3,
        "Normal load per face; below zero counts as 0: contact open, the crossing located, logged once per run",
    )
    .input()
    .shown("kN");
    match row.kind {
        // The bound is informative: values below it are accepted and mean an open contact.
        Kind::Real { unit, display, nominal, .. } => {
            Row { kind: Kind::Real { unit, display, min: Some(0.0), max: None, nominal }, ..row }
        }
        _ => row,
    }
}

pub(crate) const ROWS: &[Row] = &[
    real(
        "sliding_velocity",
        &METRE_PER_SECOND,
        10.0,
        "Velocity of the punch over the strip, signed; for a brake the disc's surface speed at the pad",
    )
    .input(),
    load(),
    real(
        "angular_velocity",
        &RADIAN_PER_SECOND,
        10.0,
        "Optional: contact.mean_radius times this is added to sliding_velocity",
    )
    .shown("rev/min")
    .input(),
    real("ambient_temperature_offset", &KELVIN, 10.0, "Optional: added to the parameter ambient_temperature")
        .of_type("TemperatureDifference")
        .input(),
    real(
        "cooling_velocity",
        &METRE_PER_SECOND,
        10.0,
        "Optional: air speed added to the absolute sliding velocity in forced convection",
    )
    .input(),
    real(
        "strip.external_temperature",
        &KELVIN,
        300.0,
        "Temperature of the strip's neighbour: of its base where strip.base_thermal = external, or behind strip.external_conductance; \
         used only there (0 K is then an error)",
    )
    .input(),
    real(
        "punch.external_temperature",
        &KELVIN,
        300.0,
        "Temperature of the punch's neighbour: of its top where punch.top_thermal = external, or behind punch.external_conductance; \
         used only there (0 K is then an error)",
    )
    .input(),
];
