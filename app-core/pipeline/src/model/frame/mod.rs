//! The frame path: visibility of the shown pose, then the picture of the region.

pub(crate) mod region_parts;

use crate::geometry::rect::PixelRect;
use crate::gpu::context::Gpu;
use crate::gpu::recorder::Recorder;
use crate::gpu::texture::{Texture, TextureView};
use crate::model::capture::CaptureTargets;
use crate::model::frame::region_parts::{Marks, RegionParts};
use crate::model::lighting;
use crate::model::lighting::{LightMaps, Lighting, Posed};
use crate::model::plan::Plan;
use crate::model::region::Region;
use crate::model::state::SceneState;
use crate::model::state::solution::{Scene, SeenScene};
use crate::passes::list::passes;
use crate::passes::pictures::{Frame, PictureGrain};
use crate::passes::thing_marks::Things;
use crate::passes::toy_mesh::ToyMesh;
use crate::plan::FrameDelta;

passes!(Plan: moved_mask, toy, coverage, on_things, composite);

/// Targets of the frame path for one region.
pub(crate) struct FrameTargets {
    /// Visibility of the lights in the shown pose.
    pub(crate) light: LightMaps,
    /// Changes of the region by the toy in the physical pose, once they have been computed.
    pub(crate) physical_marks: Option<Marks>,
    /// Parts of the region, as divided by both poses.
    pub(crate) parts: RegionParts,
    /// The part of the toy box in which the shown toy may be visible.
    pub(crate) shown_toy: Option<PixelRect>,
    pub(crate) by_pass: Targets,
}

impl FrameTargets {
    /// Allocates the resources of `plan`.
    pub(crate) fn new(gpu: &Gpu, plan: &Plan) -> Self {
        Self {
            light: LightMaps::new(gpu, plan),
            physical_marks: None,
            parts: RegionParts::all_near(plan.region.size_px),
            shown_toy: None,
            by_pass: Targets::new(gpu, plan),
        }
    }
}

/// Inputs and targets of the frame path.
pub(crate) struct FramePath<'a> {
    pub(crate) region: &'a Region,
    pub(crate) captured: &'a CaptureTargets,
    pub(crate) drawn: &'a FrameTargets,
    pub(crate) passes: &'a Passes,
    pub(crate) light: &'a lighting::Passes,
    pub(crate) lighting: &'a Lighting,
    pub(crate) state: &'a SceneState,
    pub(crate) toy: &'a ToyMesh,
    pub(crate) frame: Frame<'a>,
    pub(crate) grain: Option<PictureGrain>,
    /// Things in the picture, if any are known.
    pub(crate) things: Option<&'a Things>,
    pub(crate) shadow_strength: f32,
}

