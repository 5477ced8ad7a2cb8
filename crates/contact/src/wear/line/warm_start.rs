//! Warm start of a contact: data carried from one solution to the next.
//!
//! Theory: docs/theory.md, sections 6.6, 6.7.

/// Active sets and starting pressures: all that a solution depends on besides its own problem.
///
/// Friction shifts the pressure to one side or the other, so there is one status for each sign of `s mu`: `strokes[0]` for
/// `s mu >= 0`, `strokes[1]` for `s mu < 0`. Restoring it and solving again reproduces the result to the last bit.
#[derive(Clone, Debug, PartialEq)]
pub struct WarmStart {
    /// By the sign of the signed friction coefficient.
    pub strokes: [StrokeWarmStart; 2],
}

/// Warm start for one sign of the friction.
#[derive(Clone, Debug, PartialEq)]
pub struct StrokeWarmStart {
    /// Cells initially assumed in contact.
    pub active: Vec<bool>,
    /// Starting pressure of Newton's method, N values, in Pa; all 0: none yet.
    pub pressure: Vec<f64>,
    /// Frozen diagonal: wear per pressure at the linearization point of the factors, N values, m/Pa; all 0: none yet.
    pub diagonal: Vec<f64>,
    /// Whether pressure or diagonal may differ from 0.
    pub started: bool,
}

impl WarmStart {
    /// All of `count` cells in contact, no pressure yet.
    pub fn new(count: usize) -> Self {
        let zeros = || vec![0.0; count];
        let stroke =
            StrokeWarmStart { active: vec![true; count], pressure: zeros(), diagonal: zeros(), started: false };
        Self { strokes: [stroke.clone(), stroke] }
    }

    /// Copies another status of as many cells, without allocating.
    pub fn copy_from(&mut self, other: &WarmStart) {
        for (own, other) in self.strokes.iter_mut().zip(&other.strokes) {
            own.active.copy_from_slice(&other.active);
            if own.started || other.started {
                own.pressure.copy_from_slice(&other.pressure);
                own.diagonal.copy_from_slice(&other.diagonal);
                own.started = other.started;
            }
        }
    }

    /// Number of values that [`Self::save`] writes.
    pub fn saved_len(count: usize) -> usize {
        6 * count
    }

    /// Appends the status as numbers, 6 N values.
    pub fn save(&self, out: &mut Vec<f64>) {
        for stroke in &self.strokes {
            out.extend(stroke.active.iter().map(|active| f64::from(u8::from(*active))));
            out.extend(&stroke.pressure);
            out.extend(&stroke.diagonal);
        }
    }

    /// Reads the numbers of [`Self::save`]; `None` where they are not a valid status of this many cells.
    pub fn load(&mut self, numbers: &mut std::slice::Iter<'_, f64>) -> Option<()> {
        for stroke in &mut self.strokes {
            for active in &mut stroke.active {
                *active = match *numbers.next()? {
                    0.0 => false,
                    1.0 => true,
                    _ => return None,
                };
            }
            for value in stroke.pressure.iter_mut().chain(&mut stroke.diagonal) {
                *value = *numbers.next()?;
                if !(*value >= 0.0 && value.is_finite()) {
                    return None;
                }
            }
            stroke.started = stroke.pressure.iter().chain(&stroke.diagonal).any(|value| *value != 0.0);
        }
        Some(())
    }
}
