//! `cargo fmu verify`: problems with a known solution, each within its bound.

use crate::output::{print_line, print_text};
use anyhow::{Result, anyhow, bail};
use fmu_build::progress::bar;
use serde_json::{Value, json};
use verification::{Row, problems};

/// Errors are relative to the exact value, those of temperatures to the peak rise. Ends with an error
/// where one exceeds its bound.
#[derive(clap::Args, Debug)]
pub(crate) struct Arguments {
    /// Print the rows as a JSON array instead of a table.
    #[arg(long)]
    json: bool,
    /// Only the problems with this text in their name or quantity, upper and lower case alike.
    #[arg(long, value_name = "TEXT", value_parser = clap::builder::NonEmptyStringValueParser::new())]
    filter: Option<String>,
}

pub(crate) fn execute(arguments: &Arguments) -> Result<()> {
    let rows = solve(arguments.filter.as_deref())?;
    if arguments.json {
        print_line!("{:#}", Value::Array(rows.iter().map(record).collect()));
    } else {
        print_text!("{}", table(&rows));
    }
    let failed: Vec<&Row> = rows.iter().filter(|row| !row.passes()).collect();
    if !failed.is_empty() {
        let names: Vec<&str> = failed.iter().map(|row| row.problem.as_str()).collect();
        bail!("{} of {} rows exceed their bound: {}", failed.len(), rows.len(), names.join("; "));
    }
    Ok(())
}

fn solve(filter: Option<&str>) -> Result<Vec<Row>> {
    let wanted = filter.unwrap_or_default().to_lowercase();
    let mut chosen = problems();
    let all = chosen.len();
    chosen.retain(|problem| {
        problem.name.to_lowercase().contains(&wanted) || problem.quantity.to_lowercase().contains(&wanted)
    });
    if chosen.is_empty() {
        bail!("none of the {all} problems has {wanted:?} in its name or quantity");
    }
    let bar = bar(chosen.len(), "{pos}/{len} {msg}");
    let rows = chosen
        .iter()
        .map(|problem| {
            bar.set_message(problem.name.clone());
            let row = problem.solve().map_err(|text| anyhow!(text));
            bar.inc(1);
            row
        })
        .collect();
    bar.finish_and_clear();
    rows
}

/// A number for JSON, which has none that are not finite: text instead.
fn number(value: f64) -> Value {
    if value.is_finite() { json!(value) } else { json!(value.to_string()) }
}

fn record(row: &Row) -> Value {
    json!({
        "problem": row.problem,
        "quantity": row.quantity,
        "exact": number(row.exact),
        "computed": number(row.computed),
        "error": number(row.error),
        "bound": number(row.bound),
        "cost_seconds": number(row.cost_seconds),
    })
}

fn table(rows: &[Row]) -> String {
    let columns = ["problem", "quantity", "exact", "computed", "error", "bound", "ms"].map(String::from);
    let mut lines = vec![columns];
    lines.extend(rows.iter().map(|row| {
        [
            row.problem.clone(),
            row.quantity.to_owned(),
            format!("{:.6e}", row.exact),
            format!("{:.6e}", row.computed),
            format!("{:.1e}{}", row.error, if row.passes() { "" } else { " !" }),
            format!("{:.0e}", row.bound),
            format!("{:.2}", 1e3 * row.cost_seconds),
        ]
    }));
    let widths: [usize; 7] =
        std::array::from_fn(|column| lines.iter().map(|line| line[column].chars().count()).max().unwrap_or(0));
    let mut text = String::new();
    for line in &lines {
        let cells: Vec<String> = line
            .iter()
            .zip(widths)
            .enumerate()
            // Texts to the left, numbers to the right.
            .map(
                |(column, (cell, width))| {
                    if column < 2 { format!("{cell:<width$}") } else { format!("{cell:>width$}") }
                },
            )
            .collect();
        text += cells.join("  ").trim_end();
        text.push('\n');
    }
    let within = rows.iter().filter(|row| row.passes()).count();
    text + &format!("{within} of {} within their bounds\n", rows.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_filter_chooses_by_name_and_one_that_finds_nothing_is_an_error() {
        let rows = solve(Some("DECAY RATE")).unwrap();
        assert!(rows.len() == 5 && rows.iter().all(|row| row.problem.contains("decay rate")));
        assert!(solve(Some("no such problem")).unwrap_err().to_string().contains("no such problem"));
    }
}
