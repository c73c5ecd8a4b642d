//! Pixels that alignment must not read: withheld shadows, which are to be predicted.

use glam::{DVec2, UVec2};

use super::Aligner;
use super::kept_lights::KeptLights;
use super::lights::flat_shadows;
use super::picture::Mask;
use super::raster::{Rasterizer, project};
use super::receivers::SeenReceiver;
use super::shape::Shape;
use app_scene::frame::FrameInput;
use app_scene::scene::{Camera, Light, Scene};
use app_scene::toy::ToyError;

/// Number of points around the rim of a light whose shadows are united.
const N_RIM: u8 = 16;

impl Aligner {
    /// The pixels of a view that must not be read.
    pub(super) fn withheld(
        &self,
        input: &FrameInput,
        (camera, grown): (&Camera, f64),
        lights: Option<&KeptLights>,
    ) -> Result<Option<Mask>, ToyError> {
        let Some(lights) = lights.filter(|_| self.are_shadows_withheld) else {
            return Ok(None);
        };
        let placed = input
            .clone()
            .with_camera(*camera)
            .with_world_from_object(self.held.unwrap_or(input.world_from_object));
        shadows(&self.scene, &placed, lights.in_use(), grown).map(Some)
    }
}

/// All shadows of the toy in the input's place, grown in all directions by a fraction of the
/// picture's width, so that they cover nearby places of toy and camera.
fn shadows(scene: &Scene, input: &FrameInput, lights: &[Light], grown: f64) -> Result<Mask, ToyError> {
    let camera_from_world = input.camera.world_from_camera.inverse();
    let shape = Shape::new(scene, &(camera_from_world * input.world_from_object))?;
    let receivers = SeenReceiver::near(scene, &input.world_from_object, &camera_from_world);
    let size_px = UVec2::new(scene.width_px, scene.height_px).as_ivec2();
    let turn = std::f64::consts::TAU / f64::from(N_RIM);
    let mut points: Vec<DVec2> = (0..N_RIM)
        .map(|index| DVec2::from_angle(turn * f64::from(index)))
        .collect();
    points.push(DVec2::ZERO);
    let mut mask = Mask::new(size_px);
    let mut raster = Rasterizer::default();
    for light in lights {
        for flat in flat_shadows(light, &shape, &receivers, &camera_from_world, &points) {
            let corners = project(flat, &input.camera.intrinsics);
            let coverage = raster.coverage(&corners, &shape.faces, size_px);
            for at in coverage.pixels().filter(|at| coverage.at(*at) > 0.0) {
                mask.mark(at);
            }
        }
    }
    #[allow(clippy::cast_possible_truncation, reason = "a part of a picture's width")]
    let reach_px = (grown * f64::from(size_px.x)).ceil() as i32;
    Ok(mask.grown(reach_px))
}
