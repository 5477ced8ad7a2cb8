//! `cargo fmu plan SCENE --inputs drive.csv`: error and cost of every level on given inputs.

mod write;

use crate::columns::{self, Column, Reading};
use crate::ctrl_c;
use crate::output::{Interrupted, print_line, print_text};
use analyses::plan::inputs::{self, LEVELS};
use analyses::simulation::Trajectory;
use anyhow::{Result, anyhow, bail};
use fmu_build::progress::Progress;
use model::plan::ModelLevel;
use scene_file::SceneFile;
use std::path::{Path, PathBuf};

/// A comparison request.
pub(crate) struct Request<'a> {
    pub scene: SceneFile,
    /// File that it came from, for `--write`.
    pub file: Option<PathBuf>,
    pub inputs: &'a Path,
    pub reading: Reading,
    pub tolerance: Option<f64>,
    pub write: bool,
    pub json: bool,
}

pub(crate) fn execute(request: &Request) -> Result<()> {
    let name = &request.scene.packaged.name;
    let tolerance = inputs::tolerance(&request.scene, request.tolerance)?;
    let table = columns::read(request.inputs, &Column::inputs(), &request.reading)?;
    request.reading.check(&[&table.headers])?;
    table.notes.iter().for_each(|note| eprintln!("note: {note}"));
    let trajectory = Trajectory::new(&request.scene, Some(table), None)?;
    let mut progress = Progress::default();
    let levels = ctrl_c::attended(|| {
        inputs::compare(&request.scene, &trajectory, tolerance, &mut |number, part| {
            let what = || LEVELS.get(number).map_or("reference".into(), ModelLevel::to_string);
            progress.reached((number as f64 + part) / (LEVELS.len() + 1) as f64, what);
        })
    });
    drop(progress);
    let levels = levels?;
    if request.json {
        print_line!("{:#}", inputs::record(&levels));
    } else {
        print_text!("{}", levels.table(name, &trajectory));
    }
    if levels.interrupted {
        bail!(Interrupted(format!("interrupted after {} of at most {} levels", levels.candidates.len(), LEVELS.len())));
    }
    let cheapest = levels.cheapest()?;
    if request.write {
        let file =
            request.file.as_deref().ok_or_else(|| anyhow!("--write needs a scene file; the stock scene has none"))?;
        write::settings(file, cheapest.level, tolerance)?;
        eprintln!(
            "{}: {}, solver.tolerance = {tolerance:e} are written",
            file.display(),
            inputs::settings_text(cheapest.level)
        );
    }
    Ok(())
}
