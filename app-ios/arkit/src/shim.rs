//! Messages that return SIMD matrices, which exist in ARKit's classes but in no binding of them.
//!
//! On 64-bit ARM a `simd_float4x4` comes back in the registers v0 to v3 and a `simd_float3x3` in v0
//! to v2, as homogeneous vector aggregates (AAPCS64, 6.9). Rust takes every struct of that size
//! through the pointer in x8, which such a method never writes to; with Rust 1.100 that changes for
//! structs of vectors. The functions here are the same under both: they are called as if they
//! returned plain arrays, which go through x8 before and after, send the message on with all of its
//! arguments in their registers, and store what comes back. Arguments on the stack are not
//! supported.
//!
//! The file depends on nothing of Apple's, so that a test runs it in an emulator with a C function
//! as `objc_msgSend`.

use core::arch::aarch64::{float32x4_t, vld1q_f32};
use core::arch::naked_asm;
use core::ffi::c_void;

/// Columns of a `simd_float4x4`.
#[repr(C, align(16))]
#[derive(Clone, Copy)]
pub struct Columns4(pub [[f32; 4]; 4]);

/// Columns of a `simd_float3x3`, each with a fourth lane of undefined content.
#[repr(C, align(16))]
#[derive(Clone, Copy)]
pub struct Columns3(pub [[f32; 4]; 3]);

unsafe extern "C" {
    fn objc_msgSend();
}

/// Sends the message `selector` without arguments to `object`, for a `simd_float4x4`.
///
/// # Safety
/// `object` responds to `selector`, which has no arguments and returns a `simd_float4x4`.
pub unsafe fn columns4(object: *const c_void, selector: *const c_void) -> Columns4 {
    // SAFETY: the shim passes both on in x0 and x1, and fills all 64 bytes that x8 points to.
    let send = unsafe {
        core::mem::transmute::<
            unsafe extern "C-unwind" fn(),
            unsafe extern "C-unwind" fn(*const c_void, *const c_void) -> Columns4,
        >(send_for_four)
    };
    // SAFETY: guaranteed by this function's contract.
    unsafe { send(object, selector) }
}

/// Sends the message `selector` without arguments to `object`, for a `simd_float3x3`.
///
/// # Safety
/// `object` responds to `selector`, which has no arguments and returns a `simd_float3x3`.
pub unsafe fn columns3(object: *const c_void, selector: *const c_void) -> Columns3 {
    // SAFETY: the shim passes both on in x0 and x1, and fills all 48 bytes that x8 points to.
    let send = unsafe {
        core::mem::transmute::<
            unsafe extern "C-unwind" fn(),
            unsafe extern "C-unwind" fn(*const c_void, *const c_void) -> Columns3,
        >(send_for_three)
    };
    // SAFETY: guaranteed by this function's contract.
    unsafe { send(object, selector) }
}

/// Sends the message `selector` with a `simd_float4x4` to `object`, for a pointer.
///
/// # Safety
/// `object` responds to `selector`, whose argument is a `simd_float4x4` and which returns an
/// object, retained or not.
pub unsafe fn with4(object: *const c_void, selector: *const c_void, columns: &Columns4) -> *mut c_void {
    // A matrix argument occupies v0 to v3, as four vectors do. SAFETY: the message is passed on
    // unchanged, with both pointers in x0 and x1.
    let send = unsafe {
        core::mem::transmute::<
            unsafe extern "C" fn(),
            unsafe extern "C-unwind" fn(
                *const c_void,
                *const c_void,
                float32x4_t,
                float32x4_t,
                float32x4_t,
                float32x4_t,
            ) -> *mut c_void,
        >(objc_msgSend)
    };
    // SAFETY: every column has four lanes to load.
    let [a, b, c, d] = columns.0.map(|column| unsafe { vld1q_f32(column.as_ptr()) });
    // SAFETY: guaranteed by this function's contract.
    unsafe { send(object, selector, a, b, c, d) }
}

/// A message whose result is in v0 to v3. Only called with another signature, one that returns
/// through x8.
#[unsafe(naked)]
unsafe extern "C-unwind" fn send_for_four() {
    naked_asm!(
        ".cfi_startproc",
        "stp x29, x30, [sp, #-32]!",
        ".cfi_def_cfa_offset 32",
        ".cfi_offset x29, -32",
        ".cfi_offset x30, -24",
        "mov x29, sp",
        "str x8, [sp, #16]",
        "bl {send}",
        "ldr x8, [sp, #16]",
        "stp q0, q1, [x8]",
        "stp q2, q3, [x8, #32]",
        "ldp x29, x30, [sp], #32",
        "ret",
        ".cfi_endproc",
        send = sym objc_msgSend,
    )
}

/// A message whose result is in v0 to v2. Only called with another signature, one that returns
/// through x8.
#[unsafe(naked)]
unsafe extern "C-unwind" fn send_for_three() {
    naked_asm!(
        ".cfi_startproc",
        "stp x29, x30, [sp, #-32]!",
        ".cfi_def_cfa_offset 32",
        ".cfi_offset x29, -32",
        ".cfi_offset x30, -24",
        "mov x29, sp",
        "str x8, [sp, #16]",
        "bl {send}",
        "ldr x8, [sp, #16]",
        "stp q0, q1, [x8]",
        "str q2, [x8, #32]",
        "ldp x29, x30, [sp], #32",
        "ret",
        ".cfi_endproc",
        send = sym objc_msgSend,
    )
}
