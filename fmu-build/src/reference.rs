//! `cargo fmu reference`: every variable and every shipped scene, as Markdown.

use std::fs;
use std::path::PathBuf;

use anyhow::{Context, Result};
use clap::Args;

use crate::output::print_line;
use crate::{package, project};

/// Writes the tables of all variables and enumerations, of the shipped scenes, materials and units, to target/reference.
#[derive(Args, Debug)]
pub struct Arguments {}

/// Runs the command.
///
/// # Errors
/// As [`write()`].
pub fn execute(_: &Arguments) -> Result<()> {
    for path in write()? {
        print_line!("{}", path.display());
    }
    Ok(())
}

/// Writes the pages and returns their paths. They lie in the source tree wherever cargo's target folder is, because the site is made of it.
///
/// # Errors
/// Where a scene cannot be read or a page not be written.
pub fn write() -> Result<Vec<PathBuf>> {
    let folder = project::root().join("target").join("reference");
    fs::create_dir_all(&folder).with_context(|| format!("making {}", folder.display()))?;
    let mut paths = Vec::new();
    for (name, text) in package::reference_pages()? {
        let path = folder.join(name);
        fs::write(&path, text).with_context(|| format!("writing {}", path.display()))?;
        paths.push(path);
    }
    Ok(paths)
}
