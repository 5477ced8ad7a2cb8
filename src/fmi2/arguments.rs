//! Arrays of the importer, read and written element by element.
//!
//! They are not slices, because alignment, disjointness and the absence of concurrent writes by other threads
//! of the importer are not guaranteed.

use core::marker::PhantomData;

use super::problem::{Problem, argument};
use scene::variables::COUNT;

/// Most elements of an array of variables: each once. A larger number is an uninitialised one.
pub(crate) const MOST_VARIABLES: usize = COUNT;

/// An input array in the importer's memory.
#[derive(Clone, Copy)]
pub(crate) struct Source<'a, T> {
    start: *const T,
    count: usize,
    lifetime: PhantomData<&'a T>,
}

/// An output array in the importer's memory.
#[derive(Clone, Copy)]
pub(crate) struct Sink<'a, T> {
    start: *mut T,
    count: usize,
    lifetime: PhantomData<&'a T>,
}

#[inline(always)]
fn check(what: &str, null: bool, count: usize, most: usize) -> Result<(), Problem> {
    if null && count > 0 {
        return argument(format!("{what} is NULL, but has {count} elements"));
    }
    if count > most {
        return argument(format!("{what} has {count} elements; there can be {most} at most"));
    }
    Ok(())
}

impl<T: Copy> Source<'_, T> {
    /// An array of `count` elements; `what` names it in messages.
    ///
    /// # Errors
    /// It is NULL with elements, or has more than `most`.
    ///
    /// # Safety
    /// If `start` is not NULL and `count` is at most `most`, `count` elements can be read there for as
    /// long as the value is used.
    #[inline(always)]
    pub(crate) unsafe fn new(what: &str, start: *const T, count: usize, most: usize) -> Result<Self, Problem> {
        check(what, start.is_null(), count, most.min(isize::MAX as usize / size_of::<T>()))?;
        Ok(Source { start, count, lifetime: PhantomData })
    }

    /// Number of elements.
    #[inline(always)]
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// Element `index`.
    #[inline(always)]
    pub(crate) fn at(&self, index: usize) -> T {
        assert!(index < self.count);
        // SAFETY: `new`'s caller vouched for `count` elements; `T` is a number or a pointer, which any
        // bytes are a value of.
        unsafe { self.start.add(index).read_unaligned() }
    }

    /// Replaces the contents of `copy` by the elements.
    pub(crate) fn copy_into(&self, copy: &mut Vec<T>) {
        copy.clear();
        copy.extend((0..self.count).map(|index| self.at(index)));
    }
}

impl<T: Copy> Sink<'_, T> {
    /// As [`Source::new`].
    ///
    /// # Safety
    /// As [`Source::new`], and the elements can be written.
    #[inline(always)]
    pub(crate) unsafe fn new(what: &str, start: *mut T, count: usize, most: usize) -> Result<Self, Problem> {
        check(what, start.is_null(), count, most.min(isize::MAX as usize / size_of::<T>()))?;
        Ok(Sink { start, count, lifetime: PhantomData })
    }

    /// Number of elements.
    #[inline(always)]
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// Writes element `index`.
    #[inline(always)]
    pub(crate) fn put(&self, index: usize, value: T) {
        assert!(index < self.count);
        // SAFETY: `new`'s caller vouched for `count` elements that can be written.
        unsafe { self.start.add(index).write_unaligned(value) }
    }

    /// Writes the first elements.
    pub(crate) fn put_all(&self, values: &[T]) {
        values.iter().enumerate().for_each(|(index, &value)| self.put(index, value));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(start: *const f64, count: usize) -> Result<Source<'static, f64>, Problem> {
        // SAFETY: nothing is read in this test but the arrays that are there.
        unsafe { Source::new("value", start, count, usize::MAX) }
    }

    #[test]
    fn null_is_fine_without_elements_only() {
        assert_eq!(source(core::ptr::null(), 0).unwrap().count(), 0);
        assert!(source(core::ptr::null(), 1).is_err_and(|problem| problem.text.contains("NULL")));
    }

    #[test]
    fn lengths_that_no_memory_can_have_are_refused() {
        let value = 1.0;
        for count in [usize::MAX, usize::MAX / 8, isize::MAX as usize / 8 + 1] {
            assert!(source(&value, count).is_err(), "{count}");
        }
        assert_eq!(source(&value, 1).unwrap().at(0), 1.0);
    }

    #[test]
    fn arrays_need_no_alignment() {
        let mut bytes = [0_u8; 17];
        let odd = bytes[1..].as_mut_ptr().cast::<f64>();
        // SAFETY: 16 bytes are there.
        let (sink, source) = unsafe { (Sink::new("", odd, 2, 2).unwrap(), Source::new("", odd, 2, 2).unwrap()) };
        sink.put(1, 2.5);
        assert_eq!((source.at(0), source.at(1)), (0.0, 2.5));
        let mut copy = vec![9.0; 7];
        source.copy_into(&mut copy);
        assert_eq!(copy, [0.0, 2.5]);
    }
}
