//! The shim for an emulator: only the shim, and C functions that call it.

#![no_std]
#![allow(missing_docs, reason = "called from mock.c alone")]
#![allow(
    clashing_extern_declarations,
    reason = "the control declares what the shim is there for"
)]

#[path = "../../src/shim.rs"]
mod shim;

use core::ffi::c_void;

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {}
}

/// The control: the same message as Rust would send it by itself.
///
/// # Safety
/// As for the shim.
#[unsafe(no_mangle)]
unsafe extern "C" fn ask_for_four_without(
    object: *const c_void,
    selector: *const c_void,
    to: *mut shim::Columns4,
) {
    unsafe extern "C" {
        #[link_name = "objc_msgSend"]
        fn send(object: *const c_void, selector: *const c_void) -> shim::Columns4;
    }
    unsafe { *to = send(object, selector) };
}

/// # Safety
/// As for the shim.
#[unsafe(no_mangle)]
unsafe extern "C" fn ask_for_four(object: *const c_void, selector: *const c_void, to: *mut shim::Columns4) {
    unsafe { *to = shim::columns4(object, selector) };
}

/// # Safety
/// As for the shim.
#[unsafe(no_mangle)]
unsafe extern "C" fn ask_for_three(object: *const c_void, selector: *const c_void, to: *mut shim::Columns3) {
    unsafe { *to = shim::columns3(object, selector) };
}

/// # Safety
/// As for the shim.
#[unsafe(no_mangle)]
unsafe extern "C" fn hand_over_four(
    object: *const c_void,
    selector: *const c_void,
    from: *const shim::Columns4,
) -> *mut c_void {
    unsafe { shim::with4(object, selector, &*from) }
}
