//! The scene of the self-test: two boxes on a chequered table under one distant light, photographed by rays.

use std::sync::Arc;

use glam::{DMat4, DQuat, DVec2, DVec3, Vec3};
use serde_json::{Value, json};

use app_scene::camera_frame::{CameraImage, CodeRange, LumaCoefficients, PlanarImage, Planes, YcbcrEncoding};
use app_scene::frame::FrameInput;
use app_scene::geometry::color::srgb_from_linear;
use app_scene::scene::{Camera, Image, Intrinsics, Light, Plate, Pose, Receiver, Scene, Surface};
use app_scene::toy::{NodePose, Toy, ToyError, Trs, binary_gltf};

/// Width and height of the picture.
pub const SIZE_PX: [u32; 2] = [64, 48];
/// Rotation of the shown toy about its own axis, in radians.
const TURNED_RAD: f64 = 0.9;
/// Ambient light reflected by a white surface.
const AMBIENT: f64 = 0.35;
/// Light of the lamp, reflected by a white surface that faces it.
const DIRECT: f64 = 0.65;
/// Side of the table's checks.
const CHECK_M: f64 = 0.06;
/// Rays along either side of a pixel.
const N_RAYS: u32 = 3;

/// A box of one colour.
struct Solid {
    from_m: DVec3,
    to_m: DVec3,
    /// Linear reflectance.
    albedo: DVec3,
}

/// A body and a head at one end of it: no turn and no mirror image makes it the same.
const SOLIDS: [Solid; 2] = [
    Solid {
        from_m: DVec3::new(-0.08, 0.0, -0.03),
        to_m: DVec3::new(0.06, 0.06, 0.03),
        albedo: DVec3::new(0.60, 0.10, 0.08),
    },
    Solid {
        from_m: DVec3::new(0.02, 0.06, -0.03),
        to_m: DVec3::new(0.06, 0.12, 0.03),
        albedo: DVec3::new(0.08, 0.16, 0.60),
    },
];

/// Scene and frame.
pub(super) fn place() -> Result<(Scene, FrameInput), ToyError> {
    let toy = Arc::new(Toy::from_glb("self-test", &toy_file())?);
    let node = toy.find_node("toy")?;
    let turned = Trs {
        translation: DVec3::ZERO,
        rotation: DQuat::from_rotation_y(TURNED_RAD),
        scale: DVec3::ONE,
    };
    let shown = NodePose {
        parent_from_node: vec![(node, turned)],
        morph_weights: Vec::new(),
    };
    let camera = camera();
    let scene = Scene::new(
        SIZE_PX,
        toy,
        DMat4::IDENTITY,
        vec![Receiver {
            name: "table".to_owned(),
            world_from_plane: DMat4::IDENTITY,
            half_extent_m: DVec2::splat(2.0),
            surface: Surface::Textured,
        }],
    )
    .with_name("self-test")
    .with_lights(vec![Light::directional(to_light(), 0.0)])
    .with_plates(vec![Plate {
        camera,
        image: Arc::new(photograph(&camera, &[])),
    }]);
    let input = FrameInput::new(in_planes(photograph(&camera, &SOLIDS)), camera, DMat4::IDENTITY)
        .with_shown_pose(Pose::Nodes(Arc::new(shown)));
    Ok((scene, input))
}

fn to_light() -> DVec3 {
    DVec3::new(-0.55, 1.0, 0.3).normalize()
}

/// From above and in front, with the toy in the centre.
fn camera() -> Camera {
    let (eye, target) = (DVec3::new(0.06, 0.30, 0.32), DVec3::new(0.01, 0.03, -0.01));
    let back = (eye - target).normalize();
    let right = DVec3::Y.cross(back).normalize();
    let [x, y, z, w] =
        [(right, 0.0), (back.cross(right), 0.0), (back, 0.0), (eye, 1.0)].map(|(axis, w)| axis.extend(w));
    Camera {
        intrinsics: Intrinsics {
            fx_px: 72.0,
            fy_px: 72.0,
            cx_px: 32.0,
            cy_px: 24.0,
        },
        world_from_camera: DMat4::from_cols(x, y, z, w),
    }
}

