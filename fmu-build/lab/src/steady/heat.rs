//! The steady state with heat: drawing of `cargo fmu steady`.

use crate::plot::{Axis, Mark, Panel, Series};
use analyses::steady::Solved;
use analyses::steady::heat::known;

const ZERO_CELSIUS: f64 = 273.15;

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
