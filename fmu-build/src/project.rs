//! Where the project's files are.

use std::path::PathBuf;

/// Root of the source tree: that of the running `cargo fmu`, so that a moved clone is found.
pub fn root() -> PathBuf {
    let member =
        std::env::var_os("CARGO_MANIFEST_DIR").map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")), PathBuf::from);
    member.parent().map_or_else(|| member.clone(), std::path::Path::to_path_buf)
}

/// cargo's target folder, where everything that is made goes.
pub fn target() -> PathBuf {
    match std::env::var_os("CARGO_TARGET_DIR") {
        Some(folder) => root().join(folder),
        None => root().join("target"),
    }
}
