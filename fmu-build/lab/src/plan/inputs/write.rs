//! Writing settings into a scene file; the rest of the file, including comments, is unchanged.

use std::fs;
use std::path::Path;

use analyses::plan::inputs;
use anyhow::{Context, Result, bail};
use model::plan::ModelLevel;
use toml_edit::{DocumentMut, Item, Table, Value};

/// Puts a level and its tolerance into a scene file.
pub(crate) fn settings(path: &Path, level: ModelLevel, tolerance: f64) -> Result<()> {
    let named = || format!("{}", path.display());
    let text = fs::read_to_string(path).with_context(named)?;
    let changed = changed(&text, level, tolerance).with_context(named)?;
    fs::write(path, changed).with_context(named)
}

fn changed(text: &str, level: ModelLevel, tolerance: f64) -> Result<String> {
    scene_file::parse(text)?;
    let mut document: DocumentMut = text.parse()?;
    let solver = document.entry("solver").or_insert_with(|| Item::Table(Table::new()));
    let Some(solver) = solver.as_table_like_mut() else { bail!("solver is no table") };
    let has_cells = solver.contains_key("cells");
    let mut set = |key: &str, value: Value| match solver.get_mut(key).and_then(Item::as_value_mut) {
        Some(old) => {
            // A comment behind the value belongs to its line.
            let decoration = old.decor().clone();
            *old = value;
            *old.decor_mut() = decoration;
        }
        None => {
            solver.insert(key, Item::Value(value));
        }
    };
    let (fidelity, cells) = inputs::settings(level);
    set("fidelity", fidelity.into());
    // Cells of a line that the scene had before: 0 is none.
    if has_cells || cells > 0 {
        set("cells", i64::try_from(cells)?.into());
    }
    set("tolerance", tolerance.into());
    let changed = document.to_string();
    scene_file::parse(&changed).context("the changed scene")?;
    Ok(changed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::variables::find;

    fn of(text: &str, name: &str) -> f64 {
        scene_file::parse(text).unwrap().packaged.starts[find(name).unwrap() as usize]
    }

    #[test]
    fn the_level_is_written_and_everything_else_stays() {
        let text = "# A brake.\nname = \"a\"\n\n[solver]\n# Why lumped.\nfidelity = \"lumped\"  # so far\n\n[punch]\nwidth = \"60 mm\" # wide\n";
        let line = changed(text, ModelLevel::Line(17), 1e-2).unwrap();
        assert_eq!(
            [of(&line, "solver.fidelity"), of(&line, "solver.cells"), of(&line, "solver.tolerance")],
            [3.0, 17.0, 0.01]
        );
        for kept in ["# A brake.\n", "# Why lumped.\n", "\"line\"  # so far", "[punch]\nwidth = \"60 mm\" # wide\n"] {
            assert!(line.contains(kept), "{line}\nis without {kept}");
        }
        // Back to the lumped level: no cells are left.
        let lumped = changed(&line, ModelLevel::Lumped, 1e-2).unwrap();
        assert_eq!([of(&lumped, "solver.fidelity"), of(&lumped, "solver.cells")], [2.0, 0.0]);
    }

    #[test]
    fn a_scene_without_the_table_gets_one_and_dotted_keys_stay_dotted() {
        let bare = changed("name = \"a\"\n[punch]\nwidth = 0.06\n", ModelLevel::Line(9), 1e-3).unwrap();
        assert_eq!([of(&bare, "solver.cells"), of(&bare, "punch.width")], [9.0, 0.06]);
        let dotted =
            changed("name = \"a\"\nsolver.cells = 5\npunch.width = 0.06\n", ModelLevel::Line(9), 1e-3).unwrap();
        assert_eq!([of(&dotted, "solver.cells"), of(&dotted, "punch.width")], [9.0, 0.06]);
        assert!(dotted.contains("solver.cells = 9"), "{dotted}");
    }

    #[test]
    fn what_is_no_scene_is_not_touched() {
        assert!(changed("name = \"a\"\npunch.widht = 1\n", ModelLevel::Lumped, 1e-3).is_err());
    }
}
