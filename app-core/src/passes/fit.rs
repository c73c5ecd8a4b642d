//! `fit` and `fit_solve`: what the real shadow and the real toy tell of the light, by robust weighted least squares.

use crate::gpu::Gpu;
use crate::gpu::encoder::Encoder;
use crate::gpu::layout::{
    Fit as FitLayout, FitStep, MAX_LIGHTS, N_COLUMNS, PRIOR_BOUNCE, PRIOR_SHARE, Subject,
};
use crate::gpu::pipeline::{GROUP_GLOBALS, GROUP_PASS, view};
use crate::gpu::shaders::{FIT_SOLVE, FIT_SUMS};
use crate::plan::Plan;

/// Sums of one row: the upper triangle of the normal equations and their right-hand side.
const N_SUMS: u64 = 27;
const N_CHANNELS: u64 = 3;

pub(crate) struct Fit {
    sums: wgpu::ComputePipeline,
    solve: wgpu::ComputePipeline,
    linear: wgpu::Sampler,
}

pub(crate) struct FitInputs<'a> {
    pub(crate) frame: &'a wgpu::TextureView,
    pub(crate) plate: &'a wgpu::TextureView,
    pub(crate) evidence: &'a wgpu::TextureView,
    pub(crate) visibility: &'a wgpu::TextureView,
    pub(crate) ambient: &'a wgpu::TextureView,
    pub(crate) object_base: &'a wgpu::TextureView,
    pub(crate) object_normal: &'a wgpu::TextureView,
    pub(crate) object_received: &'a wgpu::TextureView,
}

impl Fit {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        Self {
            sums: gpu.compute_pipeline(&FIT_SUMS, "cs_accumulate"),
            solve: gpu.compute_pipeline(&FIT_SOLVE, "cs_solve"),
            linear: gpu.linear_sampler(),
        }
    }

    /// A solution to start from, which also stands where a frame gives no evidence at all.
    pub(crate) fn start(n_lights: usize) -> FitLayout {
        #[allow(clippy::cast_precision_loss, reason = "at most four lights")]
        let share = PRIOR_SHARE / n_lights.max(1) as f32;
        let mut fit = FitLayout {
            gain: [1.0; 4],
            bounce: [PRIOR_BOUNCE; 4],
            share: [[0.0; 4]; MAX_LIGHTS],
            toy: [[0.0; 4]; N_COLUMNS],
            contrast: [0.0; 4],
        };
        fit.share[..n_lights.min(MAX_LIGHTS)].fill([share; 4]);
        fit.toy[0] = [0.5; 4];
        fit
    }

    /// Runs all steps for `subject`, leaving the solution in `solution`.
    pub(crate) fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        shared: &FitShared<'_>,
        inputs: &FitInputs<'_>,
        subject: Subject,
    ) {
        let plan = shared.plan;
        let rows = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("fit rows"),
            size: 4 * N_SUMS * N_CHANNELS * u64::from(plan.n_fit_rows),
            usage: wgpu::BufferUsages::STORAGE,
            mapped_at_creation: false,
        });
        let group_0 = gpu.bind(
            &self.sums.get_bind_group_layout(GROUP_GLOBALS),
            &[
                (0, shared.globals.as_entire_binding()),
                (1, shared.solution.as_entire_binding()),
            ],
        );
        for step in 0..plan.n_fit_steps {
            let uniform = gpu.uniform("fit step", &fit_step(plan, subject, step));
            let sums = self.bind_sums(gpu, &uniform, &rows, inputs);
            let solve = gpu.bind(
                &self.solve.get_bind_group_layout(GROUP_PASS),
                &[
                    (0, uniform.as_entire_binding()),
                    (1, rows.as_entire_binding()),
                    (2, shared.solution.as_entire_binding()),
                ],
            );
            encoder.compute(
                FIT_SUMS.name,
                &self.sums,
                &[(GROUP_GLOBALS, &group_0), (GROUP_PASS, &sums)],
                [plan.n_fit_rows, 1, 3],
            );
            encoder.compute(FIT_SOLVE.name, &self.solve, &[(GROUP_PASS, &solve)], [1, 1, 1]);
        }
    }

    fn bind_sums(
        &self,
        gpu: &Gpu,
        step: &wgpu::Buffer,
        rows: &wgpu::Buffer,
        inputs: &FitInputs<'_>,
    ) -> wgpu::BindGroup {
        gpu.bind(
            &self.sums.get_bind_group_layout(GROUP_PASS),
            &[
                (0, step.as_entire_binding()),
                (1, rows.as_entire_binding()),
                (2, view(inputs.frame)),
                (3, view(inputs.plate)),
                (4, view(inputs.evidence)),
                (5, view(inputs.visibility)),
                (6, view(inputs.ambient)),
                (7, wgpu::BindingResource::Sampler(&self.linear)),
                (8, view(inputs.object_base)),
                (9, view(inputs.object_normal)),
                (10, view(inputs.object_received)),
            ],
        )
    }
}

/// What the fits of receiver and toy share.
pub(crate) struct FitShared<'a> {
    pub(crate) plan: &'a Plan,
    pub(crate) globals: &'a wgpu::Buffer,
    pub(crate) solution: &'a wgpu::Buffer,
}

fn fit_step(plan: &Plan, subject: Subject, step: u32) -> FitStep {
    #[allow(clippy::cast_possible_truncation, reason = "at most six columns")]
    let n_columns = 2 + plan.lights.len() as u32;
    FitStep {
        is_reweighted: u32::from(step > 0),
        n_rows: plan.n_fit_rows,
        n_columns,
        subject: subject as u32,
        stride_px: plan.fit_stride_px,
    }
}
