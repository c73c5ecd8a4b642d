//! A preset with ray-traced visibility in place of its own.

use std::thread;

use app_core::core::Core;
use app_core::frame::FrameInput;
use app_core::preset::Preset;
use app_core::scene::{Camera, Light, Pose, Scene};
use app_core::scene::{MAX_LIGHTS, MAX_RECEIVERS};
use app_core::session::{Capture, GroundTruth, Session};
use app_core::toy::{PosedMesh, ToyError};
use app_pipeline::core::inspect::Inspect;
use app_pipeline::geometry::anchored::AnchoredReceiver;
use app_pipeline::geometry::rect::PixelRect;
use app_pipeline::geometry::scene_layout::SceneLayout;
use app_pipeline::geometry::view::View;
use app_pipeline::readback::FloatMap;
use app_pipeline::readback::inject::InjectedVisibility;
use glam::{DMat4, DVec3, UVec2};

use desk::lens::through_lens;
use desk::metrics::flicker::{Follower, mean_flicker};
use desk::metrics::score;
use desk::replay::ReplayError;
use desk::report::mean_scores;
use reference::model::Region;
use reference::occlusion::{Occluder, sample_position};
use reference::visibility::exact_visibility;

use super::{Options, Row};

/// Number of positions within a pixel from which rays go to each light.
const N_POSITIONS: usize = 16;
/// Number of rays from each of them.
const N_RAYS: usize = 16;

/// Scores a preset with exact visibility.
pub(super) fn measure(
    session: &Capture,
    core: &mut Core,
    preset: Preset,
    options: &Options,
) -> Result<Row, ReplayError> {
    let scene = session.scene();
    core.set_scene(scene.clone(), preset)?;
    let frames = options.frames.within(session.n_frames())?;
    let n_frames = frames.len();
    let (mut scores, mut flicker) = (Vec::new(), Vec::new());
    let mut follower = Follower::default();
    let mut physical: Option<(Camera, DMat4, FloatMap)> = None;
    for index in frames {
        let failed = |reason| ReplayError::Frame { index, reason };
        let input = FrameInput::from(&session.frame(index)?);
        if let Some(rect) = core.frame(&input).map_err(failed)?.region {
            let rays = Rays::new(scene, &input, &rect);
            let map = |pose: &Pose, world_from_object: &DMat4| {
                let visibility = rays.visibility(scene, pose, world_from_object);
                visibility.map_err(|error| failed(error.into()))
            };
            // The frame's own place, which may differ from the scene's.
            let world_from_object = input.world_from_object;
            let known = physical.take().filter(|(camera, place, map)| {
                let size_px = [map.width, map.height];
                (*camera, *place, size_px) == (input.camera, world_from_object, rect.size_px.to_array())
            });
            let of_place = match known {
                Some((_, _, map)) => map,
                None => map(&scene.physical_pose, &world_from_object)?,
            };
            physical = Some((input.camera, world_from_object, of_place.clone()));
            let world_from_shown = input.world_from_shown.unwrap_or(world_from_object);
            let maps = InjectedVisibility {
                physical: Some(of_place),
                shown: Some(map(&input.shown_pose, &world_from_shown)?),
            };
            core.inject_visibility(&maps).map_err(failed)?;
            core.frame(&input).map_err(failed)?;
        }
        if let Some(truth) = session.truth(index)? {
            let picture = through_lens(session, index, core.read_picture().map_err(failed)?)?;
            let failed = |reason| ReplayError::Score { index, reason };
            scores.push(score(&picture, &truth).map_err(failed)?);
            flicker.extend(follower.next(index, &picture, &truth).map_err(failed)?);
        }
    }
    Ok(Row {
        session: scene.name.clone(),
        preset: format!("{preset}+exact"),
        n_frames,
        scores: mean_scores(&scores),
        flicker: mean_flicker(&flicker),
        align_ms: None,
        size_px: [session.scene().width_px, session.scene().height_px],
        times: Vec::new(),
        n_taps: None,
    })
}

/// The region, and the lights in each receiver's plane space.
struct Rays {
    region: Region,
    lights: Vec<Vec<Light>>,
    anchor_from_world: DMat4,
}

