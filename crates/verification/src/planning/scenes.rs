//! Generated scenes: reproducible samples of users' scenes, each with its input trajectory.
//!
//! The groups are pins on discs, reciprocating blocks, pads on brake discs, blocks in unidirectional sliding over fresh
//! material, and annular clutches. Within a group everything that planning depends on is drawn: stiffness of both bodies,
//! Peclet number, wear over elastic approach, exponents, fade tables, expansion, holder, conductance. Runs stay within the
//! nominal range of the scene (load and speed at most nominal, over the nominal duration) and below the critical speed of
//! thermoelastic instability, above which discretisations do not agree.

use model::INPUTS;
use model::instability::CriticalSpeed;
use scene::variables::{COUNT, STARTS, find, reference};
use scene::{Scene, value};
use sliding_contact::component::Values;
use std::f64::consts::PI;

/// Reproducible random numbers in [0, 1): a linear congruential generator.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// Generator with a seed.
    pub fn new(seed: u64) -> Random {
        let mut random = Random(seed ^ 0x9e37_79b9_7f4a_7c15);
        // Decorrelates neighbouring seeds.
        (0..8).for_each(|_| {
            random.next();
        });
        random
    }

    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    /// Log-uniform number.
    pub(crate) fn scaled(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.next())
    }

    pub(crate) fn chance(&mut self, part: f64) -> bool {
        self.next() < part
    }

    pub(crate) fn one_of<T: Copy>(&mut self, items: &[T]) -> T {
        items[((self.next() * items.len() as f64) as usize).min(items.len() - 1)]
    }
}

/// Kinds of scenes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Group {
    /// Pin on a disc, unidirectional on a closed path.
    Pin,
    /// Reciprocating block on a straight path.
    Reciprocating,
    /// Pad on a brake disc.
    Disc,
    /// Block in unidirectional sliding over fresh material.
    Unidirectional,
    /// Facing of a clutch.
    Annular,
}

impl Group {
    /// All groups.
    pub const ALL: [Group; 5] = [Group::Pin, Group::Reciprocating, Group::Disc, Group::Unidirectional, Group::Annular];

    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Group::Pin => "pin",
            Group::Reciprocating => "reciprocating",
            Group::Disc => "disc",
            Group::Unidirectional => "unidirectional",
            Group::Annular => "annular",
        }
    }
}

/// A scene and its input trajectory.
#[derive(Clone, Debug)]
pub struct Generated {
    /// Group of the scene.
    pub group: Group,
    /// Seed of the scene.
    pub seed: u64,
    /// Values of the variable table.
    pub starts: Box<Values>,
    /// Communication points: time (s), sliding velocity (m/s), normal load (N); linear between.
    pub course: Vec<[f64; 3]>,
}

impl Generated {
    /// The scene at a tolerance.
    ///
    /// # Errors
    /// The violated rule.
    pub fn scene(&self, tolerance: f64) -> Result<Scene, String> {
        let mut values = self.starts.clone();
        value!(values, "solver.tolerance") = tolerance;
        Scene::new(&values, None).map_err(|broken| broken.to_string())
    }

    /// Inputs at a point of the trajectory.
    pub fn inputs(&self, point: usize) -> [f64; INPUTS] {
        let mut inputs: [f64; INPUTS] = std::array::from_fn(|index| self.starts[index]);
        let [_, velocity, load] = self.course[point];
        (inputs[0], inputs[1]) = (velocity, load);
        inputs
    }

    /// Label in tables: group and seed.
    pub fn name(&self) -> String {
        format!("{} {}", self.group.name(), self.seed)
    }
}

