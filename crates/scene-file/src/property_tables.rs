//! Conductivity and specific heat over temperature of materials for which published numbers were found in two places.
//!
//! They are taken where a scene asks for them by `property_table.material`; a `material` alone keeps its constants.

use crate::materials::{MATERIALS, Material};
use scene::PropertyTable;

/// A material with a table.
pub struct Tabulated {
    /// Name in the scene file, as that of the material.
    pub name: &'static str,
    /// Where the numbers are from.
    pub source: &'static str,
    /// Temperatures of the points, degC.
    temperatures: &'static [f64],
    /// Conductivity (W/(m.K)) and specific heat (J/(kg.K)) at a temperature in degC.
    law: fn(f64) -> [f64; 2],
}

const ZERO_CELSIUS: f64 = 273.15;

/// Carbon steel: EN 1993-1-2:2005, 3.4.1.2 and 3.4.1.3. The peak of the specific heat at 735 degC is the change of its lattice.
fn carbon_steel(t: f64) -> [f64; 2] {
    let heat = match t {
        t if t < 600.0 => 425.0 + 0.773 * t - 1.69e-3 * t * t + 2.22e-6 * t * t * t,
        t if t < 735.0 => 666.0 + 13002.0 / (738.0 - t),
        t if t < 900.0 => 545.0 + 17820.0 / (t - 731.0),
        _ => 650.0,
    };
    [if t < 800.0 { 54.0 - 3.33e-2 * t } else { 27.3 }, heat]
}

/// Austenitic stainless steel: EN 1993-1-2:2005, C.3.2 and C.3.3.
fn stainless_steel(t: f64) -> [f64; 2] {
    [14.6 + 1.27e-2 * t, 450.0 + 0.280 * t - 2.91e-4 * t * t + 1.34e-7 * t * t * t]
}

/// Aluminium alloys of the 3xxx and 6xxx series up to 500 degC: EN 1999-1-2:2007, 3.3.1.2 and 3.3.1.3.
fn aluminium(t: f64) -> [f64; 2] {
    [190.0 + 0.07 * t, 903.0 + 0.41 * t]
}

/// Isotropic graphite from 25 to 1000 degC: conductivity of grade G-348, a fit to McEligot et al., INL/EXT-16-38241 (2016); specific heat:
/// Butland and Maddison, J. Nucl. Mater. 49 (1973) 45, 0.54212 cal/(g K) and the other coefficients, within 1 % of NIST WebBook.
fn graphite(t: f64) -> [f64; 2] {
    let t = t + ZERO_CELSIUS;
    let over = |k: i32| t.powi(-k);
    let heat =
        0.54212 - 2.42667e-6 * t - 90.2725 * over(1) - 43449.3 * over(2) + 1.59309e7 * over(3) - 1.43688e9 * over(4);
    [2879.688 * t.powf(-0.52813), 4184.0 * heat]
}

/// Copper: Incropera and DeWitt, Fundamentals of Heat and Mass Transfer, table A.1. Within 1 % of the specific heat of NIST-JANAF and 3 % of
/// the conductivity of electrolytic copper (Copper Development Association, to 300 degC).
fn copper(t: f64) -> [f64; 2] {
    const OF_COPPER: [(f64, [f64; 2]); 5] = [
        (300.0, [401.0, 385.0]),
        (400.0, [393.0, 397.0]),
        (600.0, [379.0, 417.0]),
        (800.0, [366.0, 433.0]),
        (1000.0, [352.0, 451.0]),
    ];
    between(&OF_COPPER, t)
}

/// Grey cast iron EN-GJL-250. Specific heat: that of 0.967 iron (NIST-JANAF, a monograph of 1998) and 0.033 graphite; its mean from 20 to 200 degC
/// is the 500 J/(kg.K) of GOST 1412. Conductivity: EN 1561, whose text was not at hand to compare; at 20 degC GOST 1412 has 50 W/(m.K). Measured
/// brake discs conduct up to a third better (Hecht et al., J. Mater. Sci. 34 (1999) 4775).
fn grey_iron(t: f64) -> [f64; 2] {
    const CARBON: f64 = 0.033;
    /// Molar mass of iron, kg/mol.
    const IRON: f64 = 0.055_845;
    const OF_IRON: [(f64, [f64; 2]); 7] = [
        (300.0, [0.0, 25.14]),
        (400.0, [0.0, 27.40]),
        (500.0, [0.0, 29.68]),
        (600.0, [0.0, 32.06]),
        (700.0, [0.0, 34.60]),
        (800.0, [0.0, 37.85]),
        (900.0, [0.0, 43.00]),
    ];
    let [[_, iron], [_, carbon]] = [between(&OF_IRON, t), graphite(t)];
    [49.5 - 0.01 * t, (1.0 - CARBON) * iron / IRON + CARBON * carbon]
}