impl FramePath<'_> {
    /// Draws everything that cannot be reused from the previous frame. A new picture of a paused
    /// toy changes its colours alone.
    pub(crate) fn encode(&self, recorder: &mut Recorder<'_>, delta: FrameDelta) {
        if delta.keeps_picture() {
            return;
        }
        let (passes, of) = (self.passes, &self.drawn.by_pass);
        let is_shape_new = !delta.keeps_pose();
        if is_shape_new {
            self.encode_lighting(recorder);
            passes
                .moved_mask
                .encode(recorder, self.region, self.toy, &of.moved_mask);
        }
        passes.toy.encode(recorder, &self.toy_inputs(), &of.toy);
        if is_shape_new {
            let inputs = self.coverage_inputs();
            passes.coverage.encode(recorder, &inputs, &of.coverage);
        }
        if let Some(things) = self.things.filter(|_| on_things::is_needed(&self.region.plan)) {
            let inputs = self.on_things_inputs(things);
            passes.on_things.encode(recorder, &inputs, &of.on_things);
        }
        let inputs = self.composite_inputs();
        passes.composite.encode(recorder, &inputs, &of.composite);
    }

    /// Draws the latest frame's picture once more, in linear light.
    pub(crate) fn encode_light(&self, recorder: &mut Recorder<'_>, target: &Texture) {
        let inputs = self.composite_inputs();
        self.passes.composite.encode_light(recorder, &inputs, target);
    }

    /// Draws the layers of that picture.
    pub(crate) fn encode_layers(
        &self,
        recorder: &mut Recorder<'_>,
        targets: &[Texture; composite::N_LAYERS],
    ) {
        let inputs = self.composite_inputs();
        self.passes.composite.encode_layers(recorder, &inputs, targets);
    }

    fn encode_lighting(&self, recorder: &mut Recorder<'_>) {
        let (light, maps) = (self.light, &self.drawn.light);
        let posed = Posed {
            globals: self.region.globals_on_device(),
            toy: self.toy,
            pose: &self.toy.shown,
        };
        self.lighting.encode_visibility(recorder, light, posed, maps);
        self.lighting.encode_self_shadow(recorder, light, posed, maps);
    }

    fn toy_inputs(&self) -> toy::Inputs<'_> {
        toy::Inputs {
            plan: &self.region.plan,
            camera_in_anchor: self.region.uniform.camera_in_anchor.into(),
            shown_toy: self.drawn.shown_toy,
            seen: self.seen(),
            toy: self.toy,
            appearance: &self.captured.by_pass.appearance,
            gbuffer_depth: &self.captured.by_pass.gbuffer.depth.view,
            self_shadow: [&self.drawn.light.self_shadow, &self.captured.light.self_shadow],
            tints: &self.state.tints,
            mixed: self.captured.by_pass.rim.mixed.as_ref(),
            unmixed: self.captured.by_pass.unmix.factor.as_ref(),
            reflected: self.captured.by_pass.gloss.view(),
            specular: &self.region.specular,
            marks_before: self.marks_before(),
        }
    }

    fn coverage_inputs(&self) -> coverage::Inputs<'_> {
        coverage::Inputs {
            region: self.region,
            toy: self.toy,
            camera_in_anchor: self.region.uniform.camera_in_anchor.into(),
            marks_before: self.marks_before(),
        }
    }

    /// The validity mask, if things before the toy have fronts.
    fn marks_before(&self) -> Option<&TextureView> {
        let validity = &self.captured.by_pass.validity.marks.view;
        (!self.region.plan.things_fronts.is_empty()).then_some(validity)
    }

    fn on_things_inputs<'a>(&'a self, things: &'a Things) -> on_things::Inputs<'a> {
        on_things::Inputs {
            seen: self.seen(),
            things,
            plate: &self.captured.plate.view,
            validity: &self.captured.by_pass.validity.marks.view,
            physical_visibility: &self.captured.light.visibility.lights.view,
            visibility: &self.drawn.light.visibility.lights.view,
        }
    }

    fn composite_inputs(&self) -> composite::Inputs<'_> {
        let (captured, drawn) = (self.captured, self.drawn);
        composite::Inputs {
            parts: &drawn.parts,
            seen: self.seen(),
            grids: &self.state.grids,
            cells: &self.state.residual.cells,
            plate: drawn
                .by_pass
                .on_things
                .plate
                .as_ref()
                .map_or(&captured.plate.view, |plate| &plate.view),
            validity: &captured.by_pass.validity.marks.view,
            physical: &captured.light,
            shown: &drawn.light,
            coverage: &drawn.by_pass.coverage.covered.view,
            toy: &drawn.by_pass.toy,
            moved_mask: &drawn.by_pass.moved_mask.moved.view,
            detail: captured
                .by_pass
                .detail
                .residual
                .as_ref()
                .map(|residual| &residual.view),
            grain: self.grain,
            is_plate_soft: self.region.uniform.is_soft(),
            shadow_strength: self.shadow_strength,
            has_edges: self.region.plan.n_receivers > 1,
        }
    }

    fn seen(&self) -> SeenScene<'_> {
        SeenScene {
            scene: Scene {
                globals: &self.region.globals,
                solution: &self.state.solution,
            },
            frame: self.frame,
        }
    }
}
