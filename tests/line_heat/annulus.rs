//! Resolved heat of an annular contact: a ring sliding on a ring.

use elasticity::discretization::{cells_for, compliances};
use scene::Scene;
use steady::states::Sliding;
use steady::thermal::{HotState, hot_state};
use test_support::{CONVECTING, Drive, HELD, INSULATED, changed_scene, scene};

/// The clutch of the examples on the contact line.
fn clutch(changes: &[(&str, f64)]) -> Drive {
    let line = [("solver.fidelity", 3.0), ("solver.cells", 17.0), ("solver.tolerance", 1e-3)];
    Drive::from_starts(&scene("clutch"), &[&line[..], changes].concat())
}

/// Changes that turn the clutch into two brake pads on a disc, each a sixth of the circle.
const PADS: [(&str, f64); 3] = [("depth", 0.099), ("punch.count", 2.0), ("contact.stick_stiffness", 0.0)];

fn engage(drive: &mut Drive, steps: std::ops::Range<u32>) -> Vec<u64> {
    let mut bits = Vec::new();
    for step in steps {
        let part = f64::from(step) / 40.0;
        let slip = 300.0 * (1.0 - part).max(-0.1);
        drive.set("angular_velocity", slip).set("normal_load", 5e3 * (0.2 + part).min(1.0));
        if step % 5 == 2 {
            drive.slope("angular_velocity", -300.0);
        }
        drive.step(0.02 + 0.01 * f64::from(step % 3));
        for output in 7..250 {
            let value = drive.0.get(output);
            assert!(value.is_finite(), "{output}");
            bits.push(value.to_bits());
        }
    }
    bits
}

#[test]
fn the_account_closes_with_every_cooling() {
    for changes in [
        &[][..],
        &PADS,
        &[("punch.top_thermal", HELD), ("strip.base_thermal", HELD)],
        &[("punch.top_thermal", CONVECTING), ("strip.base_thermal", INSULATED), ("strip.cooled_area", 0.05)],
        &[("punch.emissivity", 0.8), ("strip.emissivity", 0.5), ("strip.convection_forced", 30.0), ("depth", 0.3)],
        &[("punch.conductivity", 0.0)],
        &[("strip.property_table.points", 0.0), ("strip.conductivity", 0.0), ("punch.convection", 300.0)],
        &[("contact.conductance", 0.0), ("holder.stiffness", 1e8)],
        &[("contact.stick_stiffness", 0.0), ("depth", 0.2)],
    ] {
        let mut drive = clutch(changes);
        engage(&mut drive, 0..30);
        let received = drive.get("heat_received_punch") + drive.get("heat_received_strip");
        let (work, imbalance) = (drive.get("dissipated_energy"), drive.imbalance());
        assert!(work > 1e3 && (received / work - 1.0).abs() < 1e-9, "{changes:?}");
        assert!(imbalance < 1e-9, "{changes:?}: {imbalance}");
        assert!(drive.get("contact_temperature_max") >= drive.get("contact_temperature"));
    }
}

#[test]
fn friction_heat_is_torque_times_speed() {
    for changes in [&[][..], &PADS] {
        let mut drive = clutch(&[changes, &[("contact.stick_stiffness", 0.0), ("solver.tolerance", 1e-4)]].concat());
        drive.set("angular_velocity", 200.0).set("normal_load", 5e3).steps(20, 0.01);
        let (torque, power) = (drive.get("friction_torque"), drive.get("friction_power"));
        let heat = drive.get("heat_flow_punch") + drive.get("heat_flow_strip");
        assert!((power / (200.0 * torque) - 1.0).abs() < 1e-9, "{power} {torque}");
        assert!((heat / power - 1.0).abs() < 1e-6, "{changes:?}: {heat} {power}");
        // Sliding faster outside, the clutch is hotter there than inside.
        assert!(drive.get("profile.temperature[28]") > drive.get("profile.temperature[6]") + 1.0, "{changes:?}");
    }
}

