//! Runs the peers of benches/peers on the same scene, in the same session.
//!
//! A peer is a Python program that reads the scene as JSON on its standard input and writes one JSON object per line:
//! `{"family", "setting", "initialisation", "seconds", "steps", "samples"}` for a run, samples in the order of
//! [`Sample`] with null for quantities that it does not model, or `{"omitted": reason}`. It measures its own processor time,
//! without the import of its packages.

use super::Chart;
use super::measure::Point;
use crate::{package, project, python};
use anyhow::{Context, Result, bail};
use scene::STATIONS;
use scene::variables::TABLE;
use serde_json::{Value, json};
use std::process::Command;
use verification::drives::{DriveProblem, Errors, Sample};

/// Rows of the inputs that a peer receives per communication step, linear between them.
const ROWS: u32 = 10;

/// A peer, the scenes it can do, and what it leaves out elsewhere.
struct Peer {
    script: &'static str,
    name: &'static str,
    scenes: &'static [&'static str],
    elsewhere: &'static str,
}

const PEERS: [Peer; 3] = [
    Peer {
        script: "tamaas_wear.py",
        name: "Tamaas",
        scenes: &["unidirectional_pin"],
        elsewhere: "solves half-spaces without heat; this scene has bodies of finite height, or heat that feeds back",
    },
    Peer {
        script: "scikit_fem_punch.py",
        name: "scikit-fem",
        scenes: &["reciprocating_punch", "hot_punch"],
        elsewhere: "the peer is written for the two reciprocating blocks",
    },
    Peer {
        script: "pythonfmu_brake.py",
        name: "pythonfmu's lumped brake",
        scenes: &["udds_brake"],
        elsewhere: "it is a lumped brake for the drive cycle",
    },
];

/// Adds the runs of every peer that can do the scene to the chart; for the others the reason to its omissions.
pub(crate) fn measure(chart: &mut Chart, truth: &[Sample]) -> Result<()> {
    for peer in &PEERS {
        if !peer.scenes.contains(&chart.problem.name) {
            chart.omissions.push(format!("{}: {}", peer.name, peer.elsewhere));
            continue;
        }
        let answer = run(peer, &chart.problem)?;
        for line in answer.lines() {
            let value: Value = serde_json::from_str(line).with_context(|| format!("{}: {line}", peer.script))?;
            if let Some(reason) = value["omitted"].as_str() {
                chart.omissions.push(format!("{}: {reason}", peer.name));
                continue;
            }
            let (point, samples) = read(&value).with_context(|| format!("{}: {line}", peer.script))?;
            chart.judge(point, &samples, truth);
        }
    }
    Ok(())
}

fn run(peer: &Peer, problem: &DriveProblem) -> Result<String> {
    let mut request = describe(problem);
    if problem.name == "udds_brake" {
        request["fmu"] = json!(package::build(Some("disc_brake"), &package::Options::default())?);
        request["folder"] = json!(project::target().join("peers"));
    }
    let script = project::root().join("benches/peers").join(peer.script);
    let mut command = Command::new(python::own(python::PEERS)?);
    command
        .arg(&script)
        // One thread, as the component has.
        .envs(["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"].map(|name| (name, "1")));
    let output = project::fed(&mut command, &script.display().to_string(), request.to_string().as_bytes())?;
    if !output.status.success() {
        let words = String::from_utf8_lossy(&output.stderr);
        let last: Vec<&str> = words.lines().rev().take(6).collect();
        bail!(
            "{} ended with {}:\n{}",
            script.display(),
            output.status,
            last.into_iter().rev().collect::<Vec<_>>().join("\n")
        );
    }
    Ok(String::from_utf8(output.stdout)?)
}

/// The scene for a peer: parameters by name, inputs as a table, times at which it is judged.
fn describe(problem: &DriveProblem) -> Value {
    let mut parameters = serde_json::Map::new();
    let mut reference = 0;
    for row in TABLE {
        for element in 0..row.count() {
            let name = row.element_name(element);
            parameters.insert(name, json!(problem.starts[reference]));
            reference += 1;
        }
    }
    let step = problem.step / f64::from(ROWS);
    let last = problem.samples.last().copied().unwrap_or(0.0);
    let rows: Vec<[f64; 3]> = (0..=(last / step).round() as u32)
        .map(|index| {
            let time = f64::from(index) * step;
            let [velocity, load] = (problem.inputs)(time);
            [time, velocity, load]
        })
        .collect();
    json!({
        "name": problem.name,
        "parameters": parameters,
        "inputs": rows,
        "step": problem.step,
        "samples": problem.samples,
        "stations": STATIONS,
    })
}

fn read(value: &Value) -> Result<(Point, Vec<Sample>)> {
    let number = |name: &str| value[name].as_f64().with_context(|| format!("{name} is missing"));
    let text = |name: &str| value[name].as_str().map(str::to_owned).with_context(|| format!("{name} is missing"));
    let rows = value["samples"].as_array().context("samples are missing")?;
    let sample = |row: &Value| -> Sample { std::array::from_fn(|at| row[at].as_f64().unwrap_or(f64::NAN)) };
    let point = Point {
        family: text("family")?,
        setting: text("setting")?,
        peer: true,
        seconds: [number("initialisation")?, number("seconds")?],
        steps: number("steps")? as u64,
        errors: Errors([f64::NAN; 4]),
        failure: value["failure"].as_str().map(|reason| (reason.to_owned(), value["part"].as_f64().unwrap_or(0.0))),
    };
    Ok((point, rows.iter().map(sample).collect()))
}