/// Elastic and thermal values: Young's modulus (Pa), Poisson's ratio, density, specific heat, conductivity, expansion.
type Matter = [f64; 6];
const IRON: Matter = [1.1e11, 0.26, 7200.0, 460.0, 54.0, 11e-6];
const STEEL: Matter = [2e11, 0.3, 7800.0, 460.0, 50.0, 11e-6];
const STAINLESS: Matter = [2e11, 0.3, 7900.0, 500.0, 15.0, 16e-6];
const BRONZE: Matter = [1.15e11, 0.33, 8800.0, 377.0, 67.0, 18e-6];
const POLYMER: Matter = [2.4e9, 0.37, 1300.0, 1200.0, 0.25, 65e-6];
const LINING: Matter = [1e9, 0.25, 2600.0, 1000.0, 1.2, 15e-6];
const SINTERED: Matter = [3e10, 0.25, 5500.0, 440.0, 16.0, 14e-6];
const PAPER: Matter = [3e7, 0.25, 1100.0, 1600.0, 0.24, 20e-6];
const ALUMINIUM: Matter = [6.9e10, 0.33, 2700.0, 896.0, 167.0, 23.6e-6];

const STRAIGHT: f64 = 1.0;
const CLOSED: f64 = 2.0;

/// Start values under construction.
struct Draft {
    values: Box<[f64; COUNT]>,
}

impl Draft {
    fn set(&mut self, name: &str, value: f64) {
        let index = find(name).unwrap_or_else(|| unreachable!("a row of the variable table is called {name}"));
        self.values[index as usize] = value;
    }

    fn get(&self, name: &str) -> f64 {
        find(name).map_or(f64::NAN, |index| self.values[index as usize])
    }

    fn matter(&mut self, body: &str, matter: Matter) {
        let names =
            ["youngs_modulus", "poissons_ratio", "density", "specific_heat", "conductivity", "thermal_expansion"];
        for (name, value) in names.into_iter().zip(matter) {
            self.set(&format!("{body}.{name}"), value);
        }
    }
}

/// Values fixed by a group before the common ones are drawn.
struct Frame {
    punch: Matter,
    strip: Matter,
    width: f64,
    depth: f64,
    pressure: f64,
    velocity: f64,
    duration: f64,
    stroke: f64,
}

/// Scene of a seed, which also determines the group.
pub fn generate(seed: u64) -> Generated {
    let mut random = Random::new(seed);
    let group = Group::ALL[(seed % Group::ALL.len() as u64) as usize];
    let mut draft = Draft { values: Box::new(STARTS) };
    let mut frame = frame(group, &mut random, &mut draft);
    bodies(group, &frame, &mut random, &mut draft);
    let rise = heat(group, &mut frame, &mut random, &mut draft);
    wear(group, &frame, &mut random, &mut draft);
    laws(&frame, rise, &mut random, &mut draft);
    holder(group, &frame, &mut random, &mut draft);
    stay_stable(&mut random, &mut draft);
    let course = course(group, &mut random, &draft);
    Generated { group, seed, starts: draft.values, course }
}

