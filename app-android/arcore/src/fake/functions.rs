//! The fake's functions in C, without those for images.

#![expect(
    clippy::undocumented_unsafe_blocks,
    reason = "all write into places that the caller owns, as the table's signatures say"
)]

use std::ffi::c_void;

use super::super::ffi::*;
use super::{IMAGES, World, world};

/// First number of a pose that was given.
const GIVEN: usize = 1000;

macro_rules! give_back {
    ($($name:ident($kind:literal, $type:ty);)*) => {$(
        pub(super) unsafe extern "C" fn $name(object: *mut $type) {
            world(|world| world.give_back($kind, object));
        }
    )*};
}

give_back! {
    session_destroy("session", ArSession);
    filter_destroy("filter", ArCameraConfigFilter);
    modes_destroy("modes", ArCameraConfigList);
    mode_destroy("mode", ArCameraConfig);
    config_destroy("config", ArConfig);
    frame_destroy("frame", ArFrame);
    camera_release("camera", ArCamera);
    intrinsics_destroy("intrinsics", ArCameraIntrinsics);
    pose_destroy("pose", ArPose);
    image_release("image", ArImage);
    metadata_release("metadata", ArImageMetadata);
    list_destroy("list", ArTrackableList);
    trackable_release("plane", ArTrackable);
    anchor_release("anchor", ArAnchor);
    database_destroy("database", ArAugmentedImageDatabase);
}

macro_rules! create {
    ($($name:ident($kind:literal, $type:ty);)*) => {$(
        pub(super) unsafe extern "C" fn $name(session: *const ArSession, place: *mut *mut $type) {
            world(|world| {
                world.used("session", session);
                unsafe { *place = world.make($kind, 0) };
            });
        }
    )*};
}

create! {
    modes_create("modes", ArCameraConfigList);
    mode_create("mode", ArCameraConfig);
    frame_create("frame", ArFrame);
    intrinsics_create("intrinsics", ArCameraIntrinsics);
    list_create("list", ArTrackableList);
    database_create("database", ArAugmentedImageDatabase);
}

/// Functions that write properties of an object to output arguments.
macro_rules! get {
    ($($name:ident($kind:literal, $object:ty, $($place:ident: $type:ty),+) $write:expr;)*) => {$(
        pub(super) unsafe extern "C" fn $name(session: *const ArSession, object: *const $object, $($place: *mut $type),+) {
            world(|world| {
                world.used("session", session);
                world.used($kind, object);
                let write: fn(&World, $(&mut $type),+) = $write;
                unsafe { write(world, $(&mut *$place),+) };
            });
        }
    )*};
}

get! {
    frame_time("frame", ArFrame, time: i64) |world, time| *time = world.time_ns;
    camera_state("camera", ArCamera, state: i32) |world, state| *state = world.tracking.0;
    anchor_state("anchor", ArAnchor, state: i32) |world, state| *state = world.anchor_state;
    camera_reason("camera", ArCamera, reason: i32) |world, reason| *reason = world.tracking.1;
    focal_length("intrinsics", ArCameraIntrinsics, x: f32, y: f32) |world, x, y| [*x, *y] = [world.intrinsics[0], world.intrinsics[1]];
    principal_point("intrinsics", ArCameraIntrinsics, x: f32, y: f32) |world, x, y| [*x, *y] = [world.intrinsics[2], world.intrinsics[3]];
    dimensions("intrinsics", ArCameraIntrinsics, x: i32, y: i32) |world, x, y| [*x, *y] = world.size_px;
    image_width("image", ArImage, width: i32) |world, width| *width = world.size_px[0];
    image_height("image", ArImage, height: i32) |world, height| *height = world.size_px[1];
    image_format("image", ArImage, format: i32) |world, format| *format = world.format;
    image_planes("image", ArImage, n: i32) |world, n| *n = i32::try_from(world.image.len()).unwrap();
    modes_size("modes", ArCameraConfigList, n: i32) |world, n| *n = i32::try_from(world.listed().len()).unwrap();
    list_size("list", ArTrackableList, n: i32) |world, n| {
        let listed = if world.lists_images { &world.images } else { &world.planes };
        *n = i32::try_from(listed.len()).unwrap();
    };
}

/// Functions of one component of an image.
macro_rules! of_plane {
    ($($name:ident($($place:ident: $type:ty),+) $write:expr;)*) => {$(
        pub(super) unsafe extern "C" fn $name(session: *const ArSession, image: *const ArImage, index: i32, $($place: *mut $type),+) {
            world(|world| {
                world.used("session", session);
                world.used("image", image);
                let write: fn(&(Vec<u8>, i32, i32), $(&mut $type),+) = $write;
                unsafe { write(&world.image[usize::try_from(index).unwrap()], $(&mut *$place),+) };
            });
        }
    )*};
}

of_plane! {
    plane_data(data: *const u8, n: i32) |plane, data, n| {
        (*data, *n) = (plane.0.as_ptr(), i32::try_from(plane.0.len()).unwrap());
    };
    plane_row_stride(stride: i32) |plane, stride| *stride = plane.1;
    plane_pixel_stride(stride: i32) |plane, stride| *stride = plane.2;
}

