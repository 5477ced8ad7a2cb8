//! Cooling of bodies at rest and in motion, at both levels: radiation, forced convection, heat paths, against solutions of their own
//! and against themselves in other communication steps.

mod bounds;
mod cuts;
mod decay;
mod exact;
mod jumps;

use test_support::{Drive, LINE, LUMPED};

/// Both levels; on the line bodies expand, so that their heat is resolved.
const LEVELS: [(&str, &[(&str, f64)]); 2] = [
    ("lumped", &[("solver.fidelity", LUMPED)]),
    ("line", &[("solver.fidelity", LINE), ("solver.cells", 9.0), ("*.thermal_expansion", 1e-5)]),
];

/// Mean temperatures of both bodies and of the contact, K.
fn temperatures(drive: &mut Drive) -> [f64; 3] {
    ["punch.mean_temperature", "strip.mean_temperature", "contact_temperature"].map(|name| drive.get(name))
}
