//! Heat on the cells of an annular contact: conduction along the radius, growth of pressure bands, and agreement with the
//! lumped level in cases that are independent of the radius.
//!
//! Theory: docs/theory.md, section 4.7.

use super::driver::Driven;
use super::{Fallible, Problem, known};
use conduction::line::punch::{mate::reduce_mate, reduce};
use conduction::line::reduced::ReducedHeat;
use conduction::line::{Observed, SingleStep, Stage, Step, Surroundings, ThermalBody};
use elasticity::Cells;
use exact::{PartedRing, RadialBands};
use scene::Scene;
use scene::variables::{STARTS, find};
use std::f64::consts::PI;

pub(super) fn problems(all: &mut Vec<Problem>) {
    conduction(all);
    bands(all);
    uniform(all);
}

const WIDTH: f64 = 0.04;
const IRON: (f64, f64) = (54.0, 7200.0 * 460.0);

/// A thin ring of iron of 60 to 100 mm, insulated except for the contact.
fn conduction(all: &mut Vec<Problem>) {
    for (name, mate) in [("ring", false), ("mate of an annulus", true)] {
        let exact = parted_ring();
        all.push(Problem {
            name: format!("{name} heated inside and cooled outside of a radius, steady"),
            quantity: "temperature of the outer above the inner edge, K",
            exact: known(exact.0),
            scale: None,
            compute: Box::new(move || parted(mate)),
            bound: 1e-6,
            reason: "edges 28 heights away from the jump of the flux, sums of Bessel functions cut at 256 terms",
        });
    }
}

const CELLS: usize = 65;
const HEIGHT: f64 = 0.5e-3;
/// First cell that is cooled.
const PARTING: usize = 40;
const MEAN_RADIUS: f64 = 0.08;

fn cells() -> Fallible<Cells> {
    Ok(Cells::graded(0.5 * WIDTH, CELLS)?)
}

/// The exact difference between the outermost and the innermost cell, and the flux outside.
fn parted_ring() -> (f64, f64) {
    let Ok(cells) = cells() else { return (f64::NAN, f64::NAN) };
    let radius = |edge: usize| MEAN_RADIUS + cells.edges()[edge];
    let ring =
        PartedRing { radii: [radius(0), radius(PARTING), radius(CELLS)], conductance: IRON.0 * HEIGHT, flux: 1e4 };
    // Through an insulated height the temperature of the face exceeds the mean by q h/(3 K).
    let through = (ring.outer_flux() - ring.flux) * HEIGHT / (3.0 * IRON.0);
    (ring.rise(radius(CELLS - 1), radius(CELLS)) - ring.rise(radius(0), radius(1)) + through, ring.outer_flux())
}

fn parted(mate: bool) -> Fallible<f64> {
    let cells = cells()?;
    let mut values = STARTS;
    let body = if mate { "strip" } else { "punch" };
    for (name, value) in annular(MEAN_RADIUS) {
        values[find(name).ok_or("no such variable")? as usize] = value;
    }
    for (name, value) in iron() {
        values[find(&format!("{body}.{name}")).ok_or("no such variable")? as usize] = value;
    }
    let scene = Scene::new(&values, None)?;
    let made = match mate {
        true => reduce_mate(&scene, &cells, 1e-3, 100.0)?,
        false => reduce(&scene, &cells, 1e-3, 100.0)?,
    };
    let mut heat: ReducedHeat = made.ok_or("an insulator")?;
    let outer = parted_ring().1;
    let flux: Vec<f64> = (0..CELLS).map(|cell| if cell < PARTING { 1e4 } else { outer }).collect();
    let around = Surroundings::default();
    let mut state = vec![0.0; heat.states()];
    let (mut temperature, mut distortion) = (vec![0.0; CELLS], vec![0.0; CELLS]);
    // Long against the time of conduction along the ring.
    heat.prepare(&Step::new(1e6, [0.0; 2]));
    heat.step(&mut state, &around, &flux, &flux);
    heat.free_response(&state, &around, Stage::End, &flux, &mut temperature, &mut distortion);
    let influence = &heat.influence(Stage::End).temperature;
    let at = |cell: usize| temperature[cell] + (0..CELLS).map(|j| influence[(cell, j)] * flux[j]).sum::<f64>();
    Ok(at(CELLS - 1) - at(0))
}

