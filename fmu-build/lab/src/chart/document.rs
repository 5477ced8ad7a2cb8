//! The generated passages of docs/accuracy.md.

use super::Chart;
use super::findings::Findings;
use crate::project;
use anyhow::{Context, Result};
use std::fs;

/// The findings of a scene as a passage.
pub fn passage(chart: &Chart, findings: &Findings) -> String {
    quoted(&format!("Truth: {}\n{findings}", chart.how))
}

/// Text as it was printed.
pub fn quoted(text: &str) -> String {
    let lines: String = text.lines().map(|line| format!("{}\n", line.trim_end())).collect();
    format!("```text\n{lines}```\n")
}

/// Puts every passage between its marks; what has no marks in the document is left out.
///
/// # Errors
/// Where the document cannot be read or written, or a mark has no end.
pub fn write(passages: &[(&str, String)]) -> Result<()> {
    let path = project::root().join("docs/accuracy.md");
    let mut text = fs::read_to_string(&path).with_context(|| format!("reading {}", path.display()))?;
    for (name, passage) in passages {
        text = replaced(&text, name, passage).with_context(|| format!("{}: {name}", path.display()))?;
    }
    fs::write(&path, text).with_context(|| format!("writing {}", path.display()))
}

fn replaced(text: &str, name: &str, passage: &str) -> Result<String> {
    let begin = format!("<!-- {name}: written by cargo fmu chart --document -->\n");
    let Some((before, rest)) = text.split_once(&begin) else { return Ok(text.to_owned()) };
    let end = format!("<!-- end of {name} -->");
    let (_, after) = rest.split_once(&end).context("the passage has no end")?;
    Ok(format!("{before}{begin}{passage}{end}{after}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_passage_replaces_what_stood_between_its_marks() {
        let text = "a\n<!-- x: written by cargo fmu chart --document -->\nold\n<!-- end of x -->\nb\n";
        let new = replaced(text, "x", &quoted("new  \n")).unwrap();
        assert_eq!(new, text.replace("old\n", "```text\nnew\n```\n"));
        assert_eq!(replaced(&new, "y", "nothing").unwrap(), new);
        assert!(replaced("<!-- x: written by cargo fmu chart --document -->\n", "x", "").is_err());
    }
}
