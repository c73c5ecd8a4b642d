//! The fake's functions for tracked images.

#![expect(
    clippy::undocumented_unsafe_blocks,
    reason = "all write into places that the caller owns, as the table's signatures say"
)]

use std::ffi::{CStr, c_char};

use super::super::ffi::*;
use super::functions::plane_pose;
use super::world;

pub(super) unsafe extern "C" fn image_method(
    _: *const ArSession,
    image: *const ArAugmentedImage,
    method: *mut i32,
) {
    unsafe { *method = world(|world| world.plane(image.cast()).kind) };
}

pub(super) unsafe extern "C" fn image_pose(
    session: *const ArSession,
    image: *const ArAugmentedImage,
    pose: *mut ArPose,
) {
    unsafe { plane_pose(session, image.cast(), pose) };
}

pub(super) unsafe extern "C" fn add_image(
    session: *const ArSession,
    database: *mut ArAugmentedImageDatabase,
    name: *const c_char,
    codes: *const u8,
    width: i32,
    height: i32,
    stride: i32,
    width_m: f32,
    index: *mut i32,
) -> i32 {
    let name = unsafe { CStr::from_ptr(name) };
    let n_codes = usize::try_from(stride * height).unwrap();
    let codes = unsafe { std::slice::from_raw_parts(codes, n_codes) };
    let is_patterned = codes.contains(&0) && codes.contains(&255);
    world(|world| {
        world.used("session", session);
        world.used("database", database);
        world.call(&format!(
            "{}={width}x{height},{width_m},{is_patterned}",
            name.to_str().unwrap()
        ));
        unsafe { *index = 0 };
        world.status("add image")
    })
}

pub(super) unsafe extern "C" fn set_images(
    _: *const ArSession,
    config: *mut ArConfig,
    images: *const ArAugmentedImageDatabase,
) {
    world(|world| {
        world.used("config", config);
        world.used("database", images);
        world.call("images");
        world.config.insert("images", 1);
    });
}
