//! A scene on the device: the toy, the plate and the frame, and what was learned from them.

use std::mem;
use std::sync::Arc;

use glam::{DMat4, DVec2, DVec3, UVec2};

use crate::capture::{Capture, Pictures};
use crate::frame::{FrameInput, FrameReport, Warning};
use crate::gpu::Gpu;
use crate::gpu::encoder::Encoder;
use crate::gpu::layout::{Globals, MAX_LIGHTS};
use crate::gpu::texture::{Texture, TextureShape};
use crate::inject::InjectedVisibility;
use crate::light_points::light_points;
use crate::passes::present::Present;
use crate::passes::toy_mesh::ToyMesh;
use crate::pipeline::{Passes, encode_present};
use crate::plan::{LeftOut, Path, Plan, PublishedPlan, SceneFacts};
use crate::preset::{Method, Preset, PublishedSettings};
use crate::published::{self, Published};
use crate::region::{BORDER_PX, Bounds, PixelRect, Place, Reach, View};
use crate::scene::{Image, Light, PoseTime, Scene};
use crate::standing;
use crate::toy::{ClipId, PosedMesh, ToyError};
use crate::work::{News, Work};

/// Cameras closer than this, in matrix elements, are one camera.
const SAME_CAMERA: f64 = 1e-6;
/// Moments of a clip that its region is taken from.
const N_REGION_MOMENTS: u32 = 64;
/// The fade at the region's border, and what the toy may reach beyond its region between two such moments.
const REGION_MARGIN_PX: u32 = BORDER_PX + 8;
/// Format of the finished picture: codes, as a screen takes them.
pub(crate) const OUTPUT_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// A scene on the device.
pub(crate) struct Stage {
    scene: Scene,
    preset: Preset,
    plane_from_object: DMat4,
    plane_from_world: DMat4,
    lights: Vec<Light>,
    physical_bounds: Bounds,
    /// What the clip shown last reaches, from the camera it was shown from.
    known_reach: Option<KnownReach>,
    toy: ToyMesh,
    posed: PosedMesh,
    frame: Texture,
    frame_image: Option<Arc<Image>>,
    plate: Texture,
    present: Present,
    learned: Option<Learned>,
    standing_warnings: Vec<Warning>,
    pub(crate) output: Texture,
}

/// What toy and shadows reach in the physical pose and over a clip.
#[derive(Clone, Copy)]
struct KnownReach {
    /// The clip; none for the model's pose as authored.
    clip: Option<ClipId>,
    world_from_camera: DMat4,
    /// The toy alone, in plane space.
    bounds: Bounds,
    /// None when it is out of the picture.
    region: Option<PixelRect>,
}

/// What was learned, and of which camera.
struct Learned {
    world_from_camera: DMat4,
    work: Work,
    /// Its inputs were replaced: learn again.
    is_stale: bool,
    /// The camera picture that the toy's colours were last taken from.
    appearance_of: Option<Arc<Image>>,
}

