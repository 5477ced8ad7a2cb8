//! A cache of fixed capacity: values by key, of which the one that was used longest ago is replaced.
//!
//! A cached value must be a function of its key (and of what does not change while the cache lives) alone. A run then gives the same
//! bits whatever the capacity: a value that is found is the one that would be computed. Memory for all values is taken when the
//! cache is made; lookups and replacements allocate nothing.
//!
//! Keys compare by `==`. Floating-point numbers go into a key by their bits (`f64::to_bits`), so that a NaN equals itself and
//! zeros of different sign differ.

use std::ops::{Index, IndexMut};

/// See the module. A value is addressed by its slot, which it keeps until it is replaced.
#[derive(Clone, Debug)]
pub struct KeyedCache<K, V> {
    slots: Vec<Slot<K>>,
    values: Vec<V>,
    /// Slot that was used last.
    latest: usize,
    /// Uses so far.
    uses: u64,
}

#[derive(Clone, Debug)]
struct Slot<K> {
    /// `None`: vacant, the value is memory only.
    key: Option<K>,
    /// Number of the last use; 0: never.
    last_use: u64,
}

impl<K, V> KeyedCache<K, V> {
    /// A vacant cache whose memory is `values`; their number is the capacity.
    pub fn new(values: impl IntoIterator<Item = V>) -> Self {
        let values: Vec<V> = values.into_iter().collect();
        let slots = values.iter().map(|_| Slot { key: None, last_use: 0 }).collect();
        Self { slots, values, latest: 0, uses: 0 }
    }

    /// Number of values.
    pub fn capacity(&self) -> usize {
        self.values.len()
    }

    /// Key of the value in a slot; `None` where the slot is vacant.
    pub fn key(&self, slot: usize) -> Option<&K> {
        self.slots[slot].key.as_ref()
    }

    /// The value that was used last; `None` where there is none.
    #[inline]
    pub fn latest(&self) -> Option<&V> {
        self.slots.get(self.latest)?.key.as_ref().map(|_| &self.values[self.latest])
    }

    /// Slot of the value for which `fits` is true, for keys that stand in the values themselves. It counts as used.
    pub fn find(&mut self, fits: impl Fn(&K, &V) -> bool) -> Option<usize> {
        let stored = self.slots.iter().zip(&self.values);
        let slot = stored.map(|(slot, value)| (slot.key.as_ref(), value));
        let slot = slot.enumerate().find(|(_, (key, value))| key.is_some_and(|key| fits(key, value)))?.0;
        self.touch(slot);
        Some(slot)
    }

    /// Gives the slot that was used longest ago, a vacant one where there is one, to `key`. The caller overwrites its value.
    ///
    /// # Panics
    /// A cache of no capacity.
    pub fn insert(&mut self, key: K) -> usize {
        let slot = self.oldest();
        self.slots[slot].key = Some(key);
        self.touch(slot);
        slot
    }

    /// Makes all slots vacant.
    pub fn clear(&mut self) {
        self.slots.iter_mut().for_each(|slot| *slot = Slot { key: None, last_use: 0 });
    }

    /// A copy whose vacant slots have the memory that `vacant` takes, given the vacant value: memory that nothing was written to
    /// need not be copied.
    pub fn clone_occupied(&self, vacant: impl Fn(&V) -> V) -> Self
    where
        K: Clone,
        V: Clone,
    {
        let copy = |(slot, value): (&Slot<K>, &V)| if slot.key.is_some() { value.clone() } else { vacant(value) };
        let values = self.slots.iter().zip(&self.values).map(copy).collect();
        Self { slots: self.slots.clone(), values, ..*self }
    }

    fn touch(&mut self, slot: usize) {
        self.uses += 1;
        self.slots[slot].last_use = self.uses;
        self.latest = slot;
    }

    fn oldest(&self) -> usize {
        (0..self.slots.len())
            .min_by_key(|&slot| self.slots[slot].last_use)
            .expect("a cache that is written to has slots")
    }
}

impl<K: PartialEq, V> KeyedCache<K, V> {
    /// Slot of the value of `key`, which counts as used.
    #[inline]
    pub fn lookup(&mut self, key: &K) -> Option<usize> {
        if self.slots.get(self.latest).is_some_and(|slot| slot.key.as_ref() == Some(key)) {
            return Some(self.latest);
        }
        self.find(|known, _| known == key)
    }

    /// Slot of the value of `key`, which `compute` makes in the memory of an older one unless it is there.
    #[inline]
    pub fn get_or_compute(&mut self, key: K, compute: impl FnOnce(&mut V)) -> usize {
        match self.lookup(&key) {
            Some(slot) => slot,
            None => self.replace(key, compute),
        }
    }

    #[inline(never)]
    fn replace(&mut self, key: K, compute: impl FnOnce(&mut V)) -> usize {
        let slot = self.oldest();
        // A computation that panics leaves no value.
        self.slots[slot].key = None;
        compute(&mut self.values[slot]);
        self.slots[slot].key = Some(key);
        self.touch(slot);
        slot
    }
}

