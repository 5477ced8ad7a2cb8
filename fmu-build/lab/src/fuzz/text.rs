//! Changes of a text that know nothing of its language.

use super::random::Random;

/// Pieces that parsers stumble over.
const PIECES: [&str; 24] = [
    "\"", "'", "=", "[", "]", "{", "}", ",", ".", "#", "\n", "\r\n", "\r", "\t", "\\", "\u{feff}", "\u{0}", "\u{e9}",
    "🔥", "1e999", "-", "nan", ";", " ",
];

/// A place between two characters.
fn place(text: &str, random: &mut Random) -> usize {
    let mut at = random.below(text.len() + 1);
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

/// A piece of the text: at most `most` bytes.
fn piece(text: &str, most: usize, random: &mut Random) -> core::ops::Range<usize> {
    let begin = place(text, random);
    let mut end = (begin + random.below(most)).min(text.len());
    while !text.is_char_boundary(end) {
        end -= 1;
    }
    begin..end.max(begin)
}

/// Changes a text in one place; `others` lend it pieces.
pub(crate) fn change(text: &mut String, others: &[String], random: &mut Random) {
    match random.below(6) {
        0 => {
            let at = place(text, random);
            text.insert_str(at, random.pick::<&str>(&PIECES));
        }
        1 => {
            let range = piece(text, 12, random);
            text.replace_range(range, "");
        }
        2 => {
            let range = piece(text, 4, random);
            text.replace_range(range, random.pick::<&str>(&PIECES));
        }
        3 => {
            let at = place(text, random);
            text.truncate(at);
        }
        4 => {
            let other = random.pick(others);
            let range = piece(other, 200, random);
            let into = piece(text, 200, random);
            text.replace_range(into, &other[range]);
        }
        _ => {
            let range = piece(text, 40, random);
            let (at, copy) = (range.end, text[range].repeat(1 + random.below(4)));
            text.insert_str(at, &copy);
        }
    }
}
