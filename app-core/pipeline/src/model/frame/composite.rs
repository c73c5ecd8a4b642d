//! `composite`: plate times new shadow, without the real toy and the real shadow, and the animated
//! toy over it.

use std::sync::OnceLock;

use app_scene::grain::Noise;
use bytemuck::Zeroable;
use wgpu::{StoreOp, TextureFormat};

use crate::gpu::bindings::{GROUP_PASS, Resource, Slot};
use crate::gpu::buffer::Buffer;
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Draw, DrawSpec};
use crate::gpu::recorder::{Recorder, cleared};
use crate::gpu::samplers::Sampler;
use crate::gpu::shader::{Shader, shader};
use crate::gpu::shared::shared_struct;
use crate::gpu::texture::{Texture, TextureView, half_float};
use crate::model::diagnostics::outliers::{OUTLIER_ALL, OUTLIER_NONE, SHADOW_EVENNESS};
use crate::model::frame::region_parts::RegionParts;
use crate::model::frame::toy;
use crate::model::lighting::LightMaps;
use crate::model::plan::Plan;
use crate::model::state::grids::Grids;
use crate::model::state::solution::{SEEN_SLOTS, SeenScene};
use crate::passes::pictures::{ByForm, Picture, PictureGrain, fill_parts, n_pixels_of};
use crate::passes::present::{LIGHT_FORMAT, REGION_FORMAT};

pub(crate) const SHADER: Shader =
    shader!("frame/composite", structs: [Drawing], constants: [OUTLIER_NONE, OUTLIER_ALL, SHADOW_EVENNESS]);
const SLOTS: &[Slot] = &[
    Slot::uniform::<Grids>(),
    Slot::Read,
    Slot::Filtered,
    Slot::Filtered,
    Slot::Sampler,
];
/// Format of its layers: four of them have as many bytes per pixel as a pass may write.
const LAYER_FORMAT: TextureFormat = half_float(4);
/// Clean plate, shadow ratio, toy and masks.
pub(crate) const N_LAYERS: usize = 4;
/// Group of the inputs where shadows fall.
const GROUP_SHADOW: usize = 2;
/// Group of the inputs near the toy.
const GROUP_TOY: usize = 3;
/// Inputs where shadows fall.
const SHADOW_SLOTS: &[Slot] = &[
    Slot::Texture,
    Slot::Texture,
    Slot::Texture,
    Slot::Texture,
    Slot::per_use::<Drawing>(),
];
/// Inputs near a toy alone: together with all others they are 16 textures, the limit of a phone's
/// shader stage.
const TOY_SLOTS: &[Slot] = &[Slot::Texture; 8];
shared_struct! {
    /// The way in which the receivers were drawn.
    pub(crate) struct Drawing {
        pub has_detail: u32,
        pub picture: u32,
        pub frame_noise: [f32; 2],
        pub plate_noise: [f32; 2],
        pub grain_weights: [f32; 2],
        pub channels: f32,
        pub strength: f32,
    }
}

pub(crate) struct Pass {
    of_codes: Draws,
    /// Compiled when the first picture in light is requested.
    of_light: OnceLock<Draws>,
    /// For one receiver and for several; compiled when the first layers are requested.
    layers: [OnceLock<Layered>; 2],
}

/// Pipelines that draw the picture in one format.
struct Draws {
    format: TextureFormat,
    /// Outside the toy in either pose and its shadows: only the plate is drawn there.
    open: ByForm<Draw>,
    /// By the number of their variant; all but the plain ones are compiled when the first such frame
    /// comes.
    shadowed: [OnceLock<Shadowed>; N_VARIANTS],
}

/// Properties in which a frame differs from most.
#[derive(Clone, Copy)]
struct Variant {
    has_grain: bool,
    /// Whether the plate is as sharp as it was taken, and has noise: with grain alone.
    has_plate_noise: bool,
    /// Whether the shadow's strength is not the true one.
    has_strength: bool,
    /// Whether there are several receivers.
    has_edges: bool,
}

/// Number of variants.
const N_VARIANTS: usize = 16;

impl Variant {
    const PLAIN: Self = Self {
        has_grain: false,
        has_plate_noise: false,
        has_strength: false,
        has_edges: false,
    };

