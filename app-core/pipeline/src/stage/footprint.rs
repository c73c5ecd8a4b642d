//! The footprint of a frame: its view, work region and plates; or the reason why the frame passes
//! through.

use std::mem;
use std::sync::Arc;

use glam::{DMat4, DVec3};

use super::Stage;
use crate::frame::FrameReport;
use crate::frame::warning::Warning;
use crate::geometry::clip_reach::ClipReach;
use crate::geometry::rect::{PixelRect, PlaneRect};
use crate::geometry::scene_layout::SceneLayout;
use crate::geometry::view::View;
use crate::model::plan::AROUND_TOY_PX;
use crate::passes::globals::BORDER_PX;
use crate::passes::plate::PlateViews;
use crate::plan::SkippedWork;
use crate::plates::choice::{PlateChoice, choose, covered_fraction, plate_views};
use crate::preset::Settings;
use app_scene::frame::FrameInput;
use app_scene::geometry::bounds::Bounds;
use app_scene::scene::{Camera, Shown};
use app_scene::shadow_style::ShadowStyle;
use app_scene::toy::{ClipId, ToyError};

/// Margin of a new region on each side, so that a pose that reaches a little farther does not need
/// a new view.
pub(super) const SPARE_PX: u32 = 8;

/// View, work region and plates of a frame: the same for all frames of one clip and camera, unless a pose reaches farther.
pub(super) struct Footprint {
    camera: Camera,
    pub(super) view: View,
    /// Corners of the extent of toy and shadows.
    pub(super) corners_in_world: Vec<DVec3>,
    /// The extent, including the fade at its border.
    pub(super) least_region: PixelRect,
    /// The region of a method that starts with this frame.
    pub(super) region: PixelRect,
    /// Pixels of the image that show the toy in all poses so far, and the neighbours that are read
    /// around them; `None` if it is out of the picture.
    pub(super) least_toy_box: Option<PixelRect>,
    pub(super) bounds: Bounds,
    /// Width in pixels of each light's widest penumbra.
    pub(super) penumbrae_px: Vec<f64>,
    pub(super) plane_rects: Vec<PlaneRect>,
    pub(super) choice: PlateChoice,
    pub(super) plate_views: PlateViews,
    /// Share of the region that plates show.
    pub(super) plate_fraction: f64,
}

/// The reason why a camera frame is shown unchanged.
pub(super) enum PassThrough {
    PhysicalPose,
    NoEffect,
    Warned(Warning),
}

impl PassThrough {
    pub(super) fn tell(self, report: &mut FrameReport) {
        let reason = match self {
            Self::PhysicalPose => "the shown pose is the physical pose",
            Self::NoEffect => "nothing of the effect is shown",
            Self::Warned(warning) => {
                report.warnings.push(warning);
                "see the warnings"
            }
        };
        report.skipped.push(SkippedWork {
            what: "every pass but present",
            reason,
        });
    }
}

impl Stage {
    pub(super) fn footprint(
        &mut self,
        input: &FrameInput,
    ) -> Result<Result<Arc<Footprint>, PassThrough>, ToyError> {
        let warned = |warning| Ok(Err(PassThrough::Warned(warning)));
        if self.shows_what_is_there(input) && !self.is_shadow_withheld && !self.is_layered {
            return Ok(Err(PassThrough::PhysicalPose));
        }
        if input.effect == 0.0 {
            return Ok(Err(PassThrough::NoEffect));
        }
        let needs_plate = matches!(self.settings, Settings::Baseline(_));
        if needs_plate && self.scene.plates.is_empty() {
            return warned(Warning::NoPlate);
        }
        self.reach_shown_pose(input)?;
        let camera = &input.camera;
        if let Some(known) = self.cached_footprint.as_ref()
            && known.camera == *camera
        {
            return Ok(Ok(Arc::clone(known)));
        }
        let view = self.view(camera);
        if view.camera_in(&self.layout().world_from_anchor()).y <= 0.0 {
            return warned(Warning::CameraBelowReceiver);
        }
        let footprint = self.footprint_in(view, camera).map(Arc::new);
        self.cached_footprint.clone_from(&footprint);
        Ok(footprint.ok_or(PassThrough::Warned(Warning::OutOfPicture)))
    }