/// Functions that only record their calls, and may fail.
macro_rules! act {
    ($($name:ident($called:literal, $($argument:ty),*);)*) => {$(
        pub(super) unsafe extern "C" fn $name(session: *mut ArSession, $(_: $argument),*) -> i32 {
            world(|world| {
                world.used("session", session);
                world.call($called);
                world.status($called)
            })
        }
    )*};
}

act! {
    session_resume("resume",);
    session_update("update", *mut ArFrame);
}

/// Functions that set one number of a configuration.
macro_rules! set {
    ($($name:ident($called:literal);)*) => {$(
        pub(super) unsafe extern "C" fn $name(_: *const ArSession, config: *mut ArConfig, number: i32) {
            world(|world| {
                world.used("config", config);
                world.call(&format!("{}={number}", $called));
                world.config.insert($called, number);
            });
        }
    )*};
}

set! {
    set_update("update");
    set_planes("planes");
    set_light("light");
    set_focus("focus");
    set_texture("texture");
}

pub(super) unsafe extern "C" fn session_pause(session: *mut ArSession) -> i32 {
    world(|world| {
        world.used("session", session);
        world.call("pause");
        world.stuck_focus = world.stuck_focus.saturating_sub(1);
        world.status("pause")
    })
}

pub(super) unsafe extern "C" fn config_create(session: *const ArSession, place: *mut *mut ArConfig) {
    world(|world| {
        world.used("session", session);
        world.config.clear();
        unsafe { *place = world.make("config", 0) };
    });
}

pub(super) unsafe extern "C" fn check_availability(
    env: *mut c_void,
    activity: *mut c_void,
    answer: *mut i32,
) {
    assert!(!env.is_null() && !activity.is_null());
    let next = world(|world| {
        world.call("availability");
        let is_last = world.availability.len() == 1;
        if is_last {
            world.availability[0]
        } else {
            world.availability.remove(0)
        }
    });
    unsafe { *answer = next };
}

pub(super) unsafe extern "C" fn request_install(
    _: *mut c_void,
    _: *mut c_void,
    asked: i32,
    outcome: *mut i32,
) -> i32 {
    let (status, installed) = world(|world| {
        world.call(&format!("install={asked}"));
        world.install
    });
    unsafe { *outcome = installed };
    status
}

pub(super) unsafe extern "C" fn session_create(
    _: *mut c_void,
    _: *mut c_void,
    place: *mut *mut ArSession,
) -> i32 {
    world(|world| {
        world.call("create");
        let status = world.status("create");
        if status == 0 {
            unsafe { *place = world.make("session", 0) };
        }
        status
    })
}

pub(super) unsafe extern "C" fn session_configure(session: *mut ArSession, config: *const ArConfig) -> i32 {
    world(|world| {
        world.used("session", session);
        world.used("config", config);
        world.call("configure");
        let is_refused = |(name, value): &(&str, i32)| world.config.get(name) == Some(value);
        if world.refuses.iter().any(is_refused) {
            return -8;
        }
        world.status("configure")
    })
}

pub(super) unsafe extern "C" fn set_display(_: *mut ArSession, rotation: i32, width: i32, height: i32) {
    world(|world| world.call(&format!("display={rotation},{width},{height}")));
}

pub(super) unsafe extern "C" fn acquire_camera(
    _: *const ArSession,
    frame: *const ArFrame,
    place: *mut *mut ArCamera,
) {
    world(|world| {
        world.used("frame", frame);
        unsafe { *place = world.make("camera", 0) };
    });
}

pub(super) unsafe extern "C" fn acquire_image(
    _: *mut ArSession,
    frame: *mut ArFrame,
    place: *mut *mut ArImage,
) -> i32 {
    world(|world| {
        world.used("frame", frame.cast_const());
        let is_silent = world.silent.contains(&world.mode);
        let status = if is_silent { -12 } else { world.status("image") };
        if status == 0 {
            unsafe { *place = world.make("image", 0) };
        }
        status
    })
}

pub(super) unsafe extern "C" fn acquire_metadata(
    _: *const ArSession,
    frame: *const ArFrame,
    place: *mut *mut ArImageMetadata,
) -> i32 {
    world(|world| {
        world.used("frame", frame);
        let status = world.status("metadata");
        if status == 0 {
            unsafe { *place = world.make("metadata", 0) };
        }
        status
    })
}

pub(super) unsafe extern "C" fn metadata_entry(
    _: *const ArSession,
    metadata: *const ArImageMetadata,
    tag: u32,
    entry: *mut ArImageMetadata_const_entry,
) -> i32 {
    world(|world| {
        world.used("metadata", metadata);
        // Autofocus is the mode of continuous focus for videos, once it works.
        world.focus_mode = if world.stuck_focus > 0 { 0 } else { 3 };
        let (kind, data): (u8, *const u8) = match tag {
            0xE_0000 => (3, (&raw const world.exposure.0).cast()),
            0xE_0002 => (world.exposure.2, (&raw const world.exposure.1).cast()),
            0x1_0007 => (0, &raw const world.focus_mode),
            _ => return -1,
        };
        let count = 1;
        unsafe {
            *entry = ArImageMetadata_const_entry {
                tag,
                kind,
                count,
                data,
            }
        };
        0
    })
}

