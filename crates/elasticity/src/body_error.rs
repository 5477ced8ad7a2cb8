//! Refusal of a body of the scene that its method cannot represent.
//!
//! Theory: docs/theory.md, section 3.1.

use super::OutOfRange;
use super::block::BlockError;
use scene::message::Number;
use std::fmt;

/// A body of the scene outside the validity of the model.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyError {
    /// `punch` or `strip`.
    pub body: &'static str,
    /// Reason for the refusal.
    pub reason: BodyReason,
}

/// Reason why a body is refused.
#[derive(Clone, Debug, PartialEq)]
pub enum BodyReason {
    /// A value outside its range.
    OutOfRange(OutOfRange),
    /// Refused by the finite elements of the block.
    Block(BlockError),
    /// Height, in m, over the width of the contact outside the limits of the method.
    Proportions {
        /// Height of the body, m.
        height: f64,
        /// Width of the contact, m.
        width: f64,
        /// Least accepted ratio, 1.
        least: f64,
        /// Largest accepted ratio, 1.
        largest: f64,
    },
}

impl From<OutOfRange> for BodyReason {
    fn from(error: OutOfRange) -> Self {
        Self::OutOfRange(error)
    }
}

impl From<BlockError> for BodyReason {
    fn from(error: BlockError) -> Self {
        Self::Block(error)
    }
}

impl fmt::Display for BodyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let body = self.body;
        match &self.reason {
            BodyReason::OutOfRange(error) => write!(f, "{body}: {error}"),
            BodyReason::Block(error) => write!(f, "{body}: {error}"),
            BodyReason::Proportions { height, width, least, largest } => {
                write!(
                    f,
                    "{body}.height = {} m and punch.width = {} m: {body}.height / punch.width = {} must be at least {}",
                    Number(*height),
                    Number(*width),
                    Number(height / width),
                    Number(*least)
                )?;
                if largest.is_finite() { write!(f, " and at most {}", Number(*largest)) } else { Ok(()) }
            }
        }
    }
}

impl std::error::Error for BodyError {}
