//! Names near a mistyped one.

use strsim::levenshtein;

/// `; did you mean ...?` with the up to three nearest of `known`, or nothing where none is near.
pub fn nearest<'known>(wanted: &str, known: impl Iterator<Item = &'known str>) -> String {
    question(&near(wanted, known))
}

/// `; did you mean ...?` with these names; nothing without any.
pub(crate) fn question(names: &[impl AsRef<str>]) -> String {
    let names: Vec<&str> = names.iter().map(AsRef::as_ref).collect();
    if names.is_empty() { String::new() } else { format!("; did you mean {}?", names.join(" or ")) }
}

/// Words that users have for a variable, and the last part of its name.
const MEANINGS: [(&str, &str); 14] = [
    ("mu", "friction_coefficient"),
    ("cof", "friction_coefficient"),
    ("friction", "friction_coefficient"),
    ("radius", "mean_radius"),
    ("track_radius", "mean_radius"),
    ("wear", "wear_coefficient"),
    ("k", "wear_coefficient"),
    ("wear_rate", "wear_coefficient"),
    ("heat_transfer_coefficient", "convection"),
    ("cp", "specific_heat"),
    ("modulus", "youngs_modulus"),
    ("thickness", "height"),
    ("speed", "velocity"),
    ("force", "load"),
];

/// The up to three nearest of `known`.
pub(crate) fn near<'known>(wanted: &str, known: impl Iterator<Item = &'known str>) -> Vec<&'known str> {
    let last = |name: &str| name.rsplit('.').next().unwrap_or(name).to_owned();
    let meant = MEANINGS.iter().find(|(word, _)| last(wanted).eq_ignore_ascii_case(word)).map(|(_, name)| *name);
    let length = wanted.chars().count();
    let tolerated = (length / 4).max(2);
    let mut near: Vec<(usize, &str)> = known
        .filter_map(|name| {
            // Nothing is nearer than the lengths are apart; a text may be of any length.
            let apart = length.abs_diff(name.len());
            let distance = if apart > tolerated { apart } else { levenshtein(wanted, name) };
            // The right name in the wrong table is as near as a small slip.
            let same = last(name) == last(wanted) || meant == Some(&*last(name));
            let distance = if same { distance.min(1) } else { distance };
            (distance <= tolerated).then_some((distance, name))
        })
        .collect();
    near.sort_unstable();
    near.truncate(3);
    near.into_iter().map(|(_, name)| name).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_and_wrong_tables_are_recognised_and_nonsense_is_not() {
        let known = || ["punch.width", "punch.height", "strip.height", "depth"].into_iter();
        assert_eq!(nearest("punch.widht", known()), "; did you mean punch.width?");
        assert_eq!(nearest("strip.width", known()), "; did you mean punch.width?");
        assert_eq!(nearest("height", known()), "; did you mean punch.height or strip.height?");
        assert_eq!(nearest("punch.thickness", known()), "; did you mean punch.height or strip.height?");
        assert_eq!(
            nearest("mu", ["contact.friction_coefficient"].into_iter()),
            "; did you mean contact.friction_coefficient?"
        );
        assert_eq!(nearest("zzz", known()), "");
    }
}