pub(super) unsafe extern "C" fn camera_pose(_: *const ArSession, _: *const ArCamera, pose: *mut ArPose) {
    world(|world| world.alive.get_mut(&pose.addr()).expect("a pose").1 = 0);
}

pub(super) unsafe extern "C" fn camera_display_pose(
    _: *const ArSession,
    camera: *const ArCamera,
    pose: *mut ArPose,
) {
    world(|world| {
        world.used("camera", camera);
        world.alive.get_mut(&pose.addr()).expect("a pose").1 = DISPLAY;
    });
}

pub(super) unsafe extern "C" fn camera_intrinsics(
    _: *const ArSession,
    camera: *const ArCamera,
    place: *mut ArCameraIntrinsics,
) {
    world(|world| {
        world.used("camera", camera);
        world.used("intrinsics", place);
    });
}

pub(super) unsafe extern "C" fn pose_create(_: *const ArSession, raw: *const f32, place: *mut *mut ArPose) {
    let raw: Option<&[f32; 7]> = unsafe { raw.cast::<[f32; 7]>().as_ref() };
    world(|world| {
        let stands_for = raw.map_or(0, |raw| {
            world.given.push(*raw);
            GIVEN + world.given.len() - 1
        });
        unsafe { *place = world.make("pose", stands_for) };
    });
}

/// Number of the pose of the camera in the display's axes.
const DISPLAY: usize = usize::MAX;

/// A pose's number is 0 for the camera, one more than its index for a plane, or from [`GIVEN`] on
/// for a given pose.
pub(super) unsafe extern "C" fn pose_raw(_: *const ArSession, pose: *const ArPose, numbers: *mut f32) {
    let raw = world(|world| match world.used("pose", pose) {
        0 => world.pose,
        DISPLAY => world.display_pose(),
        given @ GIVEN.. => world.given[given - GIVEN],
        plane => world.trackable(plane - 1).pose,
    });
    unsafe { numbers.cast::<[f32; 7]>().write(raw) };
}

pub(super) unsafe extern "C" fn all_trackables(_: *const ArSession, kind: i32, list: *mut ArTrackableList) {
    world(|world| {
        world.used("list", list);
        world.lists_images = kind == 0x4152_0104;
        assert!(world.lists_images || kind == 0x4152_0101, "{kind:#x}");
    });
}

pub(super) unsafe extern "C" fn list_item(
    _: *const ArSession,
    _: *const ArTrackableList,
    index: i32,
    place: *mut *mut ArTrackable,
) {
    let index = usize::try_from(index).unwrap();
    unsafe {
        *place = world(|world| {
            let first = if world.lists_images { IMAGES } else { 0 };
            world.make("plane", first + index)
        });
    }
}

pub(super) unsafe extern "C" fn trackable_state(
    _: *const ArSession,
    plane: *const ArTrackable,
    state: *mut i32,
) {
    unsafe { *state = world(|world| world.plane(plane.cast()).state) };
}

pub(super) unsafe extern "C" fn plane_kind(_: *const ArSession, plane: *const ArPlane, kind: *mut i32) {
    unsafe { *kind = world(|world| world.plane(plane).kind) };
}

pub(super) unsafe extern "C" fn plane_pose(_: *const ArSession, plane: *const ArPlane, pose: *mut ArPose) {
    world(|world| {
        let index = world.used("plane", plane);
        world.alive.get_mut(&pose.addr()).expect("a pose").1 = 1 + index;
    });
}

pub(super) unsafe extern "C" fn polygon_size(_: *const ArSession, plane: *const ArPlane, n: *mut i32) {
    unsafe { *n = i32::try_from(world(|world| world.plane(plane).outline.len())).unwrap() };
}

pub(super) unsafe extern "C" fn polygon(_: *const ArSession, plane: *const ArPlane, numbers: *mut f32) {
    let outline = world(|world| world.plane(plane).outline);
    unsafe { numbers.copy_from_nonoverlapping(outline.as_ptr(), outline.len()) };
}

pub(super) unsafe extern "C" fn acquire_anchor(
    session: *mut ArSession,
    pose: *const ArPose,
    place: *mut *mut ArAnchor,
) -> i32 {
    world(|world| {
        world.used("session", session);
        let stands_for = world.used("pose", pose);
        world.call("anchor");
        let status = world.status("anchor");
        if status == 0 {
            unsafe { *place = world.make("anchor", stands_for) };
        }
        status
    })
}

pub(super) unsafe extern "C" fn anchor_detach(session: *mut ArSession, anchor: *mut ArAnchor) {
    world(|world| {
        world.used("session", session);
        world.used("anchor", anchor);
        world.call("detach");
    });
}

pub(super) unsafe extern "C" fn anchor_pose(_: *const ArSession, anchor: *const ArAnchor, pose: *mut ArPose) {
    world(|world| {
        let at = world.used("anchor", anchor);
        world.alive.get_mut(&pose.addr()).expect("a pose").1 = at;
    });
}
