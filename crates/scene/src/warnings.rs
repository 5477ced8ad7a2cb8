//! Warnings about values that are within their bounds but implausible.

use super::message::Number;
use super::{Body, FadeTable, Scene, ThermalBoundary};

/// Lowest plausible temperature, K. Contacts of the kinds modelled here are warmer; temperatures in degrees Celsius given as
/// kelvin are mostly below it.
const COLDEST: f64 = 150.0;

/// Warnings about temperatures that are probably in degrees Celsius.
pub(crate) fn of_temperatures(scene: &Scene) -> Vec<String> {
    let mut given = vec![
        ("ambient_temperature".to_owned(), scene.ambient_temperature),
        ("contact.temperature_limit".to_owned(), off_at_zero(scene.temperature_limit)),
    ];
    given.extend(of_table("contact.friction_fade", &scene.friction_fade));
    for (name, face, body) in [("punch", "top", &scene.punch), ("strip", "base", &scene.strip)] {
        given.extend(of_body(name, face, body));
    }
    given.into_iter().filter(|(_, kelvin)| *kelvin < COLDEST).map(|(name, kelvin)| cold(&name, kelvin)).collect()
}

/// External temperatures of strip and punch, where they act.
pub(crate) fn of_external(scene: &Scene, temperatures: [f64; 2]) -> Vec<String> {
    [(&scene.strip, "strip"), (&scene.punch, "punch")]
        .iter()
        .zip(temperatures)
        .filter(|((body, _), kelvin)| body.has_neighbour() && *kelvin < COLDEST)
        .map(|((_, name), kelvin)| cold(&format!("{name}.external_temperature"), kelvin))
        .collect()
}

/// The warning for a temperature below [`COLDEST`].
fn cold(name: &str, kelvin: f64) -> String {
    let [kelvin, celsius, coldest] = [kelvin, kelvin - 273.15, COLDEST].map(Number);
    format!(
        "{name} = {kelvin} K is {celsius} degC: temperatures are in kelvin; values below {coldest} K are implausible"
    )
}

fn of_body(name: &str, face: &str, body: &Body) -> Vec<(String, f64)> {
    let mut given = vec![(format!("{name}.initial_temperature"), off_at_zero(body.initial_temperature))];
    if body.far_thermal == ThermalBoundary::Held {
        given.push((format!("{name}.{face}_temperature"), off_at_zero(body.far_temperature)));
    }
    given.extend(of_table(&format!("{name}.wear_fade"), &body.wear_fade));
    given
}

/// The lowest temperature of a table that has an effect.
fn of_table(name: &str, table: &FadeTable) -> Option<(String, f64)> {
    (!table.flat).then(|| (format!("{name}.temperature[1]"), table.temperature[0]))
}

/// Infinity for 0, which stands for another value and is not checked.
fn off_at_zero(kelvin: f64) -> f64 {
    if kelvin == 0.0 { f64::INFINITY } else { kelvin }
}
