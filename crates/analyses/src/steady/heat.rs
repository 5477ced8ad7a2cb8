//! The steady state with heat beside the one without.

use super::{Solved, direction, number};
use ::steady::states::SteadyState;
use ::steady::thermal::HotState;
use elasticity::Cells;
use model::lumped::HIGHEST_VALID_TEMPERATURE;
use scene::Scene;
use serde_json::{Value, json};

const ZERO_CELSIUS: f64 = 273.15;

/// Root mean square difference of the pressures with and without heat over all strokes, in Pa.
pub(crate) fn difference(cells: &Cells, hot: &SteadyState, cold: &SteadyState) -> f64 {
    let width = 2.0 * cells.half_width();
    let one = |(hot, cold): (&Vec<f64>, &Vec<f64>)| {
        let squares: Vec<f64> = hot.iter().zip(cold).map(|(h, c)| (h - c) * (h - c)).collect();
        (cells.integral(&squares) / width).sqrt()
    };
    let pressures =
        |state: &SteadyState| state.strokes.iter().map(|stroke| stroke.pressure.clone()).collect::<Vec<_>>();
    pressures(hot).iter().zip(&pressures(cold)).map(one).fold(0.0, f64::max)
}

/// Reason why a state that solves the equations is unphysical: temperatures beyond the model's validity.
pub(crate) fn beyond_validity(scene: &Scene, hot: &HotState) -> Option<String> {
    let kelvin = hot.heat.highest;
    // A number that is none is beyond too.
    if kelvin <= HIGHEST_VALID_TEMPERATURE {
        return None;
    }
    Some(format!(
        "no steady state with heat within the model's validity: sliding for ever at nominal.velocity = {} m/s under \
         nominal.load = {} N would heat a surface to {} degC, the limit is {} degC",
        scene.nominal_velocity,
        scene.nominal_load,
        number(kelvin - ZERO_CELSIUS),
        number(HIGHEST_VALID_TEMPERATURE - ZERO_CELSIUS)
    ))
}

/// A warning where the state is above the scene's own limit.
fn above_limit(solved: &Solved) -> Option<String> {
    let (kelvin, limit) = (known(solved)?.heat.highest, solved.scene.temperature_limit);
    (limit > 0.0 && kelvin > limit).then(|| {
        format!(
            "the steady state is above contact.temperature_limit = {} degC: the highest surface temperature is {} degC",
            number(limit - ZERO_CELSIUS),
            number(kelvin - ZERO_CELSIUS)
        )
    })
}

/// What a reader of the state should know: a state that is unstable, beyond the scene's own limit or not converged.
pub fn warnings(solved: &Solved) -> Vec<String> {
    let Some(hot) = known(solved) else { return Vec::new() };
    let unconverged = solved.highest.as_ref().and_then(|highest| {
        highest.warning("the highest surface temperature", "degC", ZERO_CELSIUS, rise(solved, hot))
    });
    [hot.instability(), above_limit(solved), unconverged].into_iter().flatten().collect()
}

/// Rise of the highest surface temperature above the ambient, K.
pub(crate) fn rise(solved: &Solved, hot: &HotState) -> f64 {
    hot.heat.highest - solved.scene.ambient_temperature
}

pub(crate) fn record(solved: &Solved) -> Value {
    let hot = match &solved.hot {
        None => return Value::Null,
        Some(Err(reason)) => return json!({ "refused": reason }),
        Some(Ok(hot)) => hot,
    };
    let flows = &hot.heat.flows;
    let strokes = hot.state.strokes.iter().zip(&hot.heat.strokes).map(|(stroke, heat)| {
        json!({
            "direction": direction(stroke),
            "friction": stroke.friction,
            "pressure": stroke.pressure,
            "pressure_after_reversal": heat.pressure_at[0],
            "pressure_at_end": heat.pressure_at[1],
            "temperature_punch": heat.temperature[0],
            "temperature_strip": heat.temperature[1],
            "heat_flux_punch": heat.flux[0],
            "heat_flux_strip": heat.flux[1],
            "approach": stroke.approach,
            "tilt": stroke.tilt,
        })
    });
    let [least, mean, most] = hot.heat.contact_temperature;
    let on_half = solved.highest.map(|highest| json!({ "cells": highest.coarser_cells, "value": highest.coarser }));
    json!({
        "strokes": strokes.collect::<Vec<_>>(),
        "shape": hot.state.shape,
        "groove": hot.state.groove,
        "pressure_difference": difference(&solved.cells, &hot.state, &solved.state),
        "contact_temperature": { "least": least, "mean": mean, "largest": most, "highest": hot.heat.highest, "highest_on_half": on_half },
        "surface_temperature": { "least": hot.heat.range[0], "largest": hot.heat.range[1] },
        "heat_flow": {
            "friction": flows.friction,
            "punch": flows.punch,
            "strip": flows.strip,
            "punch_top": flows.punch_top,
            "strip_base": flows.strip_base,
            "ambient": flows.ambient,
        },
        "temperature_limit_exceeded": above_limit(solved).is_some(),
        "punch_wear_rate": hot.state.punch_wear_rate,
        "volume_rates": hot.state.volume_rates,
        "wear_dissipation_power": hot.state.dissipation_power,
        "friction_power": hot.state.friction_power,
        "warnings": warnings(solved),
        "speed_over_critical_speed": hot.heat.accuracy.speed_ratio,
        "cycles_computed": hot.heat.accuracy.iterations,
        "change_of_shape": hot.heat.accuracy.shape,
        "change_of_heat": hot.heat.accuracy.heat,
    })
}

/// The state with heat, where there is one.
pub(crate) fn known(solved: &Solved) -> Option<&HotState> {
    solved.hot.as_ref().and_then(|hot| hot.as_ref().ok())
}
