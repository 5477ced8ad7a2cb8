//! How far the scatter of a design goes in its results: percentiles of the outputs and of the wear life.

use super::worker::OK;
use std::fmt::Write;

/// Percentiles that are told.
const PERCENT: [f64; 3] = [5.0, 50.0, 95.0];

/// Percentiles of a result over the scenes that did not fail.
#[derive(serde::Serialize, Clone, PartialEq, Debug)]
pub(crate) struct Percentiles {
    /// Column of the results, or the wear life.
    pub result: String,
    /// At 5, 50 and 95 %; an infinite life is `None`.
    pub values: [Option<f64>; 3],
}

/// The wear life, in passes of the inputs: until a body is worn to its limit.
const LIFE: &str = "wear life [passes of the inputs]";

/// Wear limit, depth worn off before and depth worn off by a pass, of punch and strip.
const WEAR: [[&str; 3]; 2] = [
    ["punch.wear_limit", "punch.initial_wear", "wear_depth_punch"],
    ["strip.wear_limit", "strip.initial_wear", "wear_depth_strip"],
];

/// Percentiles of the columns `results` of the `rows`, whose cells are those of `columns`, and of the wear life; `scene`: value of a
/// parameter that the design does not have.
pub(crate) fn percentiles<'a>(
    columns: &[String],
    results: std::ops::Range<usize>,
    scene: impl Fn(&str) -> f64,
    rows: impl Iterator<Item = &'a Vec<String>> + Clone,
) -> Vec<Percentiles> {
    let number = |row: &[String], at: usize| row.get(at).and_then(|cell| cell.parse::<f64>().ok());
    let good = rows.filter(|row| row.len() > 1 && row[row.len() - 2] == OK);
    let place = |name: &str| columns.iter().position(|own| own.split(" [").next() == Some(name));
    let life = |row: &Vec<String>| -> Option<f64> {
        let lives = WEAR.map(|[limit, before, worn]| {
            let [limit, before] =
                [limit, before].map(|name| place(name).and_then(|at| number(row, at)).unwrap_or_else(|| scene(name)));
            let worn = number(row, place(worn)?)?;
            Some(if limit > 0.0 && worn > 0.0 { (limit - before).max(0.0) / worn } else { f64::INFINITY })
        });
        Some(lives[0]?.min(lives[1]?))
    };
    let mut found = Vec::new();
    for at in results {
        found.push((columns[at].clone(), good.clone().filter_map(|row| number(row, at)).collect::<Vec<f64>>()));
    }
    let lives: Vec<f64> = good.filter_map(life).collect();
    if lives.iter().any(|life| life.is_finite()) {
        found.push((LIFE.to_owned(), lives));
    }
    found.retain(|(_, values)| !values.is_empty());
    let of = |(result, mut values): (String, Vec<f64>)| {
        values.sort_by(f64::total_cmp);
        // By rank: a life may be infinite.
        let last = (values.len() - 1) as f64;
        let values = PERCENT.map(|percent| values[(percent / 100.0 * last).round() as usize]);
        Percentiles { result, values: values.map(|value| value.is_finite().then_some(value)) }
    };
    found.into_iter().map(of).collect()
}

pub(crate) fn table(found: &[Percentiles]) -> String {
    let width = found.iter().map(|own| own.result.chars().count()).max().unwrap_or(0);
    let mut text = format!("{:<width$}", "");
    PERCENT.iter().for_each(|percent| _ = write!(text, "  {:>11}", format!("{percent} %")));
    for own in found {
        _ = write!(text, "\n{:<width$}", own.result);
        for value in own.values {
            _ = write!(text, "  {:>11}", value.map_or("unlimited".into(), |value| format!("{value:.4e}")));
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_by_rank_and_a_life_ends_with_the_first_body() {
        let columns =
            ["punch.wear_limit", "wear_depth_punch [m]", "wear_depth_strip [m]", "status", "reason"].map(str::to_owned);
        let scene = |name: &str| match name {
            "punch.initial_wear" => 1.0,
            "strip.wear_limit" => 50.0,
            _ => 0.0,
        };
        let mut rows: Vec<Vec<String>> =
            (1..=21).map(|worn| ["11", &worn.to_string(), "0.5", OK, ""].map(str::to_owned).to_vec()).collect();
        rows.push(["1", "1e9", "1e9", "stepping", "it failed"].map(str::to_owned).to_vec());
        let found = percentiles(&columns, 1..3, scene, rows.iter());
        assert_eq!(found[0].values, [Some(2.0), Some(11.0), Some(20.0)]);
        // 10 m over the depth of a pass; the strip lasts 100 passes.
        assert_eq!(found[2].values, [Some(0.5), Some(10.0 / 11.0), Some(5.0)]);
        assert!(table(&found).contains("9.0909e-1"), "{}", table(&found));
        let unlimited = percentiles(&columns, 1..3, |_| 0.0, rows.iter().skip(21));
        assert!(unlimited.is_empty(), "{unlimited:?}");
    }
}
