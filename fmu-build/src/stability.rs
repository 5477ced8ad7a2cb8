//! `cargo fmu stability`: maps of where the methods are right, ring, grow or refuse.

use crate::plot::{Axis, Figure, Legend, Mark, Panel, Series};
use crate::project;
use anyhow::{Context, Result, anyhow, bail};
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::{Value, json};
use sliding_contact::verification::stability::{self, Definition, Map, Verdict};
use std::fmt::Write as _;
use std::fs;
use std::path::PathBuf;

/// Compute stability maps: where each method is right, rings, grows or refuses, with the bound of the theory.
///
/// Writes one SVG and one CSV per map and prints how many runs came out how.
#[derive(clap::Args, Debug)]
pub struct Arguments {
    /// Maps to compute; by default all.
    maps: Vec<String>,
    /// Folder to write to; by default `stability` in cargo's target folder.
    #[arg(short, long, value_name = "FOLDER")]
    output: Option<PathBuf>,
    /// Print the maps as JSON instead of a table.
    #[arg(long)]
    json: bool,
    /// Only list the maps there are.
    #[arg(long)]
    list: bool,
}

/// Runs the command.
///
/// # Errors
/// Where there is no such map, one cannot be computed, or a file cannot be written.
pub fn execute(arguments: &Arguments) -> Result<()> {
    let definitions = chosen(&arguments.maps)?;
    if arguments.list {
        definitions.iter().for_each(|definition| println!("{:12} {}", definition.name, definition.summary));
        return Ok(());
    }
    let folder = arguments.output.clone().unwrap_or_else(|| project::target().join("stability"));
    fs::create_dir_all(&folder).with_context(|| format!("making the folder {}", folder.display()))?;
    let mut records = Vec::new();
    for definition in definitions {
        let map = compute(&definition)?;
        let (svg, csv) =
            (folder.join(format!("{}.svg", definition.name)), folder.join(format!("{}.csv", definition.name)));
        figure(&map).write(&svg)?;
        fs::write(&csv, table(&map)).with_context(|| format!("writing {}", csv.display()))?;
        if arguments.json {
            records.push(record(definition.name, &map));
        } else {
            print!("{}", summary(&map));
            println!("  {}\n  {}", svg.display(), csv.display());
        }
    }
    if arguments.json {
        println!("{:#}", Value::Array(records));
    }
    Ok(())
}

fn chosen(names: &[String]) -> Result<Vec<Definition>> {
    let all = stability::maps();
    if names.is_empty() {
        return Ok(all);
    }
    let find = |name: &String| {
        all.iter().find(|definition| definition.name == name).copied().with_context(|| {
            let known: Vec<&str> = all.iter().map(|definition| definition.name).collect();
            format!("there is no map {name:?}: there are {}", known.join(", "))
        })
    };
    names.iter().map(find).collect()
}

fn compute(definition: &Definition) -> Result<Map> {
    let style = ProgressStyle::with_template("{bar:30} {percent:>3} % {msg}")?;
    let bar = ProgressBar::new(1000).with_style(style).with_message(definition.name);
    let map = (definition.compute)(&|part| bar.set_position((1000.0 * part) as u64));
    bar.finish_and_clear();
    let map = map.map_err(|text| anyhow!("{}: {text}", definition.name))?;
    if map.panels.is_empty() {
        bail!("{}: the map has no panel", definition.name);
    }
    Ok(map)
}

/// Colour of a verdict in the order of the plot's palette: right green, rings amber, grows vermilion, refused grey.
fn colour(verdict: Verdict) -> usize {
    match verdict {
        Verdict::Right => 2,
        Verdict::Rings => 5,
        Verdict::Grows => 1,
        Verdict::Refused => 6,
    }
}

fn figure(map: &Map) -> Figure {
    let axis = |axis: &stability::Axis| Axis {
        label: axis.label.to_owned(),
        logarithmic: axis.logarithmic,
        range: axis.range,
    };
    let panels = map.panels.iter().map(|panel| {
        let judged = Verdict::ALL.into_iter().filter_map(|verdict| {
            let points = panel.points.iter().filter(|point| point.verdict == verdict);
            let points: Vec<(f64, f64)> = points.map(|point| (point.x, point.y)).collect();
            let series = Series::line(verdict.to_string(), points).with(Mark::Points).coloured(colour(verdict));
            (!series.points.is_empty()).then_some(series)
        });
        let mut computed = 0;
        let curves = panel.curves.iter().map(|curve| {
            let series = Series::line(curve.name.clone(), curve.points.clone());
            if curve.theory {
                return series.with(Mark::Dashes).coloured(0);
            }
            computed += 1;
            series.with(Mark::Points).coloured([1, 2, 3][(computed - 1) % 3])
        });
        let mut series: Vec<Series> = judged.collect();
        series.extend(curves);
        Panel::new(panel.title.clone(), axis(&panel.x), axis(&panel.y), series).with_legend(Legend::UpperRight)
    });
    let mut header = map.header.clone();
    header.push(format!("Computed on {} {}.", std::env::consts::ARCH, std::env::consts::OS));
    let columns = map.columns;
    Figure { columns, ..Figure::new(map.title, panels.collect()).with_header(header) }
}

