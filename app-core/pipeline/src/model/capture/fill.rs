//! `fill`: the cells behind the toy, filled from their neighbours by pull-push.

use crate::gpu::bindings::{GROUP_PASS, Slot};
use crate::gpu::buffer::Buffer;
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Compute, ComputeSpec};
use crate::gpu::recorder::Recorder;
use crate::gpu::shader::{Shader, shader};
use crate::model::state::grids::Grids;
pub(crate) use crate::passes::list::NoTargets as Targets;

pub(crate) const SHADER: Shader = shader!("capture/fill");
const SLOTS: &[Slot] = &[Slot::uniform::<Grids>(), Slot::ReadWrite];

pub(crate) struct Pass {
    compute: Compute,
}

pub(crate) struct Inputs<'a> {
    pub(crate) grids: &'a Buffer,
    pub(crate) n_receivers: u32,
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        Self {
            compute: gpu.compute(&ComputeSpec {
                shader: &SHADER,
                entry_point: "cs_pull_push",
                groups: [&[], SLOTS, &[], &[]],
                constants: Vec::new(),
            }),
        }
    }

    /// Fills the finest levels of `cells` in place.
    pub(crate) fn encode(&self, recorder: &mut Recorder<'_>, inputs: &Inputs<'_>, cells: &Buffer) {
        let own = recorder.bind(&self.compute, GROUP_PASS, &[inputs.grids.into(), cells.into()]);
        recorder.compute(&self.compute, &[own], [inputs.n_receivers, 1, 1]);
    }
}
