//! The generated passages of docs/accuracy.md and docs/accuracy/measurements.md.

use super::Chart;
use super::findings::{Findings, Reached, lumped_errors, time};
use crate::project;
use anyhow::{Context, Result};
use std::fmt::Write as _;
use std::fs;

/// Page with the charts, and the page with all comparisons and omissions.
const PAGES: [&str; 2] = ["docs/accuracy.md", "docs/accuracy/measurements.md"];

/// Description of a chart.
pub struct Description {
    /// Findings, for the page with the charts.
    pub passage: String,
    /// Every comparison with a peer, and what was not run.
    pub details: String,
}

fn row(what: &str, found: &Option<Reached>) -> String {
    match found {
        Some(run) => {
            format!("| {what} | {} | {:.1e} | {} |\n", settings(&run.family, &run.setting), run.error, time(run.cost))
        }
        None => format!("| {what} | none of the runs | | |\n"),
    }
}

/// Settings of a run; those of a peer begin with its name.
fn settings(family: &str, setting: &str) -> String {
    // The operator split and explicit wear are schemes of the line.
    let own = ["auto", "line", "lumped", "field"].iter().any(|level| setting.starts_with(level));
    if own { setting.to_owned() } else { format!("{family}: {setting}") }
}

/// The findings of a scene.
pub fn describe(chart: &Chart, findings: &Findings) -> Description {
    let mut passage =
        format!("Reference: {}.\n\n| | run | largest error | processor time |\n|---|---|---|---|\n", chart.how);
    passage += &row("cheapest within 1 % in wear, temperature, force", &findings.right);
    passage += &row("and in the peak pressure", &findings.with_pressure);
    if let Some(errors) = findings.lumped {
        let _ = writeln!(passage, "| model error of `lumped`, at any tolerance | | {} | |", lumped_errors(errors));
    }
    if let Some((field, part)) = &findings.field {
        let (error, cost) = if *part < 1.0 {
            (
                "not finished".to_owned(),
                format!("{}, extrapolated from {:.1} % of the scene", time(field.cost), 100.0 * part),
            )
        } else {
            (format!("{:.1e}", field.error), time(field.cost))
        };
        let _ = writeln!(passage, "| unreduced punch | {} | {error} | {cost} |", field.setting);
    }
    let mut families: Vec<&str> = Vec::new();
    for (peer, _) in &findings.peers {
        if !families.contains(&peer.family.as_str()) {
            families.push(&peer.family);
        }
    }
    for family in families {
        let ratios =
            findings.peers.iter().filter(|(peer, _)| peer.family == family).map(|(peer, own)| peer.cost / own.cost);
        let (least, most) = ratios.fold((f64::INFINITY, 0.0_f64), |(least, most), r| (least.min(r), most.max(r)));
        let _ = writeln!(
            passage,
            "| {family} | {least:.1} to {most:.1} times the time of a run here that is as accurate | | |"
        );
    }
    let mut details = format!("{}. Reference: {}. Measured on: {}\n\n", chart.data, chart.how, chart.measured);
    if !findings.peers.is_empty() {
        details +=
            "| peer | error | time | run here | error | time | ratio of times |\n|---|---|---|---|---|---|---|\n";
        for (peer, own) in &findings.peers {
            let _ = writeln!(
                details,
                "| {} | {:.1e} | {} | {} | {:.1e} | {} | {:.1} |",
                settings(&peer.family, &peer.setting),
                peer.error,
                time(peer.cost),
                settings(&own.family, &own.setting),
                own.error,
                time(own.cost),
                peer.cost / own.cost
            );
        }
        details += "\n";
    }
    if !chart.omissions.is_empty() {
        details += "Not run:\n\n";
        chart.omissions.iter().for_each(|text| details += &format!("- {text}\n"));
    }
    Description { passage, details }
}

/// Puts every description between its marks; what has no marks in a page is left out.
///
/// # Errors
/// Where a page cannot be read or written, or a mark has no end.
pub fn write(descriptions: &[(&str, Description)]) -> Result<()> {
    for page in PAGES {
        let path = project::root().join(page);
        let mut text = fs::read_to_string(&path).with_context(|| format!("reading {}", path.display()))?;
        for (name, description) in descriptions {
            let part = if page == PAGES[0] { &description.passage } else { &description.details };
            text = replaced(&text, name, part).with_context(|| format!("{}: {name}", path.display()))?;
        }
        fs::write(&path, text).with_context(|| format!("writing {}", path.display()))?;
    }
    Ok(())
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
