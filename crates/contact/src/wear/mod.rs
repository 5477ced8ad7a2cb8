//! Wear: the law, the worn track of a straight path, and the shape of the contact line.

pub mod law;
pub mod line;
pub mod rocking;
pub mod track;
