//! Units by the names that users write: those of the variable table, further ones, and other spellings of both.
//!
//! The display units of the table stand in modelDescription.xml; the further ones here are accepted in files and arguments
//! only.

use scene::variables::units::{DisplayUnit, Unit};
use std::borrow::Cow;
use std::f64::consts::PI;

const fn unit(name: &'static str, factor: f64) -> DisplayUnit {
    DisplayUnit { name, factor, offset: 0.0 }
}

/// Accepted beside the display units, by the SI unit.
static OTHERS: &[(&str, &[DisplayUnit])] = &[
    ("m", &[unit("cm", 1e2), unit("nm", 1e9)]),
    ("m2", &[unit("mm2", 1e6)]),
    ("s", &[unit("ms", 1e3)]),
    ("m/s", &[unit("m/min", 60.0), unit("cm/s", 1e2)]),
    ("rad/s", &[unit("rev/s", 0.5 / PI), unit("deg/s", 180.0 / PI)]),
    ("N", &[unit("mN", 1e3)]),
    ("Pa", &[unit("kPa", 1e-3), unit("bar", 1e-5)]),
    ("m2/N", &[unit("mm2/N", 1e6)]),
    ("J/(kg.K)", &[unit("kJ/(kg.K)", 1e-3)]),
    ("J", &[unit("mJ", 1e3)]),
    ("W", &[unit("mW", 1e3)]),
];

/// Words for a unit, in [`plain`] spelling, and the name that the tables have for it.
const WORDS: &[(&str, &str)] = &[
    ("rpm", "rev/min"),
    ("1/min", "rev/min"),
    ("r/min", "rev/min"),
    ("U/min", "rev/min"),
    ("kmh", "km/h"),
    ("kph", "km/h"),
    ("km/hr", "km/h"),
    ("Nm", "N.m"),
    ("kNm", "kN.m"),
    ("mm3/Nm", "mm3/(N.m)"),
    ("mm3/N/m", "mm3/(N.m)"),
    ("mm3/N.m", "mm3/(N.m)"),
    ("m3/(N.m)", "m2/N"),
    ("m3/Nm", "m2/N"),
    ("m3/N/m", "m2/N"),
    ("m3/N.m", "m2/N"),
    ("mm3.N-1.m-1", "mm3/(N.m)"),
    ("1/Pa", "m2/N"),
    ("Pa-1", "m2/N"),
    ("1/MPa", "mm2/N"),
    ("MPa-1", "mm2/N"),
    ("W/mK", "W/(m.K)"),
    ("W/m.K", "W/(m.K)"),
    ("W/m/K", "W/(m.K)"),
    ("W.m-1.K-1", "W/(m.K)"),
    ("W/m2K", "W/(m2.K)"),
    ("W/m2.K", "W/(m2.K)"),
    ("W/m2/K", "W/(m2.K)"),
    ("W.m-2.K-1", "W/(m2.K)"),
    ("J/kgK", "J/(kg.K)"),
    ("J/kg.K", "J/(kg.K)"),
    ("J/kg/K", "J/(kg.K)"),
    ("J.kg-1.K-1", "J/(kg.K)"),
    ("kJ/kgK", "kJ/(kg.K)"),
    ("kJ/kg.K", "kJ/(kg.K)"),
    ("kJ/kg/K", "kJ/(kg.K)"),
    ("-", "1"),
    ("C", "degC"),
    ("deg.C", "degC"),
    ("Celsius", "degC"),
    ("sec", "s"),
    ("seconds", "s"),
    ("hours", "h"),
    ("micron", "um"),
    ("microns", "um"),
    ("m.s-1", "m/s"),
];

/// Units beside the SI unit; those with an offset only where `absolute`.
pub fn units(unit: &'static Unit, absolute: bool) -> impl Iterator<Item = &'static DisplayUnit> {
    let others = OTHERS.iter().filter(|(name, _)| *name == unit.name).flat_map(|(_, others)| others.iter());
    unit.display.iter().chain(others).filter(move |display| absolute || display.offset == 0.0)
}

/// Name that the tables have for a unit written as `symbol`: `degC` for `°C`, `rev/min` for `rpm`, `N.m` for `N·m`.
pub(crate) fn canonical(symbol: &str) -> Cow<'_, str> {
    let plain = plain(symbol);
    match WORDS.iter().find(|(word, _)| *word == plain) {
        Some((_, name)) => Cow::Borrowed(name),
        None => plain,
    }
}

