//! `fit_solve`: the solution, with weak priors, of the normal equations that `fit` summed.

use crate::gpu::bindings::{GROUP_PASS, GROUP_SCENE, Resource, Slot};
use crate::gpu::buffer::Buffer;
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Compute, ComputeSpec};
use crate::gpu::recorder::Recorder;
use crate::gpu::shader::{Shader, shader};
use crate::model::capture::fit::FitStep;
use crate::model::state::SceneState;
use crate::model::state::solution::{PRIOR_BOUNCE, PRIOR_DIRECT_FRACTION, PRIOR_WEIGHT, SAME_GAIN_WEIGHT};
use crate::passes::globals::GLOBALS_GROUP;
pub(crate) use crate::passes::list::NoTargets as Targets;

pub(crate) const SHADER: Shader = shader!("capture/fit_solve", constants: [PRIOR_WEIGHT, PRIOR_BOUNCE, PRIOR_DIRECT_FRACTION, SAME_GAIN_WEIGHT]);
const SLOTS: &[Slot] = &[
    Slot::per_use::<FitStep>(),
    Slot::Read,
    Slot::ReadWrite,
    Slot::ReadWrite,
];

pub(crate) struct Pass {
    compute: Compute,
}

pub(crate) struct Inputs<'a> {
    pub(crate) globals: &'a Buffer,
    /// Rows of this step's sums.
    pub(crate) rows: &'a Buffer,
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        Self {
            compute: gpu.compute(&ComputeSpec {
                shader: &SHADER,
                entry_point: "cs_solve",
                groups: [GLOBALS_GROUP, SLOTS, &[], &[]],
                constants: Vec::new(),
            }),
        }
    }

    /// Writes the solution and, in the last step of a fit, the accumulated sums.
    pub(crate) fn encode(
        &self,
        recorder: &mut Recorder<'_>,
        inputs: &Inputs<'_>,
        step: &FitStep,
        state: &SceneState,
    ) {
        let resources = [
            Resource::PerUse,
            inputs.rows.into(),
            (&state.solution).into(),
            (&state.fit_sums).into(),
        ];
        let groups = [
            recorder.bind(&self.compute, GROUP_SCENE, &[inputs.globals.into()]),
            recorder.bind_with(&self.compute, GROUP_PASS, step, &resources),
        ];
        recorder.compute(&self.compute, &groups, [1, 1, 1]);
    }
}