fn frame(group: Group, random: &mut Random, draft: &mut Draft) -> Frame {
    let hard = [(STEEL, STEEL), (BRONZE, STEEL), (STEEL, STAINLESS), (POLYMER, STEEL), (BRONZE, ALUMINIUM)];
    let frame = match group {
        Group::Pin => {
            let (punch, strip) = random.one_of(&hard);
            let width = random.scaled(2e-3, 1.2e-2);
            let duration = random.scaled(2.0, 2000.0);
            let velocity = random.scaled(0.02, 3.0);
            let pressure = random.scaled(0.5e6, 8e6);
            Frame { punch, strip, width, depth: width, pressure, velocity, duration, stroke: 0.0 }
        }
        Group::Reciprocating => {
            let (punch, strip) = random.one_of(&hard);
            let width = random.scaled(4e-3, 6e-2);
            let stroke = width * random.scaled(0.1, 3.0);
            let velocity = random.scaled(5e-3, 0.5);
            // Several cycles at this mean speed.
            let duration = random.between(2.0, 4.0).round() * 2.0 * stroke / velocity;
            let pressure = random.scaled(0.5e6, 1.5e7);
            Frame { punch, strip, width, depth: 1e-2, pressure, velocity, duration, stroke }
        }
        Group::Disc => {
            let punch = random.one_of(&[LINING, LINING, SINTERED]);
            let width = random.scaled(3e-2, 0.11);
            let duration = random.scaled(2.0, 300.0);
            let velocity = random.scaled(1.0, 25.0);
            let pressure = random.scaled(0.2e6, 2e6);
            Frame { punch, strip: IRON, width, depth: 0.05, pressure, velocity, duration, stroke: 0.0 }
        }
        Group::Unidirectional => {
            let (punch, strip) = random.one_of(&hard);
            let width = random.scaled(3e-3, 4e-2);
            // At least several widths, so that the strip's steady heating is reached.
            let velocity = random.scaled(1e-3, 0.3);
            let duration = random.scaled(3.0, 30.0) * width / velocity;
            let pressure = random.scaled(0.5e6, 8e6);
            Frame { punch, strip, width, depth: 1e-2, pressure, velocity, duration, stroke: 0.0 }
        }
        Group::Annular => {
            let punch = random.one_of(&[LINING, SINTERED, PAPER]);
            let width = random.scaled(8e-3, 4e-2);
            let velocity = random.scaled(2.0, 30.0);
            let pressure = random.scaled(0.1e6, 0.8e6);
            let strip = random.one_of(&[IRON, STEEL]);
            Frame {
                punch,
                strip,
                width,
                depth: 0.0,
                pressure,
                velocity,
                duration: random.scaled(0.5, 5.0),
                stroke: 0.0,
            }
        }
    };
    draft.matter("punch", frame.punch);
    draft.matter("strip", frame.strip);
    frame
}

fn bodies(group: Group, frame: &Frame, random: &mut Random, draft: &mut Draft) {
    let width = frame.width;
    draft.set("punch.width", width);
    draft.set("depth", frame.depth);
    draft.set("contact.faces", 1.0);
    let straight = matches!(group, Group::Reciprocating | Group::Unidirectional);
    draft.set("strip.path", if straight { STRAIGHT } else { CLOSED });
    let (radius, punch_height, strip_height) = match group {
        Group::Pin => {
            (random.scaled(8e-3, 4e-2).max(0.8 * width), width * random.scaled(0.5, 2.0), random.scaled(3e-3, 2e-2))
        }
        Group::Disc => (random.between(0.1, 0.2), random.scaled(6e-3, 1.8e-2), random.scaled(6e-3, 1.4e-2)),
        Group::Annular => {
            let radius = width * random.scaled(1.5, 6.0);
            draft.set("depth", 2.0 * PI * radius);
            draft.set("contact.geometry", 2.0);
            draft.set("contact.shear_coupling", 0.0);
            (radius, width * random.scaled(0.08, 0.4), random.scaled(4e-3, 1.5e-2))
        }
        _ => (0.0, width * random.scaled(0.5, 2.0), width * random.scaled(0.3, 2.0)),
    };
    draft.set("contact.mean_radius", radius);
    draft.set("strip.length", 0.0);
    draft.set("punch.height", punch_height);
    draft.set("strip.height", strip_height);
    if group == Group::Pin && random.chance(0.3) {
        draft.set("punch.count", random.between(2.0, 3.4).floor());
    }
    // Mostly elastic bodies; one of them may be simpler.
    let kinds = [4.0, 4.0, 4.0, 4.0, 3.0, 2.0];
    draft.set("strip.body", random.one_of(&kinds));
    draft.set("punch.body", if random.chance(0.15) { 1.0 } else { 4.0 });
    draft.set("strip.base", if random.chance(0.2) { 2.0 } else { 1.0 });
}

