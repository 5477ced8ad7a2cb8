//! The variables and the shipped scenes as Markdown, from their tables.

use std::fmt::Write;

use anyhow::Result;
use scene::slot::Packaged;
use scene::variables::units::UNITS;
use scene::variables::{TABLE, lookup};
use scene_file::SceneFile;
use scene_file::materials::MATERIALS;
use scene_file::{property_tables, shipped, unit_names};
use std::path::Path;

use super::markdown::{contents, escaped};
use super::tables::{Entry, topics, value};
use crate::description::enumerations;
use crate::xml::number;

/// Elements of an array up to which all of its values are listed.
const MOST_SHOWN: usize = 16;

/// File names and texts of the pages; the shipped scenes are in `folder`.
///
/// # Errors
/// Where a shipped scene cannot be read.
pub fn write(folder: &Path) -> Result<[(&'static str, String); 2]> {
    let of = "Start values are those of the stock FMU, a car's front disc brake; those of the other scenes are in [scenes](scenes.md). Scene \
              files, `--set` and Python accept other units too ([scenes](scenes.md#units)).";
    Ok([("scenes.md", scenes(folder)?), ("variables.md", variables(&Packaged::stock().starts, of))])
}

/// The variables with these start values, and what there is to say about those.
pub(crate) fn variables(starts: &[f64], of: &str) -> String {
    let topics = topics(starts);
    let mut text = format!(
        "# Variables\n\nValues pass through the interface in the unit given. Limits are inclusive. Outputs are meant to be connected, \
         results to be read. Tables over the temperature (`friction_fade`, `wear_fade`) are linear between their temperatures, which must \
         increase, and constant outside. {of}\n\n"
    );
    let title = |index: usize| {
        let topic = &topics[index];
        match topic.title {
            "Inputs" | "Outputs" => topic.title.to_owned(),
            title if topic.given => format!("Parameters: {}", lower(title)),
            title => format!("Results: {}", lower(title)),
        }
    };
    text += &contents((0..topics.len()).map(title).chain(["Enumerations".to_owned()]));
    for (index, topic) in topics.iter().enumerate() {
        let _ = writeln!(text, "## {}\n", title(index));
        text += if topic.given {
            "| name | unit | start | limits | meaning |\n|---|---|---|---|---|\n"
        } else {
            "| name | unit | meaning |\n|---|---|---|\n"
        };
        for entry in &topic.entries {
            text += &row(entry, topic.given);
        }
        text += "\n";
    }
    text += "## Enumerations\n\nItems are numbered from 1.\n\n| type | items |\n|---|---|\n";
    for kind in enumerations() {
        let items: Vec<String> = (1..)
            .zip(kind.items)
            .map(|(index, (name, about))| format!("{index} `{name}`: {}", escaped(about)))
            .collect();
        let _ = writeln!(text, "| `{}`: {} | {} |", kind.name, escaped(kind.description), items.join("<br>"));
    }
    text
}

fn lower(title: &str) -> String {
    let mut letters = title.chars();
    letters.next().map_or(String::new(), |first| first.to_lowercase().chain(letters).collect())
}

fn row(entry: &Entry, given: bool) -> String {
    let Entry { name, unit, start, limits, meaning } = entry;
    let meaning = escaped(meaning);
    if given {
        format!("| `{name}` | {unit} | {} | {} | {meaning} |\n", escaped(start), escaped(limits))
    } else {
        format!("| `{name}` | {unit} | {meaning} |\n")
    }
}

/// Text of the introduction and of the form of a scene file.
const SCENES: &str = "# Scenes

A scene is a set of parameters: geometry, materials, laws, nominal conditions, solver. The shipped ones run by name, for instance
`cargo fmu simulate clutch`, and a file of one's own by its path. Further scene files, of published cases, are in
[examples/published](../../examples/published/README.md).

";

const FORM: &str = r#"## Form of a scene file

TOML. Keys are the names of parameters and inputs in [variables](variables.md); a variable that the file does not set keeps the start value there.
A plain number is in the SI unit, a text has a unit, an enumeration takes the name of an item.

```toml
name = "my_brake"
description = "What it is"

[experiment]            # the default experiment
stop = "20 min"         # default: nominal.duration
step = 0.1              # default: a thousandth of the duration
tolerance = 1e-2

[punch]
material = "brake_lining"
width = "55 mm"
conductivity = 0.9      # overrides that of the material

[contact]
shear_coupling = false
friction_fade.temperature = ["20 degC", "300 degC", "600 degC"]    # a table has as many points as are given
friction_fade.factor = [1, 0.97, 0.65]
```

Whatever is wrong is reported together, each with line, column, key and what is accepted. Rules that join parameters are in
[messages](../../docs/messages.md#parameters-that-do-not-fit-together).

## Materials

`material` of `[punch]` or `[strip]` sets six properties to typical values at room temperature. A casting or a lining in use may differ by 10 % in the
elastic and by 30 % in the thermal ones. Wear and friction belong to a pair of materials and are not among them.
`property_table.material` gives conductivity and specific heat over temperature for those in the last column.
For bronze no two sources over temperature were found.

"#;

const UNITS_INTRODUCTION: &str = "
## Units

Accepted in scene files, in `--set`, in the headers of columns and from Python, beside the SI unit; `°C`, `µm`, `N·m` and `rpm` are understood too.
An amount of a temperature difference is in K.

| SI unit | others |
|---|---|
";

fn scenes(folder: &Path) -> Result<String> {
    let mut text = SCENES.to_owned();
    let mut known = vec![("stock".to_owned(), shipped::load(None, folder)?)];
    for name in shipped::names(folder) {
        known.push((name.clone(), shipped::load(Some(&name), folder)?));
    }
    text += "| name | scene | level | tolerance | nominal conditions |\n|---|---|---|---|---|\n";
    for (name, scene) in &known {
        let start = |name: &str| shown(&scene.packaged, name);
        let packaged = &scene.packaged;
        let _ = writeln!(
            text,
            "| [`{name}`](#{name}) | {} | {} | {} | {} N, {} m/s for {} s |",
            escaped(about(scene)),
            start("solver.fidelity"),
            number(packaged.experiment.tolerance),
            start("nominal.load"),
            start("nominal.velocity"),
            start("nominal.duration"),
        );
    }
    text += "\n";
    for (name, scene) in &known {
        text += &section(name, scene);
    }
    text += FORM;
    text += "| name | material | E, GPa | ν | ρ, kg/m³ | c, J/(kg K) | K, W/(m K) | α, µm/(m K) | table |\n|---|---|---|---|---|---|---|---|---|\n";
    for material in MATERIALS {
        let _ = writeln!(
            text,
            "| `{}` | {} | {} | {} | {} | {} | {} | {} | {} |",
            material.name,
            material.description,
            rounded(1e-9 * material.youngs_modulus),
            material.poissons_ratio,
            material.density,
            material.specific_heat,
            material.conductivity,
            rounded(1e6 * material.thermal_expansion),
            property_tables::find(material.name).map_or("", |table| table.source)
        );
    }
    text += UNITS_INTRODUCTION;
    for unit in UNITS {
        let others: Vec<&str> = unit_names::units(unit, true).map(|unit| unit.name).collect();
        if !others.is_empty() {
            let _ = writeln!(text, "| {} | {} |", unit.name, others.join(", "));
        }
    }
    Ok(text)
}

fn about(scene: &SceneFile) -> &str {
    if scene.description.is_empty() {
        "A car's front disc brake: the start values of the variables"
    } else {
        &scene.description
    }
}

/// Without the rounding of a conversion.
fn rounded(value: f64) -> f64 {
    format!("{value:.11e}").parse().unwrap_or(value)
}

fn shown(packaged: &Packaged, name: &str) -> String {
    let reference = scene::variables::find(name).expect("a row of the variable table");
    let row = lookup(reference).expect("a row of the variable table").0;
    let value = value(row, packaged.starts[reference as usize]);
    value.split(' ').next().unwrap_or_default().to_owned()
}

/// Settings of a scene, beside the start values of the stock FMU.
fn section(name: &str, scene: &SceneFile) -> String {
    let (packaged, stock) = (&scene.packaged, Packaged::stock());
    let experiment = packaged.experiment;
    let mut text = format!("## {name}\n\n{}. ", about(scene));
    if !scene.given.is_empty() {
        let _ = write!(text, "File and drive: [examples/{name}](../../examples/{name}/README.md). ");
    }
    let _ = write!(
        text,
        "Default experiment: {} s to {} s in steps of {} s, tolerance {}.\n\n",
        number(experiment.start),
        number(experiment.stop),
        number(experiment.step),
        number(experiment.tolerance)
    );
    if scene.given.is_empty() {
        return text;
    }
    text += "| other than in the stock FMU | unit | value | in the stock FMU |\n|---|---|---|---|\n";
    let mut first = 0;
    for row in TABLE {
        let elements = first..first + row.count() as usize;
        first = elements.end;
        if !scene.given.iter().any(|reference| elements.contains(&(*reference as usize))) {
            continue;
        }
        if packaged.starts[elements.clone()] == stock.starts[elements.clone()] {
            continue;
        }
        let [mut own, others] =
            [packaged, &stock].map(|packaged| super::tables::entry(row, &packaged.starts[elements.clone()]));
        if elements.len() > MOST_SHOWN {
            own.start = format!("{} values, see the file", elements.len());
        }
        let _ =
            writeln!(text, "| `{}` | {} | {} | {} |", own.name, own.unit, escaped(&own.start), escaped(&others.start));
    }
    text + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_of_a_page_has_the_columns_of_its_head() {
        for (name, text) in write(&crate::examples()).unwrap() {
            let mut columns = 0;
            for line in text.lines() {
                let own = line.replace("\\|", "").matches('|').count();
                columns = match own {
                    _ if !line.starts_with('|') => 0,
                    own if columns == 0 => own,
                    _ => columns,
                };
                assert!(!line.starts_with('|') || own == columns, "{name}: {line}");
            }
        }
    }
}
