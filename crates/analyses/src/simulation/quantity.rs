//! Values as they are read: in a multiple of the SI unit that suits their size, with the signs of the SI.

/// How the values of a quantity are shown.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Shown {
    /// The shown value is `factor * value + offset`.
    pub factor: f64,
    /// In the shown unit.
    pub offset: f64,
    /// Sign of the unit; empty of a number.
    pub unit: String,
}

/// Multiples of a unit from the largest: the least magnitude that is shown in it, its factor and its sign.
type Multiples = &'static [(f64, f64, &'static str)];

const MULTIPLES: &[(&str, Multiples)] = &[
    ("m", &[(1e3, 1e-3, "km"), (1.0, 1.0, "m"), (1e-3, 1e3, "mm"), (1e-7, 1e6, "µm"), (0.0, 1e9, "nm")]),
    ("m3", &[(0.0, 1e9, "mm³")]),
    ("kg", &[(1.0, 1.0, "kg"), (1e-3, 1e3, "g"), (0.0, 1e6, "mg")]),
    ("m/s", &[(0.1, 1.0, "m/s"), (0.0, 1e3, "mm/s")]),
    ("rad", &[(0.01, 1.0, "rad"), (1e-5, 1e3, "mrad"), (0.0, 1e6, "µrad")]),
    ("N", &[(5e3, 1e-3, "kN"), (0.0, 1.0, "N")]),
    ("N.m", &[(5e3, 1e-3, "kN·m"), (0.0, 1.0, "N·m")]),
    ("Pa", &[(1e9, 1e-9, "GPa"), (1e5, 1e-6, "MPa"), (1e3, 1e-3, "kPa"), (0.0, 1.0, "Pa")]),
    ("J", &[(1e7, 1e-6, "MJ"), (1e4, 1e-3, "kJ"), (0.0, 1.0, "J")]),
    ("W", &[(1e4, 1e-3, "kW"), (0.0, 1.0, "W")]),
];

impl Shown {
    /// For values of a variable up to `largest` in its SI unit; temperatures in degrees Celsius unless they are differences.
    pub(crate) fn of(name: &str, unit: &str, largest: f64) -> Self {
        if unit == "K" && !name.ends_with("_offset") {
            return Self { factor: 1.0, offset: -273.15, unit: "°C".into() };
        }
        Self::of_difference(unit, largest)
    }

    /// For differences of such values.
    pub(crate) fn of_difference(unit: &str, largest: f64) -> Self {
        let multiples = MULTIPLES.iter().find(|(own, _)| *own == unit);
        let chosen = multiples.and_then(|(_, multiples)| {
            // Nothing is shown in the SI unit itself where it has a sign.
            let of_nothing = multiples.iter().find(|(_, factor, _)| *factor == 1.0).or(multiples.last());
            if largest == 0.0 { of_nothing } else { multiples.iter().find(|(least, ..)| largest >= *least) }
        });
        match chosen {
            Some((_, factor, sign)) => Self { factor: *factor, offset: 0.0, unit: (*sign).to_owned() },
            None => Self { factor: 1.0, offset: 0.0, unit: signs(unit) },
        }
    }

    pub(crate) fn value(&self, value: f64) -> f64 {
        self.factor * value + self.offset
    }

    pub(crate) fn text(&self, value: f64) -> String {
        format!("{} {}", number(self.value(value)), self.unit).trim_end().to_owned()
    }

    pub(crate) fn label(&self, quantity: &str) -> String {
        if self.unit.is_empty() { quantity.to_owned() } else { format!("{quantity} ({})", self.unit) }
    }
}

/// A unit in Modelica spelling with the signs of the SI.
fn signs(unit: &str) -> String {
    if unit == "1" {
        return String::new();
    }
    let text = unit.replace('.', "·");
    let mut signs = String::new();
    let mut letters = false;
    for character in text.chars() {
        signs.push(match character {
            '2' if letters => '²',
            '3' if letters => '³',
            other => other,
        });
        letters = character.is_alphabetic();
    }
    signs
}

/// Five significant digits.
pub(crate) fn number(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 {
        return "0".into();
    }
    if !(1e-3..1e6).contains(&size) {
        return format!("{value:.4e}");
    }
    let decimals = (4 - size.log10().floor() as i32).clamp(0, 7) as usize;
    format!("{value:.decimals$}")
}

/// Without the rounding of a sum of steps.
pub fn rounded(time: f64) -> f64 {
    (time * 1e6).round() / 1e6
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_have_five_digits_and_a_unit_of_their_size() {
        for (name, unit, value, text) in [
            ("wear_depth", "m", 3.76123e-6_f64, "3.7612 µm"),
            ("wear_depth", "m", 0.0, "0 m"),
            ("friction_force", "N", 2.6e3, "2600.0 N"),
            ("contact_temperature", "K", 448.15, "175.00 °C"),
            ("friction_coefficient", "1", 0.4, "0.40000"),
            ("ambient_temperature_offset", "K", 5.0, "5.0000 K"),
            ("friction_slope", "N.s/m", 1e3, "1000.0 N·s/m"),
            ("pressure_max", "Pa", 33.3e6, "33.300 MPa"),
        ] {
            assert_eq!(Shown::of(name, unit, value.abs()).text(value), text);
        }
        assert_eq!(Shown::of_difference("K", 3.0).text(-3.0), "-3.0000 K");
        assert_eq!(signs("W/(m2.K)"), "W/(m²·K)");
        assert_eq!(Shown::of("x", "1", 1.0).label("friction coefficient"), "friction coefficient");
    }
}
