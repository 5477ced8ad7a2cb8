//! Handles in place of pointers.
//!
//! An importer holds `fmi2Component` and `fmi2FMUstate` as opaque pointers and may pass any value:
//! NULL, an uninitialised variable, a freed one, one in use in another thread. The pointer it receives
//! is therefore not an address but an integer handle,
//!
//! | bits (64-bit pointer) | content |
//! |---|---|
//! | 0..3 | tag of the registry; odd, so that no aligned address looks like a handle |
//! | 3..32 | number of the slot |
//! | 32..63 | generation of the slot, > 0; changes whenever the slot is freed |
//!
//! which is looked up here. A slot is one word of state, `2 generation + taken`, and the value. The
//! word of a vacant slot is `taken` with generation 0, which no handle has. A single compare-and-
//! exchange from `2 generation` to `2 generation + 1` therefore both validates the handle and acquires
//! exclusive access.
//!
//! Slots live in chunks of doubling size that are never moved or freed, so lookup takes no lock. The first chunk is part of the
//! registry, which is static: as long as no more values live at a time than it has slots, a library that is loaded and unloaded
//! leaves no memory behind.
//! A lock guards only the list of free slots, for insertion and removal. A slot whose generations are
//! exhausted is retired.

use core::cell::UnsafeCell;
use core::ffi::c_void;
use core::ops::{Deref, DerefMut};
use core::ptr;
use core::sync::atomic::{AtomicPtr, AtomicU32, Ordering};
use std::sync::{Mutex, PoisonError};

/// Bits of the parts of a handle: see the module.
const TAG_BITS: u32 = 3;
const INDEX_BITS: u32 = if usize::BITS >= 64 { 29 } else { 14 };
const GENERATION_SHIFT: u32 = TAG_BITS + INDEX_BITS;
/// Highest generation that fits into the handle, and into the slot's word beside `taken`.
const LAST_GENERATION: u32 = {
    let bits = usize::BITS - GENERATION_SHIFT;
    (1 << if bits > 31 { 31 } else { bits }) - 1
};
/// Slots of the first chunk; chunk `k` has `FIRST << k`.
const FIRST: usize = 32;
const CHUNKS: usize = (INDEX_BITS - FIRST.trailing_zeros()) as usize;
/// Bit of the word of a slot that is taken.
const TAKEN: u32 = 1;
/// Word of a slot without a value: taken, of generation 0.
const VACANT: u32 = TAKEN;

/// One value and its access word. Aligned to a cache line, so that instances driven in different
/// threads do not share one.
#[repr(align(64))]
struct Slot<T> {
    word: AtomicU32,
    /// Generation of the next value of a vacant slot, and the vacant slot behind it. Used under the lock of the vacancies alone.
    vacancy: UnsafeCell<(u32, Option<u32>)>,
    value: UnsafeCell<Option<Box<T>>>,
}

impl<T> Slot<T> {
    const fn vacant() -> Slot<T> {
        Slot { word: AtomicU32::new(VACANT), vacancy: UnsafeCell::new((0, None)), value: UnsafeCell::new(None) }
    }
}

/// The free slots: those whose value was removed are a list through the slots, those that never had one follow `used`.
struct Vacancies {
    /// Slot whose value was removed last.
    again: Option<u32>,
    /// Slots handed out so far, from the start of the first chunk.
    used: u32,
}

/// Values that C code holds by handle.
pub(crate) struct Registry<T> {
    tag: usize,
    first: [Slot<T>; FIRST],
    /// Chunks behind the first one.
    chunks: [AtomicPtr<Slot<T>>; CHUNKS - 1],
    vacancies: Mutex<Vacancies>,
}

// SAFETY: a value is reached by one thread at a time, the one that set `taken`; the compare-and-
// exchange (acquire) and the store that clears it (release) order its accesses. It may so move from
// thread to thread, hence `T: Send`.
unsafe impl<T: Send> Sync for Registry<T> {}

/// Reason for refusing a handle.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Refused {
    /// It is no handle of this registry, or its value is gone.
    Unknown,
    /// Another call is using the value.
    Busy,
}

/// Exclusive access to a value, released when dropped.
pub(crate) struct Guard<'a, T> {
    slot: &'a Slot<T>,
    value: &'a mut T,
    free_word: u32,
}

impl<T> Deref for Guard<'_, T> {
    type Target = T;
    #[inline(always)]
    fn deref(&self) -> &T {
        self.value
    }
}

impl<T> DerefMut for Guard<'_, T> {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut T {
        self.value
    }
}

