//! Relights plates after a lamp was moved, or switched on.
//!
//! The change of light on a receiver without a toy is smooth, and visible at all unshadowed pixels
//! of frame and plate. The shadow is an outlier.

use glam::DMat4;

use super::background::{Background, QUARTIC};
use crate::picture::{Level, Picture, Pyramid, UNKNOWN, places};
use crate::raster::{Rasterizer, project};
use crate::receivers::{SeenReceiver, receiver_at};
use crate::shape::Shape;
use app_scene::geometry::color::{CodesOfLinear, linear_of_codes};
use app_scene::scene::{Camera, Image, Plate, Scene};

/// Distance from the toy to which the light is estimated, over the toy's radius.
const REACH: f64 = 8.0;
/// Smallest value of a plate for a ratio.
const DARKEST: f32 = 0.0012;
/// Range of the ratio of light.
const LEAST: f32 = 0.02;
const MOST: f32 = 50.0;

/// Light on the receivers in a picture, over that in its plate.
pub(crate) struct Relight {
    ratio: Background<QUARTIC>,
    receivers: Vec<SeenReceiver>,
    camera_from_world: DMat4,
}

impl Relight {
    /// An estimate from a small picture; `None` without a plate.
    pub(crate) fn of(
        shape: &Shape,
        receivers: &[SeenReceiver],
        pyramid: &Pyramid,
        camera_from_world: &DMat4,
    ) -> Option<Self> {
        let level = pyramid.level(pyramid.smallest_for_shadows());
        let ratio = Level {
            intrinsics: level.intrinsics,
            frame: over(&level.frame, level.plate.as_ref()?),
            plate: None,
            softened_px: level.softened_px,
        };
        let corners = project(shape.points.iter().copied(), &level.intrinsics);
        let coverage = Rasterizer::default().coverage(&corners, &shape.faces, level.frame.size_px);
        Some(Self {
            ratio: Background::of(
                &ratio,
                &coverage,
                receivers,
                (shape.centre, REACH * shape.radius_m),
            ),
            receivers: receivers.to_vec(),
            camera_from_world: *camera_from_world,
        })
    }

    /// A small picture with its plate in this light; unknown far from the toy.
    pub(crate) fn level(&self, level: &Level) -> Level {
        let plate = level.plate.as_ref();
        let relit = |at| {
            let (receiver, point) = receiver_at(&self.receivers, &level.intrinsics, at)?;
            let (ratio, _) = self.ratio.at(&self.receivers, receiver, point)?;
            let plate = plate?.get(at)?;
            Some([0, 1, 2].map(|channel| plate[channel] * ratio[channel].clamp(LEAST, MOST)))
        };
        let size_px = level.frame.size_px;
        let pixels = places(size_px).map(|at| relit(at).unwrap_or(UNKNOWN));
        Level {
            plate: Some(Picture::of(size_px, pixels.collect())),
            ..level.clone()
        }
    }

    /// A scene's plate relit to this light, with the toy in its place; pixels far from it stay the
    /// same.
    pub(crate) fn plate(&self, plate: &Plate, (scene, world_from_object): (&Scene, &DMat4)) -> Plate {
        let Camera {
            intrinsics,
            world_from_camera,
        } = &plate.camera;
        let seen = SeenReceiver::near(scene, world_from_object, &world_from_camera.inverse());
        let here_from_there = self.camera_from_world * *world_from_camera;
        let (linear_of_code, codes) = (linear_of_codes(), CodesOfLinear::new());
        let Image {
            width_px,
            height_px,
            ref rgba8,
        } = *plate.image;
        let mut rgba8 = rgba8.clone();
        let size_px = glam::UVec2::new(width_px, height_px).as_ivec2();
        for (at, texel) in places(size_px).zip(rgba8.chunks_exact_mut(4)) {
            let Some((receiver, point)) = receiver_at(&seen, intrinsics, at) else {
                continue;
            };
            let point = here_from_there.transform_point3(point);
            let Some((ratio, _)) = self.ratio.at(&self.receivers, receiver, point) else {
                continue;
            };
            for (code, ratio) in texel.iter_mut().zip(ratio) {
                let linear = linear_of_code[usize::from(*code)] * ratio.clamp(LEAST, MOST);
                *code = codes.code(linear);
            }
        }
        Plate {
            camera: plate.camera,
            image: std::sync::Arc::new(Image {
                width_px,
                height_px,
                rgba8,
            }),
        }
    }
}

/// The ratio of two pictures.
fn over(frame: &Picture, plate: &Picture) -> Picture {
    let ratio = |at| {
        let (frame, plate) = (frame.get(at)?, plate.get(at)?);
        let is_known = plate.iter().all(|plate| *plate > DARKEST);
        is_known.then(|| [0, 1, 2].map(|channel| frame[channel] / plate[channel]))
    };
    let pixels = places(frame.size_px).map(|at| ratio(at).unwrap_or(UNKNOWN));
    Picture::of(frame.size_px, pixels.collect())
}
