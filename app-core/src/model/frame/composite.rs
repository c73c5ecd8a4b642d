//! `composite`: plate times new shadow, real toy and real shadow gone, the animated toy laid over it.

use wgpu::StoreOp;

use crate::geometry::rect::PixelRect;
use crate::gpu::bindings::{GROUP_PASS, GROUP_SCENE, Resource, Slot};
use crate::gpu::buffer::Buffer;
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Draw, DrawSpec};
use crate::gpu::recorder::{Recorder, cleared};
use crate::gpu::shader::{Shader, part};
use crate::gpu::shared::shared_struct;
use crate::gpu::texture::{Texture, TextureView};
use crate::model::diagnostics::outliers::{OUTLIER_ALL, OUTLIER_NONE, SHADOW_EVENNESS};
use crate::model::frame::coverage::COVERED;
use crate::model::frame::toy;
use crate::model::parts::{BETWEEN_CELLS, CELLS, MODEL};
use crate::model::plan::Plan;
use crate::model::state::grids::{GRID, Grids};
use crate::model::state::solution::{FIT, SCENE_SLOTS, Scene};
use crate::passes::finished::Picture;
use crate::passes::globals::GLOBALS;
use crate::passes::parts::{CHANNELS, FULLSCREEN, MARKS, PIXEL};
use crate::passes::present::REGION_FORMAT;

pub(crate) const SHADER: Shader = Shader::new(&[
    &GLOBALS,
    &FIT,
    &MODEL,
    &PIXEL,
    &GRID,
    &BETWEEN_CELLS,
    &CELLS,
    &CHANNELS,
    &COVERED,
    &FULLSCREEN,
    &MARKS,
    &part!("frame/composite", structs: [Drawing], constants: [OUTLIER_NONE, OUTLIER_ALL, SHADOW_EVENNESS]),
]);
const SLOTS: &[Slot] = &[
    Slot::uniform::<Grids>(),
    Slot::Read,
    Slot::Texture,
    Slot::Texture,
    Slot::Texture,
    Slot::Texture,
    Slot::Filtered,
    Slot::Texture,
    Slot::Filtered,
    Slot::Sampler,
    Slot::Texture,
    Slot::Texture,
    Slot::Texture,
    Slot::Texture,
    Slot::Texture,
    Slot::Texture,
    Slot::Texture,
    Slot::Texture,
    Slot::per_use::<Drawing>(),
];

shared_struct! {
    /// How the receivers were drawn.
    pub(crate) struct Drawing {
        pub has_detail: u32,
    }
}

pub(crate) struct Pass {
    /// Around the toy box.
    beside: Draw,
    /// In the toy box, where the toy was drawn once.
    drawn_once: Draw,
    drawn_four_times: Draw,
}

/// Visibility maps of one pose.
#[derive(Clone, Copy)]
pub(crate) struct Light<'a> {
    pub(crate) visibility: &'a TextureView,
    pub(crate) ambient: &'a TextureView,
}

pub(crate) struct Inputs<'a> {
    /// In the region.
    pub(crate) toy_box: PixelRect,
    pub(crate) scene: Scene<'a>,
    pub(crate) grids: &'a Buffer,
    pub(crate) cells: &'a Buffer,
    pub(crate) frame: &'a TextureView,
    pub(crate) plate: &'a TextureView,
    pub(crate) validity: &'a TextureView,
    pub(crate) physical: Light<'a>,
    pub(crate) shown: Light<'a>,
    pub(crate) coverage: &'a TextureView,
    pub(crate) toy: &'a toy::Targets,
    pub(crate) moved_mask: &'a TextureView,
    /// Each pixel's own residual; without it the frame's own pixels serve.
    pub(crate) detail: Option<&'a TextureView>,
}

/// Of the region's size.
pub(crate) struct Targets {
    pub(crate) picture: Texture,
    /// View of its sRGB codes, not decoded.
    codes: TextureView,
}

impl Targets {
    pub(crate) fn new(gpu: &Gpu, plan: &Plan) -> Self {
        let picture = Texture::target(gpu, "composite", plan.region.size_px, REGION_FORMAT);
        Self {
            codes: picture.codes(gpu),
            picture,
        }
    }

    /// Both views of the picture.
    pub(crate) fn picture(&self) -> Picture<'_> {
        Picture {
            light: &self.picture.view,
            codes: &self.codes,
        }
    }
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let groups = [SCENE_SLOTS, SLOTS, &[], &[]];
        let draw = |fragment| gpu.draw(&DrawSpec::fullscreen(&SHADER, fragment, groups, &[REGION_FORMAT]));
        Self {
            beside: draw("fs_beside"),
            drawn_once: draw("fs_drawn_once"),
            drawn_four_times: draw("fs_drawn_four_times"),
        }
    }

    pub(crate) fn encode(&self, recorder: &mut Recorder<'_>, inputs: &Inputs<'_>, targets: &Targets) {
        let [toy_0, toy_1, toy_2, toy_3] = inputs.toy.views();
        let resources = [
            inputs.grids.into(),
            inputs.cells.into(),
            inputs.frame.into(),
            inputs.plate.into(),
            inputs.validity.into(),
            inputs.physical.visibility.into(),
            inputs.physical.ambient.into(),
            inputs.shown.visibility.into(),
            inputs.shown.ambient.into(),
            (&recorder.gpu.samplers.linear).into(),
            toy_0.into(),
            toy_1.into(),
            toy_2.into(),
            toy_3.into(),
            (&inputs.toy.moved.view).into(),
            inputs.moved_mask.into(),
            // A placeholder that is not read where there is none.
            inputs.detail.unwrap_or(inputs.plate).into(),
            inputs.coverage.into(),
            Resource::PerUse,
        ];
        let drawing = Drawing {
            has_detail: u32::from(inputs.detail.is_some()),
        };
        let over_toy = match inputs.toy.n_draws() {
            1 => &self.drawn_once,
            _ => &self.drawn_four_times,
        };
        let groups = [
            recorder.bind(over_toy, GROUP_SCENE, &inputs.scene.resources()),
            recorder.bind_with(over_toy, GROUP_PASS, &drawing, &resources),
        ];
        let target = &targets.picture.view;
        let mut render = recorder.render(SHADER.name, &[Some(cleared(target))], None, StoreOp::Discard);
        render.begin(&self.beside, &groups);
        for part in inputs.toy_box.around(target.size_px()) {
            render.clip((part.origin_px, part.size_px));
            render.draw(0..3, 0..1);
        }
        render.begin(over_toy, &groups);
        render.clip((inputs.toy_box.origin_px, inputs.toy_box.size_px));
        render.draw(0..3, 0..1);
    }
}
