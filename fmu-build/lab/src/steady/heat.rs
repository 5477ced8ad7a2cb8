//! The steady state with heat: table and drawing of `cargo fmu steady`.

use crate::plot::{Axis, Mark, Panel, Series};
use analyses::steady::heat::{difference, known, rise};
use analyses::steady::{Solved, direction, largest, number};
use steady::thermal::HotState;

const ZERO_CELSIUS: f64 = 273.15;

fn range(values: &[f64]) -> f64 {
    largest(values) - values.iter().copied().fold(f64::INFINITY, f64::min)
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
    let celsius = |kelvin: f64| number(kelvin - ZERO_CELSIUS);
    let [least, mean, most] = heat.contact_temperature;
    let highest = match &solved.highest {
        Some(highest) => highest.text(ZERO_CELSIUS, rise(solved, hot)),
        None => celsius(heat.highest),
    };
    lines.extend([
        ("  difference of the pressures, rms over the mean".into(), number(off)),
        ("  contact temperature, degC".into(), celsius(mean)),
        ("  its range in a cycle, K".into(), number(most - least)),
        ("  highest surface temperature, degC".into(), highest),
        ("  contact.temperature_limit, degC".into(), limit(solved, hot)),
        ("  range of the punch's shape, µm".into(), number(1e6 * range(&hot.state.shape))),
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
        limit if hot.heat.highest > limit => format!("{}, exceeded", number(limit - ZERO_CELSIUS)),
        limit => number(limit - ZERO_CELSIUS),
    }
}

/// Cell values times a factor, as points of a series.
type Course<'a> = dyn Fn(&[f64], f64) -> Vec<(f64, f64)> + 'a;

/// Pressure and shape with heat, for the panels of those without: `over` gives the values of the cells, `curve` a curve through them.
pub fn series(solved: &Solved, over: &Course<'_>, curve: &Course<'_>) -> [Vec<Series>; 2] {
    let Some(hot) = known(solved) else { return [Vec::new(), Vec::new()] };
    let pressures = hot.state.strokes.iter().enumerate().map(|(index, stroke)| {
        let name = if index == 0 { "with heat" } else { "" };
        Series::line(name, over(&stroke.pressure, 1e-6)).with(Mark::Points).coloured(1 + index)
    });
    let shape = Series::line("punch, with heat", curve(&hot.state.shape, 1e6)).with(Mark::Dashes).coloured(1);
    [pressures.collect(), vec![shape]]
}

/// Temperatures of the surfaces.
pub fn panel(solved: &Solved, axis: Axis, curve: &Course<'_>) -> Option<Panel> {
    let hot = known(solved)?;
    let celsius = |values: &[f64]| curve(&values.iter().map(|t| t - ZERO_CELSIUS).collect::<Vec<f64>>(), 1.0);
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
    Some(Panel::new(title, axis, Axis::new("temperature (°C)"), series))
}
