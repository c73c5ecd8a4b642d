//! `lit`: colour of the lit receivers, pooled on coarse grids.

use crate::gpu::bindings::Slot;
use crate::gpu::context::Gpu;
use crate::gpu::recorder::Recorder;
use crate::gpu::shader::{Shader, shader};
use crate::model::capture::Observed;
use crate::model::capture::pool::{Pool, PoolGrids, Taken};
use crate::model::plan::Plan;
use crate::model::state::grids::Grids;
pub(crate) use crate::passes::list::NoTargets as Targets;

pub(crate) const SHADER: Shader = shader!("capture/lit");
const SLOTS: &[Slot] = &[
    Slot::uniform::<Grids>(),
    Slot::ReadWrite,
    Slot::ReadWrite,
    Slot::per_use::<Taken>(),
    Slot::Texture,
    Slot::Texture,
    Slot::Filtered,
    Slot::Sampler,
];

/// Needed only if plates do not cover the whole region.
pub(crate) fn is_needed(plan: &Plan) -> bool {
    plan.is_plate_estimated
}

pub(crate) struct Pass(Pool);

pub(crate) struct Inputs<'a> {
    pub(crate) on: PoolGrids<'a>,
    pub(crate) observed: Observed<'a>,
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        Self(Pool::new(gpu, &SHADER, SLOTS))
    }

    /// Adds this view's colours to the cells.
    pub(crate) fn encode(&self, recorder: &mut Recorder<'_>, inputs: &Inputs<'_>) {
        let observed = &inputs.observed;
        let pictures = [observed.validity, observed.visibility, observed.ambient];
        self.0.encode(recorder, &inputs.on, &Taken::ALL, &pictures);
    }
}
