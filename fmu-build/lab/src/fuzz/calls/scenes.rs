//! Random parameters: a shipped scene, changed.

use std::sync::LazyLock;

use fmu_build::scenes;
use scene::variables::{Causality, FLAT, Kind, STARTS, TABLE, ValueReference, find, reference};
use scene_file::property_tables::TABLES;

use crate::fuzz::importer::Importer;
use crate::fuzz::invariants::rows;
use crate::fuzz::random::Random;

/// Parameters that differ from the start values, of every shipped scene.
static SHIPPED: LazyLock<Vec<Vec<(ValueReference, f64)>>> = LazyLock::new(|| {
    let changed = |name: &String| {
        let scene = scenes::load(Some(name)).ok()?;
        let starts = scene.packaged.starts;
        Some(
            PARAMETERS
                .iter()
                .map(|&at| (at, starts[at as usize]))
                .filter(|&(at, value)| value != STARTS[at as usize])
                .collect(),
        )
    };
    std::iter::once(Vec::new()).chain(scenes::names().iter().filter_map(changed)).collect()
});

static PARAMETERS: LazyLock<Vec<ValueReference>> = LazyLock::new(|| rows(|row| row.causality == Causality::Parameter));

/// Parameters with items: the structure of the scene.
static CHOICES: LazyLock<Vec<ValueReference>> = LazyLock::new(|| {
    rows(|row| {
        row.causality == Causality::Parameter
            && matches!(row.kind, Kind::Enumeration(_) | Kind::Boolean)
            && row.name != "solver.fidelity"
    })
});

/// Sets one parameter by the function of its type.
pub(crate) fn set(importer: &Importer, reference: ValueReference, value: f64) {
    let kind = TABLE[FLAT[reference as usize].0 as usize].kind;
    let _ = match kind {
        Kind::Real { .. } => importer.set_reals(&[reference], &[value]),
        Kind::Integer { .. } | Kind::Enumeration(_) => importer.set_integer(reference, value as i32),
        Kind::Boolean => importer.set_boolean(reference, value as i32),
    };
}

/// Sets up a random scene; refused values keep the old one. Returns whether its steps are costly.
pub(crate) fn set_up(importer: &Importer, random: &mut Random) -> bool {
    let mut values = STARTS;
    let shipped = random.pick(&SHIPPED).clone();
    for (reference, value) in shipped {
        values[reference as usize] = value;
        set(importer, reference, value);
    }
    if random.one_in(2) {
        for _ in 0..random.below(4) {
            let choice = *random.pick(&CHOICES);
            let items = TABLE[FLAT[choice as usize].0 as usize].bounds().1.unwrap_or(1.0) as usize;
            set(importer, choice, (random.below(items + 1)) as f64);
        }
    }
    if random.one_in(2) {
        for _ in 0..random.below(6) {
            let parameter = *random.pick(&PARAMETERS);
            let row = &TABLE[FLAT[parameter as usize].0 as usize];
            set(importer, parameter, random.parameter(row, values[parameter as usize]));
        }
    }
    // Some that act where they are not 0 only.
    if random.one_in(3) {
        const SWITCHES: [(&str, f64); 8] = [
            ("contact.stick_stiffness", 1e7),
            ("contact.regularization_velocity", 0.01),
            ("holder.stiffness", 1e7),
            ("punch.emissivity", 0.8),
            ("contact.static_friction_ratio", 1.4),
            ("wear_acceleration", 1e3),
            ("holder.pivot_height", 0.02),
            ("punch.wear_limit", 1e-3),
        ];
        let (name, typical) = random.pick(&SWITCHES);
        if let Some(reference) = find(name) {
            set(importer, reference, typical * random.power(-2.0, 1.0));
        }
    }
    if random.one_in(4) {
        let (table, body) = (random.pick(TABLES), *random.pick(&["punch", "strip"]));
        for (name, value) in table.values() {
            let scale = if name.contains(".conductivity") && random.one_in(4) { random.power(-1.0, 1.0) } else { 1.0 };
            if let Some(reference) = find(&format!("{body}.{name}")) {
                set(importer, reference, value * scale);
            }
        }
    }
    level(importer, random)
}

/// Chooses the level: the lumped one is the cheapest by far, a plan by `auto` and the field level take the longest.
fn level(importer: &Importer, random: &mut Random) -> bool {
    let (fidelity, cells) = match random.below(2048) {
        0 => (1, 0),
        1 => (4, 5 + random.below(4)),
        2..64 => (3, 3 + random.below(10)),
        64..66 => (3, [1, 2, 33][random.below(3)]),
        _ => (2, 0),
    };
    let _ = importer.set_integer(reference("solver.fidelity"), fidelity);
    let _ = importer.set_integer(reference("solver.cells"), cells as i32);
    fidelity != 2
}
