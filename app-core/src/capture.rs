//! What is made of one view of the real toy and its real shadow, and how the knowledge of the place grows by it.

use wgpu::TextureFormat;

use crate::counting::CountingTargets;
use crate::gpu::Gpu;
use crate::gpu::encoder::Encoder;
use crate::gpu::layout::{Globals, PlateViews, Subject};
use crate::gpu::texture::Texture;
use crate::knowledge::Knowledge;
use crate::learner::Learner;
use crate::lighting::{Lighting, Visibilities};
use crate::passes::appearance::{APPEARANCE_FORMAT, AppearanceInputs, AppearanceOutputs, LIT_FORMAT};
use crate::passes::composite::PICTURE_FORMAT;
use crate::passes::detail::DETAIL_FORMAT;
use crate::passes::estimate::Fineness;
use crate::passes::evidence::EVIDENCE_FORMAT;
use crate::passes::motion::MotionTargets;
use crate::passes::object::{BASE_FORMAT, NORMAL_FORMAT, ObjectInputs, ObjectOutputs, RECEIVED_FORMAT};
use crate::passes::plate::PLATE_FORMAT;
use crate::passes::self_shadow::{SelfShadowMaps, Shadowed};
use crate::passes::toy::ToyTargets;
use crate::passes::toy_mesh::{PoseBuffers, ToyMesh};
use crate::pipeline::Passes;
use crate::plan::{Change, Plan};

/// Rounds in which plate and light are estimated from one another.
const N_ESTIMATE_ROUNDS: u32 = 3;

/// Everything of the region's size.
pub(crate) struct Capture {
    pub(crate) plan: Plan,
    /// What `globals` holds.
    pub(crate) known: Globals,
    pub(crate) globals: wgpu::Buffer,
    pub(crate) physical: Visibilities,
    pub(crate) shown: Visibilities,
    pub(crate) object_base: Texture,
    pub(crate) object_normal: Texture,
    pub(crate) object_received: Texture,
    pub(crate) object_depth: Texture,
    /// What the frame shows.
    pub(crate) evident: Texture,
    /// The same without the real shadow, where that is withheld.
    pub(crate) withheld: Option<Texture>,
    /// What was photographed without the toy.
    pub(crate) photographed: Texture,
    /// The same, with an estimate where nothing was.
    pub(crate) estimated: Option<Texture>,
    pub(crate) appearance: Texture,
    pub(crate) appearance_lit: Texture,
    pub(crate) appearance_base: Texture,
    pub(crate) physical_self_shadow: SelfShadowMaps,
    pub(crate) shown_self_shadow: SelfShadowMaps,
    pub(crate) motion: MotionTargets,
    pub(crate) toy: ToyTargets,
    pub(crate) coverage: CountingTargets,
    /// Each pixel's own residual, cleared of noise.
    pub(crate) detail: Option<Texture>,
    pub(crate) picture: Texture,
    pub(crate) lighting: Lighting,
}

impl Capture {
    /// Allocates what `plan` asks for. `light_points` has the points of each of its lights, receiver by receiver.
    pub(crate) fn new(gpu: &Gpu, plan: Plan, globals: &Globals, light_points: Vec<Vec<glam::Vec4>>) -> Self {
        let region_px = plan.region.size_px;
        let target = |label, format| Texture::plain_target(gpu, label, region_px, format);
        Self {
            known: *globals,
            globals: gpu.uniform("globals", globals),
            physical: Visibilities::new(gpu, &plan),
            shown: Visibilities::new(gpu, &plan),
            object_base: target("object base", BASE_FORMAT),
            object_normal: target("object normal", NORMAL_FORMAT),
            object_received: target("object received", RECEIVED_FORMAT),
            object_depth: target("object depth", TextureFormat::Depth32Float),
            evident: target("evidence", EVIDENCE_FORMAT),
            withheld: plan
                .is_shadow_withheld
                .then(|| target("withheld evidence", EVIDENCE_FORMAT)),
            photographed: target("plate", PLATE_FORMAT),
            estimated: plan
                .is_plate_estimated
                .then(|| target("estimated plate", PLATE_FORMAT)),
            appearance: target("appearance", APPEARANCE_FORMAT),
            appearance_lit: target("appearance lit", LIT_FORMAT),
            appearance_base: target("appearance base", BASE_FORMAT),
            physical_self_shadow: SelfShadowMaps::new(gpu, &plan.self_shadow),
            shown_self_shadow: SelfShadowMaps::new(gpu, &plan.self_shadow),
            motion: MotionTargets::new(gpu, region_px),
            toy: ToyTargets::new(gpu, region_px, plan.n_toy_draws),
            coverage: CountingTargets::new(gpu, "coverage", region_px),
            detail: plan.is_noise_removed.then(|| target("detail", DETAIL_FORMAT)),
            picture: target("composite", PICTURE_FORMAT),
            lighting: Lighting::new(gpu, &plan, light_points),
            plan,
        }
    }

    /// Follows the camera: the same textures show another part of another picture.
    pub(crate) fn follow(&mut self, gpu: &Gpu, plan: Plan, globals: &Globals) {
        if plan.is_plate_estimated && self.estimated.is_none() {
            self.estimated = Some(Texture::plain_target(
                gpu,
                "estimated plate",
                plan.region.size_px,
                PLATE_FORMAT,
            ));
        }
        self.physical.injected = None;
        self.shown.injected = None;
        self.plan = plan;
        self.known = *globals;
        gpu.queue
            .write_buffer(&self.globals, 0, bytemuck::bytes_of(globals));
    }

