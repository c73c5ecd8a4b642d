//! The passes of a plan, built once, and the frame path in order.

use crate::capture::Capture;
use crate::gpu::Gpu;
use crate::gpu::encoder::Encoder;
use crate::gpu::layout::Placement;
use crate::knowledge::Knowledge;
use crate::lighting::AMBIENT_FORMAT;
use crate::passes::appearance::Appearance;
use crate::passes::composite::{Composite, CompositeInputs};
use crate::passes::coverage::Coverage;
use crate::passes::detail::Detail;
use crate::passes::estimate::Estimate;
use crate::passes::evidence::Evidence;
use crate::passes::fill::Fill;
use crate::passes::fit::Fit;
use crate::passes::lit::Lit;
use crate::passes::motion::Motion;
use crate::passes::object::Object;
use crate::passes::occlusion::Occlusion;
use crate::passes::plate::Plate;
use crate::passes::present::{Present, PresentInputs};
use crate::passes::residual::Residual;
use crate::passes::self_shadow::SelfShadow;
use crate::passes::tint::Tint;
use crate::passes::toy::{Toy, ToyInputs};
use crate::passes::toy_mesh::ToyMesh;
use crate::passes::visibility::Visibility;
use crate::passes::withhold::Withhold;
use crate::plan::Plan;
use crate::work::Work;

/// What a missing plate is made by.
pub(crate) struct EstimatePasses {
    pub(crate) lit: Lit,
    pub(crate) estimate: Estimate,
}

impl EstimatePasses {
    fn new(gpu: &Gpu) -> Self {
        Self {
            lit: Lit::new(gpu),
            estimate: Estimate::new(gpu),
        }
    }
}

/// Every pass that a plan runs.
pub(crate) struct Passes {
    pub(crate) self_shadow: SelfShadow,
    pub(crate) object: Object,
    pub(crate) evidence: Evidence,
    pub(crate) appearance: Appearance,
    pub(crate) tint: Tint,
    pub(crate) occlusion: Occlusion,
    /// One a light.
    pub(crate) lights: Vec<Visibility>,
    pub(crate) ambient: Visibility,
    pub(crate) plate: Plate,
    pub(crate) estimate: Option<EstimatePasses>,
    pub(crate) fit: Fit,
    pub(crate) withhold: Option<Withhold>,
    pub(crate) residual: Residual,
    pub(crate) fill: Fill,
    pub(crate) detail: Option<Detail>,
    pub(crate) motion: Motion,
    pub(crate) toy: Toy,
    pub(crate) coverage: Coverage,
    pub(crate) composite: Composite,
}

impl Passes {
    pub(crate) fn new(gpu: &Gpu, plan: &Plan) -> Self {
        Self {
            self_shadow: SelfShadow::new(gpu),
            object: Object::new(gpu),
            evidence: Evidence::new(gpu),
            appearance: Appearance::new(gpu),
            tint: Tint::new(gpu),
            occlusion: Occlusion::new(gpu, plan.n_receivers),
            lights: plan
                .lights
                .iter()
                .enumerate()
                .map(|(channel, light)| Visibility::new(gpu, light.n_points, channel, plan.visibility_format))
                .collect(),
            ambient: Visibility::new(gpu, plan.n_ambient_directions, 0, AMBIENT_FORMAT),
            plate: Plate::new(gpu),
            estimate: plan.is_plate_estimated.then(|| EstimatePasses::new(gpu)),
            fit: Fit::new(gpu),
            withhold: plan.is_shadow_withheld.then(|| Withhold::new(gpu)),
            residual: Residual::new(gpu),
            fill: Fill::new(gpu),
            detail: plan.is_noise_removed.then(|| Detail::new(gpu)),
            motion: Motion::new(gpu),
            toy: Toy::new(gpu, plan.n_toy_draws),
            coverage: Coverage::new(gpu),
            composite: Composite::new(gpu, plan.n_toy_draws, plan.is_noise_removed),
        }
    }

    /// Makes what a plan for another view needs besides.
    pub(crate) fn prepare(&mut self, gpu: &Gpu, plan: &Plan) {
        if plan.is_plate_estimated && self.estimate.is_none() {
            self.estimate = Some(EstimatePasses::new(gpu));
        }
    }

    /// The frame path: visibility of the shown pose, then the picture of the region.
    pub(crate) fn encode_frame(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        (capture, knowledge): (&Capture, &Knowledge),
        toy: &ToyMesh,
        frame: &wgpu::TextureView,
    ) {
        let shown = (toy, &toy.shown);
        let lighting = &capture.lighting;
        lighting.encode(gpu, encoder, (self, &capture.globals), shown, &capture.shown);
        capture.encode_self_shadow(gpu, encoder, self, shown, &capture.shown_self_shadow);
        self.motion
            .encode(gpu, encoder, &capture.globals, toy, &capture.motion);
        let inputs = ToyInputs {
            globals: &capture.globals,
            solution: &knowledge.solution,
            appearance: &capture.appearance.view,
            appearance_lit: &capture.appearance_lit.view,
            object_depth: &capture.object_depth.view,
            appearance_base: &capture.appearance_base.view,
            self_shadow: &capture.shown_self_shadow,
            tints: &knowledge.tints,
        };
        self.toy.encode(gpu, encoder, toy, &inputs, &capture.toy);
        let camera = glam::Vec3::from(capture.known.camera_in_stage);
        let coverage = &capture.coverage;
        self.coverage
            .encode(gpu, encoder, &capture.globals, (toy, camera), coverage);
        let inputs = CompositeInputs {
            globals: &capture.globals,
            solution: &knowledge.solution,
            grids: &knowledge.grids,
            cells: &knowledge.residual.cells,
            frame,
            plate: &capture.plate().view,
            evidence: &capture.evidence().view,
            physical_visibility: &capture.physical.lights.view,
            physical_ambient: &capture.physical.ambient.view,
            visibility: &capture.shown.lights.view,
            ambient: &capture.shown.ambient.view,
            toy: &capture.toy,
            coverage: &capture.coverage.count.view,
            detail: capture.detail.as_ref().map(|detail| &detail.view),
            motion: &capture.motion.moved.view,
        };
        self.composite
            .encode(gpu, encoder, &inputs, &capture.picture.view);
    }
}

/// Lays the region over the camera frame, or passes the frame through where nothing was worked on.
pub(crate) fn encode_present(
    gpu: &Gpu,
    encoder: &mut Encoder,
    present: &Present,
    (frame_codes, work): (&wgpu::TextureView, Option<&Work>),
    output: &wgpu::TextureView,
) {
    let region_codes = work.map(|work| work.picture().codes());
    let nowhere = Placement {
        origin_px: [0; 2],
        size_px: [0; 2],
    };
    let placement = work.map(Work::region).map_or(nowhere, |region| Placement {
        origin_px: region.origin_px.to_array(),
        size_px: region.size_px.to_array(),
    });
    let inputs = PresentInputs {
        frame_codes,
        region_codes: region_codes.as_ref().unwrap_or(frame_codes),
        placement,
    };
    present.encode(gpu, encoder, &inputs, output);
}
