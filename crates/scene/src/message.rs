//! Numbers, quantities and given texts in messages: at most six significant digits, no unit where it is 1, and no text of any length.

use std::fmt;

/// A number with at most six significant digits, without trailing zeros.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Number(pub f64);

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let value = self.0;
        if value == 0.0 || !value.is_finite() {
            return write!(f, "{}", if value == 0.0 { 0.0 } else { value });
        }
        // Rounding first: it may raise the exponent. Both conversions are exact, so nothing is rounded twice.
        let mut digits = Digits::default();
        fmt::Write::write_fmt(&mut digits, format_args!("{value:.5e}"))?;
        let text = digits.text();
        let (mantissa, exponent) = text.split_once('e').unwrap_or((text, "0"));
        let exponent: i32 = exponent.parse().unwrap_or(0);
        if (-5..6).contains(&exponent) {
            let rounded: f64 = text.parse().unwrap_or(value);
            return write!(f, "{rounded}");
        }
        let mantissa =
            if mantissa.contains('.') { mantissa.trim_end_matches('0').trim_end_matches('.') } else { mantissa };
        write!(f, "{mantissa}e{exponent}")
    }
}

/// A number with all digits that it needs, and with an exponent where it would be a row of zeros.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Exact(pub f64);

impl fmt::Display for Exact {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let magnitude = self.0.abs();
        if magnitude != 0.0 && magnitude.is_finite() && !(1e-5..1e16).contains(&magnitude) {
            return write!(f, "{:e}", self.0);
        }
        write!(f, "{}", self.0)
    }
}

/// Room for the text of one number, so that messages of a step allocate nothing.
#[derive(Default)]
struct Digits {
    bytes: [u8; 24],
    length: usize,
}

impl Digits {
    fn text(&self) -> &str {
        std::str::from_utf8(&self.bytes[..self.length]).unwrap_or("")
    }
}

impl fmt::Write for Digits {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        let end = self.length + text.len();
        let room = self.bytes.get_mut(self.length..end).ok_or(fmt::Error)?;
        room.copy_from_slice(text.as_bytes());
        self.length = end;
        Ok(())
    }
}

/// A number as [`Number`] writes it, and its unit, unless that is 1 or empty.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Quantity<'a>(pub f64, pub &'a str);

impl fmt::Display for Quantity<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Number(self.0).fmt(f)?;
        unit(f, self.1)
    }
}

fn unit(f: &mut impl fmt::Write, unit: &str) -> fmt::Result {
    if unit.is_empty() || unit == "1" { Ok(()) } else { write!(f, " {unit}") }
}

/// Characters of a given text that a message shows.
const SHOWN: usize = 60;

/// A text that was given, without quotes; a long one up to `...`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Clipped<'a>(pub &'a str);

impl Clipped<'_> {
    /// What is shown, and whether there is more.
    fn shown(&self) -> (&str, &'static str) {
        match self.0.char_indices().nth(SHOWN) {
            Some((end, _)) => (&self.0[..end], "..."),
            None => (self.0, ""),
        }
    }
}

impl fmt::Display for Clipped<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (shown, more) = self.shown();
        write!(f, "{shown}{more}")
    }
}

/// As [`Clipped`], in quotes and with what cannot be seen escaped.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Quoted<'a>(pub &'a str);

impl fmt::Display for Quoted<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let clipped = Clipped(self.0);
        let (shown, more) = clipped.shown();
        write!(f, "{shown:?}{more}")
    }
}

/// Names of a list that a message shows.
const LISTED: usize = 20;

/// Texts that were given, after each other; of many the first and how many there are.
pub fn listed<'a>(texts: impl Iterator<Item = &'a str>) -> String {
    let all: Vec<String> = texts.map(|text| Clipped(text).to_string()).collect();
    match all.len() {
        ..=LISTED => all.join(", "),
        count => format!("{} and {} more", all[..LISTED].join(", "), count - LISTED),
    }
}

/// Texts of two quantities of one unit, with all digits where six do not tell them apart.
pub fn apart(values: [f64; 2], of: &str) -> [String; 2] {
    let texts = values.map(|value| Quantity(value, of).to_string());
    if texts[0] != texts[1] || values[0] == values[1] {
        return texts;
    }
    values.map(|value| {
        let mut text = Exact(value).to_string();
        let _ = unit(&mut text, of);
        text
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_at_most_six_digits_and_no_unit_one() {
        for (value, text) in [
            (0.0, "0"),
            (-0.0, "0"),
            (293.15, "293.15"),
            (0.1 + 0.2, "0.3"),
            (1234567.0, "1.23457e6"),
            (999999.7, "1e6"),
            (-123456.4, "-123456"),
            (1e12, "1e12"),
            (1.5e-9, "1.5e-9"),
            (2.0 / 3.0, "0.666667"),
            (1e-5, "0.00001"),
            (5e-324, "4.94066e-324"),
            (f64::MAX, "1.79769e308"),
            (f64::NAN, "NaN"),
            (f64::NEG_INFINITY, "-inf"),
        ] {
            assert_eq!(Number(value).to_string(), text);
        }
        assert_eq!(Quantity(0.5, "1").to_string(), "0.5");
        assert_eq!(Quantity(0.5, "").to_string(), "0.5");
        assert_eq!(Quantity(1.0 / 3.0, "m/s").to_string(), "0.333333 m/s");
    }

    #[test]
    fn given_texts_are_shown_up_to_a_length() {
        assert_eq!(Quoted("1 \u{7}\"é").to_string(), "\"1 \\u{7}\\\"é\"");
        assert_eq!(Quoted(&"é".repeat(61)).to_string(), format!("\"{}\"...", "é".repeat(60)));
        assert_eq!(Clipped(&"x".repeat(60)).to_string(), "x".repeat(60));
        assert_eq!(Clipped(&"x".repeat(1_000_000)).to_string(), "x".repeat(60) + "...");
        assert_eq!(listed(["a", "b"].into_iter()), "a, b");
        assert!(listed(std::iter::repeat_n("ab", 1000)).ends_with(", ab and 980 more"));
    }

    #[test]
    fn a_value_and_its_limit_are_told_apart() {
        assert_eq!(apart([2.0, 1.0], "m"), ["2 m", "1 m"]);
        assert_eq!(apart([10.000000001, 10.0], "m"), ["10.000000001 m", "10 m"]);
        assert_eq!(apart([10.000000001, 10.0], "1"), ["10.000000001", "10"]);
        assert_eq!(apart([1.0000000001e-60, 1e-60], "m"), ["1.0000000001e-60 m", "1e-60 m"]);
        assert_eq!(Exact(5e-324).to_string(), "5e-324");
        assert_eq!(Exact(1e16).to_string(), "1e16");
        assert_eq!(Exact(-0.00125).to_string(), "-0.00125");
        assert_eq!(Exact(f64::INFINITY).to_string(), "inf");
    }
}
