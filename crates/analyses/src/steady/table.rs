//! The steady state as a table.

use super::heat::{difference, rise};
use super::{Solved, direction, largest, number};
use ::steady::thermal::HotState;

const ZERO_CELSIUS: f64 = 273.15;

impl Solved {
    /// As a table, in the units that are read.
    pub fn table(&self) -> String {
        let state = &self.state;
        let mut lines = vec![
            ("scene".to_owned(), format!("{}, {} cells", self.name, self.cells.count())),
            ("state".to_owned(), self.kind().to_owned()),
            ("load, N".to_owned(), number(self.scene.nominal_load)),
            ("mean pressure, MPa".to_owned(), number(1e-6 * self.mean_pressure())),
        ];
        for stroke in &state.strokes {
            let [left, right] = self.edges(stroke).map(|pressure| number(1e-6 * pressure));
            let name = direction(stroke);
            lines.extend([
                (format!("{name}: peak pressure, MPa"), number(1e-6 * largest(&stroke.pressure))),
                (format!("{name}: pressure at -x, +x edge, MPa"), format!("{left}, {right}")),
                (format!("{name}: approach, µm"), number(1e6 * stroke.approach)),
                (format!("{name}: tilt, urad"), number(1e6 * stroke.tilt)),
            ]);
        }
        if let [forward, backward] = &state.strokes[..] {
            // Rounding is no jump.
            let jump = |a: f64, b: f64| if (a - b).abs() > 1e-12 * (a.abs() + b.abs()) { 1e6 * (a - b) } else { 0.0 };
            lines.push(("jump of the approach, µm".into(), number(jump(forward.approach, backward.approach))));
            lines.push(("jump of the tilt, urad".into(), number(jump(forward.tilt, backward.tilt))));
        }
        let range = |values: &[f64]| 1e6 * (largest(values) - values.iter().copied().fold(f64::INFINITY, f64::min));
        let [punch, strip] = state.volume_rates.map(|rate| number(1e9 * rate));
        lines.extend([
            ("range of the punch's shape, µm".into(), number(range(&state.shape))),
            ("depth of the strip's groove, µm".into(), number(range(&state.groove))),
            ("wear rate of the punch, nm/s".into(), number(1e9 * state.punch_wear_rate)),
            ("wear of punch, strip, mm3/s".into(), format!("{punch}, {strip}")),
            ("wear dissipation power, W".into(), number(state.dissipation_power)),
            ("friction power, W".into(), number(state.friction_power)),
            ("relative velocity beyond the rigid motion, over it".into(), String::new()),
        ]);
        lines.extend(self.neglected().into_iter().map(|(name, value)| (format!("  {name}"), number(value))));
        lines.extend(heat_lines(self));
        let width = lines.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
        let line = |(name, value): &(String, String)| format!("{}\n", format!("{name:<width$}  {value}").trim_end());
        lines.iter().map(line).collect()
    }
}

fn range(values: &[f64]) -> f64 {
    largest(values) - values.iter().copied().fold(f64::INFINITY, f64::min)
}

/// Lines of the table beside those of the state without heat.
fn heat_lines(solved: &Solved) -> Vec<(String, String)> {
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
