//! `things`: objects beside the toy, in the validity mask and in the plate.

use crate::gpu::bindings::{GROUP_PASS, Slot};
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Draw, DrawSpec, multiplied};
use crate::gpu::recorder::{Recorder, loaded};
use crate::gpu::shader::{Shader, shader};
use crate::gpu::texture::{Texture, TextureView};
use crate::model::capture::validity;
use crate::model::plan::Plan;
use crate::passes::plate::FINE_FORMAT;
use crate::passes::thing_marks::{Things, ThingsView};

pub(crate) const SHADER: Shader = shader!("capture/things");
const SLOTS: &[Slot] = &[Slot::uniform::<ThingsView>(), Slot::Texture];
/// The same, and the mask that is marked.
const MASK_SLOTS: &[Slot] = &[Slot::uniform::<ThingsView>(), Slot::Texture, Slot::Texture];

/// Needed only if any are known.
pub(crate) fn is_needed(plan: &Plan) -> bool {
    plan.has_things
}

pub(crate) struct Pass {
    mark: Draw,
    /// For a plate that stays as sharp, and for one that is made soft.
    correct_plate: [Draw; 2],
}

/// Targets of the region's size, if needed.
pub(crate) struct Targets {
    /// The mask without objects.
    alone: Option<Texture>,
}

impl Targets {
    pub(crate) fn new(gpu: &Gpu, plan: &Plan) -> Self {
        let target = || Texture::target(gpu, "validity alone", plan.region.size_px, validity::FORMAT);
        Self {
            alone: is_needed(plan).then(target),
        }
    }
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let draw = |fragment, slots, format| {
            let groups = [&[][..], slots, &[], &[]];
            gpu.draw(&DrawSpec::fullscreen(&SHADER, fragment, groups, &[format]))
        };
        Self {
            mark: draw("fs_mark", MASK_SLOTS, validity::FORMAT),
            correct_plate: [0, 1].map(|is_softened| {
                gpu.draw(&DrawSpec {
                    targets: vec![multiplied(FINE_FORMAT)],
                    constants: vec![("IS_SOFTENED", is_softened)],
                    ..DrawSpec::fullscreen(
                        &SHADER,
                        "fs_correct_plate",
                        [&[][..], SLOTS, &[], &[]],
                        &[FINE_FORMAT],
                    )
                })
            }),
        }
    }

    /// Marks objects in the mask, if any are known.
    pub(crate) fn mark(
        &self,
        recorder: &mut Recorder<'_>,
        things: &Things,
        targets: &Targets,
        marks: &Texture,
    ) {
        let Some(alone) = &targets.alone else { return };
        recorder.copy(marks, alone);
        let [view, codes] = things.resources();
        let groups = [recorder.bind(&self.mark, GROUP_PASS, &[view, codes, (&alone.view).into()])];
        recorder.fullscreen(&self.mark, &groups, &[&marks.view]);
    }

    /// Treats the plate as not photographed where it is wrong, and gives it the right light where
    /// that alone is wrong, before it is made soft if it is.
    pub(crate) fn correct_plate(
        &self,
        recorder: &mut Recorder<'_>,
        things: &Things,
        (photographed, is_softened): (&TextureView, bool),
    ) {
        let draw = &self.correct_plate[usize::from(is_softened)];
        let groups = [recorder.bind(draw, GROUP_PASS, &things.resources())];
        recorder.fullscreen_onto(draw, &groups, &[Some(loaded(photographed))]);
    }
}