impl<T> Drop for Guard<'_, T> {
    #[inline(always)]
    fn drop(&mut self) {
        self.slot.word.store(self.free_word, Ordering::Release);
    }
}

/// Chunk of a slot, and its place there.
#[inline(always)]
const fn place(index: usize) -> (usize, usize) {
    let shifted = index + FIRST;
    let chunk = (shifted.ilog2() - FIRST.ilog2()) as usize;
    (chunk, shifted - (FIRST << chunk))
}

impl<T> Registry<T> {
    /// An empty registry. `tag`: an odd number below 8, different for each registry.
    pub(crate) const fn new(tag: usize) -> Registry<T> {
        assert!(tag % 2 == 1 && tag < 1 << TAG_BITS, "the tag is an odd number below 8");
        Registry {
            tag,
            first: [const { Slot::vacant() }; FIRST],
            chunks: [const { AtomicPtr::new(ptr::null_mut()) }; CHUNKS - 1],
            vacancies: Mutex::new(Vacancies { again: None, used: 0 }),
        }
    }

    /// Inserts a value and returns its handle; `None` when there is no slot left.
    pub(crate) fn insert(&self, value: Box<T>) -> Option<*mut c_void> {
        let mut vacancies = self.vacancies.lock().unwrap_or_else(PoisonError::into_inner);
        let (index, generation) = match vacancies.again {
            Some(index) => {
                // SAFETY: the lock is held.
                let (generation, next) = unsafe { *self.slot(index as usize)?.vacancy.get() };
                vacancies.again = next;
                (index, generation)
            }
            None if vacancies.used < ((1 << INDEX_BITS) - FIRST) as u32 => {
                self.provide(vacancies.used as usize);
                vacancies.used += 1;
                (vacancies.used - 1, self.first_generation(vacancies.used - 1))
            }
            None => return None,
        };
        drop(vacancies);
        let slot = self.slot(index as usize)?;
        // SAFETY: the slot is vacant, so `take` refuses every handle, and its index came out of the list
        // of vacancies (or was never handed out) under the lock, so no other thread has it.
        unsafe { *slot.value.get() = Some(value) };
        slot.word.store(generation << 1, Ordering::Release);
        let (generation, index) = (generation as usize, index as usize);
        Some(ptr::without_provenance_mut((generation << GENERATION_SHIFT) | (index << TAG_BITS) | self.tag))
    }

