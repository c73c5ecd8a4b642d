//! The toy's file and the photograph, computed from numbers.

use app_core::glam::DVec3;
use app_core::scene::{Camera, Image};

/// Width and height of the photograph.
pub(crate) const SIZE_PX: [u32; 2] = [160, 120];
/// Unit vector towards the lamp, in world space.
pub(crate) const TO_LIGHT: DVec3 = DVec3::new(-0.48, 0.8, 0.36);
/// Two corners of the toy, in metres. The table's height is 0.
const FROM_M: DVec3 = DVec3::new(-0.04, 0.0, -0.02);
const TO_M: DVec3 = DVec3::new(0.04, 0.08, 0.02);
/// Corners of triangles, counter-clockwise seen from outside. The bits of a corner select from
/// [`FROM_M`] and [`TO_M`].
const TRIANGLES: &str = "046 062 137 175 015 054 267 273 023 031 457 476";

/// A box as a binary glTF file: eight corners, twelve triangles, one node.
pub(crate) fn box_glb() -> Vec<u8> {
    let corner = |i: u8| DVec3::select([i & 1 > 0, i & 2 > 0, i & 4 > 0].into(), TO_M, FROM_M);
    let numbers = (0..8).flat_map(|i| corner(i).as_vec3().to_array());
    let mut bin: Vec<u8> = numbers.flat_map(f32::to_le_bytes).collect();
    bin.extend(
        TRIANGLES
            .split(' ')
            .flat_map(str::bytes)
            .map(|digit| digit - b'0'),
    );
    let mut json = format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"name":"box","mesh":0}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"type":"VEC3","count":8,"min":{:?},"max":{:?}}},
        {{"bufferView":1,"componentType":5121,"type":"SCALAR","count":36}}],"buffers":[{{"byteLength":132}}],
        "bufferViews":[{{"buffer":0,"byteLength":96}},{{"buffer":0,"byteOffset":96,"byteLength":36}}]}}"#,
        FROM_M.to_array(),
        TO_M.to_array(),
    );
    // A header and two chunks, each padded to whole words.
    json.push_str(&" ".repeat(json.len().next_multiple_of(4) - json.len()));
    let word = |n: usize| u32::try_from(n).unwrap_or(u32::MAX).to_le_bytes();
    let header = [*b"glTF", word(2), word(28 + json.len() + bin.len())].concat();
    let json_chunk = [&word(json.len()), b"JSON", json.as_bytes()].concat();
    let bin_chunk = [&word(bin.len()), b"BIN\0", &bin[..]].concat();
    [header, json_chunk, bin_chunk].concat()
}

/// The camera's picture: a grey table, a blue box, and the shadow of the box.
pub(crate) fn photograph(camera: &Camera) -> Image {
    let [width_px, height_px] = SIZE_PX;
    let (lens, eye) = (camera.intrinsics, camera.world_from_camera.w_axis.truncate());
    let pixels = (0..height_px).flat_map(|y| (0..width_px).map(move |x| [x, y].map(|i| f64::from(i) + 0.5)));
    let color = |[x, y]: [f64; 2]| {
        let in_camera = DVec3::new((x - lens.cx_px) / lens.fx_px, (lens.cy_px - y) / lens.fy_px, -1.0);
        let ray = camera.world_from_camera.transform_vector3(in_camera);
        if is_box_hit(eye, ray) {
            [60, 90, 200, 255]
        } else if is_box_hit(eye - ray * (eye.y / ray.y), TO_LIGHT) {
            [110, 110, 110, 255]
        } else {
            [190, 190, 190, 255]
        }
    };
    Image {
        width_px,
        height_px,
        rgba8: pixels.flat_map(color).collect(),
    }
}

/// Whether a ray hits the box: at some point it lies between all three pairs of sides.
fn is_box_hit(origin: DVec3, ray: DVec3) -> bool {
    let (one, other) = ((FROM_M - origin) / ray, (TO_M - origin) / ray);
    one.min(other).max_element().max(0.0) < one.max(other).min_element()
}
