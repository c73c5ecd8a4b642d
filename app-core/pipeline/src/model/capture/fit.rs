//! `fit`: sums of the normal equations for receivers, toy and intensities.

use wgpu::BufferUsages;

use crate::gpu::bindings::{GROUP_PASS, Resource, Slot};
use crate::gpu::buffer::Buffer;
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Compute, ComputeSpec};
use crate::gpu::recorder::{Recorder, n_pixels};
use crate::gpu::shader::{Mirrors, Shader, mirrors, shader};
use crate::gpu::shared::shared_struct;
use crate::gpu::texture::TextureView;
use crate::model::capture::Observed;
use crate::model::capture::gbuffer;
use crate::model::plan::{MAX_FIT_ROWS, Plan};
use crate::model::state::grids::Grids;
use crate::model::state::solution::{N_CHANNELS, N_FIT_SUMS, SEEN_SLOTS, SeenScene};
use crate::passes::pictures::ByForm;
use crate::passes::specular::Specular;

/// One step of the iteratively reweighted least squares.
pub(crate) const FIT_STEP: Mirrors = mirrors!(
    "common/fit_step",
    structs: [FitStep],
    constants: [SUBJECT_RECEIVER, SUBJECT_TOY, SUBJECT_INTENSITIES],
);
pub(crate) const SHADER: Shader = shader!("capture/fit");
/// Grids and lit cells, from which a plate is completed.
const LIT_SLOTS: &[Slot] = &[Slot::uniform::<Grids>(), Slot::Read];
/// Group of all other resources.
const GROUP_FIT: usize = 2;
/// Step, sums and observations of receivers, followed by the observations of the toy.
const SLOTS: &[Slot] = &[
    Slot::per_use::<FitStep>(),
    Slot::ReadWrite,
    Slot::Texture,
    Slot::Texture,
    Slot::Texture,
    Slot::Filtered,
    Slot::Sampler,
    Slot::Texture,
    Slot::Texture,
    Slot::Texture,
    Slot::Depth,
    Slot::uniform::<Specular>(),
];
/// Number of slots for observations of receivers.
const N_RECEIVER_SLOTS: usize = 7;
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
    /// Whether the solution so far is good enough to down-weight outliers.
    pub(crate) is_refinement: bool,
    /// Whether the plate is still incomplete. Its missing pixels are then replaced by a smooth
    /// estimate as they are read.
    pub(crate) completes_plate: bool,
}

impl Task {
    /// The task for the first receiver, with its plate unchanged.
    pub(crate) fn new(plan: &Plan, subject: Subject, is_first: bool) -> Self {
        Self {
            subject,
            receiver: 0,
            n_steps: match subject {
                Subject::Intensities => plan.n_intensity_steps,
                Subject::Receiver | Subject::Toy if is_first => plan.n_fit_steps,
                Subject::Receiver | Subject::Toy => plan.n_refine_steps,
            },
            is_refinement: !is_first,
            completes_plate: false,
        }
    }

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
    /// Pipelines for a plate as it is, and for one that is completed.
    receiver: [ByForm<Compute>; 2],
    /// Pipelines for the same two plates.
    intensities: [ByForm<Compute>; 2],
    toy: ByForm<Compute>,
}

pub(crate) struct Inputs<'a> {
    pub(crate) seen: SeenScene<'a>,
    pub(crate) grids: &'a Buffer,
    pub(crate) lit_cells: &'a Buffer,
    pub(crate) observed: Observed<'a>,
    /// The photographed plate alone, for a task that completes it.
    pub(crate) plate: &'a TextureView,
    pub(crate) gbuffer: &'a gbuffer::Targets,
    pub(crate) specular: &'a Buffer,
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
        let compute = |entry_point, lit_slots: &'static [Slot], n_slots| {
            ByForm::new(gpu, move |gpu, form| {
                gpu.compute(&ComputeSpec {
                    shader: &SHADER,
                    entry_point,
                    groups: [SEEN_SLOTS, lit_slots, &SLOTS[..n_slots], &[]],
                    constants: vec![form],
                })
            })
        };
        let by_plate = |[complete, completing]: [_; 2]| {
            [
                compute(complete, &[], N_RECEIVER_SLOTS),
                compute(completing, LIT_SLOTS, N_RECEIVER_SLOTS),
            ]
        };
        Self {
            receiver: by_plate(["cs_receiver", "cs_receiver_completing"]),
            intensities: by_plate(["cs_intensities", "cs_intensities_completing"]),
            toy: compute("cs_toy", &[], SLOTS.len()),
        }
    }

    pub(crate) fn encode(
        &self,
        recorder: &mut Recorder<'_>,
        inputs: &Inputs<'_>,
        task: &Task,
        step: &FitStep,
        targets: &Targets,
    ) {
        let gbuffer = inputs.gbuffer;
        let observed = &inputs.observed;
        let resources = [
            Resource::PerUse,
            (&targets.rows).into(),
            inputs.plate.into(),
            observed.validity.into(),
            observed.visibility.into(),
            observed.ambient.into(),
            (&recorder.gpu.samplers.linear).into(),
            (&gbuffer.base.view).into(),
            (&gbuffer.normal.view).into(),
            (&gbuffer.received.view).into(),
            (&gbuffer.depth.view).into(),
            inputs.specular.into(),
        ];
        let by_plate = usize::from(task.completes_plate);
        let (compute, n_slots) = match task.subject {
            Subject::Receiver => (&self.receiver[by_plate], N_RECEIVER_SLOTS),
            Subject::Intensities => (&self.intensities[by_plate], N_RECEIVER_SLOTS),
            Subject::Toy => (&self.toy, SLOTS.len()),
        };
        let compute = compute.of(recorder.gpu, &inputs.seen.frame);
        let mut groups = vec![
            inputs.seen.bind(recorder, compute),
            recorder.bind_with(compute, GROUP_FIT, step, &resources[..n_slots]),
        ];
        if task.completes_plate {
            let lit = [inputs.grids.into(), inputs.lit_cells.into()];
            groups.push(recorder.bind(compute, GROUP_PASS, &lit));
        }
        let workgroups = [step.n_rows, 1, 1];
        let n_sampled = n_pixels(inputs.plate.size_px() / step.stride_px.max(1));
        recorder.compute_over(compute, &groups, workgroups, n_sampled);
    }
}
