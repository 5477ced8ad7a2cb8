//! The steady state with heat: table and drawing of `cargo fmu steady`.

use super::{Solved, direction, largest, number};
use crate::plot::{Axis, Legend, Mark, Panel, Series};
use elasticity::Cells;
use model::lumped::HIGHEST_VALID_TEMPERATURE;
use scene::Scene;
use serde_json::{Value, json};
use steady::states::SteadyState;
use steady::thermal::HotState;

const ZERO_CELSIUS: f64 = 273.15;

/// Root mean square difference of the pressures with and without heat over all strokes, in Pa.
pub fn difference(cells: &Cells, hot: &SteadyState, cold: &SteadyState) -> f64 {
    let width = 2.0 * cells.half_width();
    let one = |(hot, cold): (&Vec<f64>, &Vec<f64>)| {
        let squares: Vec<f64> = hot.iter().zip(cold).map(|(h, c)| (h - c) * (h - c)).collect();
        (cells.integral(&squares) / width).sqrt()
    };
    let pressures =
        |state: &SteadyState| state.strokes.iter().map(|stroke| stroke.pressure.clone()).collect::<Vec<_>>();
    pressures(hot).iter().zip(&pressures(cold)).map(one).fold(0.0, f64::max)
}

fn range(values: &[f64]) -> f64 {
    largest(values) - values.iter().copied().fold(f64::INFINITY, f64::min)
}

/// Highest temperature of either surface in a cycle, K.
fn hottest(hot: &HotState) -> f64 {
    hot.heat.range[1].iter().flatten().copied().fold(f64::NEG_INFINITY, f64::max)
}

/// Reason why a state that solves the equations is unphysical: temperatures beyond the model's validity.
pub fn beyond_validity(scene: &Scene, hot: &HotState) -> Option<String> {
    let kelvin = hottest(hot);
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
pub fn above_limit(solved: &Solved) -> Option<String> {
    let (kelvin, limit) = (hottest(known(solved)?), solved.scene.temperature_limit);
    (limit > 0.0 && kelvin > limit).then(|| {
        format!(
            "the steady state is above contact.temperature_limit = {} degC: the highest surface temperature is {} degC",
            number(limit - ZERO_CELSIUS),
            number(kelvin - ZERO_CELSIUS)
        )
    })
}

/// Lines of the table beside those of the state without heat.
pub fn lines(solved: &Solved) -> Vec<(String, String)> {
    let hot = match &solved.hot {
        None => return Vec::new(),
        Some(Err(reason)) => return vec![("with heat".into(), reason.clone())],
        Some(Ok(hot)) => hot,
    };
    let (heat, flows) = (&hot.heat, &hot.heat.flows);
    let mut lines = vec![("with heat".to_owned(), String::new())];
    for stroke in &hot.state.strokes {
        let name = direction(stroke);
        let [left, right] = solved.edges(stroke).map(|pressure| number(1e-6 * pressure));
        lines.extend([
            (format!("  {name}: peak pressure, MPa"), number(1e-6 * largest(&stroke.pressure))),
            (format!("  {name}: pressure at -x, +x edge, MPa"), format!("{left}, {right}")),
        ]);
    }
    let off = difference(&solved.cells, &hot.state, &solved.state) / solved.mean_pressure();
    let celsius = |kelvin: f64| number(kelvin - 273.15);
    let [least, mean, most] = heat.contact_temperature;
    lines.extend([
        ("  difference of the pressures, rms over the mean".into(), number(off)),
        ("  contact temperature, degC".into(), celsius(mean)),
        ("  its range in a cycle, K".into(), number(most - least)),
        ("  highest surface temperature, degC".into(), celsius(heat.highest)),
        ("  contact.temperature_limit, degC".into(), limit(solved, hot)),
        ("  range of the punch's shape, um".into(), number(1e6 * range(&hot.state.shape))),
        ("  friction heat, W".into(), number(flows.friction)),
        ("  into punch, strip, W".into(), format!("{}, {}", number(flows.punch), number(flows.strip))),
        (
            "  out of the punch's top, the strip's base, to the air, W".into(),
            format!("{}, {}, {}", number(flows.punch_top), number(flows.strip_base), number(flows.ambient)),
        ),
        ("  speed over the critical speed".into(), number(heat.accuracy.speed_ratio)),
        ("  cycles computed".into(), heat.accuracy.iterations.to_string()),
    ]);
    lines
}

fn limit(solved: &Solved, hot: &HotState) -> String {
    match solved.scene.temperature_limit {
        0.0 => "none".to_owned(),
        limit if hottest(hot) > limit => format!("{}, exceeded", number(limit - ZERO_CELSIUS)),
        limit => number(limit - ZERO_CELSIUS),
    }
}

/// The state with heat as JSON.
pub fn record(solved: &Solved) -> Value {
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
    json!({
        "strokes": strokes.collect::<Vec<_>>(),
        "shape": hot.state.shape,
        "groove": hot.state.groove,
        "pressure_difference": difference(&solved.cells, &hot.state, &solved.state),
        "contact_temperature": { "least": least, "mean": mean, "largest": most },
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
        "speed_over_critical_speed": hot.heat.accuracy.speed_ratio,
        "cycles_computed": hot.heat.accuracy.iterations,
        "change_of_shape": hot.heat.accuracy.shape,
        "change_of_heat": hot.heat.accuracy.heat,
    })
}

/// The state with heat, where there is one.
pub fn known(solved: &Solved) -> Option<&HotState> {
    solved.hot.as_ref().and_then(|hot| hot.as_ref().ok())
}

/// Cell values times a factor, as points of a line.
type Course<'a> = dyn Fn(&[f64], f64) -> Vec<(f64, f64)> + 'a;

/// Pressure and shape with heat, for the panels of those without.
pub fn series(solved: &Solved, over: &Course<'_>) -> [Vec<Series>; 2] {
    let Some(hot) = known(solved) else { return [Vec::new(), Vec::new()] };
    let pressures = hot.state.strokes.iter().enumerate().map(|(index, stroke)| {
        let name = if index == 0 { "with heat" } else { "" };
        Series::line(name, over(&stroke.pressure, 1e-6)).with(Mark::Points).coloured(1 + index)
    });
    let shape = Series::line("punch, with heat", over(&hot.state.shape, 1e6)).with(Mark::Dashes).coloured(1);
    [pressures.collect(), vec![shape]]
}

/// Temperatures of the surfaces.
pub fn panel(solved: &Solved, axis: Axis, over: &Course<'_>) -> Option<Panel> {
    let hot = known(solved)?;
    let celsius = |values: &[f64]| over(&values.iter().map(|t| t - 273.15).collect::<Vec<f64>>(), 1.0);
    let mut series = Vec::new();
    for (side, name) in ["punch", "strip"].into_iter().enumerate() {
        for (index, stroke) in hot.heat.strokes.iter().enumerate() {
            let way = if hot.heat.strokes.len() == 1 { "" } else { [", mean forward", ", mean backward"][index] };
            let mark = if index == 0 { Mark::Line } else { Mark::Dashes };
            series.push(
                Series::line(format!("{name}{way}"), celsius(&stroke.temperature[side])).with(mark).coloured(side),
            );
        }
    }
    let title = "Temperature of the surfaces";
    Some(Panel::new(title, axis, Axis::new("temperature, degC"), series).with_legend(Legend::Bottom))
}
