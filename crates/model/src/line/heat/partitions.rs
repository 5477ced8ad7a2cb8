//! Cache of heat partitions, for a step-size control that alternates between step sizes.
//!
//! A [`HeatPartition`] is a function of step size, reference velocity and properties of the bodies, so a cached one is identical, to the bit, to one built
//! anew.
//!
//! Theory: docs/theory.md, section 6.4.

use super::partition::{HeatPartition, PartitionKey};
use conduction::line::cache_capacity;
use numerics::cache::KeyedCache;
use std::ops::{Index, IndexMut};

/// LRU cache of the heat partitions of both stages; indexed by stage. Nothing is allocated after construction.
#[derive(Debug)]
pub(crate) struct PartitionCache {
    /// By the bits of the key.
    cache: KeyedCache<[u64; 6], [HeatPartition; 2]>,
    current: usize,
}

impl PartitionCache {
    /// Empty cache of heat partitions on `count` cells.
    pub(crate) fn new(partition: &HeatPartition, count: usize) -> PartitionCache {
        let cache = KeyedCache::new((0..cache_capacity(count)).map(|_| [partition.like(), partition.like()]));
        PartitionCache { cache, current: 0 }
    }

    /// Takes those of this key, or memory in which they have to be built: then it is false.
    pub(crate) fn take(&mut self, (step, velocity, [punch, strip]): PartitionKey) -> bool {
        let key = [step, velocity, punch.flux, punch.pace, strip.flux, strip.pace].map(f64::to_bits);
        let known = self.cache.lookup(&key);
        self.current = known.unwrap_or_else(|| self.cache.insert(key));
        known.is_some()
    }

    /// Current slot.
    pub(crate) fn slot(&self) -> usize {
        self.current
    }
}

impl Index<usize> for PartitionCache {
    type Output = HeatPartition;

    fn index(&self, stage: usize) -> &HeatPartition {
        &self.cache[self.current][stage]
    }
}

impl IndexMut<usize> for PartitionCache {
    fn index_mut(&mut self, stage: usize) -> &mut HeatPartition {
        &mut self.cache[self.current][stage]
    }
}

impl Clone for PartitionCache {
    fn clone(&self) -> PartitionCache {
        // Zeros that the system hands out are not touched until they are used.
        let memory = |pair: &[HeatPartition; 2]| pair.each_ref().map(HeatPartition::like);
        PartitionCache { cache: self.cache.clone_occupied(memory), current: self.current }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use conduction::line::SurfaceInfluence;
    use conduction::line::contact_parts::ContactParts;
    use conduction::properties::Scales;
    use nalgebra::DMatrix;

    fn influence(step: f64) -> SurfaceInfluence {
        let matrix = |scale: f64| DMatrix::from_fn(5, 5, |i, j| scale * step / (1.0 + i.abs_diff(j) as f64));
        SurfaceInfluence { temperature: matrix(1.0), distortion: matrix(-0.3) }
    }

    fn build(partition: &mut HeatPartition, step: f64) {
        let [punch, strip] = [influence(step), influence(3.0 * step)];
        partition.build((step, 0.1, [Scales::ONE; 2]), &ContactParts::whole(5), [Some(&punch), Some(&strip)]);
    }

    #[test]
    fn the_last_steps_are_kept() {
        let partition = || HeatPartition::new(&[1.0; 5], 0.7);
        let most = cache_capacity(5);
        let mut partitions = PartitionCache::new(&partition(), 5);
        assert_eq!(partitions.cache.capacity(), most);
        let mut built = 0;
        let mut take = |partitions: &mut PartitionCache, step: usize| {
            if !partitions.take((step as f64, 0.1, [Scales::ONE; 2])) {
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
        }
        // One more evicts the least recently used one.
        take(&mut partitions, 1 + most);
        (2..=most).for_each(|step| take(&mut partitions, step));
        let mut copy = partitions.clone();
        assert!(copy.take((2.0, 0.1, [Scales::ONE; 2])) && !copy.take((1.0, 0.1, [Scales::ONE; 2])));
        take(&mut partitions, 1);
        assert_eq!((built, partitions.cache.capacity()), (most + 2, most));
    }
}