    fn number(self) -> usize {
        let Self {
            has_grain,
            has_plate_noise,
            has_strength,
            has_edges,
        } = self;
        let of = [has_grain, has_plate_noise, has_strength, has_edges].map(usize::from);
        of[0] + 2 * of[1] + 4 * of[2] + 8 * of[3]
    }
}

/// The layers of the picture, over the whole region.
struct Layered {
    drawn_once: ByForm<Draw>,
    drawn_four_times: ByForm<Draw>,
}

/// Pipelines for places where shadows fall.
struct Shadowed {
    /// Outside the toy in either pose.
    beside: ByForm<Draw>,
    /// Near the toy, if it was drawn once.
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
    /// Each pixel's own residual; without it the frame's own pixels are used.
    pub(crate) detail: Option<&'a TextureView>,
    pub(crate) grain: Option<PictureGrain>,
    /// Whether the plate was softened to match the picture.
    pub(crate) is_plate_soft: bool,
    /// Strength of the shown shadow; 1 is the true one.
    pub(crate) shadow_strength: f32,
    /// Whether a pixel may show two receivers.
    pub(crate) has_edges: bool,
}

/// Targets of the region's size.
pub(crate) struct Targets {
    pub(crate) picture: Texture,
    /// View of the picture's sRGB codes, which does not decode them.
    codes: TextureView,
    /// The picture in light, once it was requested.
    light: OnceLock<Texture>,
    /// Its layers, once they were requested.
    layers: OnceLock<[Texture; N_LAYERS]>,
}

impl Targets {
    pub(crate) fn new(gpu: &Gpu, plan: &Plan) -> Self {
        let picture = Texture::target(gpu, "composite", plan.region.size_px, REGION_FORMAT);
        Self {
            codes: picture.codes(gpu),
            picture,
            light: OnceLock::new(),
            layers: OnceLock::new(),
        }
    }

    /// Target of the picture in light.
    pub(crate) fn light(&self, gpu: &Gpu) -> &Texture {
        let size_px = self.picture.size_px();
        self.light
            .get_or_init(|| Texture::target(gpu, "composite light", size_px, LIGHT_FORMAT))
    }

    /// Targets of clean plate, shadow ratio, toy and masks.
    pub(crate) fn layers(&self, gpu: &Gpu) -> &[Texture; N_LAYERS] {
        let target = |label| Texture::target(gpu, label, self.picture.size_px(), LAYER_FORMAT);
        self.layers
            .get_or_init(|| ["clean plate", "shadow ratio", "toy layer", "masks"].map(target))
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
            of_codes: Draws::new(gpu, REGION_FORMAT),
            of_light: OnceLock::new(),
            layers: Default::default(),
        }
    }

    /// Draws the picture as codes.
    pub(crate) fn encode(&self, recorder: &mut Recorder<'_>, inputs: &Inputs<'_>, targets: &Targets) {
        self.of_codes.encode(recorder, inputs, &targets.picture.view);
    }

    /// Draws the picture in light, with more precision than codes have.
    pub(crate) fn encode_light(&self, recorder: &mut Recorder<'_>, inputs: &Inputs<'_>, target: &Texture) {
        let gpu = recorder.gpu;
        let draws = self.of_light.get_or_init(|| Draws::new(gpu, LIGHT_FORMAT));
        draws.encode(recorder, inputs, &target.view);
    }

    /// Draws the layers of the picture, without grain.
    pub(crate) fn encode_layers(
        &self,
        recorder: &mut Recorder<'_>,
        inputs: &Inputs<'_>,
        targets: &[Texture; N_LAYERS],
    ) {
        let gpu = recorder.gpu;
        let has_edges = inputs.has_edges;
        let layered = self.layers[usize::from(has_edges)].get_or_init(|| Layered::new(gpu, has_edges));
        let draw = match inputs.toy.n_draws() {
            1 => &layered.drawn_once,
            _ => &layered.drawn_four_times,
        };
        let draw = draw.of(gpu, &inputs.seen.frame);
        let groups = [
            inputs.seen.bind(recorder, draw),
            recorder.bind(draw, GROUP_PASS, &inputs.of_all(&recorder.gpu.samplers.linear)),
            recorder.bind_with(draw, GROUP_SHADOW, &inputs.drawing(), &inputs.of_shadow()),
            recorder.bind(draw, GROUP_TOY, &inputs.of_toy()),
        ];
        recorder.fullscreen(draw, &groups, &targets.each_ref().map(|target| &target.view));
    }
}

