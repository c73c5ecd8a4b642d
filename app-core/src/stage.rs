//! A scene on the device: the toy, the plates and the frame, and what was learned from them.

use std::mem;
use std::sync::Arc;

use glam::{DMat4, UVec2};

use crate::capture::{Capture, Pictures};
use crate::clip_reach::ClipReach;
use crate::frame::{FrameInput, FrameReport, Warning};
use crate::gpu::Gpu;
use crate::gpu::encoder::Encoder;
use crate::gpu::layout::{MAX_LIGHTS, MAX_RECEIVERS, PlateViews};
use crate::gpu::texture::{Texture, TextureShape};
use crate::grids::{grids_over, holds};
use crate::inject::InjectedVisibility;
use crate::knowledge::Knowledge;
use crate::light_points::light_points;
use crate::passes::present::Present;
use crate::passes::toy_mesh::ToyMesh;
use crate::pipeline::{Passes, encode_present};
use crate::plan::{Change, LeftOut, Path, Plan, PublishedPlan, SceneFacts, runs};
use crate::plate_store::PlateStore;
use crate::plates::{self, PlateChoice, SAME_CAMERA};
use crate::preset::{Method, Preset, PublishedSettings};
use crate::published::{self, Published};
use crate::region::{BORDER_PX, Bounds, PixelRect, PlaneRect};
use crate::scene::{Image, Light, PoseTime, Receiver, Scene};
use crate::standing::{Most, usable};
use crate::toy::{ClipId, PosedMesh, ToyError};
use crate::view::{Place, View};
use crate::work::{Model, Work};

/// The fade at the region's border, and what the toy may reach beyond its region between two moments of a clip.
const REGION_MARGIN_PX: u32 = BORDER_PX + 8;
/// Sizes of the region under a moving camera, so that it keeps one for a while.
const REGION_STEP_PX: u32 = 64;
/// Format of the finished picture: codes, as a screen takes them.
pub(crate) const OUTPUT_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// A scene on the device.
pub(crate) struct Stage {
    scene: Scene,
    preset: Preset,
    lights: Vec<Light>,
    receivers: Vec<Receiver>,
    stage_from_object: DMat4,
    physical_bounds: Bounds,
    /// What the clip shown last reaches.
    reach: Option<ClipReach>,
    toy: ToyMesh,
    posed: PosedMesh,
    frame: Texture,
    frame_image: Option<Arc<Image>>,
    plates: PlateStore,
    present: Present,
    learned: Option<Learned>,
    standing_warnings: Vec<Warning>,
    pub(crate) output: Texture,
}

/// What was learned, and of which camera.
struct Learned {
    world_from_camera: DMat4,
    work: Work,
    /// Its inputs were replaced: learn again.
    is_stale: bool,
    /// The camera picture that was worked on last.
    image: Option<Arc<Image>>,
}

/// Where a frame is worked on.
struct Worked {
    view: View,
    region: PixelRect,
    bounds: Bounds,
    plane_rects: Vec<PlaneRect>,
    choice: PlateChoice,
}

impl Stage {
    pub(crate) fn new(gpu: &Gpu, scene: Scene, preset: Preset) -> Result<Self, ToyError> {
        let stage_from_object = scene.receivers[0].world_from_plane.inverse() * scene.world_from_object;
        let mut posed = PosedMesh::default();
        scene
            .toy
            .pose(clip_time(&scene.physical_pose), &stage_from_object, &mut posed)?;
        let size_px = [scene.width_px, scene.height_px];
        let most = match preset.method() {
            Method::Model(_) => Most {
                lights: MAX_LIGHTS,
                receivers: MAX_RECEIVERS,
            },
            Method::Published(_) => Most {
                lights: 1,
                receivers: 1,
            },
        };
        let usable = usable(&scene, most);
        let output = TextureShape {
            size_px,
            format: OUTPUT_FORMAT,
            n_samples: 1,
        };
        Ok(Self {
            physical_bounds: Bounds::around(posed.positions.iter().map(|p| p.as_dvec3())),
            toy: ToyMesh::new(gpu, &scene.toy, &posed),
            posed,
            frame: Texture::picture(gpu, "frame", size_px),
            frame_image: None,
            plates: PlateStore::new(gpu, &scene),
            present: Present::new(gpu, OUTPUT_FORMAT),
            learned: None,
            standing_warnings: usable.warnings,
            lights: usable.lights,
            receivers: usable.receivers,
            output: Texture::target(gpu, "output", output),
            preset,
            stage_from_object,
            scene,
            reach: None,
        })
    }

    /// The scene that is staged.
    pub(crate) fn scene(&self) -> &Scene {
        &self.scene
    }

    /// What was learned so far.
    pub(crate) fn work(&self) -> Option<&Work> {
        self.learned.as_ref().map(|learned| &learned.work)
    }

    /// Drops what was learned, so that the next frame learns anew.
    pub(crate) fn forget(&mut self) {
        self.learned = None;
    }