    /// The footprint of the reach in a view; `None` if it is out of the picture.
    fn footprint_in(&self, view: View, camera: &Camera) -> Option<Footprint> {
        let lights = self.reaching_lights();
        let layout = SceneLayout {
            lights: &lights,
            ..self.layout()
        };
        let reach = self.reach.as_ref()?;
        let on_view = reach.on_view(&view, &layout, self.reflection_in_use());
        let least_region = on_view.region()?.grown(BORDER_PX, view.image_px);
        let region = least_region.grown(SPARE_PX, view.image_px);
        let plane_rects = on_view.plane_rects();
        let toy = on_view.toy();
        let corners_in_world = corners_in_world(&layout, &reach.bounds, &plane_rects);
        let toy_in_world = layout.world_from_anchor().transform_point3(reach.bounds.centre());
        let choice = choose(&self.scene, &view, &corners_in_world, toy_in_world);
        Some(Footprint {
            camera: *camera,
            bounds: reach.bounds,
            penumbrae_px: on_view.penumbrae_px().to_vec(),
            plate_views: plate_views(&self.scene, &layout, &view, &choice, &self.plates.gains),
            plate_fraction: covered_fraction(&self.scene, &layout, &view, &region, &choice),
            corners_in_world,
            least_region,
            region,
            least_toy_box: toy.map(|toy| toy.grown(AROUND_TOY_PX, view.image_px)),
            plane_rects,
            choice,
            view,
        })
    }

    /// Whether the frame asks for the toy in its real pose, at its real place and with its true
    /// shadow.
    fn shows_what_is_there(&self, input: &FrameInput) -> bool {
        self.shadow_style == ShadowStyle::TRUE && input.shows_real_toy(&self.scene)
    }

    /// Poses the toy for the frame and extends `reach` to contain it.
    ///
    /// The whole clip is examined when it is shown first, so that the region rarely grows while it
    /// plays. Poses by nodes and further places are only known when they arrive.
    fn reach_shown_pose(&mut self, input: &FrameInput) -> Result<(), ToyError> {
        let clip = input.shown_pose.clip();
        let anchor_from_shown = self.anchor_from_shown(input.world_from_shown.as_ref());
        let is_film = !self.scene.film.is_empty();
        let known = self.reach.take().filter(|known| is_film || known.clip == clip);
        let mut reach = match known {
            Some(known) => known,
            None => {
                self.cached_footprint = None;
                self.first_reach(clip, &anchor_from_shown)?
            }
        };
        let shown = &input.shown_pose;
        self.scene.toy.pose(shown, &anchor_from_shown, &mut self.posed)?;
        if reach.grow(&self.posed) {
            self.cached_footprint = None;
        }
        self.reach = Some(reach);
        Ok(())
    }
}

impl Stage {
    /// The reach of the film, if there is one; otherwise the reach of a clip at a place.
    fn first_reach(
        &mut self,
        clip: Option<ClipId>,
        anchor_from_shown: &DMat4,
    ) -> Result<ClipReach, ToyError> {
        let mut posed = mem::take(&mut self.posed);
        let anchor_from_object = self.anchor_from_object();
        let physical = (&self.scene.physical_pose, &anchor_from_object);
        let toy = &self.scene.toy;
        let film = self.scene.film.iter();
        let reach = if self.scene.film.is_empty() {
            ClipReach::new(toy, physical, (clip, anchor_from_shown), &mut posed)
        } else {
            let place = |shown: &Shown| self.anchor_from_shown(shown.world_from_shown.as_ref());
            let film = film.map(|shown| (&shown.pose, place(shown)));
            ClipReach::of_film(toy, physical, film, &mut posed)
        };
        self.posed = posed;
        reach
    }
}

fn corners_in_world(layout: &SceneLayout<'_>, toy: &Bounds, plane_rects: &[PlaneRect]) -> Vec<DVec3> {
    let world_from_anchor = layout.world_from_anchor();
    let of_toy = toy.corners().map(|p| world_from_anchor.transform_point3(p));
    let reached = layout.receivers.iter().zip(plane_rects);
    let on_receivers = reached
        .filter(|(_, rect)| rect.min.is_finite() && rect.max.is_finite())
        .flat_map(|(receiver, rect)| {
            let corners = rect.corners().into_iter();
            corners.map(|p| {
                receiver
                    .world_from_plane
                    .transform_point3(DVec3::new(p.x, 0.0, p.y))
            })
        });
    of_toy.chain(on_receivers).collect()
}