impl Draws {
    fn new(gpu: &Gpu, format: TextureFormat) -> Self {
        let draws = Self {
            format,
            open: draw(gpu, "fs_open", [&[], &[]], (Variant::PLAIN, &[format])),
            shadowed: Default::default(),
        };
        draws.shadowed(gpu, Variant::PLAIN);
        draws
    }

    fn shadowed(&self, gpu: &Gpu, variant: Variant) -> &Shadowed {
        self.shadowed[variant.number()].get_or_init(|| Shadowed::new(gpu, variant, self.format))
    }

    fn encode(&self, recorder: &mut Recorder<'_>, inputs: &Inputs<'_>, target: &TextureView) {
        let gpu = recorder.gpu;
        let variant = Variant {
            has_grain: inputs.grain.is_some(),
            has_plate_noise: inputs.has_plate_noise(),
            has_strength: inputs.shadow_strength != 1.0,
            has_edges: inputs.has_edges,
        };
        let shadowed = self.shadowed(gpu, variant);
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
        let parts = inputs.parts;
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
    fn new(gpu: &Gpu, variant: Variant, format: TextureFormat) -> Self {
        let draw = |fragment, read| draw(gpu, fragment, read, (variant, &[format]));
        Self {
            beside: draw("fs_beside", [SHADOW_SLOTS, &[]]),
            drawn_once: draw("fs_drawn_once", [SHADOW_SLOTS, TOY_SLOTS]),
            drawn_four_times: draw("fs_drawn_four_times", [SHADOW_SLOTS, TOY_SLOTS]),
        }
    }
}

impl Layered {
    fn new(gpu: &Gpu, has_edges: bool) -> Self {
        // A shadow without strength leaves the clean plate.
        let variant = Variant {
            has_strength: true,
            has_edges,
            ..Variant::PLAIN
        };
        let formats = (variant, &[LAYER_FORMAT; N_LAYERS][..]);
        Self {
            drawn_once: draw(gpu, "fs_layers_once", [SHADOW_SLOTS, TOY_SLOTS], formats),
            drawn_four_times: draw(gpu, "fs_layers_four_times", [SHADOW_SLOTS, TOY_SLOTS], formats),
        }
    }
}

fn draw(
    gpu: &Gpu,
    fragment: &'static str,
    read: [&'static [Slot]; 2],
    (variant, formats): (Variant, &[TextureFormat]),
) -> ByForm<Draw> {
    let groups = [SEEN_SLOTS, SLOTS, read[0], read[1]];
    let formats = formats.to_vec();
    ByForm::new(gpu, move |gpu, form| {
        gpu.draw(&DrawSpec {
            constants: vec![
                form,
                ("HAS_GRAIN", u32::from(variant.has_grain)),
                ("HAS_PLATE_NOISE", u32::from(variant.has_plate_noise)),
                ("HAS_STRENGTH", u32::from(variant.has_strength)),
                ("HAS_EDGES", u32::from(variant.has_edges)),
            ],
            ..DrawSpec::fullscreen(&SHADER, fragment, groups, &formats)
        })
    })
}

impl<'a> Inputs<'a> {
    fn drawing(&self) -> Drawing {
        let clean = Drawing {
            has_detail: u32::from(self.detail.is_some()),
            strength: self.shadow_strength,
            ..Drawing::zeroed()
        };
        self.grain
            .map_or(clean, |PictureGrain { grain, picture }| Drawing {
                picture,
                frame_noise: [grain.frame.floor, grain.frame.per_light],
                plate_noise: [grain.plate.floor, grain.plate.per_light],
                grain_weights: grain.weights,
                channels: grain.channels,
                ..clean
            })
    }

    fn has_plate_noise(&self) -> bool {
        let is_noisy = |grain: PictureGrain| grain.grain.plate != Noise::default();
        !self.is_plate_soft && self.grain.is_some_and(is_noisy)
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
            // A placeholder that is not read if there is no detail.
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
