//! `cargo fmu stability`: maps of where the methods are accurate, oscillate, grow or are refused.

use crate::output::{self, print_line, print_text};
use crate::plot::{Axis, Figure, Mark, Panel, Series};
use crate::project;
use anyhow::{Context, Result, anyhow, bail};
use fmu_build::progress::bar;
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::fs;
use std::path::PathBuf;
use verification::stability::{self, Definition, Grid, Map, Verdict};

/// Writes one SVG and one CSV per map and prints the number of runs of each verdict.
#[derive(clap::Args, Debug)]
pub(crate) struct Arguments {
    /// Map to compute, as often as wanted; by default all.
    #[arg(long = "map", value_name = "NAME")]
    maps: Vec<String>,
    /// Twice as many points on each axis.
    #[arg(long)]
    fine: bool,
    /// Folder to write to; by default `stability` in cargo's target folder.
    #[arg(short, long, value_name = "FOLDER")]
    output: Option<PathBuf>,
    /// Print the maps as JSON instead of a table.
    #[arg(long)]
    json: bool,
    /// Only list the maps there are.
    #[arg(long, conflicts_with_all = ["fine", "output", "json"])]
    list: bool,
}

pub(crate) fn execute(arguments: &Arguments) -> Result<()> {
    let definitions = chosen(&arguments.maps)?;
    if arguments.list {
        definitions.iter().for_each(|definition| print_line!("{:12} {}", definition.name, definition.summary));
        return Ok(());
    }
    output::check_folder(arguments.output.as_deref())?;
    let folder = arguments.output.clone().unwrap_or_else(|| project::target().join("stability"));
    fs::create_dir_all(&folder).with_context(|| format!("making the folder {}", folder.display()))?;
    let grid = if arguments.fine { Grid::Fine } else { Grid::Normal };
    let mut records = Vec::new();
    for definition in definitions {
        let map = compute(&definition, grid)?;
        let (svg, csv) =
            (folder.join(format!("{}.svg", definition.name)), folder.join(format!("{}.csv", definition.name)));
        fs::write(&csv, table(&map)).with_context(|| format!("writing {}", csv.display()))?;
        figure(&map).write(&svg)?;
        if arguments.json {
            records.push(record(definition.name, &map));
        } else {
            print_text!("{}", summary(&map));
            print_line!("  {}\n  {}", svg.display(), csv.display());
        }
    }
    if arguments.json {
        print_line!("{:#}", Value::Array(records));
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

fn compute(definition: &Definition, grid: Grid) -> Result<Map> {
    let bar = bar(1000, "{percent:>3} % {msg}").with_message(definition.name);
    let map = (definition.compute)(grid, &|part| bar.set_position((1000.0 * part) as u64));
    bar.finish_and_clear();
    let map = map.map_err(|text| anyhow!("{}: {text}", definition.name))?;
    if map.panels.is_empty() {
        bail!("{}: the map has no panel", definition.name);
    }
    Ok(map)
}

/// Colour of a verdict in the order of the plot's palette: right green, inexact light blue, rings amber, hides growth purple,
/// grows vermilion, refused black.
fn colour(verdict: Verdict) -> usize {
    match verdict {
        Verdict::Right => 2,
        Verdict::Inexact => 5,
        Verdict::Rings => 4,
        Verdict::Hides => 3,
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
        let (mut computed, mut theories) = (0, 0);
        let curves = panel.curves.iter().map(|curve| {
            let series = Series::line(curve.name.clone(), curve.points.clone());
            if curve.theory {
                theories += 1;
                return series.with(Mark::Dashes).coloured([0, 6][(theories - 1) % 2]);
            }
            computed += 1;
            // Over judged points, in a colour that no verdict has.
            let colours = if panel.points.is_empty() { [1, 2, 4] } else { [0, 0, 0] };
            // No line between runs where the theory tells more.
            let finer = panel.curves.iter().any(|other| other.theory && other.points.len() > curve.points.len());
            let mark = if finer { Mark::Points } else { Mark::LineAndPoints };
            series.with(mark).coloured(colours[(computed - 1) % 3])
        });
        // The theory on top.
        let (theory, runs): (Vec<Series>, Vec<Series>) = curves.partition(|series| series.mark == Mark::Dashes);
        let series: Vec<Series> = judged.chain(runs).chain(theory).collect();
        Panel::new(panel.title.clone(), axis(&panel.x), axis(&panel.y), series)
    });
    let columns = map.columns;
    Figure { columns, ..Figure::new(map.title, panels.collect()).with_header(vec![map.problem.clone()]) }
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

fn summary(map: &Map) -> String {
    let mut text = format!("{}\n", map.title);
    for panel in map.panels.iter().filter(|panel| !panel.points.is_empty()) {
        let counts = Verdict::ALL.map(|verdict| (verdict, panel.count(verdict)));
        let counts =
            counts.iter().filter(|(_, count)| *count > 0).map(|(verdict, count)| format!("{count:4} {verdict}"));
        let _ = writeln!(text, "  {:40} {}", panel.title, counts.collect::<Vec<_>>().join("  "));
    }
    for finding in &map.findings {
        let _ = writeln!(text, "  {finding}");
    }
    text
}

fn record(name: &str, map: &Map) -> Value {
    let panels = map.panels.iter().map(|panel| {
        let points = panel.points.iter().map(|point| {
            // The error of a refused run is not finite, which becomes null.
            json!({ "x": point.x, "y": point.y, "verdict": point.verdict.to_string(), "error": point.error })
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
    let findings = &map.findings;
    json!({ "map": name, "title": map.title, "problem": map.problem, "findings": findings, "panels": panels.collect::<Vec<_>>() })
}
