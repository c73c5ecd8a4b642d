//! The additive model of the receivers: scene state, targets and passes of both paths, sequenced by
//! the frame's changes.

pub(crate) mod capture;
pub mod diagnostics;
pub(crate) mod frame;
pub(crate) mod lighting;
pub mod plan;
pub(crate) mod readback;
pub(crate) mod region;
pub mod state;

use glam::Vec4;

use crate::gpu::context::{Gpu, GpuError};
use crate::gpu::pass_run::PassGroup;
use crate::gpu::recorder::Recorder;
use crate::gpu::texture::Texture;
use crate::model::capture::{CapturePath, CaptureTargets};
use crate::model::frame::region_parts::{Marks, RegionParts};
use crate::model::frame::{FramePath, FrameTargets};
use crate::model::lighting::{InjectedLights, LightMaps, Lighting};
use crate::model::plan::Plan;
use crate::model::region::Region;
use crate::model::state::SceneState;
use crate::passes::globals::Globals;
use crate::passes::pictures::{Frame, Picture, PictureGrain, Pictures};
use crate::passes::plate;
use crate::passes::toy_mesh::ToyMesh;
use crate::plan::{Change, FrameDelta};
use crate::readback::inject::InjectedVisibility;
use crate::readback::layers::RegionLayers;
use crate::readback::{FloatMap, read_texture};
use app_scene::geometry::bounds::Sphere;
use app_scene::sharpness::Sharpness;

/// The additive model of one scene.
pub(crate) struct Model {
    pub(crate) state: SceneState,
    pub(crate) region: Region,
    lighting: Lighting,
    captured: CaptureTargets,
    drawn: FrameTargets,
    passes: Passes,
    /// Strength of the shown shadow; 1 is the real one.
    shadow_strength: f32,
}

/// Every pass of the model.
struct Passes {
    light: lighting::Passes,
    plate: plate::Pass,
    capture: capture::Passes,
    frame: frame::Passes,
}

/// Group of the capture passes. If they run for a new picture of a known view, such as the fit of
/// its gain, they count as passes of the frame path.
fn capture_path(change: Change) -> PassGroup {
    if change >= Change::View {
        PassGroup::Capture
    } else {
        PassGroup::Frame
    }
}

impl Model {
    /// Allocates the resources of `plan`. `light_points` has the points of each of its lights, receiver by receiver.
    pub(crate) fn new(
        gpu: &Gpu,
        plan: Plan,
        globals: &Globals,
        light_points: Vec<Vec<Vec4>>,
        state: SceneState,
    ) -> Self {
        Self {
            state,
            lighting: Lighting::new(gpu, &plan, light_points),
            captured: CaptureTargets::new(gpu, &plan),
            drawn: FrameTargets::new(gpu, &plan),
            passes: Passes {
                light: lighting::Passes::new(gpu),
                plate: plate::Pass::new(gpu),
                capture: capture::Passes::new(gpu),
                frame: frame::Passes::new(gpu),
            },
            region: Region::new(gpu, plan, globals),
            shadow_strength: 1.0,
        }
    }

    /// Adapts to another view, or to settings that are turned down or up. Targets are kept if they
    /// suffice; otherwise they are dropped before others are made.
    pub(crate) fn follow(
        mut self,
        gpu: &Gpu,
        plan: Plan,
        globals: &Globals,
        light_points: Vec<Vec<Vec4>>,
    ) -> Self {
        let is_alike = plan.has_sizes_of(&self.region.plan);
        if is_alike && self.captured.serves(&plan) {
            self.captured.light.injected = None;
            self.drawn.light.injected = None;
            self.lighting.cast_by(plan.casters);
            // Eyes behind a receiver move with the camera.
            if plan.n_light_points != self.region.plan.n_light_points || plan.reflection.is_some() {
                self.lighting.relocate(gpu, light_points);
            }
            self.region.follow(gpu, plan, globals);
            return self;
        }
        let Self {
            state,
            mut region,
            lighting,
            captured,
            drawn,
            passes,
            shadow_strength,
        } = self;
        gpu.release_groups();
        drop((lighting, captured, drawn));
        let (lighting, captured, drawn) = (
            Lighting::new(gpu, &plan, light_points),
            CaptureTargets::new(gpu, &plan),
            FrameTargets::new(gpu, &plan),
        );
        region.follow(gpu, plan, globals);
        Self {
            state,
            region,
            lighting,
            captured,
            drawn,
            passes,
            shadow_strength,
        }
    }

    /// Moves lights and toy, whose number and materials stay the same.
    pub(crate) fn relocate(&mut self, gpu: &Gpu, light_points: Vec<Vec<Vec4>>, toy: &Sphere) {
        self.lighting.relocate(gpu, light_points);
        self.state.tints.surround(gpu, toy);
    }

