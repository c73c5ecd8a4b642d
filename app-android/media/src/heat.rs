//! The phone's temperature state, by functions of Android 11 that are looked up while the app runs,
//! since older phones lack them.

use std::ffi::{c_char, c_int, c_void};
use std::ptr::NonNull;

/// `RTLD_NOW`.
const NOW: c_int = 2;

unsafe extern "C" {
    fn dlopen(name: *const c_char, mode: c_int) -> *mut c_void;
    fn dlsym(library: *mut c_void, name: *const c_char) -> *mut c_void;
}

/// `AThermal_acquireManager`.
type Acquire = unsafe extern "C" fn() -> *mut c_void;
/// `AThermal_getCurrentThermalStatus`.
type Status = unsafe extern "C" fn(*mut c_void) -> c_int;

/// The thermal manager, for as long as the process lives.
#[derive(Debug)]
pub struct Thermometer {
    manager: NonNull<c_void>,
    status: Status,
}

impl Thermometer {
    /// Returns `None` before Android 11.
    #[must_use]
    pub fn find() -> Option<Self> {
        // SAFETY: the name ends with a zero; the system's own library is loaded already.
        let library = NonNull::new(unsafe { dlopen(c"libandroid.so".as_ptr(), NOW) })?;
        let look_up = |name: &std::ffi::CStr| {
            // SAFETY: the library is never closed, and the name ends with a zero.
            NonNull::new(unsafe { dlsym(library.as_ptr(), name.as_ptr()) })
        };
        let acquire = look_up(c"AThermal_acquireManager")?;
        let status = look_up(c"AThermal_getCurrentThermalStatus")?;
        // SAFETY: these names have these signatures in Android's thermal.h, since API level 30.
        let (acquire, status) = unsafe {
            (
                std::mem::transmute::<*mut c_void, Acquire>(acquire.as_ptr()),
                std::mem::transmute::<*mut c_void, Status>(status.as_ptr()),
            )
        };
        // SAFETY: it has no arguments.
        let manager = NonNull::new(unsafe { acquire() })?;
        Some(Self { manager, status })
    }

    /// An `AThermalStatus`.
    #[must_use]
    pub fn status(&self) -> i32 {
        // SAFETY: the manager is never released.
        unsafe { (self.status)(self.manager.as_ptr()) }
    }
}
