//! Wear: the law, and the track that a straight path keeps.

pub mod law;
pub mod track;