impl Stage {
    pub(crate) fn new(gpu: &Gpu, scene: Scene, preset: Preset) -> Result<Self, ToyError> {
        let receiver = &scene.receivers[0];
        let plane_from_world = receiver.world_from_plane.inverse();
        let plane_from_object = plane_from_world * scene.world_from_object;
        let mut posed = PosedMesh::default();
        scene
            .toy
            .pose(clip_time(&scene.physical_pose), &plane_from_object, &mut posed)?;
        let size_px = [scene.width_px, scene.height_px];
        let (lights, standing_warnings) = standing::usable_lights(&scene, &plane_from_world, MAX_LIGHTS);
        let output = TextureShape {
            size_px,
            format: OUTPUT_FORMAT,
            n_samples: 1,
        };
        Ok(Self {
            physical_bounds: bounds_of(posed.positions.iter().map(|p| p.as_dvec3())),
            toy: ToyMesh::new(gpu, &scene.toy, &posed),
            posed,
            frame: Texture::picture(gpu, "frame", size_px),
            frame_image: None,
            plate: Texture::picture(gpu, "plate", size_px),
            present: Present::new(gpu, OUTPUT_FORMAT),
            learned: None,
            standing_warnings,
            output: Texture::target(gpu, "output", output),
            preset,
            plane_from_object,
            plane_from_world,
            lights,
            scene,
            known_reach: None,
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
        let worked = match self.region_of(input)? {
            Err(reason) => {
                reason.tell(&mut report);
                None
            }
            Ok(reach) => {
                self.encode_region(gpu, encoder, input, &reach, &mut report)?;
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
        reach: &Worked,
        report: &mut FrameReport,
    ) -> Result<(), ToyError> {
        // First, so that a pose that fails leaves nothing half learned.
        self.scene.toy.pose(
            clip_time(&input.shown_pose),
            &self.plane_from_object,
            &mut self.posed,
        )?;
        self.toy.shown.write(gpu, &self.posed);
        let is_place_new = self.ensure_learned(gpu, input, reach);
        let Some(learned) = &mut self.learned else {
            return Ok(());
        };
        let is_image_new = !learned
            .appearance_of
            .as_ref()
            .is_some_and(|known| Arc::ptr_eq(known, &input.image));
        learned.appearance_of = Some(Arc::clone(&input.image));
        let work = &learned.work;
        let pictures = Pictures {
            frame: &self.frame.view,
            plate: &self.plate.view,
        };
        let news = News {
            is_place_new,
            is_image_new,
        };
        work.encode(gpu, encoder, &self.toy, &pictures, news);
        if !is_place_new {
            report.skipped.push(LeftOut {
                what: "capture path",
                why: "place, pose and camera are known",
            });
        }
        report.ran.extend(news.runs(work.passes()));
        report.skipped.extend_from_slice(work.left_out());
        report.region = Some(work.region());
        Ok(())
    }

    /// Uploads the camera's picture unless it is the one that is there already.
    fn take_image(&mut self, gpu: &Gpu, image: &Arc<Image>) {
        if self
            .frame_image
            .as_ref()
            .is_some_and(|known| Arc::ptr_eq(known, image))
        {
            return;
        }
        self.frame.write(gpu, &image.rgba8);
        self.frame_image = Some(Arc::clone(image));
    }

    fn region_of(&mut self, input: &FrameInput) -> Result<Result<Worked, PassThrough>, ToyError> {
        let warned = |warning| Ok(Err(PassThrough::Warned(warning)));
        if is_same_pose(&input.shown_pose, &self.scene.physical_pose) {
            return Ok(Err(PassThrough::PhysicalPose));
        }
        if self.lights.is_empty() {
            return warned(Warning::NoLight);
        }
        if self.plate_image(&input.world_from_camera).is_none() {
            return warned(Warning::NoPlate);
        }
        if self.view(&input.world_from_camera).camera_in_stage().y <= 0.0 {
            return warned(Warning::CameraBelowReceiver);
        }
        let reach = self.reach(input.shown_pose.clip, &input.world_from_camera)?;
        Ok(match reach.region {
            Some(region) => Ok(Worked {
                region,
                bounds: reach.bounds,
            }),
            None => Err(PassThrough::Warned(Warning::OutOfPicture)),
        })
    }

    /// What toy and shadows reach in the physical pose and over all of `clip`.
    fn reach(&mut self, clip: Option<ClipId>, world_from_camera: &DMat4) -> Result<KnownReach, ToyError> {
        if let Some(known) = self.known_reach
            && known.clip == clip
            && known
                .world_from_camera
                .abs_diff_eq(*world_from_camera, SAME_CAMERA)
        {
            return Ok(known);
        }
        let over_clip = match clip {
            Some(clip) => self.scene.toy.bounds_over_clip(clip)?,
            None => self.scene.toy.bounds_of_pose(None)?,
        };
        let in_object = Bounds {
            min: over_clip.min.as_dvec3(),
            max: over_clip.max.as_dvec3(),
        };
        let corners = in_object
            .corners()
            .map(|p| self.plane_from_object.transform_point3(p));
        let bounds = bounds_of(corners.chain([self.physical_bounds.min, self.physical_bounds.max]));
        let view = self.view(world_from_camera);
        let mut reach = Reach::new(&view, &bounds, &self.lights, &self.plane_from_world);
        for pose in self
            .moments(clip)
            .into_iter()
            .chain([clip_time(&self.scene.physical_pose)])
        {
            self.scene
                .toy
                .pose(pose, &self.plane_from_object, &mut self.posed)?;
            self.posed
                .positions
                .iter()
                .for_each(|p| reach.include(p.as_dvec3()));
        }
        let region = reach
            .region()
            .map(|region| region.grown(REGION_MARGIN_PX, view.image_px));
        let known = KnownReach {
            clip,
            world_from_camera: *world_from_camera,
            bounds,
            region,
        };
        self.known_reach = Some(known);
        Ok(known)
    }

    /// Moments of a clip, evenly spaced, or the pose as authored.
    fn moments(&self, clip: Option<ClipId>) -> Vec<Option<(ClipId, f64)>> {
        let Some(clip) = clip else { return vec![None] };
        let duration_secs = self.scene.toy.clips()[clip.index()].duration_secs;
        (0..N_REGION_MOMENTS)
            .map(|k| {
                Some((
                    clip,
                    duration_secs * f64::from(k) / f64::from(N_REGION_MOMENTS - 1),
                ))
            })
            .collect()
    }

    /// Makes what was learned cover the region from this camera; true when it must be learned anew.
    fn ensure_learned(&mut self, gpu: &Gpu, input: &FrameInput, worked: &Worked) -> bool {
        let Worked { region, bounds } = *worked;
        if let Some(learned) = &mut self.learned
            && learned
                .world_from_camera
                .abs_diff_eq(input.world_from_camera, SAME_CAMERA)
            && learned.work.region().contains(&region)
        {
            return mem::take(&mut learned.is_stale);
        }
        if let Some(image) = self.plate_image(&input.world_from_camera) {
            self.plate.write(gpu, &image.rgba8);
        }
        let view = self.view(&input.world_from_camera);
        let centre = self.physical_bounds.centre();
        let place = Place {
            receiver: &self.scene.receivers[0],
            lights: &self.lights,
            plane_from_world: &self.plane_from_world,
            reference_in_plane: DVec2::new(centre.x, centre.z),
        };
        let penumbra_px = self
            .lights
            .iter()
            .map(|light| view.penumbra_px(light, &self.plane_from_world, &bounds));
        let facts = SceneFacts {
            region,
            penumbra_px: penumbra_px.collect(),
        };
        let globals = view.globals(&region, &place);
        let work = match self.preset.method() {
            Method::Model(settings) => self.model(gpu, Plan::new(&facts, &settings), &globals),
            Method::Published(settings) => self.published(
                gpu,
                (PublishedPlan::new(&facts, &settings), bounds.max.y),
                &globals,
                &settings,
            ),
        };
        self.learned = Some(Learned {
            world_from_camera: input.world_from_camera,
            work,
            is_stale: false,
            appearance_of: None,
        });
        true
    }

    fn model(&self, gpu: &Gpu, plan: Plan, globals: &Globals) -> Work {
        let centre = self.physical_bounds.centre();
        let points = self
            .lights
            .iter()
            .zip(&plan.lights)
            .map(|(light, planned)| light_points(light, &self.plane_from_world, centre, planned.n_points))
            .collect();
        let passes = Passes::new(gpu, &plan);
        Work::Model(Box::new((Capture::new(gpu, plan, globals, points), passes)))
    }

    fn published(
        &self,
        gpu: &Gpu,
        (plan, tallest_m): (PublishedPlan, f64),
        globals: &Globals,
        settings: &PublishedSettings,
    ) -> Work {
        let surface = self.scene.receivers[0].surface;
        let uniform = published::uniform(&self.lights, surface, settings);
        Work::Published(Box::new(Published::new(gpu, plan, globals, &uniform, tallest_m)))
    }

    fn view(&self, world_from_camera: &DMat4) -> View {
        let image_px = UVec2::new(self.scene.width_px, self.scene.height_px);
        View::new(
            image_px,
            self.scene.intrinsics,
            world_from_camera,
            &self.scene.receivers[0],
        )
    }

    fn plate_image(&self, world_from_camera: &DMat4) -> Option<&Image> {
        let plates = &self.scene.plates;
        let same = plates.iter().find(|plate| {
            plate
                .world_from_camera
                .abs_diff_eq(*world_from_camera, SAME_CAMERA)
        });
        same.map(|plate| plate.image.as_ref())
    }
}

/// Where a frame is worked on, and where the toy can be there.
struct Worked {
    region: PixelRect,
    bounds: Bounds,
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

/// The time of a pose without a clip means nothing.
fn is_same_pose(a: &PoseTime, b: &PoseTime) -> bool {
    a.clip == b.clip && (a.clip.is_none() || a.time_secs.total_cmp(&b.time_secs).is_eq())
}

fn clip_time(pose: &PoseTime) -> Option<(ClipId, f64)> {
    pose.clip.map(|clip| (clip, pose.time_secs))
}

fn bounds_of(points: impl Iterator<Item = DVec3>) -> Bounds {
    points.fold(
        Bounds {
            min: DVec3::INFINITY,
            max: DVec3::NEG_INFINITY,
        },
        |bounds, p| Bounds {
            min: bounds.min.min(p),
            max: bounds.max.max(p),
        },
    )
}
