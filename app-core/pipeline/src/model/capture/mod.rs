//! The capture path: steps that update scene state from one view of the real toy and its real shadow.

pub(crate) mod pool;

use crate::gpu::context::Gpu;
use crate::gpu::recorder::Recorder;
use crate::gpu::texture::{Texture, TextureView};
use crate::model::capture::fit::{Subject, Task};
use crate::model::capture::pool::{PoolGrids, Taken};
use crate::model::lighting;
use crate::model::lighting::{LightMaps, Lighting, Posed};
use crate::model::plan::Plan;
use crate::model::region::Region;
use crate::model::state::SceneState;
use crate::model::state::grids::CellBuffers;
use crate::model::state::solution::{Scene, SeenScene};
use crate::passes::list::passes;
use crate::passes::pictures::Pictures;
use crate::passes::plate;
use crate::passes::plate::FINE_FORMAT;
use crate::passes::thing_marks::Things;
use crate::passes::toy_mesh::ToyMesh;
use crate::plan::{Change, FrameDelta};
use app_scene::sharpness::Spread;

passes!(Plan:
    gbuffer, validity, things, soften, lit, fill, fit, fit_solve, withhold, estimate, residual, detail, rim, unmix, gloss, tint, tint_fill,
    appearance,
);

/// Rounds in which plate and light are estimated alternately.
const N_ESTIMATE_ROUNDS: u32 = 3;

/// Targets of the capture path for one region.
pub(crate) struct CaptureTargets {
    /// Visibility of the lights in the physical pose.
    pub(crate) light: LightMaps,
    /// The plate that all passes read, completed by an estimate.
    pub(crate) plate: Texture,
    pub(crate) by_pass: Targets,
}

impl CaptureTargets {
    /// Allocates the resources of `plan`.
    pub(crate) fn new(gpu: &Gpu, plan: &Plan) -> Self {
        Self {
            light: LightMaps::new(gpu, plan),
            plate: Texture::target(gpu, "plate", plan.region.size_px, plan.plate_format()),
            by_pass: Targets::new(gpu, plan),
        }
    }

    /// Whether the targets suffice for `plan`, of a region of the same size.
    pub(crate) fn serves(&self, plan: &Plan) -> bool {
        let has_photographed = !estimate::is_needed(plan) || self.by_pass.estimate.photographed.is_some();
        // A finer plate suffices for one that is kept as codes.
        let has_soft = !plan.is_softened || self.by_pass.soften.sharp.is_some();
        has_photographed && has_soft && (self.plate.format() == FINE_FORMAT || !plan.is_plate_fine)
    }
}

/// Maps of the region for passes that learn from the receivers; each is read pixel by pixel.
#[derive(Clone, Copy)]
pub(crate) struct Observed<'a> {
    pub(crate) validity: &'a TextureView,
    /// Visibility of each light in the physical pose.
    pub(crate) visibility: &'a TextureView,
    /// Visibility of the ambient light; smaller, and filtered.
    pub(crate) ambient: &'a TextureView,
}

/// Inputs and targets of the capture path.
pub(crate) struct CapturePath<'a> {
    pub(crate) region: &'a Region,
    pub(crate) captured: &'a CaptureTargets,
    pub(crate) passes: &'a Passes,
    pub(crate) plate: &'a plate::Pass,
    pub(crate) light: &'a lighting::Passes,
    pub(crate) lighting: &'a Lighting,
    pub(crate) state: &'a SceneState,
    pub(crate) toy: &'a ToyMesh,
    pub(crate) pictures: &'a Pictures<'a>,
}

