//! Steady states and cycles of whole scenes, against time stepping and exact solutions.

mod hot_cycles;
mod line_steady;
mod steady_scene;
