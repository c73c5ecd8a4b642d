//! `fit` and `fit_solve`: what the real shadow and the real toy tell of the light, by robust weighted least squares.

use crate::gpu::Gpu;
use crate::gpu::encoder::Encoder;
use crate::gpu::layout::{
    Fit as FitLayout, FitStep, MAX_LIGHTS, MAX_RECEIVERS, N_COLUMNS, N_FIT_SUMS, PRIOR_BOUNCE, PRIOR_SHARE,
    ReceiverFit, Subject,
};
use crate::gpu::pipeline::{GROUP_GLOBALS, GROUP_PASS, view};
use crate::gpu::shaders::{FIT_SOLVE, FIT_SUMS};
use crate::plan::Plan;

/// Sums of one row in one channel.
const N_SUMS: u64 = N_FIT_SUMS as u64;
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
        let mut receiver = ReceiverFit {
            bounce: [PRIOR_BOUNCE; 4],
            share: [[0.0; 4]; MAX_LIGHTS],
            contrast: [0.0; 4],
        };
        receiver.share[..n_lights.min(MAX_LIGHTS)].fill([share; 4]);
        let mut fit = FitLayout {
            gain: [1.0; 4],
            level: [[1.0; 4]; MAX_LIGHTS],
            receivers: [receiver; MAX_RECEIVERS],
            toy: [[0.0; 4]; N_COLUMNS],
        };
        fit.toy[0] = [0.5; 4];
        fit
    }

    /// Runs `task`, leaving what it finds in the solution.
    pub(crate) fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        shared: &FitShared<'_>,
        inputs: &FitInputs<'_>,
        task: FitTask,
    ) {
        let plan = shared.plan;
        let rows = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("fit rows"),
            size: 4 * N_SUMS * N_CHANNELS * u64::from(plan.n_fit_rows),
            usage: wgpu::BufferUsages::STORAGE,
            mapped_at_creation: false,
        });
        let globals = (0, shared.globals.as_entire_binding());
        let solution = (1, shared.solution.as_entire_binding());
        let to_sum = gpu.bind(
            &self.sums.get_bind_group_layout(GROUP_GLOBALS),
            &[globals.clone(), solution],
        );
        let to_solve = gpu.bind(&self.solve.get_bind_group_layout(GROUP_GLOBALS), &[globals]);
        for step in 0..task.n_steps {
            let uniform = gpu.uniform("fit step", &fit_step(plan, &task, step));
            let sums = self.bind_sums(gpu, &uniform, &rows, inputs);
            let solve = gpu.bind(
                &self.solve.get_bind_group_layout(GROUP_PASS),
                &[
                    (0, uniform.as_entire_binding()),
                    (1, rows.as_entire_binding()),
                    (2, shared.solution.as_entire_binding()),
                    (3, shared.kept.as_entire_binding()),
                ],
            );
            encoder.compute(
                FIT_SUMS.name,
                &self.sums,
                &[(GROUP_GLOBALS, &to_sum), (GROUP_PASS, &sums)],
                [plan.n_fit_rows, 1, 3],
            );
            encoder.compute(
                FIT_SOLVE.name,
                &self.solve,
                &[(GROUP_GLOBALS, &to_solve), (GROUP_PASS, &solve)],
                [1, 1, 1],
            );
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

/// What all fits share.
pub(crate) struct FitShared<'a> {
    pub(crate) plan: &'a Plan,
    pub(crate) globals: &'a wgpu::Buffer,
    pub(crate) solution: &'a wgpu::Buffer,
    /// Sums of frames before: see [`kept_bytes`].
    pub(crate) kept: &'a wgpu::Buffer,
}

/// One least-squares problem.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FitTask {
    pub(crate) subject: Subject,
    /// The receiver that is fitted, for [`Subject::Receiver`].
    pub(crate) receiver: u32,
    pub(crate) n_steps: u32,
    /// The solution so far is good enough to tell outliers from.
    pub(crate) is_refinement: bool,
}

/// Size of the sums that are kept: for each receiver and the toy.
pub(crate) const fn kept_bytes() -> u64 {
    4 * N_SUMS * N_CHANNELS * (MAX_RECEIVERS as u64 + 1)
}

fn fit_step(plan: &Plan, task: &FitTask, step: u32) -> FitStep {
    #[allow(clippy::cast_possible_truncation, reason = "at most six columns")]
    let n_columns = 2 + plan.lights.len() as u32;
    FitStep {
        is_reweighted: u32::from(step > 0 || task.is_refinement),
        n_rows: plan.n_fit_rows,
        n_columns,
        subject: task.subject as u32,
        receiver: task.receiver,
        stride_px: plan.fit_stride_px,
        is_last: u32::from(step + 1 == task.n_steps),
    }
}
