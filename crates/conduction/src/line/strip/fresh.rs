//! Fresh material under the contact: the heat that the contact leaves behind does not return.
//!
//! The modes repeat after the period L (with opposite sign), and the contact would meet its own heat there. So the states are
//! those of two stretches of the path: of the one that the contact slides on, and of the one before, which is kept apart as
//! well. Once the contact is the way D = L/4 beyond that older stretch, its states are subtracted, the stretch just passed
//! becomes the older one, and a new one begins:
//!
//! ```text
//! x' = e x + w f,   o' = e o;      beyond D:   x' = e (x - o) + w f,   o' = e (x - o)
//! ```
//!
//! with the factors e and the weights w of the step. No stretch is longer than D (one step, and within a step no heat counts that
//! lies further back), so all heat lies within 3 D of the contact, and its image at L is another D away. What is dropped has
//! spread less than D less the width: see [`StripProperties::period`](super::StripProperties::period).
//!
//! Theory: docs/theory.md, section 4.5.

use super::StripHeat;

/// The way D, m.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct Fresh {
    pub way: f64,
}

/// State entries after those of the older stretch: both ends of the stretch and of the older one, m from the contact.
pub(super) const ENDS: usize = 4;

impl Fresh {
    /// The last fraction of an interval whose heat counts at its end, `length` (s) long and of a velocity linear over it: all of it
    /// where the contact slides less than D.
    pub(crate) fn felt(&self, length: f64, [from, to]: [f64; 2]) -> f64 {
        // The fraction u before the end the contact was `length (to u - (to - from) u^2/2)` away.
        let limit = self.way / length;
        let crossing = |direction: f64| {
            let (speed, half) = (direction * to, 0.5 * direction * (to - from));
            // Smaller positive root of `half u^2 - speed u + limit`.
            let sum = speed + (speed * speed - 4.0 * half * limit).sqrt();
            if sum > 0.0 { 2.0 * limit / sum } else { f64::INFINITY }
        };
        crossing(1.0).min(crossing(-1.0)).min(1.0)
    }
}

/// Positions of the contact during a step, from that at its end: least and largest.
fn swept(length: f64, [from, to]: [f64; 2]) -> [f64; 2] {
    let start = -0.5 * length * (from + to);
    let turn = if from * to < 0.0 { start + 0.5 * length * from * from / (from - to) } else { 0.0 };
    [start.min(turn).min(0.0), start.max(turn).max(0.0)]
}

impl StripHeat {
    /// Drops the older stretch from the states `after` the step where the contact left it, and advances it.
    pub(super) fn leave_behind(&self, before: &[f64], after: &mut [f64]) {
        let (operators, step) = (&*self.operators, &self.step);
        let Some(fresh) = operators.fresh else { return };
        let (first, count) = (operators.mean_states(), operators.rate.len());
        let [waves, older, ends] = [first, first + 2 * count, first + 4 * count];
        let own = swept(step.length, step.velocity);
        let slid = 0.5 * step.length * (step.velocity[0] + step.velocity[1]);
        let [low, high, older_low, older_high] = std::array::from_fn(|end| before[ends + end] - slid);
        let own = own.map(|end| end.clamp(-fresh.way, fresh.way));
        let gap = older_low.max(-older_high);
        let reach = [low, older_low].into_iter().chain(own).fold(0.0, |reach: f64, end| reach.max(-end));
        let reach = [high, older_high].into_iter().chain(own).fold(reach, f64::max);
        // A contact that comes back may stretch further: then its oldest heat goes before an image of it arrives.
        let leaves = gap >= fresh.way || reach > 3.0 * fresh.way;
        let stretches =
            if leaves { [own, [low, high]] } else { [[low.min(own[0]), high.max(own[1])], [older_low, older_high]] };
        after[ends..ends + ENDS].copy_from_slice(stretches.as_flattened());
        let [cosine, sine] = &step.end.factor;
        let (now, kept) = after[waves..ends].split_at_mut(2 * count);
        let ((re, im), (kept_re, kept_im)) = (now.split_at_mut(count), kept.split_at_mut(count));
        for k in 0..count {
            let turned = |at: usize| {
                let (x, y) = (before[at + k], before[at + count + k]);
                [cosine[k] * x - sine[k] * y, cosine[k] * y + sine[k] * x]
            };
            let old = turned(older);
            (kept_re[k], kept_im[k]) = (old[0], old[1]);
            if leaves {
                let all = turned(waves);
                re[k] -= old[0];
                im[k] -= old[1];
                (kept_re[k], kept_im[k]) = (all[0] - old[0], all[1] - old[1]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_felt_part_of_an_interval_begins_one_way_from_its_end() {
        let fresh = Fresh { way: 0.3 };
        for velocity in
            [[1.0, 1.0], [0.0, 2.0], [2.0, 0.0], [-1.0, 3.0], [3.0, -1.0], [-2.0, -0.5], [0.1, -0.1], [0.0; 2]]
        {
            for length in [0.1, 0.5, 2.0, 1e3] {
                let felt = fresh.felt(length, velocity);
                let [from, to]: [f64; 2] = velocity;
                let away = |u: f64| length * (to * u - 0.5 * (to - from) * u * u);
                let within = (0..=1000).map(|k| away(felt * f64::from(k) / 1000.0).abs()).fold(0.0, f64::max);
                assert!(within <= fresh.way * (1.0 + 1e-9), "{velocity:?} {length}: {within}");
                assert!(felt == 1.0 || (away(felt).abs() - fresh.way).abs() < 1e-9, "{velocity:?} {length}: {felt}");
            }
        }
    }

    #[test]
    fn a_step_sweeps_to_its_turning_point() {
        assert_eq!(swept(2.0, [1.0, 2.0]), [-3.0, 0.0]);
        assert_eq!(swept(2.0, [-1.0, 1.0]), [-0.5, 0.0]);
        assert_eq!(swept(2.0, [3.0, -1.0]), [-2.0, 0.25]);
    }
}