impl<K, V> Index<usize> for KeyedCache<K, V> {
    type Output = V;

    #[inline]
    fn index(&self, slot: usize) -> &V {
        &self.values[slot]
    }
}

impl<K, V> IndexMut<usize> for KeyedCache<K, V> {
    #[inline]
    fn index_mut(&mut self, slot: usize) -> &mut V {
        &mut self.values[slot]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::alloc::{GlobalAlloc, Layout, System};
    use std::cell::Cell;

    struct Counting;

    thread_local! {
        static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
    }

    // SAFETY: every call is passed on to the system's allocator unchanged.
    unsafe impl GlobalAlloc for Counting {
        unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
            ALLOCATIONS.set(ALLOCATIONS.get() + 1);
            // SAFETY: the caller's promises are those of this function.
            unsafe { System.alloc(layout) }
        }

        unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
            // SAFETY: the memory came from `alloc`, that is from the system's allocator.
            unsafe { System.dealloc(memory, layout) }
        }
    }

    #[global_allocator]
    static ALLOCATOR: Counting = Counting;

    /// Step sizes as a step control takes them: a few by turns, now and then a new one.
    fn steps() -> impl Iterator<Item = f64> {
        (0..400_u32).map(|i| if i % 17 == 0 { 1.0 / f64::from(i + 3) } else { 0.5_f64.powi((i * i % 5) as i32) })
    }

    fn compute(step: f64, weights: &mut [f64]) {
        weights.iter_mut().enumerate().for_each(|(k, weight)| *weight = (-step * k as f64).exp());
    }

    #[test]
    fn results_do_not_depend_on_the_capacity_and_nothing_is_allocated() {
        let run = |capacity: usize| {
            let mut cache = KeyedCache::new((0..capacity).map(|_| vec![f64::NAN; 6]));
            let (mut sums, mut computed) = (Vec::with_capacity(400), 0);
            let before = ALLOCATIONS.get();
            for step in steps() {
                let slot = cache.get_or_compute(step.to_bits(), |weights| {
                    compute(step, weights);
                    computed += 1;
                });
                assert_eq!(cache.key(slot), Some(&step.to_bits()));
                assert_eq!(cache.latest().map(|latest| latest.as_ptr()), Some(cache[slot].as_ptr()));
                sums.push(cache[slot].iter().sum::<f64>().to_bits());
            }
            assert_eq!(ALLOCATIONS.get() - before, 0);
            (sums, computed)
        };
        let (alone, always) = run(1);
        for capacity in [2, 3, 7, 400] {
            let (sums, computed) = run(capacity);
            assert_eq!(sums, alone, "capacity {capacity}");
            assert!(computed < always, "capacity {capacity}: {computed} of {always}");
        }
    }

    #[test]
    fn the_value_that_was_used_longest_ago_is_replaced() {
        let mut cache = KeyedCache::new([0, 0, 0]);
        let mut computed = Vec::new();
        let mut take = |cache: &mut KeyedCache<u8, u8>, key: u8| {
            let slot = cache.get_or_compute(key, |value| {
                *value = key;
                computed.push(key);
            });
            assert_eq!(cache[slot], key);
        };
        // 2 is the oldest when 4 comes, then 3, which was used before 1.
        for key in [1, 2, 3, 1, 4, 3, 1, 4, 4, 1, 5, 1, 4, 5, 3] {
            take(&mut cache, key);
        }
        assert_eq!(computed, [1, 2, 3, 4, 5, 3]);
        assert_eq!((cache.lookup(&1), cache.lookup(&2)), (None, None));
        assert!([4, 5, 3].iter().all(|key| cache.lookup(key).is_some()));
    }

    #[test]
    fn keys_may_stand_in_the_values_and_vacant_slots_are_not_copied() {
        let mut cache = KeyedCache::new((0..3).map(|_| vec![0.0; 2]));
        assert!(cache.latest().is_none() && cache.find(|(), _| true).is_none());
        let slot = cache.insert(());
        cache[slot][0] = 7.0;
        assert_eq!(cache.find(|(), value| value[0] == 7.0), Some(slot));
        assert_eq!(cache.find(|(), value| value[0] == 0.0), None);
        let copy = cache.clone_occupied(|_| Vec::new());
        assert_eq!(copy.values, [vec![7.0, 0.0], Vec::new(), Vec::new()]);
        cache.clear();
        assert!(cache.latest().is_none() && cache.find(|(), _| true).is_none());
        assert_eq!(cache.insert(()), 0);
    }

    #[test]
    fn a_computation_that_panics_leaves_no_value() {
        let mut cache = KeyedCache::new([1.0]);
        cache.get_or_compute(1, |value| *value = 2.0);
        let failed = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
            cache.get_or_compute(2, |value| {
                *value = 3.0;
                panic!("no value");
            })
        }));
        assert!(failed.is_err() && cache.lookup(&1).is_none() && cache.lookup(&2).is_none());
    }
}
