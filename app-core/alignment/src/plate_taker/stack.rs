//! Pictures of one view averaged, in linear light.

use std::sync::Arc;

use glam::{DMat4, DQuat, DVec3};

use super::reduced::Reduced;
use app_scene::camera_frame::CameraImage;
use app_scene::geometry::color::{CodesOfLinear, linear_of_codes};
use app_scene::scene::{Camera, Image, Intrinsics, Plate};

/// Pictures from a camera that did not move.
#[derive(Clone, Debug)]
pub(super) struct Stack {
    first: CameraImage,
    /// The first one, reduced: the reference of the others.
    pub(super) reduced: Reduced,
    /// Camera of the first one.
    pub(super) camera: Camera,
    pub(super) n: u32,
    /// Sum of linear light, three numbers per pixel; empty for a single picture.
    sums: Vec<f32>,
    /// Sum of all cameras.
    cameras: CameraSum,
}

#[derive(Clone, Copy, Debug)]
struct CameraSum {
    intrinsics: [f64; 4],
    position: DVec3,
    /// Sum of all rotations, on the first one's hemisphere.
    rotation: DQuat,
}

impl Stack {
    pub(super) fn new(image: CameraImage, reduced: Reduced, camera: &Camera) -> Self {
        Self {
            first: image,
            reduced,
            n: 1,
            sums: Vec::new(),
            camera: *camera,
            cameras: CameraSum::new(camera),
        }
    }

    /// Adds a picture of the same size.
    pub(super) fn add(&mut self, image: &CameraImage, camera: &Camera) {
        let linear = linear_of_codes();
        if self.sums.is_empty() {
            let first = self.first.rgba();
            self.sums = vec![0.0; first.rgba8.len() / 4 * 3];
            add_light(&mut self.sums, first, &linear);
        }
        add_light(&mut self.sums, image.rgba(), &linear);
        self.cameras.add(CameraSum::new(camera));
        self.n += 1;
    }

    /// The mean picture, with the mean camera.
    pub(super) fn plate(&self) -> Plate {
        let image = if self.n == 1 {
            Arc::clone(self.first.rgba())
        } else {
            Arc::new(self.mean())
        };
        let camera = self.cameras.mean(f64::from(self.n));
        Plate { camera, image }
    }

    fn mean(&self) -> Image {
        let codes = CodesOfLinear::new();
        let part = 1.0 / self.n as f32;
        let code = |sum: &f32| codes.code(part * sum);
        let mut rgba8 = Vec::with_capacity(self.sums.len() / 3 * 4);
        for pixel in self.sums.chunks_exact(3) {
            rgba8.extend(pixel.iter().map(code));
            rgba8.push(u8::MAX);
        }
        let [width_px, height_px] = self.first.size_px();
        Image {
            width_px,
            height_px,
            rgba8,
        }
    }
}

fn add_light(sums: &mut [f32], image: &Image, linear: &[f32; 256]) {
    for (sum, pixel) in sums.chunks_exact_mut(3).zip(image.rgba8.chunks_exact(4)) {
        for (sum, code) in sum.iter_mut().zip(pixel) {
            *sum += linear[usize::from(*code)];
        }
    }
}

impl CameraSum {
    fn new(camera: &Camera) -> Self {
        let Intrinsics {
            fx_px,
            fy_px,
            cx_px,
            cy_px,
        } = camera.intrinsics;
        Self {
            intrinsics: [fx_px, fy_px, cx_px, cy_px],
            position: camera.world_from_camera.w_axis.truncate(),
            rotation: DQuat::from_mat4(&camera.world_from_camera).normalize(),
        }
    }

    fn add(&mut self, other: Self) {
        for (sum, number) in self.intrinsics.iter_mut().zip(other.intrinsics) {
            *sum += number;
        }
        self.position += other.position;
        let is_near = self.rotation.dot(other.rotation) >= 0.0;
        self.rotation += if is_near { other.rotation } else { -other.rotation };
    }

    fn mean(&self, n: f64) -> Camera {
        let [fx_px, fy_px, cx_px, cy_px] = self.intrinsics.map(|sum| sum / n);
        // A sum of rotations on one hemisphere is not zero.
        let rotation = self.rotation.normalize();
        Camera {
            intrinsics: Intrinsics {
                fx_px,
                fy_px,
                cx_px,
                cy_px,
            },
            world_from_camera: DMat4::from_rotation_translation(rotation, self.position / n),
        }
    }
}