/// The camera's picture of the table and the boxes on it.
fn photograph(camera: &Camera, solids: &[Solid]) -> Image {
    let [width_px, height_px] = SIZE_PX;
    let mut rgba8 = Vec::new();
    for y in 0..height_px {
        for x in 0..width_px {
            let mut light = DVec3::ZERO;
            for ray in 0..N_RAYS * N_RAYS {
                let within = DVec2::new(f64::from(ray % N_RAYS), f64::from(ray / N_RAYS)) + 0.5;
                let at_px = DVec2::new(f64::from(x), f64::from(y)) + within / f64::from(N_RAYS);
                light += seen(camera, at_px, solids) / f64::from(N_RAYS * N_RAYS);
            }
            rgba8.extend(light.to_array().map(code));
            rgba8.push(255);
        }
    }
    Image {
        width_px,
        height_px,
        rgba8,
    }
}

/// A picture as a phone's camera delivers it, so that the reading of planes is tested, too.
fn in_planes(image: Image) -> CameraImage {
    let encoding = YcbcrEncoding {
        coefficients: LumaCoefficients::Bt601,
        range: CodeRange::Full,
    };
    let map = encoding.srgb_from_ycbcr();
    let ycbcr_from_srgb = map.matrix.inverse();
    let ycbcr_at = |x: usize, y: usize| {
        let at = 4 * (y * image.width_px as usize + x);
        let srgb = Vec3::from([0, 1, 2].map(|k| f32::from(image.rgba8[at + k]) / 255.0));
        ycbcr_from_srgb * srgb + map.origin
    };
    let [columns, rows] = SIZE_PX.map(|side| side as usize);
    let all = (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y)));
    let luma: Vec<u8> = all.clone().map(|(x, y)| code_of(ycbcr_at(x, y).x)).collect();
    let fours = all.filter(|(x, y)| x % 2 + y % 2 == 0);
    let chroma: Vec<u8> = fours
        .flat_map(|(x, y)| {
            let four = [(x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)];
            let mean = four.map(|(x, y)| ycbcr_at(x, y)).into_iter().sum::<Vec3>() / 4.0;
            [mean.y, mean.z].map(code_of)
        })
        .collect();
    let planes = Planes::nv12(SIZE_PX, (&luma, columns), (&chroma, columns), encoding);
    // The planes contain their picture.
    PlanarImage::new(&planes).map_or_else(|_| image.into(), CameraImage::from)
}

#[allow(clippy::cast_possible_truncation, reason = "from 0 to 1")]
fn code(linear: f64) -> u8 {
    code_of(srgb_from_linear(linear.clamp(0.0, 1.0) as f32))
}

/// The nearest 8-bit code for a value from 0 to 1.
#[allow(clippy::cast_possible_truncation, reason = "a code of 8 bits")]
fn code_of(value: f32) -> u8 {
    (255.0 * value).round().clamp(0.0, 255.0) as u8
}

/// Light along the ray of a pixel, linear.
fn seen(camera: &Camera, at_px: DVec2, solids: &[Solid]) -> DVec3 {
    let Intrinsics {
        fx_px,
        fy_px,
        cx_px,
        cy_px,
    } = camera.intrinsics;
    let in_camera = DVec3::new((at_px.x - cx_px) / fx_px, (cy_px - at_px.y) / fy_px, -1.0);
    let along = camera.world_from_camera.transform_vector3(in_camera);
    let eye = camera.world_from_camera.w_axis.truncate();
    let nearest = solids
        .iter()
        .filter_map(|solid| hit(solid, eye, along).map(|(distance, normal)| (distance, normal, solid.albedo)))
        .min_by(|(a, ..), (b, ..)| a.total_cmp(b));
    let (distance, normal, albedo) = nearest.unwrap_or_else(|| {
        let distance = -eye.y / along.y;
        (distance, DVec3::Y, table(eye + distance * along))
    });
    let at = eye + distance * along + 1e-6 * normal;
    let is_lit = !solids.iter().any(|solid| hit(solid, at, to_light()).is_some());
    let direct = if is_lit {
        normal.dot(to_light()).max(0.0)
    } else {
        0.0
    };
    (AMBIENT + DIRECT * direct) * albedo
}

