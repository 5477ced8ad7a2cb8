//! Record of a scene, and its text format.
//!
//! Numbers are written with as many digits as tell them from their neighbours, so that reading gives the same bits.

use anyhow::{Context, Result, bail};
use scene::fnv::Fnv;
use std::fmt::Write;

/// Stands for the number before it.
const REPEATED: &str = "=";

/// Hash of the bits of numbers.
pub(crate) fn hash(values: impl IntoIterator<Item = f64>) -> Fnv {
    Fnv::of(values.into_iter().flat_map(f64::to_le_bytes))
}

/// Numbers that belong together: a variable over the kept communication points, a profile at one of them, an array of a
/// command's output.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Series {
    /// Name of the variable; of a profile, with the index of the communication point behind `@`.
    pub name: String,
    /// Hash over all communication points; of what has none, over the values.
    pub hash: Fnv,
    /// The values that are kept.
    pub values: Vec<f64>,
}

#[derive(Clone, PartialEq, Debug, Default)]
pub(crate) struct Record {
    pub error: Option<String>,
    pub points: usize,
    /// Those at which values are kept, and their times, s.
    pub kept: Vec<(usize, f64)>,
    /// For every communication point the folded hash of all its values.
    pub hashes: Vec<u32>,
    pub series: Vec<Series>,
}

impl Record {
    pub(crate) fn text(&self) -> String {
        let mut text = String::new();
        let _ = writeln!(text, "error: {}", self.error.as_deref().unwrap_or("none").replace('\n', " "));
        let _ = writeln!(text, "points: {}", self.points);
        let kept: Vec<String> = self.kept.iter().map(|(index, time)| format!("{index}@{time:e}")).collect();
        let _ = writeln!(text, "kept: {}", kept.join(" "));
        for line in self.hashes.chunks(16) {
            let line: Vec<String> = line.iter().map(|hash| format!("{hash:08x}")).collect();
            let _ = writeln!(text, "point hashes: {}", line.join(" "));
        }
        for Series { name, hash, values } in &self.series {
            let _ = write!(text, "{name} {:016x}", hash.0);
            let mut before: Option<u64> = None;
            for value in values {
                let bits = value.to_bits();
                let _ = if before == Some(bits) {
                    write!(text, " {REPEATED}")
                } else {
                    write!(text, " {}", number(*value))
                };
                before = Some(bits);
            }
            text.push('\n');
        }
        text
    }

    /// Reads what [`Record::text`] has written.
    pub(crate) fn parse(text: &str) -> Result<Self> {
        let mut record = Self::default();
        for (index, line) in text.lines().enumerate() {
            record.read(line).with_context(|| format!("line {}: {line}", index + 1))?;
        }
        Ok(record)
    }

    fn read(&mut self, line: &str) -> Result<()> {
        if let Some(error) = line.strip_prefix("error: ") {
            self.error = (error != "none").then(|| error.to_owned());
        } else if let Some(points) = line.strip_prefix("points: ") {
            self.points = points.parse()?;
        } else if let Some(kept) = line.strip_prefix("kept:") {
            for part in kept.split_whitespace() {
                let (index, time) = part.split_once('@').context("a communication point is INDEX@TIME")?;
                self.kept.push((index.parse()?, time.parse()?));
            }
        } else if let Some(hashes) = line.strip_prefix("point hashes:") {
            for part in hashes.split_whitespace() {
                self.hashes.push(u32::from_str_radix(part, 16)?);
            }
        } else {
            let mut parts = line.split_whitespace();
            let (Some(name), Some(hash)) = (parts.next(), parts.next()) else { bail!("a name and a hash are needed") };
            let mut values: Vec<f64> = Vec::new();
            for part in parts {
                values.push(match (part, values.last()) {
                    (REPEATED, Some(&before)) => before,
                    _ => read_number(part)?,
                });
            }
            self.series.push(Series { name: name.to_owned(), hash: Fnv(u64::from_str_radix(hash, 16)?), values });
        }
        Ok(())
    }
}

/// The shortest decimal number that reads as the same bits; what is not a number by its bits.
fn number(value: f64) -> String {
    if value.is_nan() { format!("NaN:{:016x}", value.to_bits()) } else { format!("{value:e}") }
}

fn read_number(text: &str) -> Result<f64> {
    Ok(match text.strip_prefix("NaN:") {
        Some(bits) => f64::from_bits(u64::from_str_radix(bits, 16)?),
        None => text.parse()?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_record_is_read_to_the_bit() {
        let values = [0.1, 0.1, -0.0, 0.0, 5e-324, f64::MAX, f64::NEG_INFINITY, f64::NAN, 1.0 / 3.0, -1e22];
        let record = Record {
            error: Some("worn through, at last".into()),
            points: 40,
            kept: vec![(0, 0.0), (39, 0.1 + 0.2)],
            hashes: (0..40).collect(),
            series: vec![
                Series { name: "profile.pressure@39".into(), hash: hash(values), values: values.to_vec() },
                Series { name: "none".into(), hash: Fnv::new(), values: Vec::new() },
            ],
        };
        let read = Record::parse(&record.text()).unwrap();
        assert_eq!(read.text(), record.text());
        let bits = |record: &Record| record.series[0].values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&read), bits(&record));
        assert_eq!((&read.kept, &read.hashes, &read.error), (&record.kept, &record.hashes, &record.error));
        assert!(Record::parse("wear_depth 0 1 x").is_err() && Record::parse("wear_depth").is_err());
    }

    #[test]
    fn hashes_tell_neighbours_and_signs_of_zero_apart() {
        assert_ne!(hash([0.0]), hash([-0.0]));
        assert_ne!(hash([1.0]), hash([1.0_f64.next_up()]));
    }
}
