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

/// Letters from which on the beginning of a name says which.
const SHORTEST: usize = 3;

/// The up to three nearest of `known`.
pub(crate) fn near<'known>(wanted: &str, known: impl Iterator<Item = &'known str>) -> Vec<&'known str> {
    let parts = |name: &'known str| name.rsplit_once('.').unwrap_or(("", name));
    let (table, own) = wanted.rsplit_once('.').unwrap_or(("", wanted));
    let meant = MEANINGS.iter().find(|(word, _)| own.eq_ignore_ascii_case(word)).map(|(_, name)| *name);
    let [length, own_length] = [wanted, own].map(|text| text.chars().count());
    let slips = own_length / 4;
    // Nothing is nearer than the lengths are apart; a text may be of any length.
    let distance = |text: &str, length: usize, name: &str, most: usize| {
        let distance = if length.abs_diff(name.len()) > most { usize::MAX } else { levenshtein(text, name) };
        (distance <= most).then_some(distance)
    };
    let begins = |whole: &str| {
        let starts = (own_length.saturating_sub(1)..=own_length + 1).filter_map(|end| whole.get(..end));
        own_length >= SHORTEST
            && starts.into_iter().any(|start| distance(own, own_length, start, own_length / 6).is_some())
    };
    let mut near: Vec<(usize, &str)> = known
        .filter_map(|name| {
            let (other, last) = parts(name);
            // The right name in the wrong table is as near as a small slip; then the beginning of a name in the right one.
            let elsewhere = if meant == Some(last) { Some(0) } else { distance(own, own_length, last, slips) };
            let started = (table.is_empty() || table == other) && begins(last);
            let whole = distance(wanted, length, name, (length / 4).max(2));
            let least =
                whole.into_iter().chain(elsewhere.map(|slips| 1 + 2 * slips)).chain(started.then_some(2)).min()?;
            Some((least, name))
        })
        .collect();
    near.sort_unstable();
    let best = near.first().map_or(0, |(least, _)| *least);
    near.retain(|(least, _)| *least <= best + 1);
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
        let contact =
            || ["contact.conductance", "contact.friction_coefficient", "contact.faces", "punch.wear_coefficient"];
        for beginning in ["contact.frction", "contact.friktion", "contact.friction_coeff", "fric"] {
            let told = nearest(beginning, contact().into_iter());
            assert_eq!(told, "; did you mean contact.friction_coefficient?", "{beginning}");
        }
        assert_eq!(nearest("punch.wear_coef", contact().into_iter()), "; did you mean punch.wear_coefficient?");
        assert_eq!(nearest("tiem", ["temperature_limit", "time"].into_iter()), "; did you mean time?");
        assert_eq!(nearest("punch.friktion", contact().into_iter()), "");
        let factors = ["contact.friction_fade.factor", "punch.wear_fade.factor"].into_iter();
        let told = nearest("contact.friction_fade.facter", factors);
        assert_eq!(told, "; did you mean contact.friction_fade.factor?");
        assert_eq!(nearest("strip.with", known()), "; did you mean punch.width?");
    }
}
