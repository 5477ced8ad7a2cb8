//! Names near a mistyped one.

/// `; did you mean ...?` with the up to three nearest of `known`, or nothing where none is near.
pub fn nearest<'known>(wanted: &str, known: impl Iterator<Item = &'known str>) -> String {
    let last = |name: &str| name.rsplit('.').next().unwrap_or(name).to_owned();
    let tolerated = (wanted.chars().count() / 4).max(2);
    let mut near: Vec<(usize, &str)> = known
        .filter_map(|name| {
            let distance = distance(wanted, name);
            // The right name in the wrong table is as near as a small slip.
            let distance = if last(name) == last(wanted) { distance.min(1) } else { distance };
            (distance <= tolerated).then_some((distance, name))
        })
        .collect();
    near.sort_unstable();
    near.truncate(3);
    let names: Vec<&str> = near.into_iter().map(|(_, name)| name).collect();
    if names.is_empty() { String::new() } else { format!("; did you mean {}?", names.join(" or ")) }
}

/// Levenshtein distance: insertions, deletions and substitutions of single characters.
fn distance(left: &str, right: &str) -> usize {
    let right: Vec<char> = right.chars().collect();
    let mut row: Vec<usize> = (0..=right.len()).collect();
    for (index, symbol) in left.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = index + 1;
        for (at, &other) in right.iter().enumerate() {
            let substituted = diagonal + usize::from(symbol != other);
            diagonal = row[at + 1];
            row[at + 1] = substituted.min(diagonal + 1).min(row[at] + 1);
        }
    }
    row[right.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_those_of_levenshtein() {
        for (left, right, expected) in
            [("", "", 0), ("abc", "", 3), ("", "abc", 3), ("kitten", "sitting", 3), ("flaw", "lawn", 2)]
        {
            assert_eq!(distance(left, right), expected, "{left} {right}");
        }
    }

    #[test]
    fn slips_and_wrong_tables_are_recognised_and_nonsense_is_not() {
        let known = || ["punch.width", "punch.height", "strip.height", "depth"].into_iter();
        assert_eq!(nearest("punch.widht", known()), "; did you mean punch.width?");
        assert_eq!(nearest("strip.width", known()), "; did you mean punch.width?");
        assert_eq!(nearest("height", known()), "; did you mean punch.height or strip.height?");
        assert_eq!(nearest("zzz", known()), "");
    }
}
