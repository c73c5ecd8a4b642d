//! `fit`: sums of the normal equations for receivers, toy and intensities.

use wgpu::BufferUsages;

use crate::gpu::bindings::{GROUP_PASS, GROUP_SCENE, Resource, Slot};
use crate::gpu::buffer::Buffer;
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Compute, ComputeSpec};
use crate::gpu::recorder::{Recorder, n_pixels};
use crate::gpu::shader::{Part, Shader, part};
use crate::gpu::shared::shared_struct;
use crate::gpu::texture::TextureView;
use crate::model::capture::gbuffer;
use crate::model::capture::observed::Observed;
use crate::model::parts::{HEMISPHERES, MODEL, TOY_RADIANCE};
use crate::model::plan::{MAX_FIT_ROWS, Plan};
use crate::model::state::solution::{FIT, N_CHANNELS, N_FIT_SUMS, SCENE_SLOTS, Scene};
use crate::passes::globals::GLOBALS;
use crate::passes::parts::{MARKS, PIXEL};

/// One step of the iteratively reweighted least squares.
pub(crate) const FIT_STEP: Part = part!(
    "common/fit_step",
    structs: [FitStep],
    constants: [SUBJECT_RECEIVER, SUBJECT_TOY, SUBJECT_INTENSITIES],
);
pub(crate) const SHADER: Shader = Shader::new(&[
    &GLOBALS,
    &FIT,
    &FIT_STEP,
    &MODEL,
    &HEMISPHERES,
    &TOY_RADIANCE,
    &PIXEL,
    &MARKS,
    &part!("capture/fit"),
]);
/// Step, sums, and what is seen of receivers; then what is seen of the toy.
const SLOTS: &[Slot] = &[
    Slot::per_use::<FitStep>(),
    Slot::ReadWrite,
    Slot::Texture,
    Slot::Texture,
    Slot::Texture,
    Slot::Texture,
    Slot::Filtered,
    Slot::Sampler,
    Slot::Texture,
    Slot::Texture,
    Slot::Texture,
];
/// Entry point of each [`Subject`], and how many of the slots it looks at.
const SUBJECTS: [(&str, usize); 3] = [("cs_receiver", 8), ("cs_toy", SLOTS.len()), ("cs_intensities", 8)];
const SUBJECT_RECEIVER: u32 = Subject::Receiver as u32;
const SUBJECT_TOY: u32 = Subject::Toy as u32;
const SUBJECT_INTENSITIES: u32 = Subject::Intensities as u32;

shared_struct! {
    /// One step of a fit.
    pub(crate) struct FitStep {
        pub is_reweighted: u32,
        pub n_rows: u32,
        pub n_columns: u32,
        pub subject: u32,
        pub receiver: u32,
        pub stride_px: u32,
        pub is_last: u32,
        pub exposure_ratio: f32,
    }
}

/// The unknowns of a fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub(crate) enum Subject {
    /// A receiver: gain, bounce and each light's direct fraction.
    Receiver = 0,
    /// The toy: ambient light, its gradient and each light's strength.
    Toy = 1,
    /// The frame's exposure and each light's intensity.
    Intensities = 2,
}

/// One least-squares problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Task {
    pub(crate) subject: Subject,
    /// The receiver that is fitted, for [`Subject::Receiver`].
    pub(crate) receiver: u32,
    pub(crate) n_steps: u32,
    /// The solution so far is good enough to down-weight outliers.
    pub(crate) is_refinement: bool,
}

impl Task {
    /// The uniform of step `index`, for a picture of `exposure_ratio` times the exposure of the one before.
    pub(crate) fn step(&self, plan: &Plan, index: u32, exposure_ratio: f32) -> FitStep {
        let is_first_of_picture = self.subject == Subject::Intensities && index == 0;
        #[allow(clippy::cast_possible_truncation, reason = "at most six columns")]
        let n_columns = 2 + plan.n_lights as u32;
        let stride_px = if self.subject == Subject::Intensities {
            plan.intensity_fit_stride_px
        } else {
            plan.fit_stride_px
        };
        FitStep {
            is_reweighted: u32::from(index > 0 || self.is_refinement),
            n_rows: plan.n_fit_rows(stride_px),
            n_columns,
            subject: self.subject as u32,
            receiver: self.receiver,
            stride_px,
            is_last: u32::from(index + 1 == self.n_steps),
            exposure_ratio: if is_first_of_picture { exposure_ratio } else { 1.0 },
        }
    }
}

pub(crate) struct Pass {
    /// In the order of [`Subject`].
    of_subjects: [Compute; 3],
}

pub(crate) struct Inputs<'a> {
    pub(crate) scene: Scene<'a>,
    pub(crate) observed: Observed<'a>,
    pub(crate) plate: &'a TextureView,
    pub(crate) gbuffer: &'a gbuffer::Targets,
}

/// Rows of sums, one per workgroup and channel.
pub(crate) struct Targets {
    pub(crate) rows: Buffer,
}

impl Targets {
    pub(crate) fn new(gpu: &Gpu, _plan: &Plan) -> Self {
        let n_sums = N_FIT_SUMS * N_CHANNELS * MAX_FIT_ROWS as usize;
        Self {
            rows: gpu.storage(
                "fit rows",
                (size_of::<f32>() * n_sums) as u64,
                BufferUsages::empty(),
            ),
        }
    }
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let of_subject = |(entry_point, n_slots): (_, usize)| {
            gpu.compute(&ComputeSpec {
                shader: &SHADER,
                entry_point,
                groups: [SCENE_SLOTS, &SLOTS[..n_slots], &[], &[]],
            })
        };
        Self {
            of_subjects: SUBJECTS.map(of_subject),
        }
    }

    pub(crate) fn encode(
        &self,
        recorder: &mut Recorder<'_>,
        inputs: &Inputs<'_>,
        step: &FitStep,
        targets: &Targets,
    ) {
        let gbuffer = inputs.gbuffer;
        let observed = &inputs.observed;
        let resources = [
            Resource::PerUse,
            (&targets.rows).into(),
            observed.frame.into(),
            inputs.plate.into(),
            observed.validity.into(),
            observed.visibility.into(),
            observed.ambient.into(),
            (&recorder.gpu.samplers.linear).into(),
            (&gbuffer.base.view).into(),
            (&gbuffer.normal.view).into(),
            (&gbuffer.received.view).into(),
        ];
        let subject = step.subject as usize;
        let (compute, (_, n_slots)) = (&self.of_subjects[subject], SUBJECTS[subject]);
        let groups = [
            recorder.bind(compute, GROUP_SCENE, &inputs.scene.resources()),
            recorder.bind_with(compute, GROUP_PASS, step, &resources[..n_slots]),
        ];
        let workgroups = [step.n_rows, 1, 1];
        let n_sampled = n_pixels(inputs.plate.size_px() / step.stride_px.max(1));
        recorder.compute_over(compute, &groups, workgroups, n_sampled);
    }
}
