//! Messages to the importer's logger.
//!
//! Three categories, as the model description declares them:
//!
//! | category | status | sent |
//! |---|---|---|
//! | `logStatusError` | `fmi2Error`, or `fmi2Discard` for a refused value | always: the reason of a returned status |
//! | `logStatusWarning` | `fmi2Warning` | unless debug logging is on for other categories only: a limit was reached, the model's validity left, an input taken as something else; each once a run |
//! | `logEvents` | `fmi2OK` | when debug logging is on for it: choices of the plan with their reasons, life cycle |
//!
//! A text goes out as the argument of the format `%s`, so that a `%` in it is only a `%`; a `#` is
//! doubled, because importers expand `#r12#` to a variable's name. Texts longer than [`LONGEST`] go
//! out in pieces, because there are loggers that print into a buffer of 1000 bytes.

use core::ffi::{CStr, c_char};
use std::ffi::CString;

use super::types::{CallbackFunctions, ComponentEnvironment, Logger, Status};
use crate::panics;

/// Most bytes of text in one message.
pub(crate) const LONGEST: usize = 900;

/// A category of messages. The discriminants are the bits of [`Log::enabled`].
#[repr(u8)]
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Category {
    /// `logEvents`
    Events = 1,
    /// `logStatusWarning`
    Warnings = 2,
    /// `logStatusError`
    Errors = 4,
}

impl Category {
    pub(crate) const ALL: [Category; 3] = [Category::Events, Category::Warnings, Category::Errors];

    /// Name as declared in the model description.
    pub(crate) const fn name(self) -> &'static CStr {
        match self {
            Category::Events => c"logEvents",
            Category::Warnings => c"logStatusWarning",
            Category::Errors => c"logStatusError",
        }
    }

    /// The category of a name; `None` where it is not declared.
    pub(crate) fn from_name(name: &CStr) -> Option<Category> {
        Category::ALL.into_iter().find(|category| category.name() == name)
    }
}

/// Destination and filter of an instance's messages.
pub(crate) struct Log {
    logger: Option<Logger>,
    environment: ComponentEnvironment,
    instance: CString,
    enabled: u8,
}

// SAFETY: the environment is never dereferenced here, only passed back to the importer's logger. The
// standard lets an importer drive an instance from any thread, so its logger must be callable from any thread.
unsafe impl Send for Log {}

impl Log {
    /// Takes over the importer's logger (which may be missing), and its name for the instance.
    pub(crate) fn new(callbacks: &CallbackFunctions, instance: CString, debug: bool) -> Log {
        let mut log =
            Log { logger: callbacks.logger, environment: callbacks.component_environment, instance, enabled: 0 };
        log.enable(debug, &Category::ALL);
        log
    }

    /// Switches debug logging off, or on for these categories only. Errors are always sent, warnings unless `categories`
    /// exclude them: they are no debug messages, and a run with a warning returns the same statuses as any other.
    pub(crate) fn enable(&mut self, on: bool, categories: &[Category]) {
        self.enabled = Category::Errors as u8;
        if !on {
            self.enabled |= Category::Warnings as u8;
        } else {
            self.enabled = categories.iter().fold(self.enabled, |enabled, &category| enabled | category as u8);
        }
    }

    /// Whether a message of this category would be sent; to save composing one that is not.
    pub(crate) fn wants(&self, category: Category) -> bool {
        self.logger.is_some() && self.enabled & category as u8 != 0
    }

    /// Sends a message, if its category is on.
    #[cold]
    pub(crate) fn send(&self, status: Status, category: Category, text: &str) {
        let Some(logger) = self.logger.filter(|_| self.wants(category)) else { return };
        let mut room = [0; LONGEST + 1];
        let mut rest = text;
        loop {
            let piece;
            (piece, rest) = split(rest, &mut room);
            let format: *const c_char = c"%s".as_ptr();
            panics::outside(|| {
                // SAFETY: the importer gave this function as its logger, with this signature; all
                // strings end with a zero and live through the call; the format takes one string.
                unsafe {
                    logger(
                        self.environment,
                        self.instance.as_ptr(),
                        status,
                        category.name().as_ptr(),
                        format,
                        piece.as_ptr(),
                    )
                }
            });
            if rest.is_empty() {
                break;
            }
        }
    }
}

/// Copies as much of a text as fits into `room` as a zero-terminated string, `#` doubled and zeros omitted, and returns it with
/// the rest of the text. Cuts between words where there are any, never inside a character or a doubled `#`. Allocates nothing,
/// because steps send messages too.
fn split<'a, 't>(text: &'t str, room: &'a mut [u8]) -> (&'a CStr, &'t str) {
    let longest = room.len() - 1;
    let mut length = 0;
    // End of the last word, in the text and in the buffer.
    let mut word = None;
    let mut rest = "";
    for (at, character) in text.char_indices().filter(|&(_, character)| character != '\0') {
        let count = if character == '#' { 2 } else { character.len_utf8() };
        if character == ' ' && length > 0 {
            word = Some((at, length));
        }
        if length + count > longest {
            let end;
            (end, length) = word.unwrap_or((at, length));
            rest = text[end..].trim_start_matches(' ');
            break;
        }
        if character == '#' {
            room[length..length + 2].copy_from_slice(b"##");
        } else {
            character.encode_utf8(&mut room[length..]);
        }
        length += count;
    }
    room[length] = 0;
    // The zero is the first one.
    (CStr::from_bytes_until_nul(room).unwrap_or_default(), rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The pieces of a text, of at most `longest` bytes.
    fn pieces(text: &str, longest: usize) -> Vec<String> {
        let mut room = vec![b'x'; longest + 1];
        let (mut pieces, mut rest) = (Vec::new(), text);
        loop {
            let piece;
            (piece, rest) = split(rest, &mut room);
            pieces.push(piece.to_str().unwrap().to_owned());
            if rest.is_empty() {
                return pieces;
            }
        }
    }

    #[test]
    fn text_is_escaped_for_importers_that_expand_references() {
        assert_eq!(pieces("50 % of #r1#", 20), ["50 % of ##r1##"]);
        assert_eq!(pieces("a\0b", 20), ["ab"]);
    }

    #[test]
    fn long_texts_are_cut_between_words_and_never_inside_a_character() {
        assert_eq!(pieces("", 5), [""]);
        assert_eq!(pieces("one two three", 7), ["one two", "three"]);
        assert_eq!(pieces("one two three", 6), ["one", "two", "three"]);
        assert_eq!(pieces("one two", 100), ["one two"]);
        assert_eq!(pieces("ééé", 5), ["éé", "é"]);
        assert_eq!(pieces("a##", 4), ["a##", "##"]);
        let long = "word ".repeat(1000);
        assert!(pieces(&long, LONGEST).iter().all(|piece| piece.len() <= LONGEST));
        assert_eq!(pieces(&long, LONGEST).iter().flat_map(|piece| piece.split_whitespace()).count(), 1000);
    }
}
