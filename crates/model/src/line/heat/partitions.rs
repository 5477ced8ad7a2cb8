//! Cache of heat partitions, for a step-size control that alternates between step sizes.
//!
//! A [`HeatPartition`] is a function of step size and reference velocity, so a cached one is identical, to the bit, to one built
//! anew.
//!
//! Theory: docs/theory.md, section 6.4.

use super::partition::HeatPartition;
use conduction::line::cache_capacity;
use std::ops::{Index, IndexMut};

/// Slot of uncached heat partitions, built for one step only.
const PASSING: usize = 0;

/// LRU cache of the heat partitions of both stages; indexed by stage. Nothing is allocated after construction.
#[derive(Debug)]
pub struct PartitionCache {
    sets: Vec<Set>,
    /// Current slot of either stage.
    current: [usize; 2],
    clock: u64,
}

/// Heat partitions of both stages, and the time of their last use (0: never).
#[derive(Clone, Debug)]
struct Set {
    used: u64,
    partitions: [HeatPartition; 2],
}

impl Set {
    /// Empty slot.
    fn like(partition: &HeatPartition) -> Set {
        Set { used: 0, partitions: [partition.like(), partition.like()] }
    }
}

impl PartitionCache {
    /// Empty cache of heat partitions on `count` cells.
    pub fn new(partition: &HeatPartition, count: usize) -> PartitionCache {
        let most = 1 + cache_capacity(count);
        PartitionCache { sets: (0..most).map(|_| Set::like(partition)).collect(), current: [PASSING; 2], clock: 0 }
    }

    /// Makes the slot of a step (s) and reference velocity (m/s) current; false: a cache miss, its partitions have to be built.
    pub fn take(&mut self, key: (f64, f64)) -> bool {
        self.clock += 1;
        let known = (PASSING + 1..self.sets.len()).find(|&place| self.sets[place].partitions[1].is_for(key));
        let place = known.unwrap_or_else(|| {
            (PASSING + 1..self.sets.len()).min_by_key(|&place| self.sets[place].used).unwrap_or(PASSING)
        });
        self.sets[place].used = self.clock;
        self.current = [place; 2];
        known.is_some()
    }

    /// Makes the uncached slot current for a stage.
    pub fn take_passing(&mut self, stage: usize) -> &mut HeatPartition {
        self.current[stage] = PASSING;
        self.sets[PASSING].used = self.clock;
        &mut self.sets[PASSING].partitions[stage]
    }

    /// Current slot of a stage.
    pub fn place(&self, stage: usize) -> usize {
        self.current[stage]
    }
}

impl Index<usize> for PartitionCache {
    type Output = HeatPartition;

    fn index(&self, stage: usize) -> &HeatPartition {
        &self.sets[self.current[stage]].partitions[stage]
    }
}

impl IndexMut<usize> for PartitionCache {
    fn index_mut(&mut self, stage: usize) -> &mut HeatPartition {
        &mut self.sets[self.current[stage]].partitions[stage]
    }
}

impl Clone for PartitionCache {
    fn clone(&self) -> PartitionCache {
        // Zeroed memory from the system is not touched until it is used.
        let copy = |set: &Set| if set.used == 0 { Set::like(&set.partitions[0]) } else { set.clone() };
        PartitionCache { sets: self.sets.iter().map(copy).collect(), ..*self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use conduction::line::SurfaceInfluence;
    use nalgebra::DMatrix;

    fn influence(step: f64) -> SurfaceInfluence {
        let matrix = |scale: f64| DMatrix::from_fn(5, 5, |i, j| scale * step / (1.0 + i.abs_diff(j) as f64));
        SurfaceInfluence { temperature: matrix(1.0), distortion: matrix(-0.3) }
    }

    fn build(partition: &mut HeatPartition, step: f64) {
        let [punch, strip] = [influence(step), influence(3.0 * step)];
        partition.build((step, 0.1), [Some(&punch), Some(&strip)]);
    }

    #[test]
    fn the_last_steps_are_kept_whatever_passes_between() {
        let partition = || HeatPartition::new(&[1.0; 5], &[1.0; 5], 0.7).in_single_precision();
        let most = cache_capacity(5);
        let mut partitions = PartitionCache::new(&partition(), 5);
        assert_eq!(partitions.sets.len(), 1 + most);
        let mut built = 0;
        let mut take = |partitions: &mut PartitionCache, step: usize| {
            if !partitions.take((step as f64, 0.1)) {
                (0..2).for_each(|stage| build(&mut partitions[stage], step as f64));
                built += 1;
            }
            partitions[0].thermal_compliance(2.0);
            let mut fresh = partition();
            build(&mut fresh, step as f64);
            fresh.thermal_compliance(2.0);
            assert_eq!(
                (partitions[0].shares(), partitions[0].thermal_compliance_values()),
                (fresh.shares(), fresh.thermal_compliance_values())
            );
        };
        for turn in 0..5 * most {
            take(&mut partitions, 1 + turn % most);
            build(partitions.take_passing(turn % 2), 0.5);
            assert_eq!(partitions.place(turn % 2), PASSING);
        }
        // One more evicts the least recently used one.
        take(&mut partitions, 1 + most);
        (2..=most).for_each(|step| take(&mut partitions, step));
        let mut copy = partitions.clone();
        assert!(copy.take((2.0, 0.1)) && !copy.take((1.0, 0.1)));
        take(&mut partitions, 1);
        assert_eq!((built, partitions.sets.len()), (most + 2, 1 + most));
    }
}
