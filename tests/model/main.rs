//! Levels of the model as built from scenes: their choice, work of their steps, shared operators.

mod choice;
mod small_pad;
mod work;
