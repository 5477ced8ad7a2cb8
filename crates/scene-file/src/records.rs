//! Records of wear tests: load, speed, distance and worn volume of every test, for the fit of a wear law.

use crate::columns::{self, Column, Reading};
use anyhow::{Result, bail};
use scene::variables::units::{CUBIC_METRE, METRE, METRE_PER_SECOND, NEWTON, Unit};
use std::io::Read;
use std::path::Path;

/// Quantities of a test, each of which a file must have with its unit.
const QUANTITIES: [(&str, &Unit); 4] =
    [("load", &NEWTON), ("speed", &METRE_PER_SECOND), ("distance", &METRE), ("volume", &CUBIC_METRE)];

/// Tests at constant load and speed, one value each.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Records {
    /// Normal load, N.
    pub load: Vec<f64>,
    /// Sliding speed [m/s].
    pub speed: Vec<f64>,
    /// Sliding distance, m.
    pub distance: Vec<f64>,
    /// Volume that the punch lost, m3.
    pub volume: Vec<f64>,
}

impl Records {
    /// Reads a CSV file.
    ///
    /// # Errors
    /// Names file, line, column and value: as [`columns::read`], and where a value is not above 0.
    pub fn read(path: &Path) -> Result<Self> {
        Self::parse(columns::open(path)?, path)
    }

    /// Reads the content of a file; `path` names it in messages.
    ///
    /// # Errors
    /// As [`Records::read`].
    pub fn parse(content: impl Read, path: &Path) -> Result<Self> {
        let known = QUANTITIES.map(|(name, unit)| Column {
            required: true,
            unit_required: true,
            ..Column::optional(name, unit)
        });
        let mut records = Self::default();
        columns::rows(content, path, &known.each_ref(), &Reading::default(), &mut |cells| {
            for cell in cells {
                // A gap is none either.
                if cell.value.is_nan() || cell.value <= 0.0 {
                    bail!("{}: a test has a {} above 0", cell.place(), cell.name);
                }
                match cell.name {
                    "load" => records.load.push(cell.value),
                    "speed" => records.speed.push(cell.value),
                    "distance" => records.distance.push(cell.value),
                    _ => records.volume.push(cell.value),
                }
            }
            Ok(())
        })?;
        Ok(records)
    }

    /// Whether a coefficient and these exponents, of pressure and of velocity, can be told apart.
    ///
    /// # Errors
    /// Says what is missing.
    pub fn check(&self, [pressure, velocity]: [bool; 2]) -> Result<()> {
        let parameters = 1 + usize::from(pressure) + usize::from(velocity);
        let tests = self.volume.len();
        if tests <= parameters {
            bail!("{tests} tests do not determine {parameters} parameters and their scatter");
        }
        let varied = |values: &[f64]| values.iter().any(|value| *value != values[0]);
        for (fitted, exponent, quantity, values) in
            [(pressure, "pressure", "load", &self.load), (velocity, "velocity", "speed", &self.speed)]
        {
            if fitted && !varied(values) {
                bail!("the {exponent} exponent needs tests at more than one {quantity}");
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn records(text: &str) -> Result<Records> {
        Records::parse(text.as_bytes(), Path::new("tests.csv"))
    }

    #[test]
    fn records_come_in_si_units() {
        let found =
            records("# a rig\nload [kN],distance [km],speed_m_per_s,volume [mm3]\n0.01,0.3,0.1,2\n0.02,1,0.1,5\n");
        let found = found.unwrap();
        assert_eq!((found.load, found.distance), (vec![10.0, 20.0], vec![300.0, 1000.0]));
        assert_eq!((found.speed[0], found.volume[1]), (0.1, 5e-9));
    }

    #[test]
    fn a_wrong_record_is_refused_with_its_place() {
        let head = "load [N],speed [m/s],distance [m],volume [mm3]\n";
        for (text, parts) in [
            (String::new(), &["tests.csv is empty", "load [N]"][..]),
            (head.to_owned(), &["no row"]),
            (head.replace("[N]", "[m/s]"), &["line 1, column 1", "\"m/s\"", "accepted are N, kN"]),
            (head.replace("load", "force"), &["line 1", "no column load [N or kN or mN]", "force [N]"]),
            (head.replace(",volume [mm3]", ""), &["no column volume [m3 or mm3"]),
            (format!("{head}5,.1,300,1\nheavy,.1,300,1\n"), &["line 3, column 1 (load [N]): \"heavy\" is no number"]),
            (format!("{head}5,.1,300,0\n"), &["line 2, column 4 (volume [mm3]): \"0\"", "above 0"]),
            (format!("{head}5,.1,300\n"), &["tests.csv, line 2: 3 cells, and the header has 4"]),
        ] {
            let error = format!("{:#}", records(&text).unwrap_err());
            assert!(parts.iter().all(|part| error.contains(part)), "{text}: {error}");
        }
    }

    #[test]
    fn tests_that_do_not_determine_the_law_are_refused() {
        let row = |load: f64, speed: f64| format!("{load},{speed},300,1\n");
        let head = "load [N],speed [m/s],distance [m],volume [mm3]\n".to_owned();
        let found = records(&(head.clone() + &row(5.0, 0.1).repeat(4))).unwrap();
        assert!(found.check([false; 2]).is_ok());
        assert!(found.check([true, false]).unwrap_err().to_string().contains("more than one load"));
        let found = records(&(head + &row(5.0, 0.1) + &row(10.0, 0.1))).unwrap();
        assert!(found.check([true, false]).unwrap_err().to_string().contains("2 tests do not determine 2"));
        assert!(found.check([false, true]).unwrap_err().to_string().contains("2 tests"));
    }
}
