//! Makes what was learned fit the frame: starts from nothing, follows the camera, or leaves it as it is.

use std::mem;
use std::sync::Arc;

use glam::UVec2;

use super::worked::Worked;
use super::{Learned, Stage, is_same_image};
use crate::capture::Capture;
use crate::exposure::match_frame;
use crate::frame::{FrameInput, Warning};
use crate::gpu::Gpu;
use crate::gpu::layout::PlateViews;
use crate::grids::{grids_over, holds};
use crate::knowledge::Knowledge;
use crate::light_points::light_points;
use crate::pipeline::Passes;
use crate::plan::{Change, Plan, PublishedPlan, SceneFacts};
use crate::plates::{self, SAME_CAMERA};
use crate::preset::{Method, PublishedSettings, Settings};
use crate::published::{self, Published};
use crate::region::{PixelRect, PlaneRect};
use crate::scene::{Light, Plate};
use crate::work::{Model, Work};

/// Sizes of the region under a moving camera, so that it keeps one for a while.
const REGION_STEP_PX: u32 = 64;

/// What a frame asks of what was learned.
enum Step {
    /// It does not fit: learn from nothing.
    Start,
    /// It fits, but its inputs were replaced: learn from nothing with the same textures.
    Again,
    /// The view is new.
    Follow,
    /// The picture is new.
    Look,
    Nothing,
}

impl Stage {
    /// Makes what was learned fit the frame; tells how much of it is new.
    pub(super) fn ensure_learned(&mut self, gpu: &Gpu, input: &FrameInput, worked: &Worked) -> Change {
        self.plates.load(gpu, &self.scene, &worked.choice.indices);
        self.known_rects = united(&self.known_rects, &worked.plane_rects);
        match self.step(input, worked) {
            Step::Start => {
                self.learn(gpu, input, worked);
                Change::Place
            }
            Step::Again => Change::Place,
            Step::Follow => {
                self.follow(gpu, input, worked);
                Change::View
            }
            Step::Look => Change::Picture,
            Step::Nothing => Change::Pose,
        }
    }

    fn step(&mut self, input: &FrameInput, worked: &Worked) -> Step {
        let Some(learned) = &mut self.learned else {
            return Step::Start;
        };
        let has_grids = match &learned.work {
            Work::Model(model) => holds(&model.knowledge.layout, &worked.plane_rects),
            Work::Published(_) => true,
        };
        let is_same_camera = learned
            .world_from_camera
            .abs_diff_eq(input.world_from_camera, SAME_CAMERA);
        let is_within = is_same_camera && learned.work.region().contains(&worked.region);
        if !has_grids {
            Step::Start
        } else if !is_within {
            Step::Follow
        } else if mem::take(&mut learned.is_stale) {
            Step::Again
        } else if is_same_image(learned.image.as_ref(), &input.image) {
            Step::Nothing
        } else {
            Step::Look
        }
    }

    /// Starts from nothing.
    fn learn(&mut self, gpu: &Gpu, input: &FrameInput, worked: &Worked) {
        let work = match self.preset.method() {
            Method::Model(settings) => {
                let plan = Plan::new(&self.facts(worked, worked.region), &self.settings(settings));
                self.model(gpu, plan, worked)
            }
            Method::Published(settings) => self.published(gpu, &settings, worked.region, worked),
        };
        self.learned = Some(Learned {
            world_from_camera: input.world_from_camera,
            work,
            is_stale: false,
            image: None,
        });
    }

    /// Takes what is known to another view.
    fn follow(&mut self, gpu: &Gpu, input: &FrameInput, worked: &Worked) {
        let Some(mut learned) = self.learned.take() else {
            return;
        };
        learned.world_from_camera = input.world_from_camera;
        let size_px = moving_size(
            learned.work.region().size_px,
            &worked.region,
            worked.view.image_px,
        );
        let region = worked.region.within(size_px, worked.view.image_px);
        match self.preset.method() {
            Method::Model(settings) => {
                if let Work::Model(model) = &mut learned.work {
                    let plan = model
                        .capture
                        .plan
                        .for_view(&self.facts(worked, region), &self.settings(settings));
                    model.follow(gpu, plan, &worked.view.globals(&region, &self.place()));
                }
            }
            Method::Published(settings) => learned.work = self.published(gpu, &settings, region, worked),
        }
        self.learned = Some(learned);
    }

    fn settings(&self, preset: Settings) -> Settings {
        Settings {
            is_shadow_withheld: self.is_shadow_withheld,
            ..preset
        }
    }

