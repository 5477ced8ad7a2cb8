//! Recording of a scene's outputs: one call per type of variable and communication point.

use crate::description::{Kind, Variable};
use crate::error::{Failure, Stage};
use crate::functions::{Handle, Status};
use std::ffi::c_int;

/// The recorded variables of one type.
struct Group<T> {
    references: Vec<u32>,
    /// Positions of their values in a row.
    columns: Vec<usize>,
    values: Vec<T>,
}

impl<T: Copy + Default> Group<T> {
    fn of(variables: &[&Variable], wanted: impl Fn(&Kind) -> bool) -> Self {
        let columns: Vec<usize> = (0..variables.len()).filter(|&column| wanted(&variables[column].kind)).collect();
        Self {
            references: columns.iter().map(|&column| variables[column].reference).collect(),
            values: vec![T::default(); columns.len()],
            columns,
        }
    }

    /// Gets the values and puts them into the row. A group without variables makes no call and returns 0, `fmi2OK`.
    #[inline]
    fn get(
        &mut self,
        function: unsafe extern "C" fn(Handle, *const u32, usize, *mut T) -> Status,
        handle: Handle,
        row: &mut [f64],
    ) -> Status
    where
        f64: From<T>,
    {
        if self.references.is_empty() {
            return 0;
        }
        // SAFETY: the handle is alive, as `Recording::add` asks, and both arrays have the length given.
        let status =
            unsafe { function(handle, self.references.as_ptr(), self.references.len(), self.values.as_mut_ptr()) };
        for (&column, &value) in self.columns.iter().zip(&self.values) {
            row[column] = value.into();
        }
        status
    }
}

pub(super) struct Getters {
    pub real: unsafe extern "C" fn(Handle, *const u32, usize, *mut f64) -> Status,
    pub integer: unsafe extern "C" fn(Handle, *const u32, usize, *mut c_int) -> Status,
    pub boolean: unsafe extern "C" fn(Handle, *const u32, usize, *mut c_int) -> Status,
}

pub(super) struct Recording<'a> {
    names: &'a [&'a str],
    reals: Group<f64>,
    integers: Group<c_int>,
    booleans: Group<c_int>,
    rows: Vec<f64>,
}

impl<'a> Recording<'a> {
    /// For as many rows as there are points; `names` are those of the variables. None of them may be a text.
    pub(crate) fn new(names: &'a [&'a str], variables: &[&Variable], points: usize) -> Self {
        Self {
            names,
            reals: Group::of(variables, |kind| *kind == Kind::Real),
            integers: Group::of(variables, |kind| matches!(kind, Kind::Integer | Kind::Enumeration(_))),
            booleans: Group::of(variables, |kind| *kind == Kind::Boolean),
            rows: Vec::with_capacity(points * names.len()),
        }
    }

    /// Appends the variables as they are now and returns the highest status of the calls; the row is meant only where
    /// that is no failure.
    ///
    /// # Safety
    /// The getters are those of the library that the handle came from, and the handle is alive.
    #[inline]
    pub(crate) unsafe fn add(&mut self, getters: &Getters, handle: Handle) -> Status {
        let base = self.rows.len();
        self.rows.resize(base + self.names.len(), f64::NAN);
        let row = &mut self.rows[base..];
        let mut status = self.reals.get(getters.real, handle, row);
        // After a fatal error nothing may be called.
        for (group, getter) in [(&mut self.integers, getters.integer), (&mut self.booleans, getters.boolean)] {
            if status <= crate::functions::WARNING {
                status = status.max(group.get(getter, handle, row));
            }
        }
        status
    }

    /// Checks that the last row holds numbers.
    pub(crate) fn check(&self, time: f64) -> Result<(), Failure> {
        let row = &self.rows[self.rows.len() - self.names.len()..];
        match row.iter().position(|value| !value.is_finite()) {
            None => Ok(()),
            Some(at) => Err(Failure::new(Stage::Stepping, format!("{} is {} at {time} s", self.names[at], row[at]))),
        }
    }

    /// All rows, one after the other.
    pub(crate) fn into_rows(self) -> Vec<f64> {
        self.rows
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::Causality;
    use std::cell::Cell;
    use std::ptr;

    thread_local! {
        static CALLS: Cell<usize> = const { Cell::new(0) };
    }

    /// A getter that returns the number of every reference and counts its calls.
    unsafe extern "C" fn number<T: From<u8>>(
        _: Handle,
        references: *const u32,
        count: usize,
        values: *mut T,
    ) -> Status {
        CALLS.set(CALLS.get() + 1);
        for at in 0..count {
            // SAFETY: the caller gives arrays of this length.
            unsafe { *values.add(at) = T::from(u8::try_from(*references.add(at)).unwrap()) };
        }
        0
    }

    unsafe extern "C" fn nothing(_: Handle, _: *const u32, _: usize, values: *mut f64) -> Status {
        // SAFETY: there is room for at least one value.
        unsafe { *values = f64::NAN };
        0
    }

    unsafe extern "C" fn fatal(_: Handle, _: *const u32, _: usize, _: *mut f64) -> Status {
        crate::functions::FATAL
    }

    fn variable(reference: u32, kind: Kind) -> Variable {
        Variable {
            name: format!("v{reference}"),
            reference,
            kind,
            causality: Causality::Output,
            unit: String::new(),
            start: String::new(),
        }
    }

    const GETTERS: Getters = Getters { real: number::<f64>, integer: number::<c_int>, boolean: number::<c_int> };

    #[test]
    fn a_row_takes_one_call_per_type_and_keeps_the_order() {
        let kinds = [Kind::Integer, Kind::Real, Kind::Boolean, Kind::Real, Kind::Enumeration(Vec::new())];
        let variables: Vec<Variable> = (1..).zip(kinds).map(|(reference, kind)| variable(reference, kind)).collect();
        let names = ["a", "b", "c", "d", "e"];
        let mut recording = Recording::new(&names, &variables.iter().collect::<Vec<_>>(), 2);
        for _ in 0..2 {
            // SAFETY: these getters do not look at the handle; so below.
            assert_eq!(unsafe { recording.add(&GETTERS, ptr::null_mut()) }, 0);
            recording.check(0.0).unwrap();
        }
        assert_eq!(CALLS.get(), 6);
        assert_eq!(recording.into_rows(), [1.0, 2.0, 3.0, 4.0, 5.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
    }

    #[test]
    fn what_is_no_number_is_told_with_its_name() {
        let (real, names) = (variable(7, Kind::Real), ["wear_depth"]);
        let mut recording = Recording::new(&names, &[&real], 1);
        // SAFETY: see above.
        assert_eq!(unsafe { recording.add(&Getters { real: nothing, ..GETTERS }, ptr::null_mut()) }, 0);
        assert!(recording.check(3.5).unwrap_err().reason.contains("wear_depth is NaN at 3.5 s"));
    }

    #[test]
    fn nothing_is_called_after_a_fatal_error() {
        let variables = [variable(1, Kind::Real), variable(2, Kind::Integer)];
        let mut recording = Recording::new(&["a", "b"], &variables.iter().collect::<Vec<_>>(), 1);
        let before = CALLS.get();
        // SAFETY: see above.
        let status = unsafe { recording.add(&Getters { real: fatal, ..GETTERS }, ptr::null_mut()) };
        assert_eq!((status, CALLS.get()), (crate::functions::FATAL, before));
    }
}
