//! A preset with the visibility that rays find in place of its own.

use std::thread;

use app_core::core::Core;
use app_core::frame::FrameInput;
use app_core::inject::InjectedVisibility;
use app_core::light_points::light_in_plane;
use app_core::maps::FloatMap;
use app_core::preset::Preset;
use app_core::region::{PixelRect, Place, View};
use app_core::scene::{Light, PoseTime, Scene};
use app_core::session::{Capture, GroundTruth, Session};
use app_core::toy::{PosedMesh, ToyError};
use glam::{DMat4, DVec2, UVec2};

use crate::metrics::{self, Regions};
use crate::reference::model::Region;
use crate::reference::occlusion::{Occluder, SAMPLE_POSITIONS};
use crate::reference::visibility::exact_visibility;
use crate::replay::ReplayError;
use crate::report::mean_scores;

use super::{Options, Row};

/// Rays from each of a pixel's four sample positions to each light.
const N_RAYS: usize = 64;
/// Lights that the core moves the shadows of.
const MAX_LIGHTS: usize = 4;

/// Scores a preset with exact visibility.
pub(super) fn measure(
    session: &Capture,
    core: &mut Core,
    preset: Preset,
    options: &Options,
) -> Result<Row, ReplayError> {
    let scene = session.scene();
    core.set_scene(scene.clone(), preset)?;
    let frames = options.frames.clone().unwrap_or(0..session.n_frames());
    let n_frames = frames.len();
    let mut scores = Vec::new();
    let mut physical: Option<(DMat4, FloatMap)> = None;
    for index in frames {
        let failed = |reason| ReplayError::Frame { index, reason };
        let input = FrameInput::from(&session.frame(index)?);
        if let Some(rect) = core.frame(&input).map_err(failed)?.region {
            let rays = Rays::new(scene, &input.world_from_camera, &rect);
            let map = |pose: &PoseTime| rays.visibility(scene, pose).map_err(|error| failed(error.into()));
            let known = physical.take().filter(|(camera, map)| {
                *camera == input.world_from_camera && [map.width, map.height] == rect.size_px.to_array()
            });
            let of_place = match known {
                Some((_, map)) => map,
                None => map(&scene.physical_pose)?,
            };
            physical = Some((input.world_from_camera, of_place.clone()));
            let maps = InjectedVisibility {
                physical: Some(of_place),
                shown: Some(map(&input.shown_pose)?),
            };
            core.inject_visibility(&maps).map_err(failed)?;
            core.frame(&input).map_err(failed)?;
        }
        if let Some(truth) = session.truth(index)? {
            let picture = core.read_picture().map_err(failed)?;
            let score = metrics::measure(&picture, &truth.image, &Regions::from_mask(&truth.mask));
            scores.push(score.map_err(|reason| ReplayError::Score { index, reason })?);
        }
    }
    Ok(Row {
        session: scene.name.clone(),
        preset: format!("{preset}+exact"),
        n_frames,
        scores: mean_scores(&scores),
        times: None,
        n_taps: None,
        ratio_to_paper: None,
    })
}

/// The region and the lights, in plane space.
struct Rays {
    region: Region,
    lights: Vec<Light>,
    plane_from_object: DMat4,
}

impl Rays {
    fn new(scene: &Scene, world_from_camera: &DMat4, rect: &PixelRect) -> Self {
        let receiver = &scene.receivers[0];
        let plane_from_world = receiver.world_from_plane.inverse();
        let image_px = UVec2::new(scene.width_px, scene.height_px);
        let view = View::new(image_px, scene.intrinsics, world_from_camera, receiver);
        let place = Place {
            receiver,
            lights: &[],
            plane_from_world: &plane_from_world,
            reference_in_plane: DVec2::ZERO,
        };
        let lights = scene.lights.iter();
        Self {
            region: Region::new(&view, rect, &place),
            lights: lights
                .filter_map(|light| above_plane(light, &plane_from_world))
                .take(MAX_LIGHTS)
                .collect(),
            plane_from_object: plane_from_world * scene.world_from_object,
        }
    }

    /// Visibility of each light over the region with the toy in a pose.
    fn visibility(&self, scene: &Scene, pose: &PoseTime) -> Result<FloatMap, ToyError> {
        let mut posed = PosedMesh::default();
        let moment = pose.clip.map(|clip| (clip, pose.time_secs));
        scene.toy.pose(moment, &self.plane_from_object, &mut posed)?;
        let positions: Vec<_> = posed
            .positions
            .iter()
            .map(|position| position.as_dvec3())
            .collect();
        let occluder = Occluder::new(&positions, scene.toy.indices());

        let UVec2 { x: width, y: height } = self.region.size_px;
        let mut texels = vec![[0.0; 4]; (width * height) as usize];
        let n_threads = thread::available_parallelism().map_or(1, usize::from);
        let rows: Vec<_> = (0..height).zip(texels.chunks_exact_mut(width as usize)).collect();
        // Rows are dealt out in turn: shadows are not spread evenly.
        let mut hands: Vec<Vec<_>> = (0..n_threads).map(|_| Vec::new()).collect();
        for (index, row) in rows.into_iter().enumerate() {
            hands[index % n_threads].push(row);
        }
        thread::scope(|scope| {
            for hand in hands {
                scope.spawn(|| {
                    for (y, row) in hand {
                        for (x, texel) in (0..).zip(row) {
                            *texel = self.texel(&occluder, UVec2::new(x, y));
                        }
                    }
                });
            }
        });
        Ok(FloatMap {
            width,
            height,
            texels,
        })
    }

    fn texel(&self, occluder: &Occluder, texel: UVec2) -> [f32; 4] {
        let mut visibility = [0.0; 4];
        for position in SAMPLE_POSITIONS {
            let in_plane = self.region.plane_point(texel.as_dvec2() + position);
            for (sum, light) in visibility.iter_mut().zip(&self.lights) {
                let of_sample = in_plane.map_or(1.0, |at| exact_visibility(occluder, at, light, N_RAYS));
                #[allow(clippy::cast_possible_truncation, reason = "maps hold no more")]
                let of_sample = of_sample as f32;
                *sum += 0.25 * of_sample;
            }
        }
        visibility
    }
}

/// The light in plane space, unless it is under the plane.
fn above_plane(light: &Light, plane_from_world: &DMat4) -> Option<Light> {
    let centre = light_in_plane(light, plane_from_world);
    (centre.y > 0.0).then(|| match *light {
        Light::Sphere { radius_m, .. } => Light::Sphere {
            position_in_world: centre.truncate(),
            radius_m,
        },
        Light::Directional {
            angular_radius_rad, ..
        } => Light::Directional {
            direction_to_light_in_world: centre.truncate(),
            angular_radius_rad,
        },
    })
}
