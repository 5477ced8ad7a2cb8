//! Log messages in memory allocated at the end of initialisation, so that a step with messages allocates nothing.

use super::{Message, Subject};
use std::fmt::{self, Write};
use std::slice;

/// Largest number of pending messages, where they are taken after every call: a step emits each message at most once.
const MOST_MESSAGES: usize = 8;

/// Bytes of a text without another allocation.
const LONGEST_TEXT: usize = 640;

/// Messages since the last call of [`Messages::take`].
#[derive(Debug, Default)]
pub(crate) struct Messages {
    /// The first `count` are pending; the others are spare memory.
    kept: Vec<Message>,
    count: usize,
}

impl Messages {
    /// Allocates the memory required by steps.
    pub(crate) fn reserve(&mut self) {
        for message in &mut self.kept {
            message.text.reserve(LONGEST_TEXT.saturating_sub(message.text.len()));
        }
        while self.kept.len() < MOST_MESSAGES {
            self.kept.push(Message { subject: Subject::Plan, text: String::with_capacity(LONGEST_TEXT) });
        }
    }

    /// Adds a message.
    pub(crate) fn add(&mut self, subject: Subject, text: fmt::Arguments<'_>) {
        self.compose(subject, |message| message.write_fmt(text));
    }

    /// Adds the message that `write` composes; none where it writes nothing.
    pub(crate) fn compose(&mut self, subject: Subject, write: impl FnOnce(&mut String) -> fmt::Result) {
        if self.count == self.kept.len() {
            self.kept.push(Message { subject, text: String::new() });
        }
        let message = &mut self.kept[self.count];
        message.subject = subject;
        message.text.clear();
        // Writing to a string fails only where the formatted value returns an error.
        if write(&mut message.text).is_ok() && !message.text.is_empty() {
            self.count += 1;
        }
    }

    /// Pending messages, oldest first; they are removed.
    pub(crate) fn take(&mut self) -> slice::Iter<'_, Message> {
        let count = std::mem::take(&mut self.count);
        self.kept[..count].iter()
    }

    /// Whether no message is pending.
    #[inline]
    pub(crate) fn is_empty(&self) -> bool {
        self.count == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_come_once_and_in_order_also_where_there_are_many() {
        let mut messages = Messages::default();
        messages.reserve();
        for round in 0..2 {
            for number in 0..2 * MOST_MESSAGES {
                messages.add(Subject::Warning, format_args!("{round} {number}"));
                messages.compose(Subject::Error, |_| Ok(()));
            }
            assert!(!messages.is_empty());
            let texts: Vec<&str> = messages.take().map(|message| message.text.as_str()).collect();
            assert_eq!(texts.len(), 2 * MOST_MESSAGES);
            assert_eq!(
                (texts[0], texts[2 * MOST_MESSAGES - 1]),
                (&*format!("{round} 0"), &*format!("{round} {}", 2 * MOST_MESSAGES - 1))
            );
            assert!(messages.is_empty() && messages.take().len() == 0);
        }
    }
}
