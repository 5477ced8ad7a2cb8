//! Cost of an internal step against the number of cells, of thermal states and of Fourier modes, with cached factors.

use super::machine;
use crate::plot::{Axis, Figure, Mark, Panel, Series};
use anyhow::{Context, Result, anyhow};
use model::levels::ModelOperators;
use scene::Scene;
use scene::variables::{changed, find};
use serde_json::{Value, json};
use sliding_contact::component::{Component, Values};
use std::fmt::{self, Write as _};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use verification::clock::process_seconds;
use verification::drives;

/// Steps timed together; the fastest of [`CHUNKS`] counts.
const STEPS: usize = 20;
const CHUNKS: usize = 8;
/// Steps before, in which factors and tables are made.
const BEFORE: usize = 40;
/// The measured costs.
const TABLE: &str = "cost_per_step.csv";
/// The exponent is that of the costs from here on, relative to the largest: below, calls cost more than arithmetic.
const FITTED: f64 = 0.24;

/// Cost over a size.
struct Law {
    name: String,
    /// Size and s per internal step.
    points: Vec<(f64, f64)>,
}

impl Law {
    /// Exponent of the largest sizes by least squares on logarithms; `None` where there are less than two.
    fn exponent(&self) -> Option<f64> {
        let largest = self.points.iter().map(|point| point.0).fold(0.0, f64::max);
        let fitted: Vec<(f64, f64)> =
            self.points.iter().filter(|p| p.0 >= FITTED * largest).map(|p| (p.0.ln(), p.1.ln())).collect();
        let count = fitted.len() as f64;
        let (x, y) = fitted.iter().fold((0.0, 0.0), |(x, y), p| (x + p.0 / count, y + p.1 / count));
        let spread: f64 = fitted.iter().map(|p| (p.0 - x).powi(2)).sum();
        let joint: f64 = fitted.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
        (fitted.len() > 1 && spread > 0.0).then(|| joint / spread)
    }
}

/// Titles and horizontal axes of the panels.
const GROUPS: [(&str, &str); 3] = [
    ("Cells of the contact line", "cells N"),
    ("Thermal states (33 cells, by the tolerance)", "states of both bodies"),
    ("Fourier waves of the strip (33 cells, by the length of the strip)", "waves"),
];

/// Laws that share an axis.
struct Group {
    title: &'static str,
    label: &'static str,
    laws: Vec<Law>,
}

pub(crate) struct Scaling {
    groups: Vec<Group>,
    omissions: Vec<String>,
    header: Vec<String>,
}

/// Measures the costs; `quick`: to 129 cells.
pub(crate) fn measure(quick: bool) -> Result<Scaling> {
    let problems = drives::problems().map_err(|text| anyhow!(text))?;
    let starts = |name: &str| {
        problems.iter().find(|problem| problem.name == name).map(|problem| problem.starts).context("a scene is missing")
    };
    let (cold, hot) = (starts("unidirectional_pin")?, starts("hot_punch")?);
    let with = |values: &Values, changes: &[(&str, f64)]| -> Result<Values> {
        changed(values, changes).map_err(|text| anyhow!(text))
    };
    // Half-planes: the step is the same as that of blocks, whose finite elements only take time to build.
    let hot = with(&hot, &[("punch.body", 3.0), ("strip.body", 3.0)])?;
    let mut omissions = Vec::new();
    let mut law = |name: &'static str, runs: &[(Values, f64, [f64; 2])], size: &dyn Fn(&Values) -> Option<f64>| {
        let mut points = Vec::new();
        for (values, step, inputs) in runs {
            match (size(values), seconds(values, *step, *inputs)) {
                (Some(size), Ok(cost)) => points.push((size, cost)),
                (_, Err(text)) => omissions.push(format!("{name}: {text}")),
                (None, _) => omissions.push(format!("{name}: heat is not carried along the line")),
            }
        }
        Law { name: name.to_owned(), points }
    };
    let counts: &[f64] = if quick { &[17.0, 33.0, 65.0, 129.0] } else { &[17.0, 33.0, 65.0, 129.0, 193.0, 257.0] };
    let line = |values: &Values, cells: f64, tolerance: f64| {
        with(values, &[("solver.fidelity", 3.0), ("solver.cells", cells), ("solver.tolerance", tolerance)])
    };
    let over = |values: &Values, step: f64, inputs: [f64; 2]| -> Result<Vec<(Values, f64, [f64; 2])>> {
        counts.iter().map(|&cells| Ok((line(values, cells, 1e-3)?, step, inputs))).collect()
    };
    let cells = |values: &Values| find("solver.cells").map(|reference| values[reference as usize]);
    // The hot punch creeps: at held inputs it would soon leave its stroke.
    let (slow, hard) = ([0.5, 100.0], [5e-4, 10e3]);
    let by_cells = vec![
        law("pressure and wear", &over(&cold, 1e-3, slow)?, &cells),
        law("with heat and distortion", &over(&hot, 1e-3, hard)?, &cells),
    ];
    let tolerances = if quick { &[1e-1, 1e-3][..] } else { &[1e-1, 3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4][..] };
    let runs: Result<Vec<_>> = tolerances.iter().map(|&t| Ok((line(&hot, 33.0, t)?, 1e-3, hard))).collect();
    let by_states = vec![law("with heat and distortion", &runs?, &|values| sizes(values).map(|size| size[0]))];
    let lengths = if quick { &[1.0, 4.0][..] } else { &[0.5, 1.0, 2.0, 4.0, 8.0][..] };
    let runs: Result<Vec<_>> = lengths
        .iter()
        .map(|&length| {
            let values = line(&hot, 33.0, 1e-3)?;
            Ok((with(&values, &[("strip.length", length)])?, 1e-3, hard))
        })
        .collect();
    let by_waves = vec![law("with heat and distortion", &runs?, &|values| sizes(values).map(|size| size[1]))];
    let group = |((title, label), laws)| Group { title, label, laws };
    let groups = GROUPS.into_iter().zip([by_cells, by_states, by_waves]).map(group).collect();
    let header = vec![
        "Processor time of one internal step at constant inputs, through the component, one thread.".to_owned(),
        format!("{}; commit {}.", machine::name(), machine::commit()),
    ];
    Ok(Scaling { groups, omissions, header })
}