impl CapturePath<'_> {
    /// Learns from a frame's changes. A new shown pose alone changes nothing.
    pub(crate) fn encode(&self, recorder: &mut Recorder<'_>, delta: FrameDelta) {
        let change = delta.change;
        match change {
            Change::Pose => return,
            Change::Picture if delta.keeps_sharpness => self.fit_intensities(recorder, false),
            Change::Picture => self.sharpen(recorder),
            Change::View => self.learn_view(recorder),
            Change::Scene => self.learn_scene(recorder),
        }
        let (passes, of) = (self.passes, &self.captured.by_pass);
        let is_view_new = change >= Change::View;
        // A new picture of a known view updates one of the two means over several pictures, in
        // turn; while the focus changes, neither, since that has passes of its own.
        let is_residual_next = self.pictures.n_before.is_multiple_of(2);
        let is_updated = |is_next: bool| is_view_new || (delta.keeps_sharpness && is_next);
        if is_updated(is_residual_next) {
            let inputs = self.residual_inputs(change >= Change::Scene);
            passes.residual.encode(recorder, &inputs);
            self.fill(recorder, &self.state.residual);
        }
        if detail::is_needed(&self.region.plan) {
            passes.detail.encode(recorder, &self.detail_inputs(), &of.detail);
        }
        if rim::is_needed(&self.region.plan) {
            passes.rim.encode(recorder, &self.rim_inputs(), &of.rim);
            // The lights' intensities hardly change from one picture to the next.
            if is_view_new || !delta.keeps_sharpness || !is_residual_next {
                passes.unmix.encode(recorder, &self.unmix_inputs(), &of.unmix);
            }
        }
        if gloss::is_needed(&self.region.plan) {
            passes.gloss.encode(recorder, &self.gloss_inputs(), &of.gloss);
        }
        if is_updated(!is_residual_next) {
            let tints = &self.state.tints;
            passes.tint.encode(recorder, &self.tint_inputs(), tints);
            passes.tint_fill.encode(recorder, tints);
        }
        if is_view_new {
            let inputs = self.appearance_inputs();
            passes.appearance.encode(recorder, &inputs, &of.appearance);
        }
    }

    /// Draws everything that depends on the picture's sharpness, for a known view, and fits exposure
    /// and intensities before the plate is estimated by them.
    fn sharpen(&self, recorder: &mut Recorder<'_>) {
        let (passes, of) = (self.passes, &self.captured.by_pass);
        passes
            .validity
            .encode(recorder, &self.validity_inputs(), &of.validity);
        self.mark_things(recorder);
        let maps = &self.captured.light;
        self.lighting
            .encode_sharp_visibility(recorder, self.light, self.physical(), maps);
        if self.pictures.things.is_some_and(Things::is_plate_wrong) {
            // What completes a plate depends on whether it is made soft afterwards.
            self.plate(recorder);
        } else {
            self.soften(recorder);
        }
        self.withhold(recorder);
        self.fit_intensities(recorder, estimate::is_needed(&self.region.plan));
        self.estimate(recorder);
    }

    /// Refines the scene state by another view.
    fn learn_view(&self, recorder: &mut Recorder<'_>) {
        self.observe(recorder);
        self.withhold(recorder);
        self.fit_intensities(recorder, estimate::is_needed(&self.region.plan));
        self.fit_receivers(recorder, false);
        self.estimate(recorder);
        self.fit_toy(recorder, false);
    }

    /// Learns the state of a new scene.
    fn learn_scene(&self, recorder: &mut Recorder<'_>) {
        self.state.forget(recorder);
        self.observe(recorder);
        self.fit_receivers(recorder, true);
        if estimate::is_needed(&self.region.plan) {
            // The first estimate was pooled with the prior's direct fractions.
            for _ in 1..N_ESTIMATE_ROUNDS {
                self.state.forget_sums(recorder);
                self.fit_receivers(recorder, true);
            }
        }
        // The first fits need the real shadow.
        self.withhold(recorder);
        self.estimate(recorder);
        self.fit_toy(recorder, true);
    }

    /// Draws the inputs of the fits: geometry and light of the physical pose, and the plate.
    fn observe(&self, recorder: &mut Recorder<'_>) {
        let (passes, of) = (self.passes, &self.captured.by_pass);
        let (light, maps) = (self.light, &self.captured.light);
        let posed = self.physical();
        self.lighting.encode_self_shadow(recorder, light, posed, maps);
        passes
            .gbuffer
            .encode(recorder, &self.gbuffer_inputs(), &of.gbuffer);
        passes
            .validity
            .encode(recorder, &self.validity_inputs(), &of.validity);
        self.mark_things(recorder);
        self.lighting.encode_visibility(recorder, light, posed, maps);
        self.plate(recorder);
    }

    fn physical(&self) -> Posed<'_> {
        Posed {
            globals: self.region.globals_on_device(),
            toy: self.toy,
            pose: &self.toy.physical,
        }
    }

    fn plate(&self, recorder: &mut Recorder<'_>) {
        let inputs = plate::Inputs {
            globals: &self.region.globals,
            views: self.pictures.plate_views,
            plates: self.pictures.plates,
            is_same_view: self.pictures.is_same_view,
        };
        let sharp = self.captured.by_pass.soften.sharp.as_ref();
        let target = sharp.unwrap_or_else(|| self.read_plate());
        self.plate.encode(recorder, &inputs, target);
        if let Some(things) = self.pictures.things.filter(|things| things.is_plate_wrong()) {
            let is_softened = sharp.is_some() && self.region.plan.sharpness.plate_spread != Spread::NONE;
            let plate = (&target.view, is_softened);
            self.passes.things.correct_plate(recorder, things, plate);
        }
        self.soften(recorder);
    }

    fn mark_things(&self, recorder: &mut Recorder<'_>) {
        for things in self.pictures.things.into_iter().chain(self.pictures.people) {
            let of = &self.captured.by_pass;
            let (things_of, marks) = (&of.things, &of.validity.marks);
            self.passes.things.mark(recorder, things, things_of, marks);
        }
    }

    /// Makes the plate as soft as the picture, if there are targets for it.
    fn soften(&self, recorder: &mut Recorder<'_>) {
        if let Some(sharp) = &self.captured.by_pass.soften.sharp {
            let spread = self.region.plan.sharpness.plate_spread;
            let target = self.read_plate();
            self.passes.soften.encode(recorder, (spread, sharp), target);
        }
    }

    /// The plate that the first passes read. Passes before `estimate` read the photographed one as
    /// well.
    fn read_plate(&self) -> &Texture {
        self.photographed().unwrap_or(&self.captured.plate)
    }

    fn withhold(&self, recorder: &mut Recorder<'_>) {
        if withhold::is_needed(&self.region.plan) {
            let of = &self.captured.by_pass;
            let inputs = self.withhold_inputs();
            self.passes
                .withhold
                .encode(recorder, &inputs, &of.withhold, &of.validity.marks);
        }
    }

    fn estimate(&self, recorder: &mut Recorder<'_>) {
        let Some(photographed) = self.photographed() else {
            return;
        };
        let inputs = estimate::Inputs {
            seen: self.seen(),
            grids: &self.state.grids,
            lit_cells: &self.state.lit.cells,
            photographed: &photographed.view,
            observed: self.observed(),
        };
        self.passes
            .estimate
            .encode(recorder, &inputs, &self.captured.plate.view);
    }

    /// Fits each receiver in turn; the first is the prior of the others. If plates are missing, the
    /// lit appearance of the receivers is estimated before.
    fn fit_receivers(&self, recorder: &mut Recorder<'_>, is_first: bool) {
        let plan = &self.region.plan;
        if lit::is_needed(plan) {
            self.passes.lit.encode(recorder, &self.lit_inputs());
            self.fill(recorder, &self.state.lit);
        }
        for receiver in 0..plan.n_receivers {
            let task = Task {
                receiver,
                completes_plate: estimate::is_needed(plan),
                ..Task::new(plan, Subject::Receiver, is_first)
            };
            self.fit(recorder, task);
        }
    }

    /// Fits the light on the toy.
    fn fit_toy(&self, recorder: &mut Recorder<'_>, is_first: bool) {
        self.fit(recorder, Task::new(&self.region.plan, Subject::Toy, is_first));
    }

    /// Fits exposure and intensities of this picture. A jump of the exposure makes every pixel an
    /// outlier, so the weights start again.
    fn fit_intensities(&self, recorder: &mut Recorder<'_>, completes_plate: bool) {
        let task = Task {
            completes_plate,
            ..Task::new(&self.region.plan, Subject::Intensities, true)
        };
        self.fit(recorder, task);
    }

    fn fit(&self, recorder: &mut Recorder<'_>, task: Task) {
        let (captured, targets) = (self.captured, &self.captured.by_pass.fit);
        let photographed = self.photographed().filter(|_| task.completes_plate);
        let inputs = fit::Inputs {
            seen: self.seen(),
            grids: &self.state.grids,
            lit_cells: &self.state.lit.cells,
            observed: self.observed(),
            plate: &photographed.unwrap_or(&captured.plate).view,
            gbuffer: &captured.by_pass.gbuffer,
            specular: &self.region.specular,
        };
        let to_solve = fit_solve::Inputs {
            globals: &self.region.globals,
            rows: &targets.rows,
        };
        for index in 0..task.n_steps {
            let step = task.step(&self.region.plan, index, self.pictures.exposure_ratio);
            self.passes.fit.encode(recorder, &inputs, &task, &step, targets);
            self.passes
                .fit_solve
                .encode(recorder, &to_solve, &step, self.state);
        }
    }

    fn fill(&self, recorder: &mut Recorder<'_>, cells: &CellBuffers) {
        let inputs = fill::Inputs {
            grids: &self.state.grids,
            n_receivers: self.region.plan.n_receivers,
        };
        self.passes.fill.encode(recorder, &inputs, &cells.cells);
    }

    /// The plate as photographed, if `estimate` is to complete it.
    fn photographed(&self) -> Option<&Texture> {
        let photographed = self.captured.by_pass.estimate.photographed.as_ref();
        photographed.filter(|_| estimate::is_needed(&self.region.plan))
    }

    fn gbuffer_inputs(&self) -> gbuffer::Inputs<'_> {
        gbuffer::Inputs {
            plan: &self.region.plan,
            camera_in_anchor: self.region.uniform.camera_in_anchor.into(),
            globals: &self.region.globals,
            toy: self.toy,
            self_shadow: &self.captured.light.self_shadow,
        }
    }

    fn validity_inputs(&self) -> validity::Inputs<'_> {
        validity::Inputs {
            plan: &self.region.plan,
            gbuffer_depth: &self.captured.by_pass.gbuffer.depth.view,
            soft_reach_px: self.region.uniform.soft_reach_px,
        }
    }

    fn withhold_inputs(&self) -> withhold::Inputs<'_> {
        withhold::Inputs {
            scene: self.scene(),
            visibility: &self.captured.light.visibility.lights.view,
            ambient: &self.captured.light.visibility.ambient.view,
        }
    }

    fn lit_inputs(&self) -> lit::Inputs<'_> {
        lit::Inputs {
            on: self.pool_grids(&self.state.lit),
            observed: self.observed(),
        }
    }

    fn residual_inputs(&self, is_first: bool) -> residual::Inputs<'_> {
        residual::Inputs {
            on: self.pool_grids(&self.state.residual),
            taken: match is_first {
                true => Taken::ALL,
                false => Taken::quarter(self.pictures.n_before),
            },
            observed: self.observed(),
            plate: &self.captured.plate.view,
        }
    }

    fn detail_inputs(&self) -> detail::Inputs<'_> {
        detail::Inputs {
            seen: self.seen(),
            observed: self.observed(),
            plate: &self.captured.plate.view,
        }
    }

    fn rim_inputs(&self) -> rim::Inputs<'_> {
        rim::Inputs {
            plan: &self.region.plan,
            scene: self.scene(),
            grids: &self.state.grids,
            cells: &self.state.residual.cells,
            plate: &self.captured.plate.view,
            observed: self.observed(),
            gbuffer_depth: &self.captured.by_pass.gbuffer.depth.view,
        }
    }

    fn unmix_inputs(&self) -> unmix::Inputs<'_> {
        unmix::Inputs {
            plan: &self.region.plan,
            scene: self.scene(),
            gbuffer: &self.captured.by_pass.gbuffer,
        }
    }

    fn gloss_inputs(&self) -> gloss::Inputs<'_> {
        gloss::Inputs {
            plan: &self.region.plan,
            seen: self.seen(),
            specular: &self.region.specular,
            gbuffer: &self.captured.by_pass.gbuffer,
        }
    }

    fn tint_inputs(&self) -> tint::Inputs<'_> {
        tint::Inputs {
            plan: &self.region.plan,
            seen: self.seen(),
            validity: self.validity(),
            gbuffer: &self.captured.by_pass.gbuffer,
            reflected: self.captured.by_pass.gloss.view(),
        }
    }

    fn appearance_inputs(&self) -> appearance::Inputs<'_> {
        appearance::Inputs {
            plan: &self.region.plan,
            globals: &self.region.globals,
            validity: self.validity(),
            gbuffer: &self.captured.by_pass.gbuffer,
        }
    }

    fn scene(&self) -> Scene<'_> {
        Scene {
            globals: &self.region.globals,
            solution: &self.state.solution,
        }
    }

    fn seen(&self) -> SeenScene<'_> {
        SeenScene {
            scene: self.scene(),
            frame: self.pictures.frame,
        }
    }

    fn observed(&self) -> Observed<'_> {
        let visibility = &self.captured.light.visibility;
        Observed {
            validity: self.validity(),
            visibility: &visibility.lights.view,
            ambient: &visibility.ambient.view,
        }
    }

    fn validity(&self) -> &TextureView {
        &self.captured.by_pass.validity.marks.view
    }

    fn pool_grids<'a>(&'a self, cells: &'a CellBuffers) -> PoolGrids<'a> {
        PoolGrids {
            seen: self.seen(),
            grids: &self.state.grids,
            layout: &self.state.layout,
            cells,
            n_receivers: self.region.plan.n_receivers,
        }
    }
}
