//! Splits for the steps that a step control goes back and forth between.
//!
//! A [`HeatPartition`] is a function of the step and of the reference velocity, so one that is kept is that which would be made, to the
//! bit.

use super::partition::HeatPartition;
use conduction::line::cache_capacity;
use numerics::cache::KeyedCache;
use std::ops::{Index, IndexMut};

/// Place of the splits that no other step asks for.
const PASSING: usize = 0;

/// Splits of both stages, each as an element of this. Nothing is allocated after construction.
#[derive(Debug)]
pub struct PartitionCache {
    /// By the bits of step and reference velocity; the one in slot k has the place k + 1.
    cache: KeyedCache<[u64; 2], [HeatPartition; 2]>,
    passing: [HeatPartition; 2],
    /// Places of those of either stage.
    current: [usize; 2],
}

impl PartitionCache {
    /// Memory for splits like the one of a stage on `count` cells.
    pub fn new(partition: &HeatPartition, count: usize) -> PartitionCache {
        let memory = || [partition.like(), partition.like()];
        let cache = KeyedCache::new((0..cache_capacity(count)).map(|_| memory()));
        PartitionCache { cache, passing: memory(), current: [PASSING; 2] }
    }

    /// Takes those of a step (s) and reference velocity (m/s), or memory in which they have to be built: then it is false.
    pub fn take(&mut self, (step, velocity): (f64, f64)) -> bool {
        let key = [step.to_bits(), velocity.to_bits()];
        let known = self.cache.lookup(&key);
        self.current = [1 + known.unwrap_or_else(|| self.cache.insert(key)); 2];
        known.is_some()
    }

    /// Takes memory for the split of a stage that no other step asks for.
    pub fn take_passing(&mut self, stage: usize) -> &mut HeatPartition {
        self.current[stage] = PASSING;
        &mut self.passing[stage]
    }

    /// Where the split of a stage stands among all.
    pub fn place(&self, stage: usize) -> usize {
        self.current[stage]
    }
}

impl Index<usize> for PartitionCache {
    type Output = HeatPartition;

    fn index(&self, stage: usize) -> &HeatPartition {
        match self.current[stage] {
            PASSING => &self.passing[stage],
            place => &self.cache[place - 1][stage],
        }
    }
}

impl IndexMut<usize> for PartitionCache {
    fn index_mut(&mut self, stage: usize) -> &mut HeatPartition {
        match self.current[stage] {
            PASSING => &mut self.passing[stage],
            place => &mut self.cache[place - 1][stage],
        }
    }
}

impl Clone for PartitionCache {
    fn clone(&self) -> PartitionCache {
        // Zeros that the system hands out are not touched until they are used.
        let memory = |pair: &[HeatPartition; 2]| pair.each_ref().map(HeatPartition::like);
        PartitionCache { cache: self.cache.clone_occupied(memory), passing: self.passing.clone(), ..*self }
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
        assert_eq!(partitions.cache.capacity(), most);
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
        // One more takes the place of the one that was asked for longest ago.
        take(&mut partitions, 1 + most);
        (2..=most).for_each(|step| take(&mut partitions, step));
        let mut copy = partitions.clone();
        assert!(copy.take((2.0, 0.1)) && !copy.take((1.0, 0.1)));
        take(&mut partitions, 1);
        assert_eq!((built, partitions.cache.capacity()), (most + 2, most));
    }
}
