//! `residual`: residual of the model, pooled on coarse grids.

use crate::gpu::bindings::Slot;
use crate::gpu::context::Gpu;
use crate::gpu::recorder::Recorder;
use crate::gpu::shader::{Shader, shader};
use crate::gpu::texture::TextureView;
use crate::model::capture::Observed;
use crate::model::capture::pool::{Pool, PoolGrids, Taken};
use crate::model::state::grids::Grids;
pub(crate) use crate::passes::list::NoTargets as Targets;

pub(crate) const SHADER: Shader = shader!("capture/residual");
const SLOTS: &[Slot] = &[
    Slot::uniform::<Grids>(),
    Slot::ReadWrite,
    Slot::ReadWrite,
    Slot::per_use::<Taken>(),
    Slot::Texture,
    Slot::Texture,
    Slot::Texture,
    Slot::Filtered,
    Slot::Sampler,
];

pub(crate) struct Pass(Pool);

pub(crate) struct Inputs<'a> {
    pub(crate) on: PoolGrids<'a>,
    /// Points of a cell that are sampled.
    pub(crate) taken: Taken,
    pub(crate) observed: Observed<'a>,
    pub(crate) plate: &'a TextureView,
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        Self(Pool::new(gpu, &SHADER, SLOTS))
    }

    /// Adds this view's residuals to the cells.
    pub(crate) fn encode(&self, recorder: &mut Recorder<'_>, inputs: &Inputs<'_>) {
        let observed = &inputs.observed;
        let pictures = [
            inputs.plate,
            observed.validity,
            observed.visibility,
            observed.ambient,
        ];
        self.0.encode(recorder, &inputs.on, &inputs.taken, &pictures);
    }
}
