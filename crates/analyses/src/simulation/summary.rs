//! Results of a run as a table and as JSON.

use super::measured::Measured;
use super::neglected_slip::{NeglectedSlip, counted};
use super::quantity::{Shown, number, rounded};
use super::rig::Rig;
use super::run::{Channel, Profiles, Recording, energy_residual};
use super::trips::{Trip, number_of, trips};
use crate::largest;
use serde_json::{Map, Value, json};

/// Heat relative to the largest of the balance below which it is rounding.
const LEAST_HEAT: f64 = 1e-12;

/// A run with everything that the table and the JSON state about it.
pub struct Summary<'a> {
    /// Name of the scene.
    pub scene: &'a str,
    /// Where the inputs are from.
    pub inputs: &'a str,
    /// The run.
    pub recording: &'a Recording,
    /// Measured quantities.
    pub measured: &'a [Measured],
    /// Files written.
    pub files: &'a [String],
}

/// Index of the largest magnitude; of equal ones the first.
fn peak(values: &[f64]) -> usize {
    (1..values.len()).fold(0, |peak, row| if values[row].abs() > values[peak].abs() { row } else { peak })
}

/// Bits of `limit_reached` in words.
fn limits(sum: f64) -> String {
    let words = ["wear limit", "temperature limit", "validity of the model"];
    let reached: Vec<&str> =
        words.into_iter().enumerate().filter(|(bit, _)| sum as u32 & 1 << bit != 0).map(|(_, word)| word).collect();
    if reached.is_empty() { "none".into() } else { reached.join(", ") }
}

fn seconds(time: f64) -> String {
    format!("{} s", rounded(time))
}

