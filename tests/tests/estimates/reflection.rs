//! Estimation of a table's reflection, with the bundled session's table, which is varnished after
//! it was photographed.

use std::sync::Arc;

use app_core::alignment::Observer;
use app_core::frame::FrameInput;
use app_core::reflection::Reflection;
use app_core::scene::{Camera, Image, Scene};
use app_core::toy::PosedMesh;
use app_scene::geometry::color::{linear_from_srgb, srgb_from_linear};
use glam::{DMat4, DVec2, DVec3};
use reference::occlusion::Occluder;

use super::bundled::SESSION;

/// Side of a block of pixels with the same varnish.
const BLOCK_PX: u32 = 3;
/// Rays of each block.
const N_RAYS: u32 = 48;
const VARNISH: Reflection = Reflection {
    roughness: 0.2,
    surroundings: [0.5, 0.6, 0.7],
    toy_above_surroundings: [-0.3, -0.45, -0.6],
};

/// A uniform number from 0 to 1, from a seed.
fn even(seed: u32) -> f64 {
    let mixed = seed.wrapping_mul(0x9E37_79B9) ^ (seed >> 7);
    let mixed = (mixed ^ (mixed >> 15)).wrapping_mul(0x85EB_CA6B);
    f64::from((mixed ^ (mixed >> 13)).wrapping_mul(0xC2B2_AE35) >> 8) / f64::from(1 << 24)
}

/// A table in a camera's view.
struct Table {
    plane_from_camera: DMat4,
    camera: Camera,
    /// The toy in the table's space.
    toy: Occluder,
}

impl Table {
    fn of(scene: &Scene, input: &FrameInput) -> Self {
        let plane_from_world = scene.receivers[0].world_from_plane.inverse();
        let mut posed = PosedMesh::default();
        let plane_from_object = plane_from_world * input.world_from_object;
        scene
            .toy
            .pose(&scene.physical_pose, &plane_from_object, &mut posed)
            .unwrap();
        let positions: Vec<DVec3> = posed.positions.iter().map(|p| p.as_dvec3()).collect();
        Self {
            plane_from_camera: plane_from_world * input.camera.world_from_camera,
            camera: input.camera,
            toy: Occluder::new(&positions, scene.toy.indices()),
        }
    }

    /// Light that the varnish adds at a pixel, with the toy or without it.
    fn reflected(&self, px: DVec2, has_toy: bool, seed: u32) -> [f32; 3] {
        let k = &self.camera.intrinsics;
        let in_camera = DVec3::new((px.x - k.cx_px) / k.fx_px, (k.cy_px - px.y) / k.fy_px, -1.0);
        let eye = self.plane_from_camera.w_axis.truncate();
        let ray = self.plane_from_camera.transform_vector3(in_camera).normalize();
        if ray.y >= 0.0 {
            return [0.0; 3];
        }
        let at = (eye - ray * (eye.y / ray.y)).with_y(0.0);
        let is_hidden = |index: u32| {
            // Beckmann's slopes are normally distributed, with half the square of alpha as
            // variance.
            let [radius, turn] = [2 * index, 2 * index + 1].map(|index| even(seed * 128 + index));
            let slope = VARNISH.roughness
                * (-(1.0 - radius).ln()).sqrt()
                * DVec2::from_angle(turn * std::f64::consts::TAU);
            let direction = ray.reflect(DVec3::new(slope.x, 1.0, slope.y).normalize());
            self.toy.nearest(at, direction).is_some()
        };
        let n_hidden = if has_toy {
            (0..N_RAYS).filter(|index| is_hidden(*index)).count()
        } else {
            0
        };
        let hidden = n_hidden as f32 / N_RAYS as f32;
        #[allow(clippy::cast_possible_truncation, reason = "a part of one")]
        let reflectance = VARNISH.reflectance(-ray.y) as f32;
        let light =
            |channel: usize| VARNISH.surroundings[channel] + hidden * VARNISH.toy_above_surroundings[channel];
        [0, 1, 2].map(|channel| reflectance * light(channel))
    }

    /// The picture with varnish on the visible part of the table.
    #[allow(clippy::cast_possible_truncation, reason = "from 0 to 255")]
    fn varnished(&self, image: &Image, has_toy: bool) -> Image {
        let n_columns = image.width_px.div_ceil(BLOCK_PX);
        let blocks = (0..n_columns * image.height_px.div_ceil(BLOCK_PX)).map(|block| {
            let corner = BLOCK_PX * glam::UVec2::new(block % n_columns, block / n_columns);
            self.reflected(corner.as_dvec2() + 0.5 * f64::from(BLOCK_PX), has_toy, block)
        });
        let blocks: Vec<[f32; 3]> = blocks.collect();
        let mut varnished = image.clone();
        for (index, texel) in (0..).zip(varnished.rgba8.chunks_exact_mut(4)) {
            let (x, y) = (index % image.width_px, index / image.width_px);
            let light = blocks[(y / BLOCK_PX * n_columns + x / BLOCK_PX) as usize];
            for (code, light) in texel.iter_mut().zip(light) {
                let linear = linear_from_srgb(f32::from(*code) / 255.0) + light;
                *code = (255.0 * srgb_from_linear(linear.min(1.0))).round() as u8;
            }
        }
        varnished
    }
}

#[test]
fn a_varnished_table_is_told_from_a_matt_one() {
    let (scene, input) = SESSION.clone();
    let found =
        |scene: &Scene, input: &FrameInput| Observer::default().observed(scene, input).unwrap().reflection;
    assert_eq!(found(&scene, &input), None);
    let table = Table::of(&scene, &input);
    let varnished_input = input
        .clone()
        .with_image(table.varnished(input.image.rgba(), true));
    let mut varnished = scene.clone();
    for plate in &mut varnished.plates {
        plate.image = Arc::new(table.varnished(&plate.image, false));
    }
    let told = found(&varnished, &varnished_input).unwrap();
    assert!((told.roughness / VARNISH.roughness).ln().abs() < 0.25, "{told:?}");
    for channel in 0..3 {
        let [actual, expected] = [told, VARNISH].map(|reflection| reflection.toy_above_surroundings[channel]);
        assert!((actual - expected).abs() < 0.25 * expected.abs(), "{told:?}");
    }
    // A plate without the varnish shows another table, but no toy in it.
    let unlike = found(&varnished, &input);
    assert_eq!(unlike, None);
}

#[test]
fn a_reflection_is_found_in_the_first_frame_that_shows_the_toy() {
    let (mut scene, input) = SESSION.clone();
    let table = Table::of(&scene, &input);
    let input = input
        .clone()
        .with_image(table.varnished(input.image.rgba(), true));
    for plate in &mut scene.plates {
        plate.image = Arc::new(table.varnished(&plate.image, false));
    }
    let mut observer = Observer::default();
    let mut look = |input: &FrameInput| observer.observed(&scene, input).unwrap().reflection;
    let empty = input.clone().with_image(Arc::clone(&scene.plates[0].image));
    assert_eq!(look(&empty), None);
    assert!(look(&input).is_some());
}
