//! The generated passages of docs/accuracy.md.

use super::Chart;
use super::findings::{Findings, Reached, lumped_errors, significant, time};
use crate::project;
use anyhow::{Context, Result};
use std::fmt::Write as _;
use std::fs;

/// Page with the charts.
const PAGE: &str = "docs/accuracy.md";

fn row(what: &str, found: &Option<Reached>) -> String {
    match found {
        Some(run) => {
            format!("| {what} | {} | {:.1e} | {} |\n", settings(&run.family, &run.setting), run.error, time(run.cost))
        }
        None => format!("| {what} | none of the runs | | |\n"),
    }
}

/// Settings of a run, with lengths of steps as plain decimals; those of a peer begin with its name.
fn settings(family: &str, setting: &str) -> String {
    let plain = |part: &str| {
        let number = part.strip_prefix("step ")?.strip_suffix(" s")?;
        Some(format!("step {} s", number.parse::<f64>().ok()?))
    };
    let parts: Vec<String> = setting.split(", ").map(|part| plain(part).unwrap_or_else(|| part.to_owned())).collect();
    let setting = parts.join(", ");
    let own = ["auto", "line", "lumped"].iter().any(|level| setting.starts_with(level));
    if own { setting } else { format!("{family}: {setting}") }
}

/// Runs of a peer: the range of their errors and times, and of their times over those of equally accurate runs here.
fn peer(family: &str, runs: &[&(Reached, Reached)]) -> String {
    let range = |values: &dyn Fn(&(Reached, Reached)) -> f64| {
        let values = runs.iter().map(|run| values(run));
        values.fold((f64::INFINITY, 0.0_f64), |(least, most), value| (least.min(value), most.max(value)))
    };
    let (errors, costs) = (range(&|run| run.0.error), range(&|run| run.0.cost));
    let ratios = range(&|run| run.0.cost / run.1.cost);
    format!(
        "| {family} | {} runs, {} to {} times as long | {:.1e} to {:.1e} | {} to {} |\n",
        runs.len(),
        significant(ratios.0),
        significant(ratios.1),
        errors.1,
        errors.0,
        time(costs.0),
        time(costs.1)
    )
}

/// The findings of a scene: data, reference, the cheapest settings within 1 %, and peers.
pub(crate) fn describe(chart: &Chart, findings: &Findings) -> String {
    // Machine, commit and where a reference is kept are in the table of all runs.
    let how = chart.how.split(" (kept: ").next().unwrap_or_default();
    let how = how.strip_prefix("exact: ").unwrap_or(how);
    let mut passage =
        format!("{}. Reference: {how}.\n\n| | run | largest error | processor time |\n|---|---|---|---|\n", chart.data);
    passage += &row("cheapest within 1 %", &findings.right);
    passage += &row("and in the peak pressure", &findings.with_pressure);
    if let Some(errors) = findings.lumped {
        let _ = writeln!(passage, "| model error of `lumped` | | {} | |", lumped_errors(errors));
    }
    let mut families: Vec<&str> = Vec::new();
    for (peer, _) in &findings.peers {
        if !families.contains(&peer.family.as_str()) {
            families.push(&peer.family);
        }
    }
    for family in families {
        let runs: Vec<_> = findings.peers.iter().filter(|(peer, _)| peer.family == family).collect();
        passage += &peer(family, &runs);
    }
    passage
}

/// Puts every description between its marks; what has no marks is left out.
pub(crate) fn write(descriptions: &[(&str, String)]) -> Result<()> {
    let path = project::root().join(PAGE);
    let mut text = fs::read_to_string(&path).with_context(|| format!("reading {}", path.display()))?;
    for (name, passage) in descriptions {
        text = replaced(&text, name, passage).with_context(|| format!("{}: {name}", path.display()))?;
    }
    fs::write(&path, text).with_context(|| format!("writing {}", path.display()))
}

fn replaced(text: &str, name: &str, passage: &str) -> Result<String> {
    let begin = format!("<!-- {name}: written by cargo fmu chart --document -->\n");
    let Some((before, rest)) = text.split_once(&begin) else { return Ok(text.to_owned()) };
    let end = format!("<!-- end of {name} -->");
    let (_, after) = rest.split_once(&end).context("the passage has no end")?;
    Ok(format!("{before}{begin}\n{passage}\n{end}{after}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_passage_replaces_what_stood_between_its_marks() {
        let text = "a\n<!-- x: written by cargo fmu chart --document -->\nold\n<!-- end of x -->\nb\n";
        let new = replaced(text, "x", "new\n").unwrap();
        assert_eq!(new, text.replace("old\n", "\nnew\n\n"));
        assert_eq!(replaced(&new, "y", "nothing").unwrap(), new);
        assert!(replaced("<!-- x: written by cargo fmu chart --document -->\n", "x", "").is_err());
    }
}
