//! Wear: the law, the track that a straight path keeps, and the shape of the contact line.

pub mod law;
pub mod line;
pub mod rocking;
pub mod track;