impl Summary<'_> {
    fn last(&self, name: &str) -> f64 {
        self.recording.values(name).last().copied().unwrap_or_default()
    }

    /// Largest magnitude with its time, and the value at the end.
    fn course(&self, name: &str) -> String {
        let (values, times) = (self.recording.values(name), &self.recording.times);
        let unit = self.recording.channel(name).map_or("1", |channel| channel.unit);
        let row = peak(values);
        let shown = Shown::of(name, unit, values[row].abs());
        format!("{} at {}, {} at the end", shown.text(values[row]), seconds(times[row]), shown.text(self.last(name)))
    }

    fn wear(&self, body: &str) -> String {
        let [depth, volume] = ["depth", "volume"].map(|kind| self.last(&format!("wear_{kind}_{body}")));
        let depth = Shown::of("wear_depth", "m", depth.abs()).text(depth);
        format!("{depth}, {}", Shown::of_difference("m3", volume.abs()).text(volume))
    }

    /// Comings to rest that last.
    fn stops(&self) -> usize {
        let speeds = ["sliding_velocity", "angular_velocity"].map(|name| self.recording.values(name));
        let rests: Vec<bool> =
            (0..self.recording.times.len()).map(|row| speeds.iter().all(|v| v[row] == 0.0)).collect();
        (1..rests.len())
            .filter(|&row| !rests[row - 1] && rests[row] && rests.get(row + 1).is_none_or(|rest| *rest))
            .count()
    }

    /// How often a load is applied and slides: from a contact without load to the next, as the events of a brake cycle are counted.
    fn applications(&self) -> usize {
        let [loads, powers] = ["normal_load", "friction_power"].map(|name| self.recording.values(name));
        let mut counted = false;
        loads
            .iter()
            .zip(powers)
            .filter(|&(load, power)| {
                let begins = !counted && *load > 0.0 && *power > 0.0;
                counted = *load > 0.0 && (counted || begins);
                begins
            })
            .count()
    }

    /// A mass, and that over the distance slid, over the stops and over the applications of the load.
    fn mass(&self, mass: f64) -> String {
        let distance = 1e-3 * self.last("sliding_distance");
        let stops = self.stops();
        let mut text = Shown::of_difference("kg", mass).text(mass);
        if distance > 0.0 {
            text += &format!(", {} mg per km slid", number(1e6 * mass / distance));
        }
        if stops > 0 {
            let each = if stops == 1 { "in" } else { "in each of" };
            text += &format!(", {} mg {each} {}", number(1e6 * mass / stops as f64), counted(stops, "stop"));
        }
        let applications = self.applications();
        if applications > 1 && applications != stops {
            text +=
                &format!(", {} mg in each of {applications} applications", number(1e6 * mass / applications as f64));
        }
        text
    }

    /// Masses with what they are over the distance slid, over the stops and over the applications of the load.
    fn masses(&self) -> Value {
        let distance = self.last("sliding_distance");
        let of = |mass: f64| {
            json!({
                "mass": mass,
                "per_distance_slid": (distance > 0.0).then(|| mass / distance),
                "per_stop": (self.stops() > 0).then(|| mass / self.stops() as f64),
                "per_application": (self.applications() > 0).then(|| mass / self.applications() as f64),
            })
        };
        json!({
            "worn": of(self.last("wear_mass_punch") + self.last("wear_mass_strip")),
            "airborne": of(self.last("wear_mass_airborne")),
            "stops": self.stops(),
            "applications": self.applications(),
        })
    }

    fn energies(&self) -> String {
        let energy = self.last("dissipated_energy");
        let shown = Shown::of("dissipated_energy", "J", energy.abs());
        let share = if energy > 0.0 {
            format!(", {:.1} % of it into the strip", 100.0 * self.last("heat_received_strip") / energy)
        } else {
            String::new()
        };
        format!("{}{share}", shown.text(energy))
    }

    fn heat(&self) -> String {
        let parts = [
            ("stored", "stored_heat"),
            ("to the air", "heat_lost_ambient"),
            ("through the punch's top", "heat_lost_punch_top"),
            ("through the strip's base", "heat_lost_strip_base"),
        ]
        .map(|(word, name)| (word, name, self.last(name)));
        // A flow through an insulated face is the rounding of the others.
        let least = LEAST_HEAT * largest(parts.map(|(_, _, value)| value));
        let parts = parts.map(|(word, name, value)| {
            let value = if value.abs() < least { 0.0 } else { value };
            format!("{} {word}", Shown::of(name, "J", value.abs()).text(value))
        });
        parts.join(", ")
    }

    fn cost(&self) -> String {
        let Recording { times, internal_steps: (accepted, rejected), seconds: [initialisation, steps], .. } =
            self.recording;
        let real_time = (times[times.len() - 1] - times[0]) / steps.max(1e-9);
        format!(
            "{} communication steps, {accepted} internal ones and {rejected} rejected; {initialisation:.3} s to initialise, \
             {steps:.3} s to step, {} times real time",
            times.len() - 1,
            number(real_time)
        )
    }

    /// The table.
    pub fn table(&self) -> String {
        let recording = self.recording;
        let (first, last) = (recording.times[0], recording.times[recording.times.len() - 1]);
        let mut lines: Vec<(String, String)> = [
            ("scene", format!("{}, level {}", self.scene, recording.level)),
            ("inputs", self.inputs.to_owned()),
            ("time", format!("{} to {}", seconds(first), seconds(last))),
            (
                "sliding distance",
                Shown::of("sliding_distance", "m", self.last("sliding_distance")).text(self.last("sliding_distance")),
            ),
            ("hottest point of the contact", self.course("contact_temperature_max")),
            ("contact, mean temperature", self.course("contact_temperature")),
            ("punch, mean temperature", self.course("punch.mean_temperature")),
            ("strip, mean temperature", self.course("strip.mean_temperature")),
            ("highest pressure", self.course("pressure_max")),
            ("friction force", self.course("friction_force")),
            ("friction coefficient", self.course("friction_coefficient")),
            ("wear of the punch", self.wear("punch")),
            ("wear of the strip", self.wear("strip")),
            ("worn mass", self.mass(self.last("wear_mass_punch") + self.last("wear_mass_strip"))),
            ("airborne particles", self.mass(self.last("wear_mass_airborne"))),
            ("friction heat", self.energies()),
            ("heat", self.heat()),
            ("energy balance closes to", format!("{:.1e} of the largest energy", energy_residual(recording))),
            ("estimated_error", estimated(self.last("estimated_error"))),
            ("limits reached", limits(self.last("limit_reached"))),
            ("cost", self.cost()),
        ]
        .map(|(name, value)| (name.to_owned(), value))
        .to_vec();
        lines.retain(|(name, _)| name != "airborne particles" || self.last("wear_mass_airborne") > 0.0);
        lines.extend(self.measured.iter().map(|own| (format!("deviation of {}", own.name), deviation(own))));
        lines.extend(Rig::of(recording, self.measured).iter().flat_map(Rig::lines));
        lines.extend(trips(recording).iter().map(|trip| (format!("trip {}", number_of(trip.number)), trip.text())));
        lines.extend(recording.neglected_slip.iter().map(|slip| ("elastic slip, neglected".to_owned(), slip.text())));
        let warnings = &recording.warnings;
        lines.extend(warnings.iter().map(|(time, text)| (format!("warning at {}", seconds(*time)), text.clone())));
        lines.extend(self.files.iter().map(|file| ("written".to_owned(), file.clone())));
        let width = lines.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
        lines.iter().map(|(name, value)| format!("{name:<width$}  {value}\n")).collect()
    }

    /// The same in SI units, with every variable and the profiles.
    pub fn record(&self) -> Value {
        let recording = self.recording;
        let times = &recording.times;
        let course = |channel: &Channel| {
            let least = channel.values.iter().copied().fold(f64::INFINITY, f64::min);
            let most = channel.values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let value = json!({
                "unit": channel.unit,
                "minimum": least,
                "maximum": most,
                "time_of_largest_magnitude": times[peak(&channel.values)],
                "end": channel.values.last(),
            });
            (channel.name.to_owned(), value)
        };
        let profiles = |profiles: &Profiles| {
            json!({
                "time": profiles.time,
                "x": profiles.x.to_vec(),
                "pressure": profiles.pressure.to_vec(),
                "temperature": profiles.temperature.to_vec(),
                "wear_punch": profiles.worn[0].to_vec(),
                "wear_strip": profiles.worn[1].to_vec(),
            })
        };
        let measured = |own: &Measured| {
            json!({
                "name": own.name,
                "unit": own.unit,
                "points": own.points.len(),
                "points_outside": own.outside,
                "root_mean_square": own.root_mean_square,
                "largest": own.largest,
                "time_of_largest": own.at,
                "range": own.range,
                "root_mean_square_over_range": own.relative(own.root_mean_square),
                "largest_over_range": own.relative(own.largest),
            })
        };
        json!({
            "scene": self.scene,
            "level": recording.level,
            "inputs": self.inputs,
            "start": times[0],
            "stop": times[times.len() - 1],
            "communication_steps": times.len() - 1,
            "internal_steps": { "accepted": recording.internal_steps.0, "rejected": recording.internal_steps.1 },
            "seconds": { "initialisation": recording.seconds[0], "steps": recording.seconds[1] },
            "energy_residual": energy_residual(recording),
            "estimated_error": self.last("estimated_error"),
            "neglected_slip": recording.neglected_slip.as_ref().map(NeglectedSlip::record),
            "wear_mass": self.masses(),
            "rig": Rig::of(recording, self.measured).as_ref().map(Rig::record),
            "trips": trips(recording).iter().map(Trip::record).collect::<Vec<_>>(),
            "variables": recording.channels.iter().map(course).collect::<Map<String, Value>>(),
            "profiles": recording.profiles.iter().map(profiles).collect::<Vec<_>>(),
            "measured": self.measured.iter().map(measured).collect::<Vec<_>>(),
            "warnings": recording.warnings.iter().map(|(time, text)| json!({ "time": time, "text": text })).collect::<Vec<_>>(),
            "failure": recording.failure,
            "files": self.files,
        })
    }
}

fn estimated(error: f64) -> String {
    if error >= 1.0 { format!("{error}: unknown") } else { format!("{error:.1e}, relative") }
}

fn deviation(own: &Measured) -> String {
    let shown = Shown::of_difference(own.unit, own.largest.abs().max(own.root_mean_square));
    let relative = |deviation: f64| match own.relative(deviation) {
        Some(part) => format!(" ({:.2} % of the range)", 100.0 * part),
        None => String::new(),
    };
    let outside =
        if own.outside > 0 { format!("; {} outside of the simulated time", own.outside) } else { String::new() };
    format!(
        "root mean square {}{}, largest {}{} at {}; {} points{outside}",
        shown.text(own.root_mean_square),
        relative(own.root_mean_square),
        shown.text(own.largest),
        relative(own.largest),
        seconds(own.at),
        own.points.len()
    )
}
