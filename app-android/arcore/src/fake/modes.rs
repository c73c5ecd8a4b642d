//! The fake's functions for the camera's modes, and for their filter.

#![expect(
    clippy::undocumented_unsafe_blocks,
    reason = "all write into places that the caller owns, as the table's signatures say"
)]

use super::super::ffi::*;
use super::world;

pub(super) unsafe extern "C" fn filter_create(
    session: *const ArSession,
    place: *mut *mut ArCameraConfigFilter,
) {
    world(|world| {
        world.used("session", session);
        world.is_filtered = false;
        unsafe { *place = world.make("filter", 0) };
    });
}

/// Functions that set one number of a filter.
macro_rules! filter {
    ($($name:ident($called:literal, $type:ty);)*) => {$(
        pub(super) unsafe extern "C" fn $name(session: *const ArSession, filter: *mut ArCameraConfigFilter, number: $type) {
            world(|world| {
                world.used("session", session);
                world.used("filter", filter);
                world.is_filtered = true;
                world.call(&format!("{}={number}", $called));
            });
        }
    )*};
}

filter! {
    filter_facing("facing", i32);
    filter_fps("fps", u32);
    filter_depth("depth", u32);
}

pub(super) unsafe extern "C" fn mode_facing(
    _: *const ArSession,
    mode: *const ArCameraConfig,
    facing: *mut i32,
) {
    let index = world(|world| world.used("mode", mode));
    unsafe { *facing = world(|world| i32::from(world.fronts.contains(&index))) };
}

pub(super) unsafe extern "C" fn supported_modes(
    _: *const ArSession,
    filter: *const ArCameraConfigFilter,
    list: *mut ArCameraConfigList,
) {
    world(|world| {
        world.used("filter", filter);
        world.used("modes", list);
    });
}

pub(super) unsafe extern "C" fn modes_item(
    _: *const ArSession,
    _: *const ArCameraConfigList,
    index: i32,
    mode: *mut ArCameraConfig,
) {
    world(|world| {
        let listed = world.listed();
        let entry = world.alive.get_mut(&mode.addr()).expect("a mode");
        entry.1 = listed[usize::try_from(index).unwrap()];
    });
}

pub(super) unsafe extern "C" fn mode_size(
    _: *const ArSession,
    mode: *const ArCameraConfig,
    width: *mut i32,
    height: *mut i32,
) {
    let index = world(|world| world.used("mode", mode));
    unsafe { [*width, *height] = world(|world| [world.modes[index][0], world.modes[index][1]]) };
}

pub(super) unsafe extern "C" fn mode_hz(
    _: *const ArSession,
    mode: *const ArCameraConfig,
    least: *mut i32,
    most: *mut i32,
) {
    let index = world(|world| world.used("mode", mode));
    unsafe { [*least, *most] = [15, world(|world| world.modes[index][2])] };
}

pub(super) unsafe extern "C" fn set_mode(_: *const ArSession, mode: *const ArCameraConfig) -> i32 {
    world(|world| {
        let index = world.used("mode", mode);
        world.call(&format!("mode={index}"));
        world.mode = index;
        world.status("mode")
    })
}