/// One row per run and per point of a curve.
fn table(map: &Map) -> String {
    let mut text = String::from("panel,curve,x,y,verdict,error\n");
    for panel in &map.panels {
        for point in &panel.points {
            let (x, y, verdict, error) = (point.x, point.y, point.verdict, point.error);
            let _ = writeln!(text, "\"{}\",,{x},{y:.6e},{verdict},{error:.3e}", panel.title);
        }
        for curve in &panel.curves {
            for (x, y) in &curve.points {
                let _ = writeln!(text, "\"{}\",\"{}\",{x:.6e},{y:.6e},,", panel.title, curve.name);
            }
        }
    }
    text
}

fn count(map: &Map, panel: usize, verdict: Verdict) -> usize {
    map.panels[panel].points.iter().filter(|point| point.verdict == verdict).count()
}

fn summary(map: &Map) -> String {
    let mut text = format!("{}\n", map.title);
    for (index, panel) in map.panels.iter().enumerate().filter(|(_, panel)| !panel.points.is_empty()) {
        let counts = Verdict::ALL.map(|verdict| format!("{:4} {verdict}", count(map, index, verdict)));
        let _ = writeln!(text, "  {:32} {}", panel.title, counts.join("  "));
    }
    text
}

fn record(name: &str, map: &Map) -> Value {
    // JSON has no NaN: a refused run has no error.
    let error = |value: f64| if value.is_finite() { json!(value) } else { Value::Null };
    let panels = map.panels.iter().map(|panel| {
        let points = panel.points.iter().map(|point| {
            json!({
                "x": point.x,
                "y": point.y,
                "verdict": point.verdict.to_string(),
                "error": error(point.error),
            })
        });
        let curves = panel.curves.iter().map(|curve| json!({ "name": curve.name, "points": curve.points }));
        json!({
            "title": panel.title,
            "x": panel.x.label,
            "y": panel.y.label,
            "points": points.collect::<Vec<_>>(),
            "curves": curves.collect::<Vec<_>>(),
        })
    });
    json!({ "map": name, "title": map.title, "header": map.header, "panels": panels.collect::<Vec<_>>() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use sliding_contact::verification::stability::{Curve, Point};

    fn sample() -> Map {
        let axis = |label| stability::Axis { label, logarithmic: true, range: Some((0.1, 10.0)) };
        let point = |y, verdict, error| Point { x: 1.0, y, verdict, error };
        Map {
            title: "A map",
            header: vec!["what it shows".into()],
            panels: vec![stability::Panel {
                title: "a method".into(),
                x: axis("cells"),
                y: axis("step"),
                points: vec![point(0.5, Verdict::Right, 1e-3), point(2.0, Verdict::Refused, f64::NAN)],
                curves: vec![Curve { name: "bound".into(), points: vec![(0.1, 1.0), (10.0, 1.0)], theory: true }],
            }],
            columns: 1,
        }
    }

    #[test]
    fn figure_table_and_record_hold_every_run() {
        let map = sample();
        let svg = figure(&map).svg().unwrap();
        for text in ["A map", "what it shows", "a method", "cells", "step", "right", "refused", "bound"] {
            assert!(svg.contains(text), "{text} is missing");
        }
        assert!(!svg.contains("grows"));
        let lines: Vec<String> = table(&map).lines().map(str::to_owned).collect();
        assert_eq!(lines.len(), 5);
        assert_eq!(lines[1], "\"a method\",,1,5.000000e-1,right,1.000e-3");
        let record = record("a", &map);
        assert_eq!(record["panels"][0]["points"][1]["verdict"], "refused");
        assert!(record["panels"][0]["points"][1]["error"].is_null());
        assert!(summary(&map).contains("1 right"));
    }

    #[test]
    fn maps_are_found_by_name() {
        assert!(!chosen(&[]).unwrap().is_empty());
        let error = chosen(&["no such map".into()]).unwrap_err().to_string();
        assert!(error.contains("no such map") && error.contains("wear-step"), "{error}");
    }
}
