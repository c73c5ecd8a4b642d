//! Foxglove's messages of a frame, for viewers: its picture, its camera, the poses of camera and
//! toy.
//!
//! The session reader ignores them: they repeat the frame's entry in a viewer's form.

use glam::{DMat3, DMat4, DQuat, DVec3};
use serde::Deserialize;

use super::protobuf::{Fields, counted_field, timestamp};
use crate::record::IntrinsicsRecord;

/// Names of coordinate frames. The camera's is that of its optics: x right, y down, z forward.
const WORLD: &str = "world";
const CAMERA: &str = "camera";
const TOY: &str = "toy";
/// Field of `foxglove.CompressedImage` with the file.
const DATA: u64 = 2;

/// The part of a session's index that viewers receive. Missing or invalid values are left out.
#[derive(Clone, Copy, Default, Deserialize)]
pub(super) struct SessionShape {
    width: Option<u32>,
    height: Option<u32>,
    intrinsics: Option<IntrinsicsRecord>,
    toy: Option<ToyShape>,
}

#[derive(Clone, Copy, Deserialize)]
struct ToyShape {
    world_from_object: Option<[f64; 16]>,
}

/// The part of a frame's entry that viewers receive.
#[derive(Clone, Copy, Default, Deserialize)]
pub(super) struct EntryShape {
    intrinsics: Option<IntrinsicsRecord>,
    world_from_camera: Option<[f64; 16]>,
    world_from_object: Option<[f64; 16]>,
}

/// `foxglove.CompressedImage`.
pub(super) fn compressed_image(time_ns: u64, file: &[u8]) -> Vec<u8> {
    let format = if file.starts_with(b"\xff\xd8\xff") {
        "jpeg"
    } else {
        "png"
    };
    let message = Fields::new().message(1, &timestamp(time_ns));
    let message = message.text(4, CAMERA).text(3, format);
    message.bytes(DATA, file).into_bytes()
}

/// Range of the file in a `foxglove.CompressedImage`.
pub(super) fn image_file(message: &[u8]) -> Option<std::ops::Range<usize>> {
    counted_field(message, DATA)
}

/// `foxglove.CameraCalibration`: a pinhole without distortion. Pixel coordinates are as in
/// sessions, the first centre at 0.5.
pub(super) fn calibration(time_ns: u64, session: &SessionShape, entry: &EntryShape) -> Option<Vec<u8>> {
    let (width, height) = (session.width?, session.height?);
    let IntrinsicsRecord { fx, fy, cx, cy } = entry.intrinsics.or(session.intrinsics)?;
    let message = Fields::new().message(1, &timestamp(time_ns)).text(9, CAMERA);
    let message = message.fixed32(2, width).fixed32(3, height);
    let message = message.doubles(6, &[fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0]);
    let message = message.doubles(7, &DMat3::IDENTITY.to_cols_array());
    let message = message.doubles(8, &[fx, 0.0, cx, 0.0, 0.0, fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0]);
    Some(message.into_bytes())
}

/// `foxglove.FrameTransform` of camera and toy, if they are known.
pub(super) fn transforms(time_ns: u64, session: &SessionShape, entry: &EntryShape) -> Vec<Vec<u8>> {
    let camera = entry.world_from_camera.and_then(|world_from_camera| {
        // From the lens's axes to ours, half a turn around x.
        let camera_from_lens = DMat4::from_scale(DVec3::new(1.0, -1.0, -1.0));
        let world_from_lens = DMat4::from_cols_array(&world_from_camera) * camera_from_lens;
        transform(time_ns, CAMERA, &world_from_lens)
    });
    let of_session = session.toy.and_then(|toy| toy.world_from_object);
    let toy = entry
        .world_from_object
        .or(of_session)
        .and_then(|world_from_object| transform(time_ns, TOY, &DMat4::from_cols_array(&world_from_object)));
    camera.into_iter().chain(toy).collect()
}

/// The transform without its scale. `None` if an axis has length zero.
fn transform(time_ns: u64, child: &str, world_from_child: &DMat4) -> Option<Vec<u8>> {
    let axes = [
        world_from_child.x_axis,
        world_from_child.y_axis,
        world_from_child.z_axis,
    ];
    let [Some(x), Some(y), Some(z)] = axes.map(|axis| axis.truncate().try_normalize()) else {
        return None;
    };
    let turned = DQuat::from_mat3(&DMat3::from_cols(x, y, z));
    let at = world_from_child.w_axis;
    if !turned.is_finite() || !at.is_finite() {
        return None;
    }
    let translation = Fields::new().double(1, at.x).double(2, at.y).double(3, at.z);
    let rotation = Fields::new().double(1, turned.x).double(2, turned.y);
    let rotation = rotation.double(3, turned.z).double(4, turned.w);
    let message = Fields::new().message(1, &timestamp(time_ns));
    let message = message.text(2, WORLD).text(3, child);
    let message = message.message(4, &translation).message(5, &rotation);
    Some(message.into_bytes())
}
