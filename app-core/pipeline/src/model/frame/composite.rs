//! `composite`: plate times new shadow, real toy and real shadow gone, the animated toy laid over it.

use std::sync::OnceLock;

use bytemuck::Zeroable;
use wgpu::StoreOp;

use crate::gpu::bindings::{GROUP_PASS, Resource, Slot};
use crate::gpu::buffer::Buffer;
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Draw, DrawSpec};
use crate::gpu::recorder::{Recorder, cleared};
use crate::gpu::samplers::Sampler;
use crate::gpu::shader::{Shader, shader};
use crate::gpu::shared::shared_struct;
use crate::gpu::texture::{Texture, TextureView};
use crate::model::diagnostics::outliers::{OUTLIER_ALL, OUTLIER_NONE, SHADOW_EVENNESS};
use crate::model::frame::region_parts::RegionParts;
use crate::model::frame::toy;
use crate::model::lighting::LightMaps;
use crate::model::plan::Plan;
use crate::model::state::grids::Grids;
use crate::model::state::solution::{SEEN_SLOTS, SeenScene};
use crate::passes::pictures::{ByForm, Picture, PictureGrain, fill_parts, n_pixels_of};
use crate::passes::present::REGION_FORMAT;

pub(crate) const SHADER: Shader =
    shader!("frame/composite", structs: [Drawing], constants: [OUTLIER_NONE, OUTLIER_ALL, SHADOW_EVENNESS]);
const SLOTS: &[Slot] = &[
    Slot::uniform::<Grids>(),
    Slot::Read,
    Slot::Filtered,
    Slot::Filtered,
    Slot::Sampler,
];
/// Group of what is read where shadows fall.
const GROUP_SHADOW: usize = 2;
/// Group of what is read near the toy.
const GROUP_TOY: usize = 3;
/// What is read where shadows fall.
const SHADOW_SLOTS: &[Slot] = &[
    Slot::Texture,
    Slot::Texture,
    Slot::Texture,
    Slot::Texture,
    Slot::per_use::<Drawing>(),
];
/// What is read near a toy alone: with all else that is 16 textures, the most that a phone's stage may have.
const TOY_SLOTS: &[Slot] = &[Slot::Texture; 8];
shared_struct! {
    /// How the receivers were drawn.
    pub(crate) struct Drawing {
        pub has_detail: u32,
        pub picture: u32,
        pub frame_noise: [f32; 2],
        pub plate_noise: [f32; 2],
        pub beside: f32,
        pub channels: f32,
    }
}

pub(crate) struct Pass {
    /// Clear of the toy in either pose, and of its shadows: there nothing is made.
    open: ByForm<Draw>,
    clean: Shadowed,
    /// With grain, compiled when the first frame has any.
    grained: OnceLock<Shadowed>,
}

/// Where shadows fall.
struct Shadowed {
    /// Clear of the toy in either pose.
    beside: ByForm<Draw>,
    /// Near it, where the toy was drawn once.
    drawn_once: ByForm<Draw>,
    drawn_four_times: ByForm<Draw>,
}

