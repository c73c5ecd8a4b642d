//! One view and what is known of the place: each step by which the one adds to the other.

use crate::capture::Capture;
use crate::gpu::Gpu;
use crate::gpu::encoder::Encoder;
use crate::gpu::layout::Subject;
use crate::grids::CellBuffers;
use crate::knowledge::Knowledge;
use crate::passes::detail::DetailInputs;
use crate::passes::estimate::{EstimateInputs, Fineness};
use crate::passes::fit::{FitInputs, FitShared, FitTask};
use crate::passes::lit::LitInputs;
use crate::passes::residual::ResidualInputs;
use crate::passes::tint::TintInputs;
use crate::passes::withhold::WithholdInputs;
use crate::pipeline::{EstimatePasses, Passes};
use crate::pool::PoolGrids;

pub(crate) struct Learner<'a> {
    pub(crate) gpu: &'a Gpu,
    pub(crate) capture: &'a Capture,
    pub(crate) passes: &'a Passes,
    pub(crate) knowledge: &'a Knowledge,
    pub(crate) frame: &'a wgpu::TextureView,
    /// What the frame may tell the fits.
    pub(crate) fit_evidence: &'a wgpu::TextureView,
}

impl Learner<'_> {
    /// The light on each receiver in turn: what the first tells is what the others are expected to be.
    pub(crate) fn fit_receivers(&self, encoder: &mut Encoder, is_first: bool) {
        for receiver in 0..self.capture.plan.n_receivers {
            self.fit(encoder, Subject::Receiver, receiver, is_first);
        }
    }

    /// The exposure of this picture and the power of each light in it.
    pub(crate) fn fit_levels(&self, encoder: &mut Encoder) {
        self.fit(encoder, Subject::Levels, 0, false);
    }

    pub(crate) fn fit(&self, encoder: &mut Encoder, subject: Subject, receiver: u32, is_first: bool) {
        let (capture, plan) = (self.capture, &self.capture.plan);
        let shared = FitShared {
            plan,
            globals: &capture.globals,
            solution: &self.knowledge.solution,
            kept: &self.knowledge.fit_sums,
        };
        let inputs = FitInputs {
            frame: self.frame,
            plate: &capture.plate().view,
            evidence: self.fit_evidence,
            visibility: &capture.physical.lights.view,
            ambient: &capture.physical.ambient.view,
            object_base: &capture.object_base.view,
            object_normal: &capture.object_normal.view,
            object_received: &capture.object_received.view,
        };
        let task = FitTask {
            subject,
            receiver,
            n_steps: if is_first {
                plan.n_fit_steps
            } else {
                plan.n_refine_steps
            },
            // A jump of the exposure makes every pixel an outlier.
            is_refinement: !is_first && subject != Subject::Levels,
        };
        self.passes.fit.encode(self.gpu, encoder, &shared, &inputs, task);
    }

    /// What the receivers look like in the light, where plates do not show them.
    pub(crate) fn pool_lit(&self, encoder: &mut Encoder) {
        let (capture, knowledge) = (self.capture, self.knowledge);
        let Some(pass) = self.estimate_passes() else {
            return;
        };
        let inputs = LitInputs {
            on: self.pool_grids(&knowledge.lit),
            frame: self.frame,
            evidence: self.fit_evidence,
            visibility: &capture.physical.lights.view,
            ambient: &capture.physical.ambient.view,
        };
        pass.lit.encode(self.gpu, encoder, &inputs);
        self.fill(encoder, &knowledge.lit);
    }

    /// Completes the plate, where plates do not show everything.
    pub(crate) fn estimate_plate(&self, encoder: &mut Encoder, fineness: Fineness) {
        let (capture, knowledge) = (self.capture, self.knowledge);
        let (Some(pass), Some(target)) = (self.estimate_passes(), &capture.estimated) else {
            return;
        };
        let inputs = EstimateInputs {
            globals: &capture.globals,
            solution: &knowledge.solution,
            grids: &knowledge.grids,
            lit_cells: &knowledge.lit.cells,
            plate: &capture.photographed.view,
            frame: self.frame,
            evidence: &capture.evidence().view,
            visibility: &capture.physical.lights.view,
            ambient: &capture.physical.ambient.view,
        };
        pass.estimate
            .encode(self.gpu, encoder, &inputs, fineness, &target.view);
    }

    /// What each pixel knows of its own residual, where noise is to be removed.
    pub(crate) fn separate_detail(&self, encoder: &mut Encoder) {
        let (capture, knowledge) = (self.capture, self.knowledge);
        let (Some(pass), Some(target)) = (&self.passes.detail, &capture.detail) else {
            return;
        };
        let inputs = DetailInputs {
            globals: &capture.globals,
            solution: &knowledge.solution,
            frame: self.frame,
            plate: &capture.plate().view,
            evidence: &capture.evidence().view,
            visibility: &capture.physical.lights.view,
            ambient: &capture.physical.ambient.view,
        };
        pass.encode(self.gpu, encoder, &inputs, &target.view);
    }

    /// What the toy's visible surface tells of its paint, also where no camera sees it.
    pub(crate) fn pool_tint(&self, encoder: &mut Encoder) {
        let (capture, knowledge) = (self.capture, self.knowledge);
        let inputs = TintInputs {
            plan: &capture.plan,
            globals: &capture.globals,
            solution: &knowledge.solution,
            frame: self.frame,
            evidence: &capture.evident.view,
            object_depth: &capture.object_depth.view,
            object_normal: &capture.object_normal.view,
            object_received: &capture.object_received.view,
            object_base: &capture.object_base.view,
        };
        self.passes
            .tint
            .encode(self.gpu, encoder, &inputs, &knowledge.tints);
    }

    /// Keeps the real shadow from what follows, where that is asked for.
    pub(crate) fn withhold(&self, encoder: &mut Encoder) {
        let (capture, knowledge) = (self.capture, self.knowledge);
        let (Some(pass), Some(target)) = (&self.passes.withhold, &capture.withheld) else {
            return;
        };
        let inputs = WithholdInputs {
            globals: &capture.globals,
            solution: &knowledge.solution,
            evidence: &capture.evident.view,
            visibility: &capture.physical.lights.view,
            ambient: &capture.physical.ambient.view,
        };
        pass.encode(self.gpu, encoder, &inputs, &target.view);
    }

    /// What the model leaves unexplained, also where the toy hides it.
    pub(crate) fn pool_residual(&self, encoder: &mut Encoder) {
        let (capture, knowledge) = (self.capture, self.knowledge);
        let inputs = ResidualInputs {
            on: self.pool_grids(&knowledge.residual),
            frame: self.frame,
            plate: &capture.plate().view,
            evidence: &capture.evidence().view,
            visibility: &capture.physical.lights.view,
            ambient: &capture.physical.ambient.view,
        };
        self.passes.residual.encode(self.gpu, encoder, &inputs);
        self.fill(encoder, &knowledge.residual);
    }

    /// The passes that estimate a plate, where this view needs one.
    fn estimate_passes(&self) -> Option<&EstimatePasses> {
        let passes = self.passes.estimate.as_ref();
        passes.filter(|_| self.capture.plan.is_plate_estimated)
    }

    fn pool_grids<'a>(&'a self, cells: &'a CellBuffers) -> PoolGrids<'a> {
        PoolGrids {
            globals: &self.capture.globals,
            solution: &self.knowledge.solution,
            grids: &self.knowledge.grids,
            cells,
            n_receivers: self.capture.plan.n_receivers,
        }
    }

    fn fill(&self, encoder: &mut Encoder, cells: &CellBuffers) {
        let filled = (&self.knowledge.grids, &cells.cells);
        let n_receivers = self.capture.plan.n_receivers;
        self.passes.fill.encode(self.gpu, encoder, filled, n_receivers);
    }
}
