//! The files in an FMU that a scene decides, and the FMU of another scene from a packaged one.
//!
//! `cargo fmu package` compiles the library and packs it; the Python package has FMUs of the shipped scenes and fills the library in
//! one of them anew. Both write these files here.

pub mod archive;
pub mod description;
pub mod documentation;
pub mod parameter_set;
pub mod reference;
mod terminals;
mod xml;

use anyhow::{Context, Result, anyhow};
use archive::Files;
use description::MODEL_IDENTIFIER;
use scene::slot;
use scene_file::SceneFile;
use std::path::Path;

/// Path of the model description in an FMU.
pub(crate) const DESCRIPTION: &str = "modelDescription.xml";

/// Path in an FMU of the library for the platform of this process.
pub fn own_library() -> String {
    format!("binaries/{}/{MODEL_IDENTIFIER}{}", fmu_host::platform(), std::env::consts::DLL_SUFFIX)
}

/// Adds the model description, the page and the terminals of a scene.
pub fn add_texts(files: &mut Files, scene: &SceneFile) {
    let texts = [
        (DESCRIPTION, description::write(&scene.packaged, &scene.description)),
        ("documentation/index.html", documentation::write(scene)),
        ("terminalsAndIcons/terminalsAndIcons.xml", terminals::write()),
    ];
    files.extend(texts.map(|(path, text)| (path.to_owned(), text.into_bytes())));
}

/// The FMU of a scene, for the platforms of `packaged`, an FMU of any other scene of the same version.
///
/// Every library gets the scene into its slot; texts and reference are written anew, for which the library for this machine runs
/// from `folder`, which is made and removed.
///
/// # Errors
/// Where `packaged` is no such FMU, the scene breaks a rule, or its reference run fails.
pub fn of_scene(packaged: &[u8], scene: &SceneFile, folder: &Path) -> Result<Vec<u8>> {
    let mut files = archive::unpack(packaged)?;
    for (_, library) in files.iter_mut().filter(|(path, _)| path.starts_with("binaries/")) {
        slot::fill(library, &scene.packaged).map_err(|reason| anyhow!(reason))?;
    }
    add_texts(&mut files, scene);
    let own = own_library();
    let library = files.get(&own).with_context(|| format!("the FMU that it is made from has no {own}"))?.clone();
    reference::add(&mut files, &scene.packaged, library, folder)?;
    archive::pack(&files)
}

/// Root of the source tree.
#[cfg(test)]
fn root() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

#[cfg(test)]
fn examples() -> std::path::PathBuf {
    root().join("examples")
}
