//! Log messages of the FMU.

use crate::functions::{Status, WARNING};
use std::cell::RefCell;
use std::ffi::{CStr, c_char, c_void};

/// Longest stored log, bytes; longer ones are cut.
const LONGEST_LOG: usize = 4096;

/// The FMU's logger: stores messages about failures.
///
/// # Safety
/// `environment` is the log of a living worker; the texts end with a zero.
pub(super) unsafe extern "C" fn keep_message(
    environment: *mut c_void,
    _instance: *const c_char,
    status: Status,
    _category: *const c_char,
    format: *const c_char,
    argument: *const c_char,
) {
    // Only messages about failed calls: an earlier warning is not the reason of a later failure.
    if status <= WARNING || environment.is_null() || format.is_null() {
        return;
    }
    // SAFETY: the worker handed out this address and outlives its instance.
    let log = unsafe { &*environment.cast::<RefCell<String>>() };
    // SAFETY: see above.
    let format = unsafe { CStr::from_ptr(format) };
    let has_argument = cfg!(not(all(target_vendor = "apple", target_arch = "aarch64")));
    let text = if has_argument && format == c"%s" && !argument.is_null() {
        // SAFETY: the format says that the argument is a text.
        unsafe { CStr::from_ptr(argument) }
    } else {
        // Formats with other arguments are stored unexpanded, since the types of their arguments are unknown.
        format
    };
    // Importers expand `#r12#` to a variable's name, so a plain `#` arrives doubled.
    let text = text.to_string_lossy().replace("##", "#");
    if let Ok(mut log) = log.try_borrow_mut() {
        if !log.is_empty() {
            log.push(' ');
        }
        let room = LONGEST_LOG.saturating_sub(log.len());
        log.push_str(&text[..text.floor_char_boundary(room)]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::ffi::CString;
    use std::ptr;

    #[test]
    fn messages_are_collected_and_cut() {
        let log = RefCell::new(String::new());
        let tell = |format: &CStr, text: &CStr| {
            let environment = ptr::from_ref(&log).cast_mut().cast::<c_void>();
            // SAFETY: all texts end with a zero and the environment is a log.
            unsafe { keep_message(environment, ptr::null(), 3, ptr::null(), format.as_ptr(), text.as_ptr()) };
        };
        // SAFETY: as above.
        unsafe {
            keep_message(
                ptr::from_ref(&log).cast_mut().cast(),
                ptr::null(),
                WARNING,
                ptr::null(),
                c"%s".as_ptr(),
                c"open".as_ptr(),
            )
        };
        assert_eq!(*log.borrow(), "");
        tell(c"%s", c"punch.width = ##1");
        tell(c"plain", c"unused");
        assert_eq!(*log.borrow(), "punch.width = #1 plain");
        tell(c"%s", &CString::new("é".repeat(LONGEST_LOG)).unwrap());
        assert!(log.borrow().len() <= LONGEST_LOG);
    }
}