/// Linear between points over K, at a temperature in degC.
fn between(points: &[(f64, [f64; 2])], t: f64) -> [f64; 2] {
    let next = points.partition_point(|point| point.0 <= t + ZERO_CELSIUS).clamp(1, points.len() - 1);
    let [left, right] = [points[next - 1], points[next]];
    let part = (t + ZERO_CELSIUS - left.0) / (right.0 - left.0);
    [0, 1].map(|k| left.1[k] + part * (right.1[k] - left.1[k]))
}

/// Dense at the peak.
const OF_STEEL: &[f64] =
    &[20.0, 150.0, 300.0, 450.0, 550.0, 650.0, 690.0, 712.0, 723.0, 729.0, 733.0, 735.0, 739.0, 750.0, 790.0, 900.0];
const OF_GRAPHITE: &[f64] = &[25.0, 100.0, 200.0, 300.0, 400.0, 500.0, 600.0, 700.0, 800.0, 900.0, 1000.0];
const OF_STAINLESS: &[f64] =
    &[20.0, 100.0, 200.0, 300.0, 400.0, 500.0, 600.0, 700.0, 800.0, 900.0, 1000.0, 1100.0, 1200.0];

/// Every table, in alphabetical order.
pub static TABLES: &[Tabulated] = &[
    Tabulated {
        name: "aluminium_6061",
        source: "EN 1999-1-2, 3xxx and 6xxx series, to 500 degC",
        temperatures: &[0.0, 500.0],
        law: aluminium,
    },
    Tabulated {
        name: "carbon_steel",
        source: "EN 1993-1-2, carbon steel, to 900 degC",
        temperatures: OF_STEEL,
        law: carbon_steel,
    },
    Tabulated {
        name: "copper",
        source: "Incropera and DeWitt, table A.1, to 725 degC",
        temperatures: &[27.0, 127.0, 327.0, 527.0, 725.0],
        law: copper,
    },
    Tabulated {
        name: "graphite",
        source: "grade G-348 (INL/EXT-16-38241), Butland and Maddison 1973, to 1000 degC",
        temperatures: OF_GRAPHITE,
        law: graphite,
    },
    Tabulated {
        name: "grey_cast_iron",
        source: "EN 1561 (conductivity), iron and graphite of NIST-JANAF (specific heat), to 600 degC",
        temperatures: &[20.0, 100.0, 200.0, 300.0, 400.0, 500.0, 600.0],
        law: grey_iron,
    },
    Tabulated {
        name: "stainless_steel",
        source: "EN 1993-1-2, annex C, to 1200 degC",
        temperatures: OF_STAINLESS,
        law: stainless_steel,
    },
    Tabulated {
        name: "structural_steel",
        source: "EN 1993-1-2, carbon steel, to 900 degC",
        temperatures: OF_STEEL,
        law: carbon_steel,
    },
];

/// The table of the material whose preset has these constants, W/(m.K) and J/(kg.K).
pub fn of_constants([conductivity, specific_heat]: [f64; 2]) -> Option<&'static Tabulated> {
    let is_it = |material: &&Material| (material.conductivity, material.specific_heat) == (conductivity, specific_heat);
    find(MATERIALS.iter().find(is_it)?.name)
}

/// The table of this name.
pub fn find(name: &str) -> Option<&'static Tabulated> {
    TABLES.iter().find(|table| table.name == name)
}

impl Tabulated {
    /// Temperature (K), conductivity and specific heat of every point.
    pub(crate) fn points(&self) -> Vec<[f64; 3]> {
        let point = |t: &f64| {
            let [conductivity, specific_heat] = (self.law)(*t);
            [t + ZERO_CELSIUS, conductivity, specific_heat]
        };
        self.temperatures.iter().map(point).collect()
    }

    /// The table as a body takes it.
    pub fn table(&self) -> PropertyTable {
        let points = self.points();
        let row = |k: usize| std::array::from_fn(|i| points.get(i).map_or(0.0, |point| point[k]));
        PropertyTable { points: points.len(), temperature: row(0), conductivity: row(1), specific_heat: row(2) }
    }

