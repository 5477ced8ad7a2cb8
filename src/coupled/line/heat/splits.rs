//! Splits for the steps that a step control goes back and forth between.
//!
//! A [`Split`] is a function of the step and of the reference velocity, so one that is kept is that which would be made, to the
//! bit.

use super::split::Split;
use crate::heat::line::kept_steps;
use std::ops::{Index, IndexMut};

/// Place of the splits that no other step asks for.
const PASSING: usize = 0;

/// Splits of both stages, each as an element of this. Nothing is allocated after construction.
#[derive(Debug)]
pub struct Splits {
    sets: Vec<Set>,
    /// Those of either stage.
    current: [usize; 2],
    clock: u64,
}

/// Splits of both stages, and when they were asked for (0: never).
#[derive(Clone, Debug)]
struct Set {
    used: u64,
    splits: [Split; 2],
}

impl Set {
    /// Memory for such splits.
    fn like(split: &Split) -> Set {
        Set { used: 0, splits: [split.like(), split.like()] }
    }
}

impl Splits {
    /// Memory for splits like the one of a stage on `count` cells.
    pub fn new(split: &Split, count: usize) -> Splits {
        let most = 1 + kept_steps(count);
        Splits { sets: (0..most).map(|_| Set::like(split)).collect(), current: [PASSING; 2], clock: 0 }
    }

    /// Takes those of a step (s) and reference velocity (m/s), or memory in which they have to be built: then it is false.
    pub fn take(&mut self, key: (f64, f64)) -> bool {
        self.clock += 1;
        let known = (PASSING + 1..self.sets.len()).find(|&place| self.sets[place].splits[1].is_for(key));
        let place = known.unwrap_or_else(|| {
            (PASSING + 1..self.sets.len()).min_by_key(|&place| self.sets[place].used).unwrap_or(PASSING)
        });
        self.sets[place].used = self.clock;
        self.current = [place; 2];
        known.is_some()
    }

    /// Takes memory for the split of a stage that no other step asks for.
    pub fn take_passing(&mut self, stage: usize) -> &mut Split {
        self.current[stage] = PASSING;
        self.sets[PASSING].used = self.clock;
        &mut self.sets[PASSING].splits[stage]
    }

    /// Where the split of a stage stands among all.
    pub fn place(&self, stage: usize) -> usize {
        self.current[stage]
    }
}

impl Index<usize> for Splits {
    type Output = Split;

    fn index(&self, stage: usize) -> &Split {
        &self.sets[self.current[stage]].splits[stage]
    }
}

impl IndexMut<usize> for Splits {
    fn index_mut(&mut self, stage: usize) -> &mut Split {
        &mut self.sets[self.current[stage]].splits[stage]
    }
}

impl Clone for Splits {
    fn clone(&self) -> Splits {
        // Zeros that the system hands out are not touched until they are used.
        let copy = |set: &Set| if set.used == 0 { Set::like(&set.splits[0]) } else { set.clone() };
        Splits { sets: self.sets.iter().map(copy).collect(), ..*self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::heat::line::Gains;
    use nalgebra::DMatrix;

    fn gains(step: f64) -> Gains {
        let matrix = |scale: f64| DMatrix::from_fn(5, 5, |i, j| scale * step / (1.0 + i.abs_diff(j) as f64));
        Gains { temperature: matrix(1.0), distortion: matrix(-0.3) }
    }

    fn build(split: &mut Split, step: f64) {
        let [punch, strip] = [gains(step), gains(3.0 * step)];
        split.build((step, 0.1), [Some(&punch), Some(&strip)]);
    }

    #[test]
    fn the_last_steps_are_kept_whatever_passes_between() {
        let split = || Split::new(&[1.0; 5], &[1.0; 5], 0.7).in_single_precision();
        let most = kept_steps(5);
        let mut splits = Splits::new(&split(), 5);
        assert_eq!(splits.sets.len(), 1 + most);
        let mut built = 0;
        let mut take = |splits: &mut Splits, step: usize| {
            if !splits.take((step as f64, 0.1)) {
                (0..2).for_each(|stage| build(&mut splits[stage], step as f64));
                built += 1;
            }
            splits[0].extra(2.0);
            let mut fresh = split();
            build(&mut fresh, step as f64);
            fresh.extra(2.0);
            assert_eq!((splits[0].shares(), splits[0].extra_values()), (fresh.shares(), fresh.extra_values()));
        };
        for turn in 0..5 * most {
            take(&mut splits, 1 + turn % most);
            build(splits.take_passing(turn % 2), 0.5);
            assert_eq!(splits.place(turn % 2), PASSING);
        }
        // One more takes the place of the one that was asked for longest ago.
        take(&mut splits, 1 + most);
        (2..=most).for_each(|step| take(&mut splits, step));
        let mut copy = splits.clone();
        assert!(copy.take((2.0, 0.1)) && !copy.take((1.0, 0.1)));
        take(&mut splits, 1);
        assert_eq!((built, splits.sets.len()), (most + 2, 1 + most));
    }
}
