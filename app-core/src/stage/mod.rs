//! A scene on the device: the toy, the plates and the frame, and what was learned from them.

mod learning;
mod worked;

use std::sync::Arc;

use glam::{DMat4, UVec2};

use crate::capture::Pictures;
use crate::clip_reach::ClipReach;
use crate::frame::{FrameInput, FrameReport, Warning};
use crate::gpu::Gpu;
use crate::gpu::encoder::Encoder;
use crate::gpu::texture::{Texture, TextureShape};
use crate::inject::InjectedVisibility;
use crate::passes::present::Present;
use crate::passes::toy_mesh::ToyMesh;
use crate::pipeline::encode_present;
use crate::plan::{Change, LeftOut, Path, runs};
use crate::plate_store::PlateStore;
use crate::preset::{Method, Preset};
use crate::region::{BORDER_PX, Bounds, PlaneRect};
use crate::scene::{Image, Light, PoseTime, Receiver, Scene};
use crate::standing::usable;
use crate::toy::{ClipId, PosedMesh, ToyError};
use crate::view::{Place, View};
use crate::work::Work;

use worked::Worked;

/// The fade at the region's border, and what the toy may reach beyond its region between two moments of a clip.
const REGION_MARGIN_PX: u32 = BORDER_PX + 8;
/// Format of the finished picture: codes, as a screen takes them.
pub(crate) const OUTPUT_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// A scene on the device.
pub(crate) struct Stage {
    scene: Scene,
    preset: Preset,
    lights: Vec<Light>,
    /// Their places in the scene's list.
    pub(crate) light_indices: Vec<usize>,
    receivers: Vec<Receiver>,
    stage_from_object: DMat4,
    physical_bounds: Bounds,
    is_shadow_withheld: bool,
    /// What the clip shown last reaches.
    reach: Option<ClipReach>,
    /// Where the latest frame was worked on.
    known_worked: Option<Arc<Worked>>,
    toy: ToyMesh,
    posed: PosedMesh,
    frame: Texture,
    frame_image: Option<Arc<Image>>,
    plates: PlateStore,
    present: Present,
    learned: Option<Learned>,
    /// What the clips shown so far reach of each receiver.
    known_rects: Vec<PlaneRect>,
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

impl Stage {
    pub(crate) fn new(gpu: &Gpu, scene: Scene, preset: Preset) -> Result<Self, ToyError> {
        let stage_from_object = scene.receivers[0].world_from_plane.inverse() * scene.world_from_object;
        let mut posed = PosedMesh::default();
        scene
            .toy
            .pose(clip_time(&scene.physical_pose), &stage_from_object, &mut posed)?;
        let size_px = [scene.width_px, scene.height_px];
        let usable = usable(&scene);
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
            known_rects: Vec::new(),
            standing_warnings: usable.warnings,
            lights: usable.lights,
            light_indices: usable.light_indices,
            receivers: usable.receivers,
            output: Texture::target(gpu, "output", output),
            preset,
            stage_from_object,
            scene,
            is_shadow_withheld: false,
            reach: None,
            known_worked: None,
        })
    }

    /// Keeps the real shadow from what is learned from the next frame on; what was learned is forgotten.
    pub(crate) fn withhold_shadow(&mut self) {
        if matches!(self.preset.method(), Method::Model(_)) {
            self.is_shadow_withheld = true;
            self.learned = None;
        }
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
        if let Some(learned) = &mut self.learned {
            learned.image = Some(Arc::clone(&input.image));
        }
        let Some(learned) = &self.learned else {
            return Ok(());
        };
        let work = &learned.work;
        let exposed = (change >= Change::Picture && work.model().is_none())
            .then(|| self.plate_views_at_exposure_of(input, worked));
        let pictures = Pictures {
            frame: &self.frame.view,
            plates: &self.plates.pictures.view,
            plate_views: exposed.as_ref().unwrap_or(&worked.plate_views),
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

fn is_same_image(known: Option<&Arc<Image>>, image: &Arc<Image>) -> bool {
    known.is_some_and(|known| Arc::ptr_eq(known, image))
}

fn clip_time(pose: &PoseTime) -> Option<(ClipId, f64)> {
    pose.clip.map(|clip| (clip, pose.time_secs))
}