/// Profiles of pressure and temperature after slip that falls, with `parts` steps.
fn slow_down(parts: u32, changes: &[(&str, f64)]) -> [Vec<f64>; 2] {
    // Below the critical speed, with internal steps as long as the communication steps.
    let plain = [
        ("solver.tolerance", 0.1),
        ("contact.stick_stiffness", 0.0),
        ("contact.static_friction_ratio", 1.0),
        ("*.thermal_expansion", 1e-6),
    ];
    let mut drive = clutch(&[&plain[..], changes].concat());
    drive.set("normal_load", 5e3);
    let duration = 0.4;
    let step = duration / f64::from(parts);
    let velocity = |time: f64| 30.0 * (time / duration).powi(3);
    for part in 0..parts {
        let time = step * f64::from(part);
        let (from, to) = (velocity(time), velocity(time + step));
        drive.set("sliding_velocity", from).slope("sliding_velocity", (to - from) / step);
        drive.step(step);
    }
    assert!(drive.get("contact_fraction") > 0.999);
    ["pressure", "temperature"].map(|name| drive.profile(name))
}

#[test]
fn pressure_and_temperature_are_of_second_order() {
    for changes in [&[][..], &PADS[..2]] {
        let finest = slow_down(1280, changes);
        let errors = [40, 80, 160].map(|parts| {
            let values = slow_down(parts, changes);
            [0, 1].map(|quantity| {
                let pairs = values[quantity].iter().zip(&finest[quantity]);
                pairs.map(|(value, exact)| (value - exact).powi(2)).sum::<f64>().sqrt()
            })
        });
        for quantity in 0..2 {
            let order = (errors[0][quantity] / errors[2][quantity]).log2() / 2.0;
            assert!((1.9..2.1).contains(&order), "{changes:?} {quantity}: {order} {errors:?}");
        }
    }
}

/// The clutch with these changes, and its hot steady state on 17 cells.
fn found_directly(changes: &[(&str, f64)], sliding: &Sliding) -> (Scene, HotState) {
    let made = changed_scene(&scene("clutch"), changes);
    let cells = cells_for(&made, 17).unwrap();
    let bodies = compliances(&made, &cells).unwrap();
    let hot = hot_state(&made, &cells, &bodies, sliding).unwrap();
    (made, hot)
}

/// Long sliding at a constant speed converges to the directly computed steady state.
#[test]
fn stepping_ends_in_the_steady_state_found_directly() {
    let steady = [
        ("contact.stick_stiffness", 0.0),
        ("contact.static_friction_ratio", 1.0),
        ("nominal.load", 500.0),
        ("nominal.velocity", 2.0),
        ("nominal.duration", 2e4),
        ("punch.top_thermal", HELD),
        ("strip.convection", 100.0),
        ("punch.wear_coefficient", 5e-13),
        ("strip.wear_coefficient", 1.5e-13),
        ("solver.tolerance", 1e-4),
        // Below the critical speed: stable for any duration.
        ("*.thermal_expansion", 1e-7),
    ];
    let radiating = [("strip.emissivity", 0.9), ("punch.emissivity", 0.6), ("punch.top_thermal", CONVECTING)];
    let hotter = [&PADS[..], &radiating, &[("strip.convection", 10.0), ("punch.convection_forced", 20.0)]].concat();
    for changes in [&[][..], &PADS, &hotter] {
        let changes = [&steady[..], changes].concat();
        let (_, hot) = found_directly(&changes, &Sliding::Unidirectional { velocity: 2.0 });
        let mut drive = clutch(&changes);
        drive.set("normal_load", 500.0).set("sliding_velocity", 2.0);
        for step in 0..30 {
            drive.step(0.1 * 1.5f64.powi(step));
        }
        let (t, ambient) = (drive.get("contact_temperature"), 333.15);
        let rise = hot.heat.contact_temperature[1] - ambient;
        let highest = hot.state.strokes[0].pressure.iter().copied().fold(0.0, f64::max);
        let flows = hot.heat.flows;
        assert!((t - ambient - rise).abs() < 1e-3 * rise, "{t} {rise}");
        assert!((highest / drive.get("pressure_max") - 1.0).abs() < 1e-3, "{highest}");
        assert!((drive.get("friction_power") / flows.friction - 1.0).abs() < 1e-3);
        assert!((drive.get("heat_flow_punch") - flows.punch).abs() < 1e-3 * flows.friction);
        // All of it leaves, each face its part.
        let lost = flows.punch_top + flows.strip_base + flows.ambient;
        assert!((lost / flows.friction - 1.0).abs() < 1e-4, "{changes:?}: {flows:?}");
        for (name, flow) in [
            ("heat_flow_punch_top", flows.punch_top),
            ("heat_flow_strip_base", flows.strip_base),
            ("heat_flow_ambient", flows.ambient),
        ] {
            assert!((drive.get(name) - flow).abs() < 2e-3 * flows.friction, "{changes:?} {name}: {}", drive.get(name));
        }
        assert!((drive.get("contact_temperature_max") - hot.heat.highest).abs() < 1e-3 * rise, "{}", hot.heat.highest);
    }
}