/// Costs that [`Scaling::write`] wrote into the folder.
pub(crate) fn read(folder: &Path) -> Result<Scaling> {
    let path = folder.join(TABLE);
    let text = fs::read_to_string(&path).with_context(|| format!("reading {}", path.display()))?;
    let mut groups = GROUPS.map(|(title, label)| Group { title, label, laws: Vec::new() });
    let (mut header, mut omissions) = (Vec::new(), Vec::new());
    for line in text.lines().filter_map(|line| line.strip_prefix("# ")) {
        match line.strip_prefix("left out: ") {
            Some(omission) => omissions.push(omission.to_owned()),
            None => header.push(line.to_owned()),
        }
    }
    let mut rows = csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(text.as_bytes());
    for row in rows.deserialize() {
        let (label, name, size, cost): (String, String, f64, f64) =
            row.with_context(|| format!("reading {}", path.display()))?;
        let group = groups.iter_mut().find(|group| group.label == label);
        let laws = &mut group.with_context(|| format!("{}: there is no group {label:?}", path.display()))?.laws;
        match laws.last_mut().filter(|law| law.name == name) {
            Some(law) => law.points.push((size, cost)),
            None => laws.push(Law { name, points: vec![(size, cost)] }),
        }
    }
    Ok(Scaling { groups: groups.into(), omissions, header })
}

/// Thermal states of both bodies and Fourier modes of the strip.
fn sizes(values: &Values) -> Option<[f64; 2]> {
    let scene = Scene::new(values, None).ok()?;
    let Ok(ModelOperators::Line(operators)) = ModelOperators::new(&scene, steady::run_in) else { return None };
    let heat = operators.heat.as_ref()?;
    Some([(heat.states[0] + heat.states[1]) as f64, heat.waves as f64])
}

/// Processor time of an internal step, s.
fn seconds(values: &Values, step: f64, inputs: [f64; 2]) -> Result<f64, String> {
    let mut component = Component::new(Arc::new(*values));
    component.enter_initialization();
    component.initialise(None)?;
    component.set_input(0, inputs[0]);
    component.set_input(1, inputs[1]);
    (0..BEFORE).try_for_each(|_| component.step(step))?;
    let mut fastest = f64::INFINITY;
    for _ in 0..CHUNKS {
        let (begin, before) = (process_seconds(), component.work());
        (0..STEPS).try_for_each(|_| component.step(step))?;
        let after = component.work();
        // Lumped heat takes steps of its own; the line takes at least one per communication step.
        let steps = (after.0 + after.1 - before.0 - before.1).max(1) as f64;
        fastest = fastest.min((process_seconds() - begin) / steps);
    }
    Ok(fastest)
}