    fn facts(&self, worked: &Worked, region: PixelRect) -> SceneFacts {
        let world_from_stage = self.place().world_from_stage();
        let widest_px = |light: &Light| {
            let widths = self.receivers.iter().map(|receiver| {
                let plane_from_stage = receiver.world_from_plane.inverse() * world_from_stage;
                let toy = worked.bounds.transformed(&plane_from_stage);
                worked.view.penumbra_px(light, &receiver.world_from_plane, &toy)
            });
            widths.fold(0.0, f64::max)
        };
        #[allow(clippy::cast_possible_truncation, reason = "at most four")]
        let n_receivers = self.receivers.len() as u32;
        SceneFacts {
            region,
            penumbra_px: self.lights.iter().map(widest_px).collect(),
            n_receivers,
            is_plate_complete: self.is_plate_complete(worked, &region),
        }
    }

    /// One plate or several show all of the region, which may be larger than the frame asks for.
    fn is_plate_complete(&self, worked: &Worked, region: &PixelRect) -> bool {
        let Worked { view, choice, .. } = worked;
        let share = if *region == worked.region {
            worked.plate_share
        } else {
            plates::covered_share(&self.scene, &self.place(), view, region, choice)
        };
        share == 1.0
    }

    pub(super) fn plate_warning(&self, worked: &Worked) -> Option<Warning> {
        if self.scene.plates.is_empty() {
            return Some(Warning::PlateEstimated);
        }
        let share = worked.plate_share;
        (share < 1.0).then_some(Warning::PlatePartial { share })
    }

    /// The plates as the published method takes them; the model fits the exposure with the light.
    pub(super) fn plate_views_at_exposure_of(&self, input: &FrameInput, worked: &Worked) -> PlateViews {
        let frame = Plate {
            world_from_camera: input.world_from_camera,
            image: Arc::clone(&input.image),
        };
        let plates = (&worked.choice.indices[..], &self.plates.gains[..]);
        let gain = match_frame(&self.scene, &frame, plates, &worked.region);
        plates::exposed(&worked.plate_views, gain)
    }

    fn model(&self, gpu: &Gpu, plan: Plan, worked: &Worked) -> Work {
        let globals = worked.view.globals(&plan.region, &self.place());
        let toy = (&self.toy.physical.around, self.toy.n_materials());
        let knowledge = Knowledge::new(gpu, grids_over(&self.known_rects), self.lights.len(), toy);
        let points = self.lights.iter().zip(&plan.lights);
        let points = points
            .map(|(light, planned)| self.points_of(light, planned.n_points))
            .collect();
        Work::Model(Box::new(Model {
            passes: Passes::new(gpu, &plan),
            capture: Capture::new(gpu, plan, &globals, points),
            knowledge,
        }))
    }

    /// Points over a light in the space of each receiver in turn: the same ones, so that shadows meet where receivers do.
    fn points_of(&self, light: &Light, n_points: usize) -> Vec<glam::Vec4> {
        let world_from_stage = self.place().world_from_stage();
        let target = self.physical_bounds.centre();
        let points = light_points(light, &world_from_stage.inverse(), target, n_points);
        let planes = self
            .receivers
            .iter()
            .map(|receiver| receiver.world_from_plane.inverse() * world_from_stage);
        planes
            .flat_map(|plane_from_stage| {
                points
                    .iter()
                    .map(move |p| (plane_from_stage * p.as_dvec4()).as_vec4())
            })
            .collect()
    }

    fn published(&self, gpu: &Gpu, settings: &PublishedSettings, region: PixelRect, worked: &Worked) -> Work {
        let plan = PublishedPlan::new(&self.facts(worked, region), settings);
        let globals = worked.view.globals(&region, &self.place());
        let uniform = published::uniform(&self.place(), &worked.bounds, settings);
        Work::Published(Box::new(Published::new(gpu, plan, &globals, &uniform)))
    }
}

/// The size a region takes under a moving camera: as it is while that is enough, else the next step.
fn moving_size(current_px: UVec2, needed: &PixelRect, image_px: UVec2) -> UVec2 {
    let step = |side_px: u32| side_px.div_ceil(REGION_STEP_PX) * REGION_STEP_PX;
    let stepped = UVec2::new(step(needed.size_px.x), step(needed.size_px.y)).min(image_px);
    if needed.size_px.cmple(current_px).all() {
        current_px
    } else {
        stepped.max(current_px)
    }
}

/// What either reaches of each receiver, so that going back and forth between clips starts nothing anew.
fn united(known: &[PlaneRect], new: &[PlaneRect]) -> Vec<PlaneRect> {
    if known.is_empty() {
        return new.to_vec();
    }
    let pairs = known.iter().zip(new);
    pairs
        .map(|(a, b)| PlaneRect {
            min: a.min.min(b.min),
            max: a.max.max(b.max),
        })
        .collect()
}
