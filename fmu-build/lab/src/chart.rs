//! `cargo fmu chart`: error against cost for six scenes, every level and peer on the same axes.

mod document;
mod figure;
mod findings;
pub(crate) mod machine;
mod measure;
mod peers;
mod scaling;
mod stored;
mod summary;
mod table;
mod truth;

use crate::output::{self, print_line, print_text};
use crate::project;
use anyhow::{Context, Result, anyhow, bail};
use fmu_build::progress::bar;
use measure::Point;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use verification::drives::{self, DriveProblem, Sample};

/// Every level, tolerance, number of cells, order of the inputs and communication step, and peers where they can do
/// the scene. Writes one SVG and one CSV per scene, and those of the cost per step; prints what reaches 1 %.
#[derive(clap::Args, Debug)]
pub(crate) struct Arguments {
    /// Scenes to chart; by default all, and the cost per step.
    #[arg(long, value_name = "NAME")]
    scene: Vec<String>,
    /// The coarser half of every family, shorter budgets, no peers: under a minute.
    #[arg(long)]
    quick: bool,
    /// Folder to write to; by default `accuracy` in cargo's target folder.
    #[arg(short, long, value_name = "FOLDER")]
    output: Option<PathBuf>,
    /// Leave the peers out: no Python environment is made for them.
    #[arg(long)]
    no_peers: bool,
    /// Recompute the reference solutions of the scenes, without a limit of time, and keep them in docs/accuracy/truth: for
    /// scenes whose finest run takes longer than a chart should.
    #[arg(long, conflicts_with_all = ["quick", "json", "output", "no_peers"])]
    write_truth: bool,
    /// Write the findings into docs/accuracy.md as well.
    #[arg(long, conflicts_with = "quick")]
    document: bool,
    /// Draw and describe the measurements in docs/accuracy anew; nothing is measured.
    #[arg(long, conflicts_with_all = ["quick", "output", "no_peers", "write_truth", "json"])]
    redraw: bool,
    /// Print the findings as JSON.
    #[arg(long)]
    json: bool,
    /// Only list the scenes there are.
    #[arg(long, conflicts_with_all = ["scene", "quick", "output", "no_peers", "write_truth", "document", "redraw", "json"])]
    list: bool,
}

/// Name of the chart of the cost per step among the scenes.
const SCALING: &str = "cost_per_step";

struct Chart {
    problem: DriveProblem,
    /// Origin of the reference solution.
    how: String,
    /// Data of the scene as it was measured.
    data: String,
    /// Machine and source version.
    measured: String,
    points: Vec<Point>,
    /// Omissions from the chart with their reasons.
    omissions: Vec<String>,
    quick: bool,
}

