//! Verification problems with exact solutions, printed by `cargo fmu verify` and asserted by the tests.
//!
//! Each [`Problem`] has its exact value with the derivation or the source, the computation, a bound of the error and the
//! reason for that bound. Exact values are independent of the code under test: closed forms are here, the others are
//! computed in [`reference`] by another method.
//!
//! Theory: docs/theory.md, section 10.

mod annulus;
mod bodies;
pub mod clock;
mod component;
mod contact_line;
mod driver;
pub mod drives;
mod explicit_limit;
mod heat_line;
mod heat_punch;
mod hot_states;
mod instability;
pub mod integrator;
mod moving_source;
mod operator_split;
pub(crate) mod path_modes;
mod punch_heat;
pub mod stability;
mod steady_states;
pub mod timed_steps;
pub(crate) mod wave;
mod wear_line;

use std::time::Instant;

/// What a computation gives, or any reason why it fails.
type Fallible<T> = Result<T, Box<dyn std::error::Error + Send + Sync>>;

type Value = Box<dyn Fn() -> Fallible<f64>>;

/// A problem with an exact solution.
pub struct Problem {
    /// Description, with the parameters.
    pub name: String,
    /// Compared quantity, with its unit.
    pub quantity: &'static str,
    /// Exact value, by closed form or by an independent method.
    pub exact: Value,
    /// Scale of the error; `None`: the exact value. Temperatures: the peak rise, K.
    pub scale: Option<f64>,
    /// The value under test.
    pub compute: Value,
    /// Bound of the relative error.
    pub bound: f64,
    /// Reason why the bound is not smaller.
    pub reason: &'static str,
}

/// A solved problem.
#[derive(Clone, PartialEq, Debug)]
pub struct Row {
    /// [`Problem::name`].
    pub problem: String,
    /// [`Problem::quantity`].
    pub quantity: &'static str,
    /// Exact value.
    pub exact: f64,
    /// Value under test.
    pub computed: f64,
    /// |computed - exact| relative to [`Problem::scale`]; infinite where a value is not finite.
    pub error: f64,
    /// [`Problem::bound`].
    pub bound: f64,
    /// Wall time of the computation under test, set-up included, s.
    pub cost_seconds: f64,
}

impl Row {
    /// Whether the error is within its bound.
    pub fn passes(&self) -> bool {
        self.error <= self.bound
    }
}

impl Problem {
    /// Solves the problem.
    pub fn solve(&self) -> Result<Row, String> {
        let named = |error: Box<dyn std::error::Error + Send + Sync>| format!("{}: {error}", self.name);
        let exact = (self.exact)().map_err(named)?;
        let start = Instant::now();
        let computed = (self.compute)().map_err(named)?;
        let cost_seconds = start.elapsed().as_secs_f64();
        let error = (computed - exact).abs() / self.scale.unwrap_or(exact.abs());
        Ok(Row {
            problem: self.name.clone(),
            quantity: self.quantity,
            exact,
            computed,
            error: if error.is_finite() { error } else { f64::INFINITY },
            bound: self.bound,
            cost_seconds,
        })
    }
}

/// All problems, in printing order.
pub fn problems() -> Vec<Problem> {
    let mut all = Vec::new();
    bodies::problems(&mut all);
    moving_source::problems(&mut all);
    heat_line::problems(&mut all);
    all.extend(punch_heat::problems());
    all.extend(heat_punch::problems());
    annulus::problems(&mut all);
    instability::problems(&mut all);
    component::problems(&mut all);
    all.extend(operator_split::problems());
    contact_line::problems(&mut all);
    wear_line::problems(&mut all);
    steady_states::problems(&mut all);
    hot_states::problems(&mut all);
    all
}

fn known(value: f64) -> Value {
    Box::new(move || Ok(value))
}
