//! `tint_fill`: tints of the toy's paint, filled in where no camera has seen the paint.

use crate::gpu::bindings::{GROUP_PASS, Slot};
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Compute, ComputeSpec};
use crate::gpu::recorder::Recorder;
use crate::gpu::shader::{Shader, shader};
use crate::model::state::tints::Tints;
pub(crate) use crate::passes::list::NoTargets as Targets;

pub(crate) const SHADER: Shader = shader!("capture/tint_fill");
const SLOTS: &[Slot] = &[Slot::Read, Slot::ReadWrite, Slot::ReadWrite];

pub(crate) struct Pass {
    compute: Compute,
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        Self {
            compute: gpu.compute(&ComputeSpec {
                shader: &SHADER,
                entry_point: "cs_fill",
                groups: [&[], SLOTS, &[], &[]],
                constants: Vec::new(),
            }),
        }
    }

    /// Accumulates the sums of a frame, and fills every cell.
    pub(crate) fn encode(&self, recorder: &mut Recorder<'_>, tints: &Tints) {
        let buffers = [&tints.sums, &tints.accumulated, &tints.cells];
        let own = recorder.bind(&self.compute, GROUP_PASS, &buffers.map(Into::into));
        recorder.compute(&self.compute, &[own], [tints.layout.n_materials, 1, 1]);
    }
}