    /// Sets the sharpness of the picture from now on.
    pub(crate) fn soften(&mut self, gpu: &Gpu, sharpness: Sharpness) {
        self.region.soften(gpu, sharpness);
    }

    /// Sets the strength of shadows from now on, and the points of each light from which they are
    /// drawn, receiver by receiver; `None` selects the lights' own.
    pub(crate) fn style_shadow(&mut self, gpu: &Gpu, strength: f32, points: Option<Vec<Vec<Vec4>>>) {
        self.shadow_strength = strength;
        self.drawn.light.soften(gpu, &self.region.plan, points);
    }

    /// The region's picture.
    pub(crate) fn picture(&self) -> Picture<'_> {
        self.drawn.by_pass.composite.picture()
    }

    /// Locates the toy and its shadows in the region, in the poses that are new.
    pub(crate) fn update_coverage_tiles(&mut self, toy: &ToyMesh, delta: FrameDelta) {
        if delta.keeps_pose() {
            return;
        }
        let marks = |pose, maps| Marks::of(&self.region, &self.lighting, toy, pose, maps);
        let known = self.drawn.physical_marks.take();
        let physical = known
            .filter(|_| delta.keeps_physical())
            .unwrap_or_else(|| marks(&toy.physical, &self.captured.light));
        let mut shown = marks(&toy.shown, &self.drawn.light);
        if self.shadow_strength != 1.0 {
            shown.shadow_all();
        }
        let (plan, uniform) = (&self.region.plan, &self.region.uniform);
        self.drawn.shown_toy = toy.shown.seen_rect(&uniform.by_camera(), plan.toy_box.size_px);
        self.drawn.parts = RegionParts::new([&physical, &shown]);
        self.drawn.physical_marks = Some(physical);
    }

    /// Encodes the frame passes whose results cannot be reused, and before them the capture passes
    /// of the change.
    pub(crate) fn encode(
        &self,
        recorder: &mut Recorder<'_>,
        toy: &ToyMesh,
        pictures: &Pictures<'_>,
        delta: FrameDelta,
    ) {
        let capture = CapturePath {
            region: &self.region,
            captured: &self.captured,
            passes: &self.passes.capture,
            plate: &self.passes.plate,
            light: &self.passes.light,
            lighting: &self.lighting,
            state: &self.state,
            toy,
            pictures,
        };
        recorder.group = capture_path(delta.change);
        capture.encode(recorder, delta);
        recorder.group = PassGroup::Frame;
        let frame = FramePath {
            things: pictures.things,
            ..self.frame_path(toy, pictures.frame, pictures.grain)
        };
        frame.encode(recorder, delta);
    }

    /// The frame path of a picture.
    fn frame_path<'a>(
        &'a self,
        toy: &'a ToyMesh,
        frame: Frame<'a>,
        grain: Option<PictureGrain>,
    ) -> FramePath<'a> {
        FramePath {
            region: &self.region,
            captured: &self.captured,
            drawn: &self.drawn,
            passes: &self.passes.frame,
            light: &self.passes.light,
            lighting: &self.lighting,
            state: &self.state,
            toy,
            frame,
            grain,
            things: None,
            shadow_strength: self.shadow_strength,
        }
    }

    /// Encodes the region's picture of the latest frame once more, in linear light.
    pub(crate) fn encode_light(
        &self,
        recorder: &mut Recorder<'_>,
        toy: &ToyMesh,
        (frame, grain): (Frame<'_>, Option<PictureGrain>),
    ) -> &Texture {
        let target = self.drawn.by_pass.composite.light(recorder.gpu);
        self.frame_path(toy, frame, grain).encode_light(recorder, target);
        target
    }

    /// Waits for the device and returns the layers of the region's picture of the latest frame.
    pub(crate) fn read_layers(
        &self,
        gpu: &Gpu,
        toy: &ToyMesh,
        frame: Frame<'_>,
    ) -> Result<RegionLayers, GpuError> {
        let mut recorder = Recorder::new(gpu, None);
        let layers = self.drawn.by_pass.composite.layers(gpu);
        self.frame_path(toy, frame, None)
            .encode_layers(&mut recorder, layers);
        recorder.submit();
        let [clean_plate, shadow_ratio, toy, masks] =
            layers.each_ref().map(|layer| read_texture(gpu, layer.raw()));
        Ok([clean_plate?, shadow_ratio?, toy?, masks?])
    }

    /// Replaces visibilities from the next frame on.
    pub(crate) fn inject(&mut self, gpu: &Gpu, maps: &InjectedVisibility) {
        let n_lights = self.region.plan.n_lights;
        let upload = |map: &Option<FloatMap>, light: &LightMaps| {
            let map = map.as_ref();
            map.map(|map| InjectedLights::new(gpu, map, n_lights, &light.visibility.lights))
        };
        self.captured.light.injected = upload(&maps.physical, &self.captured.light);
        self.drawn.light.injected = upload(&maps.shown, &self.drawn.light);
    }
}