/// What to do with a unit of another quantity that data sheets give; `None` for others.
pub(crate) fn hint(symbol: &str) -> Option<&'static str> {
    let of_work = matches!(&*canonical(symbol), "mm3/J" | "m3/J" | "mm3/(W.s)");
    of_work
        .then_some("; a volume by friction work times the friction coefficient is one by load and distance, mm3/(N.m)")
}

/// The symbol in ASCII, as Modelica writes units.
fn plain(symbol: &str) -> Cow<'_, str> {
    if symbol.is_ascii() && !symbol.contains(['*', '^', ' ']) {
        return Cow::Borrowed(symbol);
    }
    let mut text = String::with_capacity(symbol.len());
    for character in symbol.chars() {
        match character {
            '·' | '⋅' | '*' | ' ' => text.push('.'),
            '^' => {}
            '²' => text.push('2'),
            '³' => text.push('3'),
            // The sign of micro and the Greek letter.
            '\u{b5}' | '\u{3bc}' => text.push('u'),
            '°' => text.push_str("deg"),
            '℃' => text.push_str("degC"),
            other => text.push(other),
        }
    }
    Cow::Owned(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::variables::units::{KELVIN, METRE_PER_SECOND, RADIAN_PER_SECOND};

    #[test]
    fn other_spellings_are_the_same_unit() {
        for (symbol, name) in [
            ("°C", "degC"),
            ("℃", "degC"),
            ("C", "degC"),
            ("deg C", "degC"),
            ("sec", "s"),
            ("seconds", "s"),
            ("microns", "um"),
            ("m s-1", "m/s"),
            ("rpm", "rev/min"),
            ("1/min", "rev/min"),
            ("µm", "um"),
            ("μm", "um"),
            ("N·m", "N.m"),
            ("Nm", "N.m"),
            ("nm", "nm"),
            ("mm³/(N·m)", "mm3/(N.m)"),
            ("mm3/(N*m)", "mm3/(N.m)"),
            ("mm3/(N m)", "mm3/(N.m)"),
            ("mm^3/(N*m)", "mm3/(N.m)"),
            ("mm3/N/m", "mm3/(N.m)"),
            ("1/Pa", "m2/N"),
            ("Pa^-1", "m2/N"),
            ("MPa^-1", "mm2/N"),
            ("W/(m²·K)", "W/(m2.K)"),
            ("W/m²K", "W/(m2.K)"),
            ("W/m·K", "W/(m.K)"),
            ("W m^-1 K^-1", "W/(m.K)"),
            ("kJ/kgK", "kJ/(kg.K)"),
            ("-", "1"),
            ("mph", "mph"),
        ] {
            assert_eq!(canonical(symbol), name, "{symbol}");
        }
    }

    #[test]
    fn every_name_is_one_unit_only_of_its_quantity() {
        for unit in scene::variables::units::UNITS {
            let mut names: Vec<&str> = units(unit, true).map(|display| display.name).chain([unit.name]).collect();
            let count = names.len();
            names.sort_unstable();
            names.dedup();
            assert_eq!(names.len(), count, "{names:?}");
            // A word for one unit must not hide another.
            assert!(names.iter().all(|name| canonical(name) == *name), "{names:?}");
        }
        for (name, _) in OTHERS {
            assert!(scene::variables::units::UNITS.iter().any(|unit| unit.name == *name), "{name}");
        }
    }

    #[test]
    fn offsets_are_of_absolute_temperatures_and_turns_of_angular_velocities() {
        assert_eq!(units(&KELVIN, false).count(), 0);
        assert_eq!(units(&KELVIN, true).count(), 1);
        let has = |unit, name| units(unit, true).any(|display| display.name == name);
        assert!(has(&RADIAN_PER_SECOND, "rev/min") && !has(&METRE_PER_SECOND, "rev/min"));
    }
}
