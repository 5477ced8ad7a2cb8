//! The car of the brakes' examples: what `--set car.NAME=VALUE` may change, and in which limits.

use super::Example;
use crate::scenes;
use anyhow::{Result, bail};
use scene::message::Clipped;
use scene::variables::units::{KILOGRAM, METRE, ONE, SQUARE_METRE, Unit};
use scene_file::{SceneFile, nearest, quantity};
use std::ops::RangeInclusive;

struct Property {
    name: &'static str,
    unit: &'static Unit,
    limits: RangeInclusive<f64>,
    /// Examples whose car has it: its own, the coupled one.
    of: &'static [Example],
}

const BOTH: &[Example] = &[Example::DiscBrake, Example::VehicleBrake];
const DISC_BRAKE: &[Example] = &[Example::DiscBrake];
const VEHICLE_BRAKE: &[Example] = &[Example::VehicleBrake];

/// Names are those of `Car` in examples/disc_brake/road_load.py and of the vehicle's parameters in
/// examples/vehicle_brake/vehicle/variables.h. The coupled car brakes its axles by their loads, which follow from its geometry.
const PROPERTIES: [Property; 9] = [
    Property { name: "mass", unit: &KILOGRAM, limits: 100.0..=1e5, of: BOTH },
    Property { name: "wheel_radius", unit: &METRE, limits: 0.05..=1.5, of: BOTH },
    Property { name: "rolling_resistance", unit: &ONE, limits: 0.0..=0.1, of: BOTH },
    Property { name: "drag_area", unit: &SQUARE_METRE, limits: 0.0..=20.0, of: BOTH },
    Property { name: "front_share", unit: &ONE, limits: 0.01..=1.0, of: DISC_BRAKE },
    Property { name: "hold_grade", unit: &ONE, limits: 0.0..=1.0, of: DISC_BRAKE },
    Property { name: "wheelbase", unit: &METRE, limits: 0.5..=10.0, of: VEHICLE_BRAKE },
    Property { name: "centre_to_rear_axle", unit: &METRE, limits: 0.0..=10.0, of: VEHICLE_BRAKE },
    Property { name: "centre_height", unit: &METRE, limits: 0.0..=3.0, of: VEHICLE_BRAKE },
];

/// Changes the scene by the assignments, except those of the car, which are returned as the scripts take them: `NAME=VALUE` in SI units.
pub(crate) fn apply(example: Example, assignments: &[String], scene: &mut SceneFile) -> Result<Vec<String>> {
    let of_car = |assignment: &&String| assignment.trim_start().starts_with("car.");
    let (car, others): (Vec<&String>, Vec<&String>) = assignments.iter().partition(of_car);
    scenes::assign_all(scene, &others)?;
    let own = |assignment: &String| property(example, assignment.trim_start().trim_start_matches("car."));
    car.into_iter().map(own).collect()
}

/// An assignment of a property, `mass=1800 kg`, in its SI unit.
fn property(example: Example, assignment: &str) -> Result<String> {
    let Some((name, value)) = assignment.split_once('=').map(|(name, value)| (name.trim(), value.trim())) else {
        bail!("car.{} must be KEY=VALUE, as car.mass=\"1800 kg\"", Clipped(assignment));
    };
    let own = || PROPERTIES.iter().filter(|property| property.of.contains(&example));
    if own().next().is_none() {
        bail!("car.{} does not apply to {}: disc_brake and vehicle_brake have a car", Clipped(name), example.folder());
    }
    let Some(property) = own().find(|property| property.name == name) else {
        let names: Vec<&str> = own().map(|property| property.name).collect();
        bail!(
            "car.{}: the car of {} has {}{}",
            Clipped(name),
            example.folder(),
            names.join(", "),
            nearest(name, names.iter().copied())
        );
    };
    let (low, high) = (property.limits.start(), property.limits.end());
    match quantity::text(value, property.unit, true) {
        Ok(value) if property.limits.contains(&value) => Ok(format!("{name}={value}")),
        Ok(value) => bail!("car.{name} = {value} must be from {low} to {high} {}", property.unit.name),
        Err(wrong) => bail!("car.{name}: {wrong}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_car_and_its_brake_are_set_together() {
        let mut scene = scenes::load(Some("disc_brake")).unwrap();
        let set = ["car.mass=1.8 t", "punch.width=80 mm", "car.front_share = 65 %", "car.wheel_radius=0.33"];
        let set = set.map(|text| text.replace("1.8 t", "1800 kg"));
        let car = apply(Example::DiscBrake, &set, &mut scene).unwrap();
        assert_eq!(car, ["mass=1800", "front_share=0.65", "wheel_radius=0.33"]);
        let width = scene::variables::find("punch.width").unwrap() as usize;
        assert_eq!(scene.packaged.starts[width], 0.08);
    }

    #[test]
    fn what_is_no_property_of_the_car_is_refused() {
        let told = |example, text: &str| {
            let mut scene = scenes::load(Some("disc_brake")).unwrap();
            format!("{:#}", apply(example, &[text.to_owned()], &mut scene).unwrap_err())
        };
        for (example, text, reason) in [
            (Example::DiscBrake, "car.mass=0 kg", "car.mass = 0 must be from 100 to 100000 kg"),
            (Example::DiscBrake, "car.mass=3 m", "the wrong unit \"m\""),
            (Example::DiscBrake, "car.mas=1500", "did you mean mass"),
            (Example::DiscBrake, "car.mass", "must be KEY=VALUE"),
            (Example::VehicleBrake, "car.front_share=0.7", "the car of vehicle_brake has mass, wheel_radius"),
            (Example::Clutch, "car.mass=1500", "does not apply to clutch"),
            (Example::DiscBrake, "punch.widht=1", "punch.width"),
        ] {
            let message = told(example, text);
            assert!(message.contains(reason), "{text}: {message}");
        }
    }
}