    /// Replaces visibilities in what follows, where anything was learned.
    pub(crate) fn inject(&mut self, gpu: &Gpu, maps: &InjectedVisibility) {
        if let Some(learned) = &mut self.learned {
            learned.work.inject(gpu, maps);
            learned.is_stale = true;
        }
    }

    /// Encodes one frame into `output`.
    pub(crate) fn encode(
        &mut self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        input: &FrameInput,
    ) -> Result<FrameReport, ToyError> {
        self.take_image(gpu, &input.image);
        let mut report = FrameReport {
            ran: Vec::new(),
            skipped: Vec::new(),
            region: None,
            warnings: self.standing_warnings.clone(),
        };
        let worked = match self.worked(input)? {
            Err(reason) => {
                reason.tell(&mut report);
                None
            }
            Ok(worked) => {
                self.encode_region(gpu, encoder, input, &worked, &mut report)?;
                self.learned.as_ref()
            }
        };
        let work = worked.map(|learned| &learned.work);
        let codes = self.frame.codes();
        encode_present(gpu, encoder, &self.present, (&codes, work), &self.output.view);
        report.ran.push((Path::Frame, "present"));
        Ok(report)
    }

    fn encode_region(
        &mut self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        input: &FrameInput,
        worked: &Worked,
        report: &mut FrameReport,
    ) -> Result<(), ToyError> {
        // First, so that a pose that fails leaves nothing half learned.
        self.scene.toy.pose(
            clip_time(&input.shown_pose),
            &self.stage_from_object,
            &mut self.posed,
        )?;
        self.toy.shown.write(gpu, &self.posed);
        let change = self.ensure_learned(gpu, input, worked);
        let plate_views = self.plate_views(worked);
        let Some(learned) = &mut self.learned else {
            return Ok(());
        };
        learned.image = Some(Arc::clone(&input.image));
        let work = &learned.work;
        let pictures = Pictures {
            frame: &self.frame.view,
            plates: &self.plates.pictures.view,
            plate_views,
        };
        work.encode(gpu, encoder, &self.toy, &pictures, change);
        if change < Change::View {
            report.skipped.push(LeftOut {
                what: "capture path",
                why: "place, pose and camera are known",
            });
        }
        report.ran.extend(runs(work.passes(), change));
        report.skipped.extend_from_slice(work.left_out());
        report.region = Some(work.region());
        report.warnings.extend(self.plate_warning(worked));
        Ok(())
    }

    /// Uploads the camera's picture unless it is the one that is there already.
    fn take_image(&mut self, gpu: &Gpu, image: &Arc<Image>) {
        if is_same_image(self.frame_image.as_ref(), image) {
            return;
        }
        self.frame.write(gpu, &image.rgba8);
        self.frame_image = Some(Arc::clone(image));
    }

    fn worked(&mut self, input: &FrameInput) -> Result<Result<Worked, PassThrough>, ToyError> {
        let warned = |warning| Ok(Err(PassThrough::Warned(warning)));
        if is_same_pose(&input.shown_pose, &self.scene.physical_pose) {
            return Ok(Err(PassThrough::PhysicalPose));
        }
        if self.lights.is_empty() {
            return warned(Warning::NoLight);
        }
        let needs_plate = matches!(self.preset.method(), Method::Published(_));
        if needs_plate && self.scene.plates.is_empty() {
            return warned(Warning::NoPlate);
        }
        let view = self.view(&input.world_from_camera);
        if view.camera_in(&self.place().world_from_stage()).y <= 0.0 {
            return warned(Warning::CameraBelowReceiver);
        }
        let reach = self.clip_reach(input.shown_pose.clip)?;
        let bounds = reach.bounds;
        let on_view = reach.on_view(&view, &self.place());
        let toy_in_world = self.place().world_from_stage().transform_point3(bounds.centre());
        Ok(match on_view.region() {
            Some(region) => Ok(Worked {
                region: region.grown(REGION_MARGIN_PX, view.image_px),
                bounds,
                plane_rects: on_view.plane_rects(),
                choice: plates::choose(&self.scene, &input.world_from_camera, toy_in_world),
                view,
            }),
            None => Err(PassThrough::Warned(Warning::OutOfPicture)),
        })
    }

    /// What toy and shadows reach in the physical pose and over all of `clip`.
    fn clip_reach(&mut self, clip: Option<ClipId>) -> Result<ClipReach, ToyError> {
        if let Some(known) = self.reach.as_ref().filter(|known| known.clip == clip) {
            return Ok(known.clone());
        }
        let physical = clip_time(&self.scene.physical_pose);
        let reach = ClipReach::new(
            &self.scene.toy,
            &self.stage_from_object,
            (physical, clip),
            &mut self.posed,
        )?;
        self.reach = Some(reach.clone());
        Ok(reach)
    }

