//! ARCore's library, loaded while the app runs.

use std::ffi::{CStr, c_char, c_int, c_void};

use super::ffi::{Functions, MissingFunction};

const NAME: &CStr = c"libarcore_sdk_c.so";
/// `RTLD_NOW`.
const NOW: c_int = 2;

unsafe extern "C" {
    fn dlopen(name: *const c_char, mode: c_int) -> *mut c_void;
    fn dlsym(library: *mut c_void, name: *const c_char) -> *mut c_void;
}

/// The reason why ARCore's functions are missing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LoadError {
    /// The package was built without it.
    #[error("the app was packaged without ARCore's library")]
    NoLibrary,
    /// Its version differs from the one for which the app was built.
    #[error(transparent)]
    Function(#[from] MissingFunction),
}

/// Loads the library for as long as the process lives, and looks up its functions.
///
/// # Errors
/// If the library or one of its functions is missing.
pub fn load() -> Result<Functions, LoadError> {
    // SAFETY: the name ends with a zero. The code that runs while the library is loaded is Google's
    // own, made for that.
    let library = unsafe { dlopen(NAME.as_ptr(), NOW) };
    if library.is_null() {
        return Err(LoadError::NoLibrary);
    }
    // SAFETY: the library is never closed, and its functions are those of its header, with which
    // the table is compared.
    Ok(unsafe { Functions::look_up(|name| dlsym(library, name.as_ptr()).cast_const()) }?)
}
