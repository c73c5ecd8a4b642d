//! A pale toy on a table as dark as its own shaded side: its outline has little contrast there.

use std::sync::Arc;

use app_core::alignment::Aligner;
use app_core::frame::FrameInput;
use app_core::scene::{Image, Plate, Scene};
use app_core::toy::PosedMesh;
use app_scene::geometry::color::{linear_from_srgb, srgb_from_linear};
use glam::{DVec2, UVec2};

use super::bundled::SESSION;

/// Colour of the dark table, over that of the recorded one.
const DARKER: [f32; 3] = [0.42, 0.37, 0.35];
/// Samples along each side of a pixel.
const N_SAMPLES: u32 = 4;

/// The share of each pixel that the toy covers.
fn coverage(scene: &Scene, input: &FrameInput) -> Vec<f32> {
    let [width, height] = input.image.size_px().map(|side| side as usize);
    let mut posed = PosedMesh::default();
    scene
        .toy
        .pose(&scene.physical_pose, &input.world_from_object, &mut posed)
        .unwrap();
    let pixels: Vec<DVec2> = posed
        .points()
        .map(|point| input.camera.pixel_of(point).unwrap())
        .collect();
    let n = N_SAMPLES as usize;
    let mut samples = vec![false; n * width * n * height];
    for corners in scene.toy.indices().chunks_exact(3) {
        let [a, b, c] = [0, 1, 2].map(|k| f64::from(N_SAMPLES) * pixels[corners[k] as usize]);
        let area = (b - a).perp_dot(c - a);
        let (low, high) = (a.min(b).min(c).as_uvec2(), a.max(b).max(c).as_uvec2());
        for (y, x) in (low.y..=high.y).flat_map(|y| (low.x..=high.x).map(move |x| (y, x))) {
            let at = UVec2::new(x, y).as_dvec2() + 0.5;
            let weights = [
                (b - at).perp_dot(c - at),
                (c - at).perp_dot(a - at),
                (a - at).perp_dot(b - at),
            ];
            if weights.iter().all(|weight| weight * area >= 0.0) {
                samples[y as usize * n * width + x as usize] = true;
            }
        }
    }
    let of_pixel = |index: usize| {
        let (x, y) = (index % width, index / width);
        let inside = (0..n * n).filter(|k| samples[(n * y + k / n) * n * width + n * x + k % n]);
        inside.count() as f32 / (n * n) as f32
    };
    (0..width * height).map(of_pixel).collect()
}

/// Linear light of a pixel.
fn linear(image: &Image, index: usize) -> [f32; 3] {
    [0, 1, 2].map(|channel| linear_from_srgb(f32::from(image.rgba8[4 * index + channel]) / 255.0))
}

/// The table's part of a pixel's light; where the toy covers some of it, the plate in the light beside the toy.
fn of_table((image, plate): (&Image, &Image), coverage: &[f32], index: usize) -> [f32; 3] {
    if coverage[index] == 0.0 {
        return linear(image, index);
    }
    if coverage[index] == 1.0 {
        return [0.0; 3];
    }
    let width = image.width_px as usize;
    let (x, y) = (index % width, index / width);
    let around = (0..49).map(|k| (y + k / 7 - 3) * width + x + k % 7 - 3);
    let clear: Vec<usize> = around.filter(|at| coverage[*at] == 0.0).collect();
    let sum = |image, channel: usize| clear.iter().map(|at| linear(image, *at)[channel]).sum::<f32>();
    let alone = linear(plate, index);
    [0, 1, 2]
        .map(|channel| (1.0 - coverage[index]) * sum(image, channel) / sum(plate, channel) * alone[channel])
}

/// A picture on a table of the new colour: each pixel as far as it shows the table.
fn darkened(image: &Image, plate: &Image, coverage: &[f32]) -> Image {
    let mut darkened = image.clone();
    for (index, texel) in darkened.rgba8.chunks_exact_mut(4).enumerate() {
        let (own, table) = (linear(image, index), of_table((image, plate), coverage, index));
        for channel in 0..3 {
            let left = own[channel] - (1.0 - DARKER[channel]) * table[channel];
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a code")]
            let code = (255.0 * srgb_from_linear(left.clamp(0.0, 1.0))).round() as u8;
            texel[channel] = code;
        }
    }
    darkened
}

/// The bundled session on the dark table.
fn pale() -> (Scene, FrameInput) {
    let (scene, mut input) = SESSION.clone();
    let plate = Arc::clone(&scene.plates[0].image);
    let covered = coverage(&scene, &input);
    input.image = Arc::new(darkened(input.image.rgba(), &plate, &covered)).into();
    let nothing = vec![0.0; covered.len()];
    let plates = scene.plates.iter().map(|plate| Plate {
        camera: plate.camera,
        image: Arc::new(darkened(&plate.image, &plate.image, &nothing)),
    });
    let plates = plates.collect();
    (scene.with_plates(plates), input)
}

#[test]
fn a_pale_toy_on_a_dark_table_is_found_and_is_not_soft() {
    let (scene, input) = pale();
    let found = Aligner::new(scene).align(&input).unwrap();
    let pose = found.report.pose.unwrap();
    assert!(pose.shown_px() < 0.5, "{pose:?}");
    let soft_px = found.sharpness.outline_spread.mean_px();
    assert!(soft_px < 0.7, "{soft_px}");
}
