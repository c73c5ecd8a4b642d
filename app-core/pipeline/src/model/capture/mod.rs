//! The capture path: steps that update scene state from one view of the real toy and its real shadow.

pub(crate) mod observed;
pub(crate) mod order;
pub(crate) mod pool;

use crate::gpu::context::Gpu;
use crate::gpu::recorder::Recorder;
use crate::gpu::texture::{Texture, TextureView};
use crate::model::capture::fit::Task;
use crate::model::capture::observed::Observed;
use crate::model::capture::order::Step;
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
use crate::passes::toy_mesh::ToyMesh;

passes!(Plan:
    gbuffer, validity, lit, estimate, fit, fit_solve, withhold, residual, fill, detail, tint, tint_fill, appearance,
);

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
        // A finer plate will do where codes would.
        has_photographed && (self.plate.format() == FINE_FORMAT || !plan.is_plate_fine)
    }
}

/// Inputs and targets of the capture path.
pub(crate) struct CapturePath<'a> {
    pub(crate) region: &'a Region,
    pub(crate) captured: &'a CaptureTargets,
    pub(crate) passes: &'a Passes,
    pub(crate) plate: &'a plate::Pass,
    pub(crate) lighting: (&'a lighting::Passes, &'a Lighting),
    pub(crate) state: &'a SceneState,
    pub(crate) toy: &'a ToyMesh,
    pub(crate) pictures: &'a Pictures<'a>,
}

impl CapturePath<'_> {
    pub(crate) fn encode(&self, recorder: &mut Recorder<'_>, step: Step) {
        let (passes, of) = (self.passes, &self.captured.by_pass);
        match step {
            Step::Forget => self.state.forget(recorder),
            Step::ForgetSums => self.state.forget_sums(recorder),
            Step::Lighting(step) => self.light(recorder, step),
            Step::Gbuffer => passes
                .gbuffer
                .encode(recorder, &self.gbuffer_inputs(), &of.gbuffer),
            Step::Validity => passes
                .validity
                .encode(recorder, &self.validity_inputs(), &of.validity),
            Step::Plate => self.plate(recorder),
            Step::Withhold => {
                let marks = &of.validity.marks;
                passes
                    .withhold
                    .encode(recorder, &self.withhold_inputs(), &of.withhold, marks);
            }
            Step::Lit => passes.lit.encode(recorder, &self.lit_inputs()),
            Step::FillLit => self.fill(recorder, &self.state.lit),
            Step::Estimate => self.estimate(recorder),
            Step::Fit(task) => self.fit(recorder, task),
            Step::Residual { is_first } => {
                let inputs = self.residual_inputs(is_first);
                passes.residual.encode(recorder, &inputs);
            }
            Step::FillResidual => self.fill(recorder, &self.state.residual),
            Step::Detail => passes.detail.encode(recorder, &self.detail_inputs(), &of.detail),
            Step::Tint => passes
                .tint
                .encode(recorder, &self.tint_inputs(), &self.state.tints),
            Step::TintFill => passes.tint_fill.encode(recorder, &self.state.tints),
            Step::Appearance => {
                let inputs = self.appearance_inputs();
                passes.appearance.encode(recorder, &inputs, &of.appearance);
            }
        }
    }

    fn light(&self, recorder: &mut Recorder<'_>, step: lighting::Step) {
        let (passes, lighting) = self.lighting;
        let posed = Posed {
            globals: self.region.globals_on_device(),
            toy: self.toy,
            pose: &self.toy.physical,
        };
        lighting.encode(recorder, passes, step, (posed, &self.captured.light));
    }

    fn plate(&self, recorder: &mut Recorder<'_>) {
        let inputs = plate::Inputs {
            globals: &self.region.globals,
            views: self.pictures.plate_views,
            plates: self.pictures.plates,
            is_same_view: self.pictures.is_same_view,
        };
        // If `estimate` completes the plate, it reads this photographed one, and so do the fits before it.
        let is_completed = estimate::is_needed(&self.region.plan);
        let photographed = self.captured.by_pass.estimate.photographed.as_ref();
        let target = photographed
            .filter(|_| is_completed)
            .unwrap_or(&self.captured.plate);
        self.plate.encode(recorder, &inputs, target);
    }

    fn estimate(&self, recorder: &mut Recorder<'_>) {
        let Some(photographed) = &self.captured.by_pass.estimate.photographed else {
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

    fn fit(&self, recorder: &mut Recorder<'_>, task: Task) {
        let (captured, targets) = (self.captured, &self.captured.by_pass.fit);
        let photographed = captured.by_pass.estimate.photographed.as_ref();
        let photographed = photographed.filter(|_| task.completes_plate);
        let inputs = fit::Inputs {
            seen: self.seen(),
            grids: &self.state.grids,
            lit_cells: &self.state.lit.cells,
            observed: self.observed(),
            plate: &photographed.unwrap_or(&captured.plate).view,
            gbuffer: &captured.by_pass.gbuffer,
        };
        let to_solve = fit_solve::Inputs {
            globals: &self.region.globals,
            rows: &targets.rows,
        };
        for index in 0..task.n_steps {
            let step = task.step(&self.region.plan, index, self.pictures.exposure_ratio);
            self.passes.fit.encode(recorder, &inputs, (&task, &step), targets);
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

    fn tint_inputs(&self) -> tint::Inputs<'_> {
        tint::Inputs {
            plan: &self.region.plan,
            seen: self.seen(),
            validity: self.validity(),
            gbuffer: &self.captured.by_pass.gbuffer,
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
