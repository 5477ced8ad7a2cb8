//! A chart as it was measured before, from its CSV file.

use super::Chart;
use super::measure::Point;
use anyhow::{Context, Result, anyhow};
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
    let mut points = Vec::new();
    for (number, line) in text.lines().enumerate().skip(header.len() + 1) {
        points.push(point(line, &own).with_context(|| format!("line {}: {line}", number + 1))?);
    }
    Ok(Chart { how, data, measured, points, omissions, quick: false, problem })
}

fn point(line: &str, own: &[&str]) -> Result<Point> {
    // Texts are between quotation marks, numbers are not.
    let mut cells = Vec::new();
    for (index, part) in line.split('"').enumerate() {
        if index % 2 == 1 {
            cells.push(part.to_owned());
        } else {
            cells.extend(part.trim_matches(',').split(',').filter(|_| part.len() > 1).map(str::to_owned));
        }
    }
    let [family, setting, initialisation, total, steps, wear, temperature, force, pressure, part, failure] =
        <[String; 11]>::try_from(cells).map_err(|cells| anyhow!("{} columns of 11", cells.len()))?;
    let number = |text: &str| text.parse::<f64>().with_context(|| format!("{text:?} is not a number"));
    let error = |text: &str| if text.is_empty() { Ok(f64::NAN) } else { number(text) };
    Ok(Point {
        peer: !own.contains(&family.as_str()) && !FORMER.contains(&family.as_str()),
        seconds: [number(&initialisation)?, number(&total)?],
        steps: steps.parse()?,
        errors: Errors([error(&wear)?, error(&temperature)?, error(&force)?, error(&pressure)?]),
        failure: if failure.is_empty() { None } else { Some((failure, number(&part)?)) },
        family,
        setting,
    })
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
