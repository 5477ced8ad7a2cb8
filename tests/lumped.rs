//! The lumped level through the component: exact values, balances, steps and events.

use sliding_contact::component::{Component, Snapshot, Values};
use sliding_contact::variables::{STARTS, find};
use std::sync::Arc;

/// A component with some start values replaced, initialised.
fn component(changes: &[(&str, f64)]) -> Component {
    let mut starts: Values = STARTS;
    for (name, value) in changes {
        starts[find(name).unwrap_or_else(|| panic!("no variable {name}")) as usize] = *value;
    }
    let mut component = Component::new(Arc::new(starts));
    component.enter_initialization();
    component.initialise(None).unwrap();
    component
}

fn get(component: &mut Component, name: &str) -> f64 {
    component.get(find(name).unwrap())
}

fn set(component: &mut Component, name: &str, value: f64) {
    component.set_input(find(name).unwrap(), value);
}

#[test]
fn a_stop_runs_and_its_heat_is_accounted_for() {
    let mut c = component(&[]);
    let (mut v, step) = (27.8, 0.05);
    set(&mut c, "normal_load", 8e3);
    while v > 0.0 {
        set(&mut c, "sliding_velocity", v);
        c.step(step).unwrap();
        v -= 6.0 * step;
    }
    for name in ["contact_temperature", "wear_depth", "friction_force", "dissipated_energy", "stored_heat",
        "heat_lost_ambient", "heat_received_punch", "heat_received_strip", "sliding_distance", "strip.mean_temperature"] {
        println!("{name} {}", get(&mut c, name));
    }
    println!("{}", "x");
    let balance = get(&mut c, "dissipated_energy")
        - get(&mut c, "stored_heat")
        - get(&mut c, "heat_lost_ambient")
        - get(&mut c, "heat_lost_punch_top")
        - get(&mut c, "heat_lost_strip_base");
    assert!(balance.abs() < 1e-9 * get(&mut c, "dissipated_energy"), "{balance}");
}

#[test]
fn timing() {
    let mut c = component(&[]);
    let temperature = find("contact_temperature").unwrap();
    let force = find("friction_force").unwrap();
    let wear = find("wear_depth").unwrap();
    for vary in [0.0] {
        let start = std::time::Instant::now();
        let n = 50_000;
        let mut sum = 0.0;
        for i in 0..n {
            c.set_input(0, 10.0 + vary * f64::from(i % 1000));
            c.set_input(1, 5e3 + vary * f64::from(i % 1000));
            c.step(0.1).unwrap();
            if vary < 1.0 { sum += c.get(temperature) + c.get(force) + c.get(wear); }
        }
        println!("work {:?}", c.work());
        println!("vary {vary}: {} ns ({sum})", start.elapsed().as_nanos() as f64 / f64::from(n));
    }
    let mut s = Snapshot::default();
    c.snapshot(&mut s);
    println!("bytes {}", s.encoded_size());
}
