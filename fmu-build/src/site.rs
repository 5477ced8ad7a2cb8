//! `cargo fmu site`: the documentation as a static site.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::Result;
use clap::Args;

use crate::output::{self, print_line};
use crate::{project, python, reference};

/// Makes a static site of README, docs, examples and the other Markdown pages, by Sphinx. A link that leads nowhere is an error.
#[derive(Args, Debug)]
pub struct Arguments {
    /// Folder to write to [default: target/site]
    #[arg(short, long, value_name = "FOLDER")]
    output: Option<PathBuf>,
}

/// Runs the command.
pub fn execute(arguments: &Arguments) -> Result<()> {
    output::check_folder(arguments.output.as_deref())?;
    let folder = arguments.output.clone().unwrap_or_else(|| project::target().join("site"));
    print_line!("{}", build(&folder)?.display());
    Ok(())
}

/// Makes the site in a folder and returns its first page.
pub(crate) fn build(folder: &Path) -> Result<PathBuf> {
    reference::write(None)?;
    let python = python::own(python::SITE)?;
    // Beside the site, so that nothing but the site is in its folder.
    let cache = project::target().join("site-cache");
    let mut sphinx = Command::new(&python);
    sphinx
        .current_dir(project::root())
        // Every warning is an error, after all of them were found; nothing is left of pages that are gone.
        .args(["-m", "sphinx", "-q", "-W", "--keep-going", "-E", "-b", "html", "-c", "fmu-build/site", "-d"])
        .arg(&cache)
        .arg(".")
        .arg(std::path::absolute(folder)?)
        .env("PYTHONDONTWRITEBYTECODE", "1");
    project::printed(&mut sphinx, &python.display().to_string(), "the site has faults:\n")?;
    Ok(folder.join("index.html"))
}