/// Long reciprocating sliding converges to the directly computed steady cycle, on the whole circle and with two pads.
#[test]
fn stepping_reciprocating_ends_in_the_cycle_found_directly() {
    // Different forward and backward speeds: the temperature oscillates with the strokes.
    let (speeds, stroke) = ([3.0, 1.0], 0.5);
    let steady = [
        ("contact.stick_stiffness", 0.0),
        ("contact.static_friction_ratio", 1.0),
        ("nominal.load", 500.0),
        ("nominal.velocity", 2.0),
        ("nominal.stroke", stroke),
        ("nominal.duration", 200.0),
        ("*.height", 2e-3),
        ("punch.top_thermal", HELD),
        ("strip.base_thermal", HELD),
        ("punch.wear_coefficient", 5e-11),
        ("strip.wear_coefficient", 1.5e-11),
        ("solver.tolerance", 1e-4),
        ("*.thermal_expansion", 1e-6),
    ];
    for changes in [&[][..], &PADS] {
        let changes = [&steady[..], changes].concat();
        let (made, hot) = found_directly(&changes, &Sliding::Reciprocating { strokes: [stroke; 2], speeds });
        let mut drive = clutch(&changes);
        drive.set("normal_load", 500.0);
        let (mut least, mut highest) = (f64::INFINITY, 0.0_f64);
        for _ in 0..200 {
            (least, highest) = (f64::INFINITY, 0.0);
            for velocity in [speeds[0], -speeds[1]] {
                drive.set("sliding_velocity", velocity);
                for _ in 0..10 {
                    drive.step(0.1 * stroke / velocity.abs());
                    let t = drive.get("contact_temperature");
                    (least, highest) = (least.min(t), highest.max(t));
                }
            }
        }
        let ambient = 333.15;
        let [lowest, _, largest] = hot.heat.contact_temperature;
        let end = &hot.heat.strokes[1].pressure_at[1];
        let peak = end.iter().copied().fold(0.0, f64::max);
        assert!((highest - largest).abs() < 2e-3 * (largest - ambient), "{highest} {largest}");
        assert!((least - lowest).abs() < 2e-3 * (largest - ambient), "{least} {lowest}");
        assert!((peak / drive.get("pressure_max") - 1.0).abs() < 2e-3, "{peak}");
        assert!(largest - lowest > 0.1 * (largest - ambient), "{lowest} {largest}");
        // Steady wear determines the pressure: higher at the inner radius, where the sliding velocity is lower.
        assert!(peak > 1.05 * 500.0 / made.contact_area() / made.count, "{peak}");
    }
}

/// Above the critical speed a band of the carbon clutch takes up the load, below it the load stays spread.
#[test]
fn bands_grow_above_the_critical_speed_only() {
    let changes = [
        ("*.youngs_modulus", 2e10),
        ("*.poissons_ratio", 0.2),
        ("*.density", 1750.0),
        ("*.specific_heat", 1200.0),
        ("*.conductivity", 80.0),
        ("*.thermal_expansion", 1e-6),
        ("*.height", 0.006),
        ("*.wear_coefficient", 0.0),
        ("contact.friction_coefficient", 0.25),
        ("contact.static_friction_ratio", 1.0),
        ("contact.stick_stiffness", 0.0),
        ("nominal.velocity", 10.0),
        ("strip.property_table.points", 0.0),
    ];
    let unevenness = |ratio: f64| {
        let mut drive = clutch(&changes);
        drive.set("normal_load", 5e3);
        drive.set("sliding_velocity", 1.0);
        let speed = ratio * drive.get("critical_speed");
        drive.set("sliding_velocity", speed);
        let mut highest = Vec::new();
        for step in 0..80 {
            // The longest wave takes seconds to grow.
            drive.step(0.1);
            if step % 20 == 19 {
                highest.push(drive.get("pressure_max") / drive.get("pressure_mean"));
            }
        }
        (highest, drive.get("contact_fraction"), drive.imbalance())
    };
    let (below, above) = (unevenness(0.3), unevenness(3.0));
    assert!(below.1 == 1.0 && below.0[3] < 1.05 * below.0[0], "{below:?}");
    assert!(above.1 < 0.9 && above.0[3] > 2.0 * below.0[3], "{above:?}");
    assert!(above.2 < 1e-9, "{above:?}");
}