pub(crate) fn execute(arguments: &Arguments) -> Result<()> {
    let problems = drives::problems().map_err(|text| anyhow!(text))?;
    if arguments.list {
        problems.iter().for_each(|problem| print_line!("{:20} {}", problem.name, problem.title));
        print_line!("{SCALING:20} Cost per step against cells, thermal states and Fourier modes");
        return Ok(());
    }
    let known: Vec<&str> = problems.iter().map(|problem| problem.name).chain([SCALING]).collect();
    if let Some(name) = arguments.scene.iter().find(|name| !known.contains(&name.as_str())) {
        bail!("there is no scene {name:?}: there are {}", known.join(", "));
    }
    let wanted = |name: &str| arguments.scene.is_empty() || arguments.scene.iter().any(|own| own == name);
    output::check_folder(arguments.output.as_deref())?;
    let folder = arguments.output.clone().unwrap_or_else(|| project::target().join("accuracy"));
    fs::create_dir_all(&folder).with_context(|| format!("making the folder {}", folder.display()))?;
    if arguments.write_truth {
        return problems.iter().filter(|problem| wanted(problem.name)).try_for_each(truth::write);
    }
    if arguments.redraw {
        let folder = project::root().join("docs/accuracy");
        let mut descriptions = Vec::new();
        for problem in problems.into_iter().filter(|problem| wanted(problem.name)) {
            let chart = stored::read(problem, &folder)?;
            for path in draw(&chart, &folder)? {
                print_line!("{}", path.display());
            }
            descriptions.push((chart.problem.name, document::describe(&chart, &findings::of(&chart))));
        }
        if wanted(SCALING) {
            let scaling = scaling::read(&folder)?;
            for path in scaling.write(&folder)? {
                print_line!("{}", path.display());
            }
            descriptions.push((SCALING, scaling.table()));
        }
        return document::write(&descriptions);
    }
    let peers = !(arguments.quick || arguments.no_peers);
    let (mut records, mut passages, mut left_out) = (Vec::new(), Vec::new(), Vec::new());
    for problem in problems.into_iter().filter(|problem| wanted(problem.name)) {
        let known = match truth::of(&problem, measure::Budget::new(arguments.quick).truth) {
            Ok(known) => known,
            Err(error) => {
                eprintln!("{} is left out: {error:#}", problem.name);
                left_out.push(problem.name);
                continue;
            }
        };
        let chart = measure(problem, known, arguments.quick, peers)?;
        let paths = write(&chart, &folder)?;
        let findings = findings::of(&chart);
        passages.push((chart.problem.name, document::describe(&chart, &findings)));
        if arguments.json {
            records.push(findings.record(&chart));
        } else {
            print_text!("{}\n  Truth: {}\n{findings}", chart.problem.title, chart.how);
            paths.iter().for_each(|path| print_line!("  {}", path.display()));
        }
    }
    if wanted(SCALING) {
        let scaling = scaling::measure(arguments.quick)?;
        let paths = scaling.write(&folder)?;
        passages.push((SCALING, scaling.table()));
        if arguments.json {
            records.push(scaling.record());
        } else {
            print_text!("{scaling}");
            paths.iter().for_each(|path| print_line!("  {}", path.display()));
        }
    }
    if arguments.document {
        document::write(&passages)?;
    }
    if arguments.json {
        print_line!("{:#}", Value::Array(records));
    }
    // A quick chart has no time for every truth; a whole one must have it.
    if !arguments.quick && !left_out.is_empty() {
        bail!("without a truth there is no chart: {}", left_out.join(", "));
    }
    Ok(())
}

/// Measures every family and every peer against the reference.
fn measure(problem: DriveProblem, known: (String, Vec<Sample>), quick: bool, with_peers: bool) -> Result<Chart> {
    let families = problem.families(quick);
    let bar = bar(families.iter().map(|family| family.settings.len()).sum(), "{percent:>3} % {msg}");
    let budget = measure::Budget::new(quick);
    let (how, truth) = known;
    let measured = machine::measured(quick);
    let data = problem.data.to_owned();
    let mut chart = Chart { how, data, measured, points: Vec::new(), omissions: Vec::new(), quick, problem };
    for family in families {
        bar.set_message(format!("{}: {}", chart.problem.name, family.name));
        measure::family(&mut chart, &family, &truth, &budget);
        bar.inc(family.settings.len() as u64);
    }
    if with_peers {
        bar.set_message(format!("{}: peers", chart.problem.name));
        peers::measure(&mut chart, &truth)?;
    } else {
        chart.omissions.push("peers: not run (--quick or --no-peers)".into());
    }
    bar.finish_and_clear();
    Ok(chart)
}

fn write(chart: &Chart, folder: &Path) -> Result<Vec<PathBuf>> {
    let csv = folder.join(format!("{}.csv", chart.problem.name));
    fs::write(&csv, table::of(chart)).with_context(|| format!("writing {}", csv.display()))?;
    Ok(draw(chart, folder)?.into_iter().chain([csv]).collect())
}

/// Draws everything that was measured, and its summary.
fn draw(chart: &Chart, folder: &Path) -> Result<[PathBuf; 2]> {
    let whole = folder.join(format!("{}.svg", chart.problem.name));
    let summary = folder.join(format!("{}-summary.svg", chart.problem.name));
    figure::draw(chart).write(&whole)?;
    summary::draw(chart).write(&summary)?;
    Ok([whole, summary])
}

impl Chart {
    fn family(&self, name: &str) -> impl Iterator<Item = &Point> {
        self.points.iter().filter(move |point| point.family == name)
    }

    /// Names of the families with a point, in the order in which they were measured.
    fn families(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for point in &self.points {
            if !names.contains(&point.family.as_str()) {
                names.push(&point.family);
            }
        }
        names
    }

    /// Adds an external run with its errors against the reference.
    fn judge(&mut self, point: Point, samples: &[Sample], truth: &[Sample]) {
        let errors = self.problem.errors(samples, truth);
        self.points.push(Point { errors, ..point });
    }
}
