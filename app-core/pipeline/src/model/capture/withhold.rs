//! `withhold`: validity mask without the real shadow, to measure its reconstruction.

use crate::gpu::bindings::{GROUP_PASS, GROUP_SCENE, Slot};
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Draw, DrawSpec};
use crate::gpu::recorder::Recorder;
use crate::gpu::shader::{Shader, shader};
use crate::gpu::texture::{Texture, TextureView};
use crate::model::capture::validity;
use crate::model::plan::Plan;
use crate::model::state::solution::{SCENE_SLOTS, Scene};

pub(crate) const SHADER: Shader = shader!("capture/withhold");
const SLOTS: &[Slot] = &[Slot::Texture, Slot::Texture, Slot::Filtered, Slot::Sampler];

/// Needed only on request.
pub(crate) fn is_needed(plan: &Plan) -> bool {
    plan.is_shadow_withheld
}

pub(crate) struct Pass {
    draw: Draw,
}

pub(crate) struct Inputs<'a> {
    pub(crate) scene: Scene<'a>,
    pub(crate) visibility: &'a TextureView,
    pub(crate) ambient: &'a TextureView,
}

/// Targets of the region's size, if needed.
pub(crate) struct Targets {
    /// The mask with the real shadow.
    all: Option<Texture>,
}

impl Targets {
    pub(crate) fn new(gpu: &Gpu, plan: &Plan) -> Self {
        let target = || Texture::target(gpu, "all validity", plan.region.size_px, validity::FORMAT);
        Self {
            all: is_needed(plan).then(target),
        }
    }
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let groups = [SCENE_SLOTS, SLOTS, &[], &[]];
        Self {
            draw: gpu.draw(&DrawSpec::fullscreen(
                &SHADER,
                "fs_withhold",
                groups,
                &[validity::FORMAT],
            )),
        }
    }

    /// Clears the mask in the real shadow.
    pub(crate) fn encode(
        &self,
        recorder: &mut Recorder<'_>,
        inputs: &Inputs<'_>,
        targets: &Targets,
        marks: &Texture,
    ) {
        let Some(all) = &targets.all else { return };
        recorder.copy(marks, all);
        let resources = [
            (&all.view).into(),
            inputs.visibility.into(),
            inputs.ambient.into(),
            (&recorder.gpu.samplers.linear).into(),
        ];
        let groups = [
            recorder.bind(&self.draw, GROUP_SCENE, &inputs.scene.resources()),
            recorder.bind(&self.draw, GROUP_PASS, &resources),
        ];
        recorder.fullscreen(&self.draw, &groups, &[&marks.view]);
    }
}