/// Draws the thermal parameters; returns the expected mean rise, K.
fn heat(group: Group, frame: &mut Frame, random: &mut Random, draft: &mut Draft) -> f64 {
    let friction = random.between(0.1, 0.6);
    draft.set("contact.friction_coefficient", friction);
    draft.set("contact.conductance", random.scaled(5e3, 2e5));
    let straight = matches!(group, Group::Reciprocating | Group::Unidirectional);
    draft.set("punch.top_thermal", random.one_of(&[1.0, 2.0, 3.0]));
    draft.set("strip.base_thermal", if straight { 1.0 } else { random.one_of(&[1.0, 2.0, 3.0]) });
    draft.set("punch.convection", random.scaled(5.0, 50.0));
    draft.set("strip.convection", random.scaled(5.0, 50.0));
    draft.set("strip.convection_forced", if group == Group::Disc { 8.0 } else { 0.0 });
    draft.set("strip.emissivity", if random.chance(0.3) { 0.5 } else { 0.0 });
    // Rise by effusivity over the duration, of a strip whose heat is distributed along its path.
    let effusivity = |matter: &Matter| (matter[2] * matter[3] * matter[4]).sqrt();
    let cover = match group {
        Group::Pin | Group::Disc => {
            draft.get("punch.count") * frame.width / (2.0 * PI * draft.get("contact.mean_radius"))
        }
        _ => 1.0,
    };
    let flux = friction * frame.pressure * frame.velocity;
    let time = if group == Group::Unidirectional { frame.width / frame.velocity } else { frame.duration };
    let diffused = flux * time.sqrt() / (effusivity(&frame.punch) + effusivity(&frame.strip) / cover.min(1.0));
    // The heat capacity of the height bounds the heat that diffuses in.
    let stored = frame.strip[2] * frame.strip[3] * draft.get("strip.height") / cover;
    let rise = diffused.max(flux * time / (stored + 1.0)).max(1e-3);
    // Load first, then speed, until the contact is warm: the temperature of a cold one is of no interest.
    let wanted = random.scaled(8.0, 250.0);
    let pressure = frame.pressure * (wanted / rise).clamp(0.1, 3.0);
    let missing = (wanted / (rise * pressure / frame.pressure)).max(1.0);
    let rise = rise * pressure / frame.pressure;
    // The same path in less time: the rise grows with the speed, and falls with the square root of the duration.
    let faster = if missing > 1.0 { missing.powi(2).min(100.0) } else { 1.0 };
    frame.velocity *= faster;
    frame.duration /= if group == Group::Unidirectional || group == Group::Reciprocating { faster } else { 1.0 };
    let rise = rise * faster.sqrt();
    let around = draft.get("depth") * frame.width * draft.get("punch.count");
    draft.set("nominal.load", pressure * around);
    draft.set("nominal.velocity", frame.velocity);
    draft.set("nominal.duration", frame.duration);
    draft.set("nominal.stroke", frame.stroke);
    if random.chance(0.4) {
        draft.set("punch.thermal_expansion", 0.0);
        draft.set("strip.thermal_expansion", 0.0);
    }
    wanted.min(rise)
}

fn wear(group: Group, frame: &Frame, random: &mut Random, draft: &mut Draft) {
    let pressure = draft.get("nominal.load") / (draft.get("depth") * frame.width * draft.get("punch.count"));
    let exponent = |random: &mut Random| if random.chance(0.5) { 1.0 } else { random.between(0.5, 2.0) };
    let (b_punch, b_strip) = (exponent(random), exponent(random));
    draft.set("punch.wear_pressure_exponent", b_punch);
    draft.set("strip.wear_pressure_exponent", b_strip);
    let velocity_exponent = if random.chance(0.7) { 1.0 } else { random.between(0.5, 1.5) };
    draft.set("punch.wear_velocity_exponent", velocity_exponent);
    draft.set("strip.wear_velocity_exponent", velocity_exponent);
    // Wear over elastic approach at the end of the run.
    let approach =
        pressure * (frame.width.min(draft.get("punch.height")) / frame.punch[0] + frame.width / frame.strip[0]);
    let worn = approach * random.scaled(0.03, 30.0);
    let worn = worn.min(0.05 * draft.get("punch.height"));
    let depth = |b: f64| 1e6 * (pressure / 1e6).powf(b) * frame.velocity.powf(velocity_exponent) * frame.duration;
    draft.set("punch.wear_coefficient", worn / depth(b_punch));
    let wears = random.chance(if group == Group::Reciprocating { 0.25 } else { 0.5 });
    let shallower = worn * random.scaled(0.02, 0.5);
    draft.set("strip.wear_coefficient", if wears { shallower / depth(b_strip) } else { 0.0 });
}

