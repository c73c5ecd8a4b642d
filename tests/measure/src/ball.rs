//! A toy on a table for the ledger's examples: its cost depends on a few numbers, which are varied.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use app_core::camera_frame::{PlanarImage, Planes};
use app_core::frame::FrameInput;
use app_core::scene::{Camera, Image, Light, Plate, Pose, Receiver, Scene, Surface};
use app_core::toy::Toy;
use glam::{DMat4, DVec2, DVec3, Vec3};
use serde_json::json;

use crate::glb::Glb;
use crate::photographer::world::camera;
use crate::planar::BT601_FULL;

/// The screen of an iPhone X, in landscape.
pub const SCREEN_PX: [u32; 2] = [2436, 1125];

/// Positions on the unit sphere, and the corners of 2 `n_around` (`n_along` - 1) triangles that
/// close it, counter-clockwise from outside; the last position is its lowest point.
#[must_use]
pub fn ball_mesh(n_around: u32, n_along: u32) -> (Vec<Vec3>, Vec<u32>) {
    let mut positions = vec![Vec3::Y];
    for ring in 1..n_along {
        let polar = PI * f64::from(ring) / f64::from(n_along);
        positions.extend((0..n_around).map(|step| {
            let turn = TAU * f64::from(step) / f64::from(n_around);
            let at = DVec3::new(polar.sin() * turn.cos(), polar.cos(), polar.sin() * turn.sin());
            at.as_vec3()
        }));
    }
    positions.push(-Vec3::Y);
    let last = u32::try_from(positions.len()).unwrap_or(u32::MAX) - 1;
    let at = |ring: u32, step: u32| 1 + (ring - 1) * n_around + step % n_around;
    let mut indices = Vec::new();
    for step in 0..n_around {
        indices.extend([0, at(1, step + 1), at(1, step)]);
        for ring in 1..n_along - 1 {
            let [a, b, c, d] = [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(r, s)| at(ring + r, step + s));
            indices.extend([a, b, c, b, d, c]);
        }
        indices.extend([last, at(n_along - 1, step), at(n_along - 1, step + 1)]);
    }
    (positions, indices)
}

/// A closed ball of that many triangles, 40 mm in radius.
///
/// # Panics
/// With fewer than three triangles around or along it.
#[must_use]
pub fn ball(n_around: u32, n_along: u32) -> Toy {
    let (positions, indices) = ball_mesh(n_around, n_along);
    let normals: Vec<f32> = positions.iter().flat_map(Vec3::to_array).collect();
    let scaled: Vec<f32> = normals.iter().map(|x| 0.04 * x).collect();
    lifted(&scaled, &normals, &indices)
}

/// A toy that a clip lifts.
///
/// # Panics
/// When the triangles are invalid.
#[must_use]
pub fn lifted(positions: &[f32], normals: &[f32], indices: &[u32]) -> Toy {
    let mut file = Glb::new();
    let (position, normal) = (file.floats("VEC3", positions), file.floats("VEC3", normals));
    let indices = file.u32s(indices);
    let mesh = file.push(
        "meshes",
        json!({ "primitives": [{ "attributes": { "POSITION": position, "NORMAL": normal }, "indices": indices }] }),
    );
    file.push("nodes", json!({ "mesh": mesh, "name": "toy" }));
    let times = file.floats("SCALAR", &[0.0, 1.0]);
    let places = file.floats("VEC3", &[0.0, 0.0, 0.0, 0.02, 0.02, 0.0]);
    file.animate("lift", "translation", "LINEAR", [times, places]);
    Toy::from_glb("toy.glb", &file.bytes()).expect("a toy of valid triangles")
}

/// A grey picture as a phone without texture sharing delivers it.
fn planes(size_px: [u32; 2]) -> Option<PlanarImage> {
    let [width, height] = size_px.map(|side| side as usize);
    let (luma, chroma) = (vec![128; width * height], vec![128; width * height.div_ceil(2)]);
    PlanarImage::new(&Planes::nv12(
        size_px,
        (&luma, width),
        (&chroma, width),
        BT601_FULL,
    ))
    .ok()
}

/// A camera that shows the ball's region some 900 x 700 px large on that screen.
#[must_use]
pub fn phone() -> Camera {
    camera(
        SCREEN_PX,
        DVec3::new(0.0, 0.37, 0.41),
        DVec3::new(-0.02, 0.03, 0.0),
    )
}

/// A toy on a table, in pictures of the given size.
///
/// # Panics
/// When the toy has no clip `lift`, or a side of the picture is 0.
#[must_use]
pub fn scene_of(toy: Toy, n_lights: u32, (camera, size_px): (Camera, [u32; 2])) -> (Scene, FrameInput) {
    let [width_px, height_px] = size_px;
    let image = Image {
        width_px,
        height_px,
        rgba8: vec![128; 4 * (width_px * height_px) as usize],
    };
    let place = |turn: f64| DVec3::new(turn.cos(), 1.6, turn.sin());
    let lights = (0..n_lights).map(|index| Light::sphere(place(0.4 + 2.0 * f64::from(index)), 0.05));
    let world_from_object = DMat4::from_translation(DVec3::new(0.0, 0.04, 0.0));
    let toy = Arc::new(toy);
    let scene = Scene::new(
        size_px,
        Arc::clone(&toy),
        world_from_object,
        vec![Receiver {
            name: "table".to_owned(),
            world_from_plane: DMat4::IDENTITY,
            half_extent_m: DVec2::splat(1.0),
            surface: Surface::Uniform,
        }],
    )
    .with_name("ball")
    .with_lights(lights.collect())
    .with_plates(vec![Plate {
        camera,
        image: Arc::new(image),
    }]);
    let input = FrameInput::new(
        planes(size_px).expect("a picture that has pixels"),
        camera,
        world_from_object,
    )
    .with_shown_pose(Pose::Clip {
        clip: toy.find_clip("lift").expect("a clip of that name"),
        time_secs: 0.5,
    });
    (scene, input)
}