    /// The table as pairs of the variable's name behind the body and its value.
    pub fn values(&self) -> Vec<(String, f64)> {
        let points = self.points();
        let mut values = vec![("property_table.points".to_owned(), points.len() as f64)];
        for (i, point) in points.into_iter().enumerate() {
            for (row, value) in ["temperature", "conductivity", "specific_heat"].into_iter().zip(point) {
                values.push((format!("property_table.{row}[{}]", i + 1), value));
            }
        }
        values
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::materials;
    use scene::PROPERTY_POINTS;

    #[test]
    fn a_table_begins_near_the_constants_of_its_material() {
        for pair in TABLES.windows(2) {
            assert!(pair[0].name < pair[1].name, "{} is out of order", pair[1].name);
        }
        for table in TABLES {
            let material = materials::find(table.name).expect(table.name);
            let points = table.points();
            assert!((2..=PROPERTY_POINTS).contains(&points.len()), "{}", table.name);
            let [_, conductivity, specific_heat] = points[0];
            // Alloys differ: 6061 conducts 12 % less than what the standard gives for its series.
            for (of_table, constant) in [(conductivity, material.conductivity), (specific_heat, material.specific_heat)]
            {
                assert!((of_table / constant - 1.0).abs() < 0.15, "{}: {of_table} {constant}", table.name);
            }
        }
    }

    /// Values of other sources than those of the tables.
    #[test]
    fn tables_agree_with_a_second_source() {
        // GOST 1412, grade SCh25: mean specific heat from 20 to 200 degC, and conductivity.
        let iron = find("grey_cast_iron").unwrap().table();
        let mean = iron.heat_of_rise(20.0 + ZERO_CELSIUS, 180.0) / 180.0;
        assert!((mean / 500.0 - 1.0).abs() < 0.01, "{mean}");
        assert!((iron.at(20.0 + ZERO_CELSIUS)[0] / 50.0 - 1.0).abs() < 0.02);
        // NIST-JANAF, solid copper; Copper Development Association.
        let copper = find("copper").unwrap().table();
        for t in [400.0, 600.0, 800.0, 990.0] {
            let k = t / 1000.0;
            let molar = 17.72891 + 28.0987 * k - 31.25289 * k * k + 13.97243 * k * k * k + 0.068611 / (k * k);
            assert!((copper.at(t)[1] / (molar / 0.063_546) - 1.0).abs() < 0.01, "{t} K: {}", copper.at(t)[1]);
        }
        for (t, conductivity) in [(20.0, 394.0), (100.0, 385.0), (200.0, 381.0), (300.0, 377.0)] {
            assert!((copper.at(t + ZERO_CELSIUS)[0] / conductivity - 1.0).abs() < 0.03, "{t} degC");
        }
        // NIST WebBook, graphite of Butland and Maddison at 300 K: 8.6186 J/(mol K).
        let graphite = find("graphite").unwrap().table();
        assert!((graphite.at(300.0)[1] / (8.6186 / 0.012_011) - 1.0).abs() < 0.01, "{}", graphite.at(300.0)[1]);
    }

    #[test]
    fn a_table_is_found_by_the_constants_of_its_material() {
        let preset = materials::find("grey_cast_iron").unwrap();
        let found = of_constants([preset.conductivity, preset.specific_heat]).map(|table| table.name);
        assert_eq!((found, of_constants([preset.conductivity, 461.0]).is_none()), (Some("grey_cast_iron"), true));
    }

    #[test]
    fn points_resolve_the_law() {
        // Everything below the peak of steel to a fortieth, the peak to a fifth.
        for (table, bounds) in TABLES.iter().map(|table| (table, [0.025, 0.2])) {
            let points = table.points();
            for pair in points.windows(2) {
                let middle = 0.5 * (pair[0][0] + pair[1][0]);
                let exact = (table.law)(middle - ZERO_CELSIUS);
                let bound = bounds[usize::from(middle > 960.0)];
                for (k, exact) in exact.into_iter().enumerate() {
                    let between = 0.5 * (pair[0][k + 1] + pair[1][k + 1]);
                    assert!((between / exact - 1.0).abs() < bound, "{} at {middle} K: {between} {exact}", table.name);
                }
            }
        }
    }
}
