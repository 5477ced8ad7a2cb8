//! Step size control of both levels: a piece of a communication step is cut into 2^n equal parts.
//!
//! A step whose error, in units of the tolerance, is above 1 is rejected and halved; after two halves with room to spare the step is
//! doubled again. Steps are dyadic fractions of the piece, so that operators made for a step size are found again, and n is part of
//! the state, so that a replay takes the same steps.
//!
//! Theory: docs/theory.md, section 7.3.

/// Finest subdivision: 2^-40 of the piece.
pub(crate) const FINEST: u8 = 40;

/// Where a piece stands, and how finely it is cut.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StepController {
    length: f64,
    level: u8,
    part: u64,
    /// Error below which a step of twice the size is tried.
    doubling: f64,
}

impl StepController {
    /// For a piece of `length` (s) in 2^`level` parts; steps with an error below `doubling` let the step be doubled: 2^-p of the
    /// tolerance for an error of order p, with a margin.
    pub(crate) fn new(length: f64, level: u8, doubling: f64) -> StepController {
        StepController { length, level, part: 0, doubling }
    }

    /// Whether the piece is done.
    pub(crate) fn is_done(&self) -> bool {
        self.part >= 1_u64 << self.level
    }

    /// Number of parts that the piece is cut into, and of those that are done.
    pub(crate) fn parts(&self) -> (u64, u64) {
        (1_u64 << self.level, self.part)
    }

    /// log2 of the number of parts.
    pub(crate) fn level(&self) -> u8 {
        self.level
    }

    /// Size of the step, s.
    pub(crate) fn step(&self) -> f64 {
        self.length / (1_u64 << self.level) as f64
    }

    /// Start of the step, s from the start of the piece.
    pub(crate) fn start(&self) -> f64 {
        self.part as f64 * self.step()
    }

    /// Takes a step of this error; it is doubled where that leaves room and `may_double`.
    pub(crate) fn accept(&mut self, error: f64, may_double: bool) {
        self.part += 1;
        if self.level > 0 && self.part.is_multiple_of(2) && error < self.doubling && may_double {
            self.level -= 1;
            self.part /= 2;
        }
    }

    /// Halves the step so many times, down to the finest; false where it is the finest already.
    pub(crate) fn halve(&mut self, halvings: u8) -> bool {
        if self.level >= FINEST {
            return false;
        }
        let level = (self.level + halvings).min(FINEST);
        self.part <<= level - self.level;
        self.level = level;
        true
    }
}

/// Halvings that bring an error (> 1) of the given order below 1; 2 where it is not finite.
pub(crate) fn halvings(error: f64, order: u8) -> u8 {
    // Most halvings after one rejected step.
    if error.is_finite() { (error.log2() / f64::from(order)).ceil().clamp(1.0, 10.0) as u8 } else { 2 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steps over a piece whose error is `strength h^order`: the starts and sizes of those accepted, and the number rejected.
    fn run(strength: f64, order: u8, level: u8) -> (Vec<(f64, f64)>, u32) {
        let mut control = StepController::new(2.0, level, 0.7 * 0.5_f64.powi(i32::from(order)));
        let (mut taken, mut rejected) = (Vec::new(), 0);
        while !control.is_done() {
            let (start, step) = (control.start(), control.step());
            let error = strength * (1.0 + start) * step.powi(i32::from(order));
            if error <= 1.0 {
                taken.push((start, step));
                control.accept(error, true);
            } else {
                rejected += 1;
                assert!(control.halve(halvings(error, order)));
            }
        }
        (taken, rejected)
    }

    #[test]
    fn steps_follow_one_another_over_the_piece_within_the_tolerance() {
        for (strength, order, level) in [(0.1, 2, 0), (40.0, 2, 0), (40.0, 3, 0), (3e4, 2, 1), (0.1, 2, 6)] {
            let (taken, rejected) = run(strength, order, level);
            assert_eq!(taken[0].0, 0.0);
            assert!(taken.windows(2).all(|pair| pair[0].0 + pair[0].1 == pair[1].0), "{taken:?}");
            let last = taken[taken.len() - 1];
            assert_eq!(last.0 + last.1, 2.0);
            assert!(rejected <= 4, "{rejected} rejected");
        }
        // With room to spare a fine cut grows coarser at every second step.
        let sizes: Vec<f64> = run(1e-3, 2, 3).0.iter().map(|(_, step)| *step).collect();
        assert_eq!(sizes, [0.25, 0.25, 0.5, 1.0]);
    }

    #[test]
    fn halvings_follow_the_order_and_end_at_the_finest_step() {
        assert_eq!([1.01, 4.0, 4.01, 16.0, 1e30].map(|error| halvings(error, 2)), [1, 1, 2, 2, 10]);
        assert_eq!(
            [halvings(8.0, 3), halvings(8.01, 3), halvings(f64::INFINITY, 2), halvings(f64::NAN, 2)],
            [1, 2, 2, 2]
        );
        let mut control = StepController::new(1.0, FINEST - 1, 0.2);
        assert!(control.halve(10) && control.level() == FINEST && !control.halve(1));
        assert_eq!(control.step(), 0.5_f64.powi(40));
        // A step that must not be doubled is not.
        let mut control = StepController::new(1.0, 1, 0.2);
        control.accept(0.0, false);
        control.accept(0.0, false);
        assert!(control.is_done() && control.level() == 1);
    }
}