    /// Makes what was learned fit the frame; tells how much of it is new.
    fn ensure_learned(&mut self, gpu: &Gpu, input: &FrameInput, worked: &Worked) -> Change {
        self.plates.load(gpu, &self.scene, &worked.choice.indices);
        let change = self.change(input, worked);
        match change {
            Change::Place => self.learn(gpu, input, worked),
            Change::View => self.follow(gpu, input, worked),
            Change::Picture | Change::Pose => {}
        }
        change
    }

    fn change(&mut self, input: &FrameInput, worked: &Worked) -> Change {
        let Some(learned) = &mut self.learned else {
            return Change::Place;
        };
        let known_rects = match &learned.work {
            Work::Model(model) => holds(&model.knowledge.layout, &worked.plane_rects),
            Work::Published(_) => true,
        };
        let is_same_camera = learned
            .world_from_camera
            .abs_diff_eq(input.world_from_camera, SAME_CAMERA);
        let is_within = is_same_camera && learned.work.region().contains(&worked.region);
        if !known_rects {
            Change::Place
        } else if !is_within {
            Change::View
        } else if mem::take(&mut learned.is_stale) {
            Change::Place
        } else if is_same_image(learned.image.as_ref(), &input.image) {
            Change::Pose
        } else {
            Change::Picture
        }
    }

    /// Starts from nothing.
    fn learn(&mut self, gpu: &Gpu, input: &FrameInput, worked: &Worked) {
        // What was injected stays with its textures.
        if let Some(learned) = &self.learned
            && learned.work.region().contains(&worked.region)
            && learned
                .world_from_camera
                .abs_diff_eq(input.world_from_camera, SAME_CAMERA)
        {
            return;
        }
        let work = match self.preset.method() {
            Method::Model(settings) => {
                let plan = Plan::new(&self.facts(worked, worked.region), &settings);
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
        match (&mut learned.work, self.preset.method()) {
            (Work::Model(model), Method::Model(settings)) => {
                let facts = self.facts(worked, region);
                let plan = model.capture.plan.for_view(&facts, &settings);
                model.follow(gpu, plan, &worked.view.globals(&region, &self.place()));
            }
            (work, Method::Published(settings)) => *work = self.published(gpu, &settings, region, worked),
            (Work::Published(_), Method::Model(_)) => {}
        }
        self.learned = Some(learned);
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
            is_plate_complete: self.covered_share(worked) == 1.0,
        }
    }

    fn covered_share(&self, worked: &Worked) -> f64 {
        let Worked {
            view, region, choice, ..
        } = worked;
        plates::covered_share(&self.scene, &self.place(), view, region, choice)
    }

    fn plate_warning(&self, worked: &Worked) -> Option<Warning> {
        if self.scene.plates.is_empty() {
            return Some(Warning::PlateEstimated);
        }
        let share = self.covered_share(worked);
        (share < 1.0).then_some(Warning::PlatePartial { share })
    }

    fn plate_views(&self, worked: &Worked) -> PlateViews {
        plates::plate_views(
            &self.scene,
            &self.place(),
            &worked.view,
            &worked.choice,
            &self.plates.gains,
        )
    }

    fn model(&self, gpu: &Gpu, plan: Plan, worked: &Worked) -> Work {
        let globals = worked.view.globals(&plan.region, &self.place());
        let knowledge = Knowledge::new(gpu, grids_over(&worked.plane_rects), self.lights.len());
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
        let surface = self.scene.receivers[0].surface;
        let stage_from_world = self.place().world_from_stage().inverse();
        let uniform = published::uniform(&self.lights[0], &stage_from_world, surface, settings);
        Work::Published(Box::new(Published::new(
            gpu,
            plan,
            &globals,
            &uniform,
            worked.bounds.max.y,
        )))
    }

    fn place(&self) -> Place<'_> {
        Place {
            receivers: &self.receivers,
            lights: &self.lights,
            toy_in_stage: self.physical_bounds.centre(),
        }
    }

    fn view(&self, world_from_camera: &DMat4) -> View {
        let image_px = UVec2::new(self.scene.width_px, self.scene.height_px);
        View::new(image_px, self.scene.intrinsics, world_from_camera)
    }
}

/// Why a camera frame is shown as it is.
enum PassThrough {
    PhysicalPose,
    Warned(Warning),
}

impl PassThrough {
    fn tell(self, report: &mut FrameReport) {
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

fn is_same_image(known: Option<&Arc<Image>>, image: &Arc<Image>) -> bool {
    known.is_some_and(|known| Arc::ptr_eq(known, image))
}

/// The time of a pose without a clip means nothing.
fn is_same_pose(a: &PoseTime, b: &PoseTime) -> bool {
    a.clip == b.clip && (a.clip.is_none() || a.time_secs.total_cmp(&b.time_secs).is_eq())
}

fn clip_time(pose: &PoseTime) -> Option<(ClipId, f64)> {
    pose.clip.map(|clip| (clip, pose.time_secs))
}