impl Rays {
    fn new(scene: &Scene, input: &FrameInput, rect: &PixelRect) -> Self {
        let used = scene.receivers.iter().take(MAX_RECEIVERS);
        let toy_in_world = input.world_from_object.w_axis.truncate();
        let receivers: Vec<AnchoredReceiver> = used
            .map(|receiver| AnchoredReceiver::near(receiver, toy_in_world))
            .collect();
        let image_px = UVec2::new(scene.width_px, scene.height_px);
        let view = View::new(image_px, &input.camera);
        let layout = SceneLayout {
            receivers: &receivers,
            lights: &[],
            toy_in_anchor: DVec3::ZERO,
        };
        let planes_from_world: Vec<DMat4> = receivers
            .iter()
            .map(|receiver| receiver.world_from_plane.inverse())
            .collect();
        let is_usable = |light: &&Light| {
            let mut planes = planes_from_world.iter();
            planes.any(|plane_from_world| light.is_above(plane_from_world))
        };
        let usable: Vec<&Light> = scene.lights.iter().filter(is_usable).take(MAX_LIGHTS).collect();
        let lights_in = |plane_from_world: &DMat4| {
            let lights = usable.iter();
            lights.map(|light| light.moved(plane_from_world)).collect()
        };
        Self {
            region: Region::new(&view, rect, &layout),
            lights: planes_from_world.iter().map(lights_in).collect(),
            anchor_from_world: layout.world_from_anchor().inverse(),
        }
    }

    /// Visibility of each light over the region, with the toy in a pose at a place.
    fn visibility(
        &self,
        scene: &Scene,
        pose: &Pose,
        world_from_object: &DMat4,
    ) -> Result<FloatMap, ToyError> {
        let mut posed = PosedMesh::default();
        let anchor_from_object = self.anchor_from_world * *world_from_object;
        scene.toy.pose(pose, &anchor_from_object, &mut posed)?;
        let occluder_in = |plane_from_anchor: &DMat4| {
            let positions = posed.positions.iter();
            let positions: Vec<DVec3> = positions
                .map(|position| plane_from_anchor.transform_point3(position.as_dvec3()))
                .collect();
            Occluder::new(&positions, scene.toy.indices())
        };
        let receivers = self.region.receivers.iter();
        let occluders: Vec<Occluder> = receivers
            .map(|receiver| occluder_in(&receiver.plane_from_anchor))
            .collect();

        let UVec2 { x: width, y: height } = self.region.size_px;
        let mut texels = vec![[0.0; 4]; (width * height) as usize];
        let n_threads = thread::available_parallelism().map_or(1, usize::from);
        let rows: Vec<_> = (0..height).zip(texels.chunks_exact_mut(width as usize)).collect();
        // Rows are distributed alternately, since shadows are not evenly spread.
        let mut hands: Vec<Vec<_>> = (0..n_threads).map(|_| Vec::new()).collect();
        for (index, row) in rows.into_iter().enumerate() {
            hands[index % n_threads].push(row);
        }
        thread::scope(|scope| {
            for hand in hands {
                scope.spawn(|| {
                    for (y, row) in hand {
                        for (x, texel) in (0..).zip(row) {
                            *texel = self.texel(&occluders, UVec2::new(x, y));
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

    fn texel(&self, occluders: &[Occluder], texel: UVec2) -> [f32; 4] {
        let mut visibility = [0.0; 4];
        for position in (0..N_POSITIONS).map(|i| sample_position(i, N_POSITIONS)) {
            let point = self.region.receiver_point(texel.as_dvec2() + position);
            let receiver = point.map_or(0, |point| point.receiver);
            for (sum, light) in visibility.iter_mut().zip(&self.lights[receiver]) {
                let of_sample = point.map_or(1.0, |point| {
                    exact_visibility(&occluders[receiver], point.in_plane, light, N_RAYS)
                });
                #[allow(clippy::cast_possible_truncation, reason = "maps hold no more")]
                let of_sample = of_sample as f32;
                *sum += of_sample / N_POSITIONS as f32;
            }
        }
        visibility
    }
}
