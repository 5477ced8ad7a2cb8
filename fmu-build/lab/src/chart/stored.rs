//! A chart as it was measured before, from its CSV file.

use super::Chart;
use super::measure::Point;
use anyhow::{Context, Result};
use std::path::Path;
use verification::drives::{DriveProblem, Errors, FORMER};

/// Reads the chart of a scene from the table beside its picture.
pub(crate) fn read(problem: DriveProblem, folder: &Path) -> Result<Chart> {
    let path = folder.join(format!("{}.csv", problem.name));
    let text = std::fs::read_to_string(&path).with_context(|| format!("reading {}", path.display()))?;
    parse(problem, &text).with_context(|| format!("{}", path.display()))
}

fn parse(problem: DriveProblem, text: &str) -> Result<Chart> {
    let comment = |line: &'_ str| line.strip_prefix("# ").map(str::to_owned);
    let header: Vec<String> = text.lines().map_while(comment).collect();
    let find = |begin: &str| header.iter().find_map(|line| line.strip_prefix(begin));
    let how = find("Truth: ").context("no line on the truth")?;
    let how = how.strip_suffix(&format!("; {}.", problem.reason)).unwrap_or(how).to_owned();
    let data = header.first().context("no line on the scene")?.clone();
    let measured = header.iter().find(|line| line.contains("; commit ")).context("no line on the machine")?.clone();
    let omissions = header.iter().filter_map(|line| Some(line.strip_prefix("left out: ")?.to_owned())).collect();
    let own: Vec<&str> = problem.families(false).iter().map(|family| family.name).collect();
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(text.as_bytes());
    let points = reader.deserialize().map(|row| Ok(point(row?, &own))).collect::<Result<_>>()?;
    Ok(Chart { how, data, measured, points, omissions, quick: false, problem })
}

/// Family, settings, processor times, internal steps, errors (empty: not judged), part done and failure of a run.
type Row = (String, String, [f64; 2], u64, [Option<f64>; 4], f64, String);

fn point((family, setting, seconds, steps, errors, part, failure): Row, own: &[&str]) -> Point {
    Point {
        peer: !own.contains(&family.as_str()) && !FORMER.contains(&family.as_str()),
        seconds,
        steps,
        errors: Errors(errors.map(|error| error.unwrap_or(f64::NAN))),
        failure: (!failure.is_empty()).then_some((failure, part)),
        family,
        setting,
    }
}

#[cfg(test)]
mod tests {
    use super::super::table;
    use super::*;
    use verification::drives::problems;

    #[test]
    fn the_committed_tables_read_back_as_they_were_written() {
        let folder = crate::project::root().join("docs/accuracy");
        for problem in problems().unwrap() {
            let path = folder.join(format!("{}.csv", problem.name));
            let chart = read(problem, &folder).unwrap();
            assert!(chart.points.len() > 30, "{}", path.display());
            let text = std::fs::read_to_string(&path).unwrap();
            assert_eq!(table::of(&chart), text, "{}", path.display());
        }
    }
}
