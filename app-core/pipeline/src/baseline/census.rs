//! `census`: the sets of lights whose shadows occur in mask 3c.

use wgpu::BufferUsages;

use crate::baseline::plan::BaselinePlan;
use crate::gpu::{Buffer, Compute, ComputeSpec, GROUP_PASS, Gpu, Recorder, Shader, Slot, Texture, shader};
use app_scene::scene::MAX_RECEIVERS;

pub(crate) const SHADER: Shader = shader!("baseline/census");
const SLOTS: &[Slot] = &[Slot::WholeNumbers, Slot::ReadWrite];
/// Invocations of a workgroup along each side.
const WORKGROUP_PX: u32 = 16;
/// One word per receiver, in which bit s is set if the set s of lights occurs.
pub(crate) type SeenSets = [u32; MAX_RECEIVERS];

/// Needed only if the real shadow is sampled.
pub(crate) fn is_needed(plan: &BaselinePlan) -> bool {
    plan.is_sampled
}

pub(crate) struct Pass {
    compute: Compute,
}

pub(crate) struct Targets {
    /// The words, as [`SeenSets`].
    pub(crate) seen_sets: Buffer,
}

impl Targets {
    pub(crate) fn new(gpu: &Gpu, _plan: &BaselinePlan) -> Self {
        let usage = BufferUsages::COPY_SRC | BufferUsages::COPY_DST;
        Self {
            seen_sets: gpu.storage("seen sets", size_of::<SeenSets>() as u64, usage),
        }
    }
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        Self {
            compute: gpu.compute(&ComputeSpec {
                shader: &SHADER,
                entry_point: "cs_count",
                groups: [&[], SLOTS, &[], &[]],
                constants: Vec::new(),
            }),
        }
    }

    /// Collects the sets that occur in mask 3c.
    pub(crate) fn encode(&self, recorder: &mut Recorder<'_>, labels: &Texture, targets: &Targets) {
        recorder.clear(&targets.seen_sets);
        let resources = [(&labels.view).into(), (&targets.seen_sets).into()];
        let own = recorder.bind(&self.compute, GROUP_PASS, &resources);
        let workgroups = labels.size_px().map(|side| side.div_ceil(WORKGROUP_PX)).extend(1);
        recorder.compute(&self.compute, &[own], workgroups.to_array());
    }
}
