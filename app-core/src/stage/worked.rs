//! Where a frame is worked on, or why it passes through.

use std::sync::Arc;

use glam::DMat4;

use super::{REGION_MARGIN_PX, Stage, clip_time};
use crate::clip_reach::ClipReach;
use crate::frame::{FrameInput, FrameReport, Warning};
use crate::gpu::layout::PlateViews;
use crate::plan::LeftOut;
use crate::plates::{self, PlateChoice};
use crate::preset::Method;
use crate::region::{Bounds, PixelRect, PlaneRect};
use crate::scene::PoseTime;
use crate::toy::{ClipId, ToyError};
use crate::view::View;

/// Where a frame is worked on: the same for all frames of one clip and camera.
pub(super) struct Worked {
    pub(super) clip: Option<ClipId>,
    pub(super) world_from_camera: DMat4,
    pub(super) view: View,
    pub(super) region: PixelRect,
    pub(super) bounds: Bounds,
    pub(super) plane_rects: Vec<PlaneRect>,
    pub(super) choice: PlateChoice,
    pub(super) plate_views: PlateViews,
    /// Share of the region that plates show.
    pub(super) plate_share: f64,
}

/// Why a camera frame is shown as it is.
pub(super) enum PassThrough {
    PhysicalPose,
    Warned(Warning),
}

impl PassThrough {
    pub(super) fn tell(self, report: &mut FrameReport) {
        let why = match self {
            Self::PhysicalPose => "the shown pose is the physical pose",
            Self::Warned(warning) => {
                report.warnings.push(warning);
                "see the warnings"
            }
        };
        report.skipped.push(LeftOut {
            what: "every pass but present",
            why,
        });
    }
}

impl Stage {
    pub(super) fn worked(
        &mut self,
        input: &FrameInput,
    ) -> Result<Result<Arc<Worked>, PassThrough>, ToyError> {
        let warned = |warning| Ok(Err(PassThrough::Warned(warning)));
        let is_physical = is_same_pose(&input.shown_pose, &self.scene.physical_pose);
        if is_physical && !self.is_shadow_withheld {
            return Ok(Err(PassThrough::PhysicalPose));
        }
        if self.lights.is_empty() {
            return warned(Warning::NoLight);
        }
        let needs_plate = matches!(self.preset.method(), Method::Published(_));
        if needs_plate && self.scene.plates.is_empty() {
            return warned(Warning::NoPlate);
        }
        let (clip, world_from_camera) = (input.shown_pose.clip, &input.world_from_camera);
        let is_known =
            |known: &&Arc<Worked>| known.clip == clip && known.world_from_camera == *world_from_camera;
        if let Some(known) = self.known_worked.as_ref().filter(is_known) {
            return Ok(Ok(Arc::clone(known)));
        }
        let view = self.view(world_from_camera);
        if view.camera_in(&self.place().world_from_stage()).y <= 0.0 {
            return warned(Warning::CameraBelowReceiver);
        }
        self.ensure_reach(clip)?;
        let worked = self.worked_in(view, world_from_camera).map(Arc::new);
        self.known_worked.clone_from(&worked);
        Ok(worked.ok_or(PassThrough::Warned(Warning::OutOfPicture)))
    }

    /// Where the clip whose reach is known is worked on in a view; none when it is out of the picture.
    fn worked_in(&self, view: View, world_from_camera: &DMat4) -> Option<Worked> {
        let (place, reach) = (self.place(), self.reach.as_ref()?);
        let on_view = reach.on_view(&view, &place);
        let region = on_view.region()?.grown(REGION_MARGIN_PX, view.image_px);
        let plane_rects = on_view.plane_rects();
        let toy_in_world = place.world_from_stage().transform_point3(reach.bounds.centre());
        let choice = plates::choose(&self.scene, world_from_camera, toy_in_world);
        Some(Worked {
            clip: reach.clip,
            world_from_camera: *world_from_camera,
            bounds: reach.bounds,
            plate_views: plates::plate_views(&self.scene, &place, &view, &choice, &self.plates.gains),
            plate_share: plates::covered_share(&self.scene, &place, &view, &region, &choice),
            region,
            plane_rects,
            choice,
            view,
        })
    }

    /// Makes `reach` what toy and shadows reach in the physical pose and over all of `clip`.
    fn ensure_reach(&mut self, clip: Option<ClipId>) -> Result<(), ToyError> {
        if self.reach.as_ref().is_none_or(|known| known.clip != clip) {
            let physical = clip_time(&self.scene.physical_pose);
            self.reach = Some(ClipReach::new(
                &self.scene.toy,
                &self.stage_from_object,
                (physical, clip),
                &mut self.posed,
            )?);
        }
        Ok(())
    }
}

/// The time of a pose without a clip means nothing.
fn is_same_pose(a: &PoseTime, b: &PoseTime) -> bool {
    a.clip == b.clip && (a.clip.is_none() || a.time_secs.total_cmp(&b.time_secs).is_eq())
}
