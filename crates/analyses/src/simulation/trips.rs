//! Trips of a drive: a column `trip` of the inputs divides it.

use super::quantity::{Shown, number};
use super::run::Recording;
use serde_json::{Value, json};

/// Results of a trip, from its first row of inputs to that of the next.
pub(super) struct Trip {
    /// Its number.
    pub number: f64,
    /// From and until, s.
    span: [f64; 2],
    /// Highest temperatures of contact and strip (mean), and that of the strip at the start, K.
    temperature: [f64; 3],
    /// Worn and airborne mass, kg.
    mass: [f64; 2],
    /// Sliding distance, m.
    distance: f64,
}

/// The trips of a run, those that it has reached.
pub(super) fn trips(recording: &Recording) -> Vec<Trip> {
    let times = &recording.times;
    let last = times[times.len() - 1];
    let begun = recording.trips.iter().filter(|(_, from)| *from < last);
    let until = recording.trips.iter().skip(1).map(|(_, from)| *from).chain([last]);
    // Every row of the inputs is a communication point.
    let at = |time: f64| times.partition_point(|own| *own < time).min(times.len() - 1);
    begun
        .zip(until)
        .map(|(&(number, from), until)| {
            let (first, end) = (at(from), at(until));
            let highest =
                |name: &str| recording.values(name)[first..=end].iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let gained = |name: &str| recording.values(name)[end] - recording.values(name)[first];
            Trip {
                number,
                span: [times[first], times[end]],
                temperature: [
                    highest("contact_temperature_max"),
                    highest("strip.mean_temperature"),
                    recording.values("strip.mean_temperature")[first],
                ],
                mass: [gained("wear_mass_punch") + gained("wear_mass_strip"), gained("wear_mass_airborne")],
                distance: gained("sliding_distance"),
            }
        })
        .collect()
}

/// A whole number without decimals.
pub(super) fn number_of(trip: f64) -> String {
    if trip.fract() == 0.0 { format!("{trip:.0}") } else { number(trip) }
}

impl Trip {
    pub(super) fn text(&self) -> String {
        let celsius = |kelvin: f64| Shown::of("contact_temperature", "K", kelvin).text(kelvin);
        let [contact, strip, start] = self.temperature.map(celsius);
        let worn = Shown::of_difference("kg", self.mass[0]).text(self.mass[0]);
        let mut text = format!("contact at most {contact}, strip {start} to {strip}, {worn} worn");
        if self.distance > 0.0 {
            text += &format!(", {} mg per km slid", number(1e9 * self.mass[0] / self.distance));
        }
        text
    }

    /// As JSON, SI units.
    pub(super) fn record(&self) -> Value {
        json!({
            "trip": self.number,
            "start": self.span[0],
            "end": self.span[1],
            "contact_temperature_max": self.temperature[0],
            "strip_mean_temperature_max": self.temperature[1],
            "strip_mean_temperature_start": self.temperature[2],
            "worn_mass": self.mass[0],
            "airborne_mass": self.mass[1],
            "sliding_distance": self.distance,
        })
    }
}
