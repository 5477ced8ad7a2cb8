//! The physics of the lumped level through the component alone: steps, balances, geometry, standstill,
//! derivatives and limits, against closed forms and fine steps.

mod balance;
mod bristle;
mod derivatives;
mod faces;
mod friction_table;
mod geometry;
mod limits;
mod neighbours;
mod properties;
mod rates;
mod replay;
mod standstill;
mod steps;
mod stroke;
mod tuning;