/// A clutch that is closed from load 0 in one communication step: its friction work is that of the course of the load, `mu v F t/2`.
#[test]
fn a_load_that_begins_at_zero_is_felt_from_the_first_step_on() {
    let work = |steps: u32| {
        let line = [("solver.fidelity", 3.0), ("solver.cells", 17.0)];
        let mut drive = Drive::from_starts(&scene("clutch"), &line);
        for step in 0..steps {
            let load = 5e3 * f64::from(step) / f64::from(steps);
            drive.set("sliding_velocity", 20.0).set("normal_load", load).slope("normal_load", 5e4);
            drive.step(0.1 / f64::from(steps));
        }
        (drive.get("dissipated_energy"), drive.get("friction_power"))
    };
    let [(one, power), (many, _)] = [work(1), work(50)];
    assert!((one / many - 1.0).abs() < 0.02, "{one} and {many} J");
    assert!((one / (0.05 * power) - 1.0).abs() < 0.1, "{one} J at {power} W");
}

/// A bristle that slips leaves the heat, the wear and the temperature of rigid friction, however the run is cut; also in hot
/// bodies that cool, where the friction of each cell rises.
#[test]
fn a_slipping_bristle_heats_as_rigid_friction_does() {
    let stable = [("contact.static_friction_ratio", 1.0), ("*.thermal_expansion", 1e-6), ("*.initial_at_ambient", 0.0)];
    let names = ["dissipated_energy", "wear_depth_punch", "wear_depth_strip", "contact_temperature"];
    for (start, bound) in [(333.15, 1e-5), (630.0, 2e-4)] {
        let hot = [("*.initial_temperature", start), ("strip.convection", 2e3)];
        let run = |stiffness: f64, cuts: [u32; 2]| {
            let mut drive = clutch(&[&stable[..], &hot, &[("contact.stick_stiffness", stiffness)]].concat());
            drive.set("normal_load", 2e3);
            for ((from, to), cut) in [(0.0, 20.0), (20.0, 2.0)].into_iter().zip(cuts) {
                let (step, rate) = (5.0 / f64::from(cut), (to - from) / 5.0);
                for part in 0..cut {
                    drive.set("angular_velocity", from + rate * step * f64::from(part));
                    drive.slope("angular_velocity", rate).step(step);
                }
            }
            names.map(|name| drive.get(name) - if name == "contact_temperature" { 300.0 } else { 0.0 })
        };
        let rigid = run(0.0, [100, 100]);
        for cuts in [[1, 1], [10, 3], [100, 100]] {
            let slipping = run(1e9, cuts);
            for ((name, own), rigid) in names.iter().zip(slipping).zip(rigid) {
                assert!((own / rigid - 1.0).abs() < bound, "{start} K, {cuts:?} {name}: {own} {rigid}");
            }
        }
    }
}

/// With mean heat the friction of the tables is predicted over the inputs as they change: load and speed that fall together wear the
/// same in one step as in many.
#[test]
fn mean_heat_is_predicted_over_inputs_that_change() {
    let worn = |steps: u32| {
        let mut drive = clutch(&[("solver.heat", 2.0)]);
        let duration = 2.0;
        for step in 0..steps {
            let left = 1.0 - f64::from(step) / f64::from(steps);
            drive.set("normal_load", 1e3 * left).slope("normal_load", -1e3 / duration);
            drive.set("sliding_velocity", 0.5 + 0.9 * left).slope("sliding_velocity", -0.9 / duration);
            drive.step(duration / f64::from(steps));
        }
        drive.get("wear_depth")
    };
    let (one, many) = (worn(1), worn(100));
    assert!((one / many - 1.0).abs() < 0.03, "{one:e} {many:e}");
}
