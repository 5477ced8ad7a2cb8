//! Drops of the load under a bristle, at once between communication steps and linear within them, at both levels: every step ends,
//! with the force, the heat and the slip of an elastic-plastic spring that is integrated here by return mapping.

use test_support::{Drive, Random};

const STIFFNESS: f64 = 1e6;
/// Friction coefficient times faces of the stock scene.
const LIMIT_PER_LOAD: f64 = 2.0 * 0.4;

/// Spring with a damper in series with a slider: force, heat and slip by steps of `dt` s, each implicit.
#[derive(Clone, Copy)]
struct Spring {
    damping: f64,
    deflection: f64,
    heat: f64,
    slipped: f64,
}

impl Spring {
    /// Return mapping: the spring follows the motion, and what exceeds the limit at the end is slip.
    fn step(&mut self, velocity: f64, limit: f64, dt: f64) {
        let before = self.deflection;
        let stuck = before + velocity * dt;
        let trial = STIFFNESS * stuck + self.damping * velocity;
        let mut force = trial;
        self.deflection = stuck;
        if trial.abs() > limit {
            force = limit.copysign(trial);
            // c dz/dt = force - k z.
            self.deflection = (self.damping / dt * before + force) / (self.damping / dt + STIFFNESS);
        }
        self.slipped += (stuck - self.deflection).abs();
        self.heat += force * velocity * dt - 0.5 * STIFFNESS * (self.deflection.powi(2) - before.powi(2));
    }

    fn force(&self, velocity: f64, limit: f64) -> f64 {
        let trial = STIFFNESS * self.deflection + self.damping * velocity;
        trial.clamp(-limit, limit)
    }
}

/// Loads (N) and velocities (m/s) at start and end of the communication steps, of `length` s.
struct Drops {
    length: f64,
    steps: Vec<[f64; 4]>,
}

/// Slides at the limit, and drops the load: at once or linearly, to a part of it or to nothing, with the velocity going on, halted or
/// reversed.
fn drops(random: &mut Random) -> Drops {
    let length = 10f64.powf(random.between(-3.0, 0.0));
    let speed = 10f64.powf(random.between(-1.0, 1.3)).max(0.02 / length);
    let (high, part) = (random.between(500.0, 5e3), random.between(0.0, 0.95));
    let low = if part < 0.15 { 0.0 } else { part * high };
    let last = [speed, 0.1 * speed, 0.0, -speed][(4.0 * random.next()) as usize];
    let mut steps = vec![[high, high, speed, speed]; 2];
    if random.next() < 0.5 {
        steps.extend([[low, low, last, last]; 3]);
    } else {
        steps.extend([[high, low, speed, speed], [low, low, last, last]]);
    }
    Drops { length, steps }
}

fn drive(changes: &[(&str, f64)], drops: &Drops, each: &mut dyn FnMut(&mut Drive)) -> Result<(), String> {
    let mut drive = Drive::stock(changes);
    for &[load, last_load, velocity, last_velocity] in &drops.steps {
        drive.set("normal_load", load).set("sliding_velocity", velocity);
        drive.slope("normal_load", (last_load - load) / drops.length);
        drive.slope("sliding_velocity", (last_velocity - velocity) / drops.length);
        drive.0.step(drops.length)?;
        each(&mut drive);
    }
    Ok(())
}

fn compare(level: &[(&str, f64)], count: usize, damping: f64) {
    let mut random = Random(20_261);
    let mut failed = Vec::new();
    let changes = [level, &[("contact.stick_stiffness", STIFFNESS), ("contact.stick_damping", damping)]].concat();
    for number in 0..count {
        let drops = drops(&mut random);
        let mut spring = Spring { damping, deflection: 0.0, heat: 0.0, slipped: 0.0 };
        let mut steps = drops.steps.iter();
        let mut worst = [0.0_f64; 5];
        let outcome = drive(&changes, &drops, &mut |drive| {
            let &[load, last_load, velocity, last_velocity] = steps.next().expect("as many as driven");
            const PARTS: u32 = 20_000;
            let dt = drops.length / f64::from(PARTS);
            // The jump.
            spring.step(0.0, if damping < 1.0 { LIMIT_PER_LOAD * load } else { f64::INFINITY }, 1.0);
            for part in 1..=PARTS {
                let done = f64::from(part) / f64::from(PARTS);
                let between = |from: f64, to: f64| from + (to - from) * done;
                spring.step(between(velocity, last_velocity), LIMIT_PER_LOAD * between(load, last_load), dt);
            }
            let force = spring.force(last_velocity, LIMIT_PER_LOAD * last_load);
            let largest = LIMIT_PER_LOAD * drops.steps[0][0];
            let energy = 0.5 * STIFFNESS * spring.deflection.powi(2);
            for (slot, difference) in worst.iter_mut().zip([
                (drive.get("friction_force") - force) / largest,
                (drive.get("dissipated_energy") - spring.heat) / spring.heat,
                (drive.get("bristle_energy") - energy) / spring.heat,
                (drive.get("sliding_distance") - spring.slipped) / spring.slipped,
                drive.imbalance() * 1e8,
            ]) {
                *slot = slot.max(difference.abs());
            }
        });
        if outcome.is_err() || worst.iter().any(|worst| worst.is_nan() || *worst > 1e-3) {
            failed.push(format!("{number}: {:?} each {} s: {worst:?} {outcome:?}", drops.steps, drops.length));
        }
    }
    assert!(failed.is_empty(), "{} of {count}:\n{}", failed.len(), failed.join("\n"));
}

#[test]
fn a_bristle_returns_to_a_limit_that_drops_at_the_lumped_level() {
    // The second one returns in 1e-12 s.
    for damping in [0.0, 1e-6, 2e3] {
        compare(&[("solver.fidelity", 2.0)], 300, damping);
    }
}

#[test]
fn a_bristle_returns_to_a_limit_that_drops_on_the_contact_line() {
    for (damping, count) in [(0.0, 300), (2e3, 60)] {
        compare(&[("solver.fidelity", 3.0), ("solver.cells", 9.0)], count, damping);
    }
}

#[test]
fn a_load_that_drops_from_2600_to_1000_n_leaves_the_force_at_the_limit() {
    for level in [2.0, 3.0] {
        let mut drive =
            Drive::stock(&[("solver.fidelity", level), ("solver.cells", 9.0), ("contact.stick_stiffness", STIFFNESS)]);
        drive.set("sliding_velocity", 10.0).set("normal_load", 2600.0).step(0.1);
        let before = drive.get("dissipated_energy");
        drive.set("normal_load", 1000.0).step(0.1);
        assert!((drive.get("friction_force") / (LIMIT_PER_LOAD * 1000.0) - 1.0).abs() < 1e-9);
        // The work over a metre, and what the spring gave back.
        let exact =
            LIMIT_PER_LOAD * 1000.0 + 0.5 * LIMIT_PER_LOAD.powi(2) * (2600_f64.powi(2) - 1000_f64.powi(2)) / STIFFNESS;
        let heat = drive.get("dissipated_energy") - before;
        assert!((heat / exact - 1.0).abs() < 1e-9, "level {level}: {heat} J, {exact} J");
        assert!(drive.imbalance() < 1e-12);
    }
}