    /// Acquires exclusive access to the value of a handle.
    ///
    /// # Errors
    /// [`Refused`]; never waits.
    #[inline(always)]
    pub(crate) fn acquire(&self, handle: *mut c_void) -> Result<Guard<'_, T>, Refused> {
        let (slot, free_word) = self.take(handle)?;
        // SAFETY: `take` set `taken` for this handle's generation, so this thread alone has access to
        // the value until `Guard::drop` clears it, and the value is there.
        match unsafe { &mut *slot.value.get() } {
            Some(value) => Ok(Guard { slot, value, free_word }),
            None => Err(Refused::Unknown),
        }
    }

    /// Removes the value of a handle; the handle is invalid from then on.
    ///
    /// # Errors
    /// [`Refused`]; a value in use stays.
    pub(crate) fn remove(&self, handle: *mut c_void) -> Result<Box<T>, Refused> {
        let (slot, free_word) = self.take(handle)?;
        // SAFETY: as in `acquire`; no handle of this generation gets in again.
        let value = unsafe { (*slot.value.get()).take() };
        slot.word.store(VACANT, Ordering::Release);
        let generation = free_word >> 1;
        if generation < LAST_GENERATION {
            let index = (handle.addr() >> TAG_BITS) & ((1 << INDEX_BITS) - 1);
            let mut vacancies = self.vacancies.lock().unwrap_or_else(PoisonError::into_inner);
            // SAFETY: the lock is held.
            unsafe { *slot.vacancy.get() = (generation + 1, vacancies.again) };
            vacancies.again = Some(index as u32);
        }
        value.ok_or(Refused::Unknown)
    }

    /// Marks the slot of a handle as taken; returns it with the word that makes it free again.
    #[inline(always)]
    fn take(&self, handle: *mut c_void) -> Result<(&Slot<T>, u32), Refused> {
        let bits = handle.addr();
        let generation = bits >> GENERATION_SHIFT;
        if bits & ((1 << TAG_BITS) - 1) != self.tag || generation == 0 || generation > LAST_GENERATION as usize {
            return Err(Refused::Unknown);
        }
        let slot = self.slot((bits >> TAG_BITS) & ((1 << INDEX_BITS) - 1)).ok_or(Refused::Unknown)?;
        let free_word = (generation as u32) << 1;
        match slot.word.compare_exchange(free_word, free_word | TAKEN, Ordering::Acquire, Ordering::Relaxed) {
            Ok(_) => Ok((slot, free_word)),
            Err(word) if word == free_word | TAKEN => Err(Refused::Busy),
            Err(_) => Err(Refused::Unknown),
        }
    }

    #[inline(always)]
    fn slot(&self, index: usize) -> Option<&Slot<T>> {
        let (chunk, offset) = place(index);
        let Some(chunk) = chunk.checked_sub(1) else { return self.first.get(offset) };
        let start = self.chunks.get(chunk)?.load(Ordering::Acquire);
        if start.is_null() {
            return None;
        }
        // SAFETY: a chunk that is not null has as many initialised slots as `provide` made and is never freed;
        // `place` returns an offset below that.
        Some(unsafe { &*start.add(offset) })
    }

    /// Generation of a slot's first value: a number of its own for each slot and for each copy of the
    /// library (whose address is random where the system loads it so), so that neither a damaged handle
    /// nor one of another FMU is likely to fit.
    fn first_generation(&self, index: u32) -> u32 {
        let salt = (ptr::from_ref(self).addr() >> 4) as u32;
        let mixed = salt.wrapping_add(index).wrapping_mul(0x9e37_79b1);
        (mixed ^ (mixed >> 15)) % (LAST_GENERATION / 2) + 1
    }

    /// Allocates the chunk of slot `index` if necessary. Called under the lock.
    fn provide(&self, index: usize) {
        let (number, _) = place(index);
        let Some(chunk) = number.checked_sub(1) else { return };
        if !self.chunks[chunk].load(Ordering::Relaxed).is_null() {
            return;
        }
        let slots: Box<[Slot<T>]> = (0..FIRST << number).map(|_| Slot::vacant()).collect();
        self.chunks[chunk].store(Box::into_raw(slots).cast(), Ordering::Release);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counted(registry: &Registry<u64>, value: u64) -> *mut c_void {
        registry.insert(Box::new(value)).unwrap()
    }

    #[test]
    fn a_handle_reaches_its_own_value_and_no_other() {
        let registry = Registry::new(1);
        let handles: Vec<_> = (0..5000).map(|value| counted(&registry, value)).collect();
        for (value, &handle) in handles.iter().enumerate() {
            let mut guard = registry.acquire(handle).unwrap();
            assert_eq!(*guard, value as u64);
            *guard += 1;
        }
        for (value, &handle) in handles.iter().enumerate() {
            assert_eq!(*registry.remove(handle).unwrap(), value as u64 + 1);
        }
    }

    #[test]
    fn a_freed_handle_stays_dead_when_its_slot_is_used_again() {
        let registry = Registry::new(1);
        let first = counted(&registry, 1);
        assert_eq!(*registry.remove(first).unwrap(), 1);
        assert_eq!(registry.remove(first), Err(Refused::Unknown));
        let second = counted(&registry, 2);
        let index = |handle: *mut c_void| (handle.addr() >> TAG_BITS) & ((1 << INDEX_BITS) - 1);
        assert_eq!(index(first), index(second), "the slot is used again");
        assert_eq!(registry.acquire(first).err(), Some(Refused::Unknown));
        assert_eq!(*registry.acquire(second).unwrap(), 2);
    }

    #[test]
    fn a_handle_of_another_registry_is_unknown() {
        let (registry, other) = (Registry::new(1), Registry::new(3));
        counted(&registry, 1);
        assert_eq!(registry.acquire(counted(&other, 1)).err(), Some(Refused::Unknown));
    }

    #[test]
    fn a_slot_whose_generations_are_used_up_is_retired() {
        let registry = Registry::new(1);
        let handle = counted(&registry, 1);
        registry.remove(handle).unwrap();
        let vacant = registry.vacancies.lock().unwrap().again.unwrap();
        // SAFETY: no other thread uses the registry.
        unsafe { (*registry.slot(vacant as usize).unwrap().vacancy.get()).0 = LAST_GENERATION };
        let last = counted(&registry, 2);
        assert_eq!(*registry.remove(last).unwrap(), 2);
        assert_eq!(registry.remove(last), Err(Refused::Unknown));
        let next = counted(&registry, 3);
        assert_eq!((next.addr() >> TAG_BITS) & ((1 << INDEX_BITS) - 1), 1);
    }
}