impl Scaling {
    fn figure(&self) -> Figure {
        let panels = self.groups.iter().map(|group| {
            let mut series: Vec<Series> = Vec::new();
            for law in &group.laws {
                let exponent = law.exponent().map_or(String::new(), |e| format!(", exponent {e:.2}"));
                series.push(
                    Series::line(
                        format!("{}{exponent}", law.name),
                        law.points.iter().map(|p| (p.0, 1e6 * p.1)).collect(),
                    )
                    .with(Mark::LineAndPoints),
                );
            }
            let all = || group.laws.iter().flat_map(|law| &law.points);
            let largest = all().map(|p| p.0).fold(0.0, f64::max);
            let smallest = all().map(|p| p.0).fold(f64::INFINITY, f64::min);
            let top = all().filter(|p| p.0 == largest).map(|p| 1e6 * p.1).fold(0.0, f64::max);
            if top > 0.0 {
                let square = vec![(smallest, top * (smallest / largest).powi(2)), (largest, top)];
                series.push(Series::line("square of the size", square).with(Mark::Dashes).coloured(6));
            }
            let costs = all().map(|p| 1e6 * p.1).filter(|cost| *cost > 0.0);
            let (least, most) = costs.fold((f64::INFINITY, 0.0_f64), |(l, m), cost| (l.min(cost), m.max(cost)));
            // Room for round numbers on a narrow axis.
            let cost = Axis::logarithmic("time of a step (µs)").over((0.5 * least).max(1e-3), 2.0 * most.max(1e-2));
            let size = Axis::logarithmic(group.label).over((0.6 * smallest).min(0.6 * largest), 1.6 * largest.max(1.0));
            Panel::new(group.title, size, cost, series)
        });
        let mut header = self.header.clone();
        header.extend(self.omissions.iter().map(|text| format!("Left out: {text}")));
        let panels: Vec<Panel> = panels.collect();
        Figure::new("Cost of a step against its size", panels).with_header(header)
    }

    /// Writes picture and table.
    pub(crate) fn write(&self, folder: &Path) -> Result<[PathBuf; 2]> {
        let (svg, csv) = (folder.join("cost_per_step.svg"), folder.join(TABLE));
        let mut text: String = self.header.iter().map(|line| format!("# {line}\n")).collect();
        text.extend(self.omissions.iter().map(|line| format!("# left out: {line}\n")));
        text += "group,law,size,seconds_per_step\n";
        for group in &self.groups {
            for law in &group.laws {
                for (size, cost) in &law.points {
                    let _ = writeln!(text, "\"{}\",\"{}\",{size},{cost:.4e}", group.label, law.name);
                }
            }
        }
        fs::write(&csv, text).with_context(|| format!("writing {}", csv.display()))?;
        self.figure().write(&svg)?;
        Ok([svg, csv])
    }

    pub(crate) fn record(&self) -> Value {
        let laws = self.groups.iter().flat_map(|group| {
            group.laws.iter().map(move |law| {
                json!({ "size": group.label, "law": law.name, "exponent": law.exponent(), "points": law.points })
            })
        });
        json!({ "scene": super::SCALING, "laws": laws.collect::<Vec<_>>(), "omissions": self.omissions })
    }

    /// Axis, law, its exponent, and the largest size with its cost.
    fn exponents(&self) -> impl Iterator<Item = [String; 5]> {
        let laws = self.groups.iter().flat_map(|group| group.laws.iter().map(|law| (group.label, law)));
        laws.map(|(label, law)| {
            let exponent = law.exponent().map_or("none".into(), |exponent| format!("{exponent:.2}"));
            let (size, cost) = law.points.last().copied().unwrap_or((0.0, 0.0));
            [label.to_owned(), law.name.clone(), exponent, size.to_string(), super::findings::time(cost)]
        })
    }

    pub(crate) fn table(&self) -> String {
        let mut text = "| over | of | exponent | largest, time of a step |\n|---|---|---|---|\n".to_owned();
        for [label, name, exponent, size, cost] in self.exponents() {
            let _ = writeln!(text, "| {label} | {name} | {exponent} | {size}: {cost} |");
        }
        text
    }
}

impl fmt::Display for Scaling {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(formatter, "Cost of a step against its size")?;
        for [label, name, exponent, size, cost] in self.exponents() {
            writeln!(formatter, "  {label:24} {name:26} exponent {exponent}; {cost} at {size}")?;
        }
        self.omissions.iter().try_for_each(|text| writeln!(formatter, "  left out: {text}"))
    }
}