fn laws(_frame: &Frame, rise: f64, random: &mut Random, draft: &mut Draft) {
    let table = |draft: &mut Draft, name: &str, reach: f64, last: f64| {
        let first =
            find(&format!("{name}.temperature[1]")).unwrap_or_else(|| unreachable!("fade tables are rows")) as usize;
        let factors =
            find(&format!("{name}.factor[1]")).unwrap_or_else(|| unreachable!("fade tables are rows")) as usize;
        for k in 0..8 {
            let part = k as f64 / 7.0;
            draft.values[first + k] = 293.15 + reach * (0.2 + part);
            draft.values[factors + k] = last.powf(part);
        }
    };
    if random.chance(0.4) {
        table(draft, "contact.friction_fade", 1.5 * rise, random.between(0.6, 0.9));
    }
    if random.chance(0.3) {
        table(draft, "punch.wear_fade", 1.5 * rise, random.between(1.5, 5.0));
    }
}

fn holder(group: Group, frame: &Frame, random: &mut Random, draft: &mut Draft) {
    if matches!(group, Group::Pin | Group::Reciprocating | Group::Unidirectional | Group::Disc) && random.chance(0.3) {
        draft.set("holder.constraint", 2.0);
        let lever = random.between(0.02, 0.35) * 0.5 * frame.width;
        draft.set("holder.pivot_height", lever / draft.get("contact.friction_coefficient"));
    }
}

/// Reduces the expansion where the nominal speed is near the critical one.
fn stay_stable(random: &mut Random, draft: &mut Draft) {
    let Ok(scene) = Scene::new(&draft.values, None) else { return };
    let critical = CriticalSpeed::new(&scene).modelled(scene.friction_coefficient);
    let wanted = random.scaled(0.02, 0.6);
    if critical > 0.0 && scene.nominal_velocity > wanted * critical {
        let factor = wanted * critical / scene.nominal_velocity;
        for body in ["punch", "strip"] {
            let name = format!("{body}.thermal_expansion");
            draft.set(&name, draft.get(&name) * factor);
        }
    }
}

fn course(group: Group, random: &mut Random, draft: &Draft) -> Vec<[f64; 3]> {
    let duration = draft.values[reference("nominal.duration") as usize];
    let (velocity, load) = (draft.get("nominal.velocity"), draft.get("nominal.load"));
    if group == Group::Reciprocating {
        let stroke = draft.get("nominal.stroke");
        let cycles = duration * velocity / (2.0 * stroke);
        // Sinusoidal: the mean speed is nominal, so the largest is pi/2 times it.
        let count = (20.0 * cycles).round() as usize;
        let at = |n: usize| {
            let phase = 2.0 * PI * n as f64 / 20.0;
            [duration * n as f64 / count as f64, 0.5 * PI * velocity * phase.sin(), load]
        };
        return (0..=count).map(at).collect();
    }
    let count = 40;
    let kind = random.next();
    let at = |n: usize| {
        let part = n as f64 / count as f64;
        let time = duration * part;
        match group {
            // Engagement and stop: the speed falls.
            Group::Disc | Group::Annular if kind < 0.5 => [time, velocity * (1.0 - 0.95 * part), load],
            // Load and speed vary below the nominal ones.
            _ if kind < 0.3 => {
                [time, velocity * (0.75 + 0.25 * (9.0 * part).cos()), load * (0.7 + 0.3 * (7.0 * part).sin())]
            }
            _ => [time, velocity, load],
        }
    };
    (0..=count).map(at).collect()
}