    /// What the frame may tell of the receivers, but for the first fits: these need the real shadow.
    pub(crate) fn evidence(&self) -> &Texture {
        self.withheld.as_ref().unwrap_or(&self.evident)
    }

    /// The plate that all passes read.
    pub(crate) fn plate(&self) -> &Texture {
        self.estimated
            .as_ref()
            .filter(|_| self.plan.is_plate_estimated)
            .unwrap_or(&self.photographed)
    }

    /// Encodes what a view shows before anything is learned from it: geometry of the physical pose, and the plate.
    fn encode_view(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        passes: &Passes,
        toy: &ToyMesh,
        pictures: &Pictures<'_>,
    ) {
        let physical = (toy, &toy.physical);
        self.encode_self_shadow(gpu, encoder, passes, physical, &self.physical_self_shadow);
        let inputs = ObjectInputs {
            globals: &self.globals,
            toy,
            self_shadow: &self.physical_self_shadow,
        };
        let outputs = ObjectOutputs {
            base: &self.object_base.view,
            normal: &self.object_normal.view,
            received: &self.object_received.view,
            depth: &self.object_depth.view,
        };
        passes.object.encode(gpu, encoder, &inputs, &outputs);
        passes
            .evidence
            .encode(gpu, encoder, &self.object_depth.view, &self.evident.view);
        self.lighting
            .encode(gpu, encoder, (passes, &self.globals), physical, &self.physical);
        passes.plate.encode(
            gpu,
            encoder,
            &self.globals,
            (pictures.plate_views, pictures.plates),
            &self.photographed.view,
        );
    }

    /// Encodes what is learned from one view: `change` tells whether it is the first.
    pub(crate) fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        passes: &Passes,
        (toy, knowledge): (&ToyMesh, &Knowledge),
        (pictures, change): (&Pictures<'_>, Change),
    ) {
        self.encode_view(gpu, encoder, passes, toy, pictures);
        let is_first = change == Change::Place;
        let learner = Learner {
            gpu,
            capture: self,
            passes,
            knowledge,
            frame: pictures.frame,
            fit_evidence: if is_first {
                &self.evident.view
            } else {
                &self.evidence().view
            },
        };
        if !is_first {
            learner.withhold(encoder);
            learner.estimate_plate(encoder, Fineness::Smooth);
            learner.fit_levels(encoder);
        }
        learner.pool_lit(encoder);
        learner.estimate_plate(encoder, Fineness::Smooth);
        learner.fit_receivers(encoder, is_first);
        if is_first && self.plan.is_plate_estimated {
            // The first guess was pooled with shares that nobody had seen.
            for _ in 1..N_ESTIMATE_ROUNDS {
                knowledge.forget_sums(&mut encoder.raw);
                learner.pool_lit(encoder);
                learner.estimate_plate(encoder, Fineness::Smooth);
                learner.fit_receivers(encoder, is_first);
            }
        }
        if is_first {
            learner.withhold(encoder);
        }
        learner.estimate_plate(encoder, Fineness::Full);
        learner.fit(encoder, Subject::Toy, 0, is_first);
        learner.pool_residual(encoder);
        learner.separate_detail(encoder);
        learner.pool_tint(encoder);
    }

    /// Encodes what follows each new camera picture of a known view: its exposure, the lights' power, and what has come
    /// into the picture or left it.
    pub(crate) fn encode_levels(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        passes: &Passes,
        knowledge: &Knowledge,
        frame: &wgpu::TextureView,
    ) {
        let learner = Learner {
            gpu,
            capture: self,
            passes,
            knowledge,
            frame,
            fit_evidence: &self.evidence().view,
        };
        learner.fit_levels(encoder);
        learner.pool_residual(encoder);
        learner.separate_detail(encoder);
        learner.pool_tint(encoder);
    }

    /// Encodes the toy's own colours, which follow each new camera frame.
    pub(crate) fn encode_appearance(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        passes: &Passes,
        (knowledge, frame): (&Knowledge, &wgpu::TextureView),
    ) {
        let inputs = AppearanceInputs {
            globals: &self.globals,
            solution: &knowledge.solution,
            frame,
            evidence: &self.evident.view,
            object_depth: &self.object_depth.view,
            object_normal: &self.object_normal.view,
            object_received: &self.object_received.view,
            object_base: &self.object_base.view,
        };
        let outputs = AppearanceOutputs {
            color: &self.appearance.view,
            lit: &self.appearance_lit.view,
            base: &self.appearance_base.view,
        };
        passes.appearance.encode(gpu, encoder, &inputs, &outputs);
    }

    /// Encodes the shadow that the toy casts on itself in a pose.
    pub(crate) fn encode_self_shadow(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        passes: &Passes,
        (toy, pose): (&ToyMesh, &PoseBuffers),
        maps: &SelfShadowMaps,
    ) {
        let shadowed = Shadowed {
            toy,
            pose,
            light_points: &self.lighting.points_in_stage(),
        };
        passes
            .self_shadow
            .encode(gpu, encoder, &self.plan.self_shadow, &shadowed, maps);
    }
}

/// The camera frame and the plates, of the image's size.
pub(crate) struct Pictures<'a> {
    pub(crate) frame: &'a wgpu::TextureView,
    pub(crate) plates: &'a wgpu::TextureView,
    pub(crate) plate_views: &'a PlateViews,
}