fn annular(mean_radius: f64) -> [(&'static str, f64); 6] {
    [
        ("contact.geometry", 2.0),
        ("contact.mean_radius", mean_radius),
        ("punch.width", WIDTH),
        ("depth", 2.0 * PI * mean_radius),
        ("strip.path", 2.0),
        ("strip.length", 0.0),
    ]
}

fn iron() -> [(&'static str, f64); 7] {
    [
        ("height", HEIGHT),
        ("conductivity", IRON.0),
        ("density", 7200.0),
        ("specific_heat", 460.0),
        ("thermal_expansion", 0.0),
        ("convection", 0.0),
        ("convection_forced", 0.0),
    ]
}

/// Columns of iron that slide on a rigid insulator, at 1.5 times the critical speed of pressure bands on a straight contact
/// of the same width.
fn bands(all: &mut Vec<Problem>) {
    let mean_radius = 0.16;
    let diffusivity = IRON.0 / IRON.1;
    let decay = diffusivity * (PI / WIDTH).powi(2);
    let drive = 1.5 * decay;
    let radii = [mean_radius - 0.5 * WIDTH, mean_radius + 0.5 * WIDTH];
    all.push(Problem {
        name: "bands across an annulus of columns at 1.5 times the critical speed".into(),
        quantity: "growth rate, 1/s",
        exact: Box::new(move || Ok(RadialBands { radii, diffusivity, drive }.growth())),
        scale: Some(decay),
        compute: Box::new(move || band_growth(mean_radius, drive, 65)),
        bound: 1e-3,
        reason: "65 cells on half a wave, steps of second order, bands of other lengths that have not died out",
    });
}

fn band_growth(mean_radius: f64, drive: f64, cells: usize) -> Fallible<f64> {
    let (stiffness, friction, expansion, nu) = (3e10, 0.3, 1.2e-5, 0.25);
    let speed = drive * IRON.1 / (friction * stiffness * expansion * (1.0 + nu));
    let load = 1e4;
    let run = |gap: f64| -> Fallible<[f64; 3]> {
        let shape: Vec<(String, f64)> = (1..=33)
            .map(|k| (format!("contact.initial_gap[{k}]"), gap * (1.0 + (PI * f64::from(k - 1) / 32.0).cos())))
            .collect();
        let mut changes = annular(mean_radius).to_vec();
        changes.extend([
            ("solver.fidelity", 3.0),
            ("solver.cells", cells as f64),
            ("solver.tolerance", 1e-5),
            ("contact.faces", 1.0),
            ("contact.friction_coefficient", friction),
            ("contact.initial_shape", 4.0),
            ("strip.body", 1.0),
            ("strip.conductivity", 0.0),
            ("strip.wear_coefficient", 0.0),
            ("strip.thermal_expansion", 0.0),
            ("punch.body", 2.0),
            ("punch.foundation_stiffness", stiffness),
            ("punch.poissons_ratio", nu),
            ("punch.height", 0.02),
            ("punch.conductivity", IRON.0),
            ("punch.density", 7200.0),
            ("punch.specific_heat", 460.0),
            ("punch.thermal_expansion", expansion),
            ("punch.wear_coefficient", 0.0),
            ("punch.convection", 0.0),
            ("punch.top_thermal", 3.0),
            ("nominal.load", load),
            ("nominal.velocity", speed),
            ("nominal.duration", 30.0),
        ]);
        changes.extend(shape.iter().map(|(name, value)| (name.as_str(), *value)));
        let mut driven = Driven::new(&changes)?;
        driven.set("normal_load", load)?;
        driven.set("sliding_velocity", speed)?;
        let mut pressures = [0.0; 3];
        for pressure in &mut pressures {
            driven.steps(0.5, 17)?;
            *pressure = driven.get("profile.pressure[1]")?;
        }
        if driven.get("contact_fraction")? < 1.0 {
            return Err("the contact opens".into());
        }
        Ok(pressures)
    };
    // The effect of the load is the same in both runs; the difference is that of the gap.
    let (plain, shaped) = (run(0.0)?, run(1e-8)?);
    let [first, second, third] = std::array::from_fn(|k| shaped[k] - plain[k]);
    Ok(((third - second) / (second - first)).ln() / 8.5)
}

/// A ring so slender that all quantities are independent of the radius, braked by pads that cover three tenths of it: line
/// level against lumped level.
fn uniform(all: &mut Vec<Problem>) {
    let quantities: [(&'static str, &'static str); 4] = [
        ("contact_temperature", "rise of the contact temperature, K"),
        ("strip.mean_temperature", "rise of the disc's mean temperature, K"),
        ("punch.mean_temperature", "rise of the pads' mean temperature, K"),
        ("heat_flow_ambient", "heat flow to the air, W"),
    ];
    for (variable, quantity) in quantities {
        all.push(Problem {
            name: format!("annulus where nothing depends on the radius against the lumped level, {variable}"),
            quantity,
            exact: Box::new(move || slender(2.0, variable)),
            scale: None,
            compute: Box::new(move || slender(3.0, variable)),
            bound: 1e-6,
            reason: "tolerance of the reduced means, 2e-6; pressure that is even but for 3e-7",
        });
    }
}

fn slender(level: f64, variable: &str) -> Fallible<f64> {
    // Three tenths of the circumference.
    let changes = [("solver.fidelity", level), ("depth", 0.3 * PI * 10.0)];
    let mut driven = Driven::read(include_str!("../scenes/slender_annulus.toml"), &changes)?;
    driven.set("normal_load", 1e6)?;
    driven.set("sliding_velocity", 10.0)?;
    driven.steps(0.5, 120)?;
    let value = driven.get(variable)?;
    Ok(if variable.ends_with("temperature") { value - 293.15 } else { value })
}