pub(crate) struct Inputs<'a> {
    pub(crate) parts: &'a RegionParts,
    pub(crate) seen: SeenScene<'a>,
    pub(crate) grids: &'a Buffer,
    pub(crate) cells: &'a Buffer,
    pub(crate) plate: &'a TextureView,
    pub(crate) validity: &'a TextureView,
    pub(crate) physical: &'a LightMaps,
    pub(crate) shown: &'a LightMaps,
    pub(crate) coverage: &'a TextureView,
    pub(crate) toy: &'a toy::Targets,
    pub(crate) moved_mask: &'a TextureView,
    /// Each pixel's own residual; without it the frame's own pixels serve.
    pub(crate) detail: Option<&'a TextureView>,
    pub(crate) grain: Option<PictureGrain>,
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
        Self {
            open: draw(gpu, "fs_open", [&[], &[]], false),
            clean: Shadowed::new(gpu, false),
            grained: OnceLock::new(),
        }
    }

    pub(crate) fn encode(&self, recorder: &mut Recorder<'_>, inputs: &Inputs<'_>, targets: &Targets) {
        let gpu = recorder.gpu;
        let shadowed = match inputs.grain {
            None => &self.clean,
            Some(_) => self.grained.get_or_init(|| Shadowed::new(gpu, true)),
        };
        let near_toy = match inputs.toy.n_draws() {
            1 => &shadowed.drawn_once,
            _ => &shadowed.drawn_four_times,
        };
        let [open, beside, near_toy] =
            [&self.open, &shadowed.beside, near_toy].map(|draw| draw.of(gpu, &inputs.seen.frame));
        let of_open = [
            inputs.seen.bind(recorder, open),
            recorder.bind(open, GROUP_PASS, &inputs.of_all(&recorder.gpu.samplers.linear)),
        ];
        let drawing = inputs.drawing();
        let shadowed = recorder.bind_with(beside, GROUP_SHADOW, &drawing, &inputs.of_shadow());
        let of_toy = recorder.bind(near_toy, GROUP_TOY, &inputs.of_toy());
        let (target, parts) = (&targets.picture.view, inputs.parts);
        let mut render = recorder.render(SHADER.name, &[Some(cleared(target))], None, StoreOp::Discard);
        render.begin(open, &of_open);
        fill_parts(&mut render, &parts.open);
        render.narrow(n_pixels_of(&parts.shadowed) + n_pixels_of(&parts.near));
        render.begin(beside, &[shadowed]);
        fill_parts(&mut render, &parts.shadowed);
        render.narrow(n_pixels_of(&parts.near));
        render.begin(near_toy, &[of_toy]);
        fill_parts(&mut render, &parts.near);
    }
}

impl Shadowed {
    fn new(gpu: &Gpu, has_grain: bool) -> Self {
        Self {
            beside: draw(gpu, "fs_beside", [SHADOW_SLOTS, &[]], has_grain),
            drawn_once: draw(gpu, "fs_drawn_once", [SHADOW_SLOTS, TOY_SLOTS], has_grain),
            drawn_four_times: draw(gpu, "fs_drawn_four_times", [SHADOW_SLOTS, TOY_SLOTS], has_grain),
        }
    }
}

fn draw(gpu: &Gpu, fragment: &'static str, read: [&'static [Slot]; 2], has_grain: bool) -> ByForm<Draw> {
    let groups = [SEEN_SLOTS, SLOTS, read[0], read[1]];
    ByForm::new(gpu, move |gpu, form| {
        gpu.draw(&DrawSpec {
            constants: vec![form, ("HAS_GRAIN", u32::from(has_grain))],
            ..DrawSpec::fullscreen(&SHADER, fragment, groups, &[REGION_FORMAT])
        })
    })
}

impl<'a> Inputs<'a> {
    fn drawing(&self) -> Drawing {
        let clean = Drawing {
            has_detail: u32::from(self.detail.is_some()),
            ..Drawing::zeroed()
        };
        self.grain
            .map_or(clean, |PictureGrain { grain, picture }| Drawing {
                picture,
                frame_noise: [grain.frame.floor, grain.frame.per_light],
                plate_noise: [grain.plate.floor, grain.plate.per_light],
                beside: grain.beside,
                channels: grain.channels,
                ..clean
            })
    }

    fn of_all(&self, sampler: &'a Sampler) -> [Resource<'a>; 5] {
        [
            self.grids.into(),
            self.cells.into(),
            (&self.physical.visibility.ambient.view).into(),
            (&self.shown.visibility.ambient.view).into(),
            sampler.into(),
        ]
    }

    fn of_shadow(&self) -> [Resource<'a>; 5] {
        [
            self.plate.into(),
            (&self.physical.visibility.lights.view).into(),
            (&self.shown.visibility.lights.view).into(),
            // A placeholder that is not read where there is none.
            self.detail.unwrap_or(self.plate).into(),
            Resource::PerUse,
        ]
    }

    fn of_toy(&self) -> [Resource<'a>; 8] {
        let [toy_0, toy_1, toy_2, toy_3] = self.toy.views();
        [
            self.validity.into(),
            toy_0.into(),
            toy_1.into(),
            toy_2.into(),
            toy_3.into(),
            (&self.toy.moved.view).into(),
            self.moved_mask.into(),
            self.coverage.into(),
        ]
    }
}