/// Albedo of the table, linear.
fn table(at: DVec3) -> DVec3 {
    let checks = (at / CHECK_M).floor();
    let is_dark = (checks.x + checks.z).rem_euclid(2.0) < 1.0;
    DVec3::new(0.62, 0.55, 0.44) * if is_dark { 0.8 } else { 1.0 }
}

/// Entry point of a ray into a box: its distance in lengths of `along`, and the outward normal
/// there.
fn hit(solid: &Solid, from: DVec3, along: DVec3) -> Option<(f64, DVec3)> {
    let (a, b) = ((solid.from_m - from) / along, (solid.to_m - from) / along);
    let (enters, leaves) = (a.min(b), a.max(b));
    let distance = enters.max_element();
    if !(distance > 0.0 && distance <= leaves.min_element()) {
        return None;
    }
    let is_entered = enters.cmpeq(DVec3::splat(distance));
    let axis = DVec3::select(is_entered, DVec3::ONE, DVec3::ZERO);
    Some((distance, (-along.signum() * axis).normalize()))
}

/// The boxes as a glTF binary.
fn toy_file() -> Vec<u8> {
    let mut bin: Vec<u8> = Vec::new();
    let (mut views, mut accessors) = (Vec::new(), Vec::new());
    let (mut materials, mut primitives) = (Vec::new(), Vec::new());
    for solid in &SOLIDS {
        let (corners, indices) = faces(solid);
        let positions: &[u8] = bytemuck::cast_slice(&corners);
        views.push(json!({ "buffer": 0, "byteOffset": bin.len(), "byteLength": positions.len() }));
        accessors.push(accessor(accessors.len(), 5126, "VEC3", corners.len()));
        bin.extend_from_slice(positions);
        let corners_of_triangles: &[u8] = bytemuck::cast_slice(&indices);
        let (offset, length) = (bin.len(), corners_of_triangles.len());
        views.push(json!({ "buffer": 0, "byteOffset": offset, "byteLength": length }));
        accessors.push(accessor(accessors.len(), 5125, "SCALAR", indices.len()));
        bin.extend_from_slice(corners_of_triangles);
        let [r, g, b] = solid.albedo.to_array();
        primitives.push(json!({
            "attributes": { "POSITION": accessors.len() - 2 },
            "indices": accessors.len() - 1,
            "material": materials.len(),
        }));
        materials.push(json!({ "pbrMetallicRoughness": { "baseColorFactor": [r, g, b, 1.0] } }));
    }
    let json = json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "name": "toy", "mesh": 0 }],
        "meshes": [{ "primitives": primitives }],
        "materials": materials,
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{ "byteLength": bin.len() }],
    });
    binary_gltf(json.to_string().as_bytes(), &bin)
}

fn accessor(view: usize, component: u32, kind: &str, count: usize) -> Value {
    json!({ "bufferView": view, "componentType": component, "type": kind, "count": count })
}

/// Corners of the six faces, and their triangles, counter-clockwise seen from outside.
fn faces(solid: &Solid) -> (Vec<[f32; 3]>, Vec<u32>) {
    let ends = [solid.from_m, solid.to_m].map(|end| end.as_vec3().to_array());
    let (mut corners, mut indices) = (Vec::new(), Vec::new());
    for axis in 0..3 {
        for side in 0..2 {
            let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
            let mut around = [[0, 0], [1, 0], [1, 1], [0, 1]];
            if side == 0 {
                around.reverse();
            }
            for n in [0, 1, 2, 0, 2, 3] {
                // Four corners per face, 24 per box.
                indices.push(u32::try_from(corners.len()).unwrap_or(0) + n);
            }
            for [at_b, at_c] in around {
                let mut corner = ends[side];
                (corner[b], corner[c]) = (ends[at_b][b], ends[at_c][c]);
                corners.push(corner);
            }
        }
    }
    (corners, indices)
}
