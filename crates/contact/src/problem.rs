//! Statement of a contact problem: prescribed quantities, solution, errors.
//!
//! Theory: docs/theory.md, sections 2.1, 2.5.

use std::fmt;

/// Prescribed normal quantity. Loads are per depth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Normal {
    /// Resultant of the pressure, in N/m.
    Load(f64),
    /// Approach, in m.
    Approach(f64),
    /// A spring between load and punch: resultant = `load - stiffness * approach`, N/m and N/m2.
    Spring {
        /// Resultant at zero approach, in N/m.
        load: f64,
        /// Decrease of the resultant per approach, in N/m2.
        stiffness: f64,
    },
}

/// Prescribed tilt quantity. Positive tilt lowers the +x edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tilt {
    /// Tilt, in rad: 0 for a punch that can only translate.
    Fixed(f64),
    /// Free to rotate: the resultant acts at this `x`, in m. A pivot at height H: `s mu H`.
    ResultantAt(f64),
    /// Free to rotate under a moment: `integral (x - lever) p dx = moment` per depth, m and N.
    Moment {
        /// Point of action of the resultant without the moment, in m.
        lever: f64,
        /// Moment per depth, in N; positive presses the +x edge.
        moment: f64,
    },
}

/// Pressure and gap of every cell, approach and tilt.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactState {
    /// N cell means of the pressure, in Pa; exactly 0 out of contact.
    pub pressure: Vec<f64>,
    /// N cell means of the gap, in m; exactly 0 in contact.
    pub gap: Vec<f64>,
    /// Approach delta, in m.
    pub approach: f64,
    /// Tilt theta, in rad.
    pub tilt: f64,
}

impl ContactState {
    /// State of `count` open cells with zero gap.
    pub fn new(count: usize) -> Self {
        Self { pressure: vec![0.0; count], gap: vec![0.0; count], approach: 0.0, tilt: 0.0 }
    }
}

/// Work done by the solver since its construction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WorkCounter {
    /// Calls of [`ContactSolver::solve`](super::ContactSolver::solve).
    pub solves: u64,
    /// Active sets tried: back-substitutions.
    pub iterations: u64,
    /// Matrix factorisations.
    pub factorisations: u64,
    /// Solves passed from the active-set iteration to complementary pivoting.
    pub fallbacks: u64,
    /// Pivots of the fallback.
    pub pivots: u64,
}

impl std::ops::Add for WorkCounter {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            solves: self.solves + other.solves,
            iterations: self.iterations + other.iterations,
            factorisations: self.factorisations + other.factorisations,
            fallbacks: self.fallbacks + other.fallbacks,
            pivots: self.pivots + other.pivots,
        }
    }
}

/// Reason why a contact problem has no solution.
#[derive(Clone, Debug, PartialEq)]
pub enum ContactError {
    /// A number is not finite, or a load negative.
    Invalid {
        /// Name of the quantity.
        quantity: &'static str,
        /// Value found.
        value: f64,
    },
    /// The resultant would have to act outside the contact zone: the punch tips over.
    Tipping {
        /// Point of action of the resultant, in m.
        lever: f64,
        /// Centre of the outermost cell, in m, the limit of the lever.
        limit: f64,
    },
    /// Both bodies are rigid and there is no other compliance.
    Rigid,
    /// No equilibrium exists with this friction: the pivoting terminated on a ray.
    NoEquilibrium,
}

impl fmt::Display for ContactError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Invalid { quantity, value } => {
                write!(f, "{quantity} = {value} is out of range: must be finite, a load not negative")
            }
            Self::Tipping { lever, limit } => write!(
                f,
                "the punch tips over: equilibrium needs the resultant at x = {lever} m, the cells reach to {limit} m"
            ),
            Self::Rigid => write!(f, "two rigid bodies have no contact pressure on cells: one must be elastic"),
            Self::NoEquilibrium => {
                write!(f, "no equilibrium of the contact: the pressure is unbounded under friction and rotation")
            }
        }
    }
}

impl std::error::Error for ContactError {}
