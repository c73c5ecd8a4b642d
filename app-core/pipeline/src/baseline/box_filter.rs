//! `box_filter`: box filter of the shadow term that discards samples outside the shadow.

use crate::baseline::plan::BaselinePlan;
use crate::baseline::search::TERM_FORMAT;
use crate::baseline::uniform::{SCENE_SLOTS, Scene};
use crate::gpu::{
    Attachment, Draw, DrawSpec, GROUP_PASS, GROUP_SCENE, Gpu, Recorder, Resource, Shader, Slot, Texture,
    TextureLayers, TextureView, cleared, loaded, shader, shared_struct,
};
use app_scene::scene::MAX_LIGHTS;

pub(crate) const SHADER: Shader = shader!("baseline/box_filter", structs: [Summed]);
const SLOTS: &[Slot] = &[Slot::per_use::<Summed>(), Slot::Texture];

shared_struct! {
    /// Parameters of one run.
    pub(crate) struct Summed {
        pub label: u32,
        pub receiver: u32,
    }
}

/// Needed only if the real shadow is sampled.
pub(crate) fn is_needed(plan: &BaselinePlan) -> bool {
    plan.is_sampled
}

pub(crate) struct Pass {
    draw: Draw,
}

pub(crate) struct Inputs<'a> {
    pub(crate) scene: Scene<'a>,
    pub(crate) terms: &'a TextureView,
    pub(crate) n_receivers: u32,
}

/// Targets of the region's size.
pub(crate) struct Targets {
    /// Sums of the rows.
    between: Texture,
    /// Sums over the box, one layer per set of lights, from set 1 on.
    pub(crate) sums: TextureLayers,
}

impl Targets {
    pub(crate) fn new(gpu: &Gpu, plan: &BaselinePlan) -> Self {
        let size_px = plan.region.size_px;
        Self {
            between: Texture::target(gpu, "terms between", size_px, TERM_FORMAT),
            sums: TextureLayers::targets(gpu, "filtered terms", (size_px, plan.n_sets), TERM_FORMAT),
        }
    }
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let groups = [SCENE_SLOTS, SLOTS, &[], &[]];
        Self {
            draw: gpu.draw(&DrawSpec::fullscreen(&SHADER, "fs_sum", groups, &[TERM_FORMAT])),
        }
    }

    /// Filters each set of lights on each receiver, first the rows, then the columns.
    pub(crate) fn encode(&self, recorder: &mut Recorder<'_>, inputs: &Inputs<'_>, targets: &Targets) {
        for receiver in 0..inputs.n_receivers {
            for (set, of_set) in (1..).zip(&targets.sums.layers) {
                let rows = Summed {
                    label: (receiver << MAX_LIGHTS) + set,
                    receiver,
                };
                let columns = Summed { label: 0, receiver };
                let between = cleared(&targets.between.view);
                self.sum(recorder, (inputs.scene, rows), inputs.terms, between);
                // The columns of a receiver keep the texels of the other receivers.
                let sums = if receiver == 0 {
                    cleared(of_set)
                } else {
                    loaded(of_set)
                };
                self.sum(recorder, (inputs.scene, columns), &targets.between.view, sums);
            }
        }
    }

    fn sum(
        &self,
        recorder: &mut Recorder<'_>,
        (scene, summed): (Scene<'_>, Summed),
        from: &TextureView,
        to: Attachment<'_>,
    ) {
        let groups = [
            recorder.bind(&self.draw, GROUP_SCENE, &scene.resources()),
            recorder.bind_with(&self.draw, GROUP_PASS, &summed, &[Resource::PerUse, from.into()]),
        ];
        recorder.fullscreen_onto(&self.draw, &groups, &[Some(to)]);
    }
}
