//! Analyses of a scene: simulation along inputs, steady state, cycles, plan. `cargo fmu` prints and draws their results, the Python
//! package returns them; neither computes anything itself.

#![forbid(unsafe_code)]

pub mod convergence;
pub(crate) mod curve;
pub mod cycles;
pub mod plan;
pub mod simulation;
pub mod steady;

/// Largest magnitude; NaN counts as infinite.
pub(crate) fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |most: f64, value| if value.is_nan() { f64::INFINITY } else { most.max(value.abs()) })
}

#[cfg(test)]
mod tests {
    use scene_file::SceneFile;
    use std::path::Path;

    /// A shipped scene.
    pub(crate) fn shipped(name: &str) -> SceneFile {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
        scene_file::shipped::load(Some(name), &folder).unwrap()
    }
}
