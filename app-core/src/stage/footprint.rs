//! Where a frame is worked on, or why it passes through.

use std::sync::Arc;

use super::Stage;
use crate::frame::input::FrameInput;
use crate::frame::report::FrameReport;
use crate::frame::warning::Warning;
use crate::geometry::bounds::Bounds;
use crate::geometry::clip_reach::ClipReach;
use crate::geometry::rect::{PixelRect, PlaneRect};
use crate::geometry::view::View;
use crate::passes::plate::PlateViews;
use crate::plan::LeftOut;
use crate::plates::choice::{PlateChoice, choose, covered_fraction, plate_views};
use crate::preset::Settings;
use crate::scene::Camera;
use crate::toy::{ClipId, ToyError};

use crate::passes::globals::BORDER_PX;

/// The fade at the region's border, and what the toy may reach beyond its region between two moments of a clip.
const REGION_MARGIN_PX: u32 = BORDER_PX + 8;

/// Where a frame is worked on: the same for all frames of one clip and camera.
pub(super) struct Footprint {
    pub(super) clip: Option<ClipId>,
    pub(super) camera: Camera,
    pub(super) view: View,
    pub(super) region: PixelRect,
    pub(super) bounds: Bounds,
    pub(super) plane_rects: Vec<PlaneRect>,
    pub(super) choice: PlateChoice,
    pub(super) plate_views: PlateViews,
    /// Share of the region that plates show.
    pub(super) plate_fraction: f64,
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
    pub(super) fn footprint(
        &mut self,
        input: &FrameInput,
    ) -> Result<Result<Arc<Footprint>, PassThrough>, ToyError> {
        let warned = |warning| Ok(Err(PassThrough::Warned(warning)));
        let is_physical = input.shown_pose == self.scene.physical_pose;
        if is_physical && !self.is_shadow_withheld {
            return Ok(Err(PassThrough::PhysicalPose));
        }
        if self.lights.is_empty() {
            return warned(Warning::NoLight);
        }
        let needs_plate = matches!(self.preset.settings(), Settings::Baseline(_));
        if needs_plate && self.scene.plates.is_empty() {
            return warned(Warning::NoPlate);
        }
        let (clip, camera) = (input.shown_pose.clip(), &input.camera);
        let is_known = |known: &&Arc<Footprint>| known.clip == clip && known.camera == *camera;
        if let Some(known) = self.cached_footprint.as_ref().filter(is_known) {
            return Ok(Ok(Arc::clone(known)));
        }
        let view = self.view(camera);
        if view.camera_in(&self.layout().world_from_anchor()).y <= 0.0 {
            return warned(Warning::CameraBelowReceiver);
        }
        self.ensure_reach(clip)?;
        let footprint = self.footprint_in(view, camera).map(Arc::new);
        self.cached_footprint.clone_from(&footprint);
        Ok(footprint.ok_or(PassThrough::Warned(Warning::OutOfPicture)))
    }

    /// Where the clip whose reach is known is worked on in a view; none when it is out of the picture.
    fn footprint_in(&self, view: View, camera: &Camera) -> Option<Footprint> {
        let (layout, reach) = (self.layout(), self.reach.as_ref()?);
        let on_view = reach.on_view(&view, &layout);
        let region = on_view.region()?.grown(REGION_MARGIN_PX, view.image_px);
        let plane_rects = on_view.plane_rects();
        let toy_in_world = layout.world_from_anchor().transform_point3(reach.bounds.centre());
        let choice = choose(&self.scene, &camera.world_from_camera, toy_in_world);
        Some(Footprint {
            clip: reach.clip,
            camera: *camera,
            bounds: reach.bounds,
            plate_views: plate_views(&self.scene, &layout, &view, &choice, &self.plates.gains),
            plate_fraction: covered_fraction(&self.scene, &layout, &view, &region, &choice),
            region,
            plane_rects,
            choice,
            view,
        })
    }

    /// Makes `reach` what toy and shadows reach in the physical pose and over all of `clip`.
    fn ensure_reach(&mut self, clip: Option<ClipId>) -> Result<(), ToyError> {
        if self.reach.as_ref().is_none_or(|known| known.clip != clip) {
            let physical = &self.scene.physical_pose;
            self.reach = Some(ClipReach::new(
                &self.scene.toy,
                &self.anchor_from_object,
                (physical, clip),
                &mut self.posed,
            )?);
        }
        Ok(())
    }
}
