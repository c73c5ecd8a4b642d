//! Predicted outlines of a scene in a frame, to be drawn over the photograph.

use glam::{DVec2, UVec2};

use super::error::{AlignError, check};
use super::lights::flat_shadows;
use super::pose::outline_px;
use super::raster::Rasterizer;
use super::receivers::SeenReceiver;
use super::shape::Shape;
use app_scene::frame::FrameInput;
use app_scene::scene::Scene;

/// Points on outlines, about a pixel apart, in pixels of the picture.
#[derive(Clone, Debug)]
pub struct Outlines {
    /// Outline of the physical toy.
    pub toy: Vec<DVec2>,
    /// Outlines of its hard shadow from the centre of each light, over all receivers, including
    /// parts that the toy hides.
    pub shadows: Vec<Vec<DVec2>>,
}

impl Outlines {
    /// The outlines for a frame's input.
    ///
    /// # Errors
    /// As [`Aligner::align`](super::Aligner::align).
    pub fn of(scene: &Scene, input: &FrameInput) -> Result<Self, AlignError> {
        check(scene, input)?;
        let camera_from_world = input.camera.world_from_camera.inverse();
        let shape = Shape::new(scene, &(camera_from_world * input.world_from_object))?;
        let receivers = SeenReceiver::near(scene, &input.world_from_object, &camera_from_world);
        let size_px = UVec2::new(scene.width_px, scene.height_px).as_ivec2();
        let (k, mut raster) = (&input.camera.intrinsics, Rasterizer::default());
        let lights = input.lights.as_deref().unwrap_or(&scene.lights);
        let shadows = lights.iter().map(|light| {
            let flat = flat_shadows(light, &shape, &receivers, &camera_from_world, &[DVec2::ZERO]);
            let outlines = flat
                .iter()
                .map(|flat| outline_px(&mut raster, (flat, &shape), k, size_px));
            outlines.flatten().collect()
        });
        Ok(Self {
            shadows: shadows.collect(),
            toy: outline_px(&mut Rasterizer::default(), (&shape.points, &shape), k, size_px),
        })
    }
}
