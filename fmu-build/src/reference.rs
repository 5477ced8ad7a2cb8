//! `cargo fmu reference`: every variable and every shipped scene, as Markdown.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use clap::Args;

use crate::output::{self, print_line};
use crate::{project, scenes};

/// Writes the tables of all variables and enumerations, of the shipped scenes, materials and units.
#[derive(Args, Debug)]
pub struct Arguments {
    /// Folder to write to; by default `target/reference`.
    #[arg(short, long, value_name = "FOLDER")]
    output: Option<PathBuf>,
}

/// Runs the command.
pub fn execute(arguments: &Arguments) -> Result<()> {
    output::check_folder(arguments.output.as_deref())?;
    for path in write(arguments.output.as_deref())? {
        print_line!("{}", path.display());
    }
    Ok(())
}

/// Writes the pages to a folder and returns their paths. By default they lie in the source tree wherever cargo's target folder is,
/// because the site is made of it.
pub(crate) fn write(folder: Option<&Path>) -> Result<Vec<PathBuf>> {
    let folder = folder.map_or_else(|| project::root().join("target").join("reference"), Path::to_owned);
    fs::create_dir_all(&folder).with_context(|| format!("making {}", folder.display()))?;
    let mut paths = Vec::new();
    for (name, text) in fmu_file::documentation::pages::write(&scenes::folder())? {
        let path = folder.join(name);
        fs::write(&path, text).with_context(|| format!("writing {}", path.display()))?;
        paths.push(path);
    }
    Ok(paths)
}
