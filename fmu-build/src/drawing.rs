//! Figures as files, drawn by the Python package with the matplotlib of the pinned environment.

use crate::output::Interrupted;
use crate::{output, project, python};
use anyhow::{Context, Result, anyhow, bail};
use serde::Serialize;
use std::path::Path;
use std::process::Command;

/// Formats, by the ending of the file.
const FORMATS: [&str; 3] = ["svg", "pdf", "png"];

/// Draws this content into a file, whose folder is made; `kind` says what it is of (simulation, steady, cycles, panels), `option` names the
/// file.
pub fn write(kind: &str, content: &impl Serialize, option: &str, path: &Path) -> Result<()> {
    let format = format(option, path)?;
    output::make_above(path)?;
    let python = python::environment().with_context(|| format!("the environment with matplotlib, for {option}"))?;
    let mut command = Command::new(python);
    command
        .args(["-m", "sliding_contact._content"])
        .arg(path)
        .arg(format)
        .env("PYTHONPATH", project::root().join("python"))
        // Caches of fonts and byte code belong to the target folder, not to the sources or the user's home.
        .env("MPLCONFIGDIR", project::target().join("python").join("matplotlib"))
        .env("PYTHONDONTWRITEBYTECODE", "1");
    let text = serde_json::to_vec(&serde_json::json!({ "kind": kind, "content": content }))?;
    let output = project::fed(&mut command, "Python", &text)?;
    if project::interrupted(output.status) {
        bail!(Interrupted(format!("interrupted before {} was drawn", path.display())));
    }
    if !output.status.success() {
        let told = String::from_utf8_lossy(&output.stderr);
        bail!("drawing {}: {}", path.display(), told.trim().lines().last().unwrap_or("Python failed"));
    }
    Ok(())
}

/// Format of a figure's file; SVG where it has no ending.
pub fn format(option: &str, path: &Path) -> Result<&'static str> {
    let Some(ending) = path.extension() else { return Ok(FORMATS[0]) };
    FORMATS.into_iter().find(|format| ending.eq_ignore_ascii_case(format)).ok_or_else(|| {
        anyhow!("{option} {}: .{} are drawn, not .{}", path.display(), FORMATS.join(", ."), ending.display())
    })
}
