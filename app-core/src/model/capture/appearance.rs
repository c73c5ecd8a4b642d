//! `appearance`: the toy's own colours from the camera frame, carried a little past its outline.

use wgpu::{Color, TextureFormat};

use crate::gpu::bindings::{GROUP_PASS, GROUP_SCENE, Resource, Slot};
use crate::gpu::buffer::Buffer;
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Draw, DrawSpec};
use crate::gpu::recorder::{Recorder, cleared, cleared_to};
use crate::gpu::shader::{Shader, part};
use crate::gpu::texture::{Texture, TextureView};
use crate::model::capture::gbuffer::{self, BASE_FORMAT, RECEIVED_FORMAT};
use crate::model::parts::HEMISPHERES;
use crate::model::plan::Plan;
use crate::passes::globals::{GLOBALS, GLOBALS_GROUP};
use crate::passes::parts::{DEPTH, FULLSCREEN};

pub(crate) const SHADER: Shader = Shader::new(&[
    &GLOBALS,
    &HEMISPHERES,
    &DEPTH,
    &FULLSCREEN,
    &part!("capture/appearance", constants: [REACH_PX]),
]);
/// Frame and source, of which colours are made, then what is the same for all pictures of a view.
const SLOTS: &[Slot] = &[
    Slot::Texture,
    Slot::Texture,
    Slot::Texture,
    Slot::Depth,
    Slot::Texture,
    Slot::Texture,
    Slot::Texture,
];
/// Format of the colours: as the camera's, so that its codes come through unrounded.
const COLOR_FORMAT: TextureFormat = TextureFormat::Rgba8UnormSrgb;
/// Format of the numbers of the pixels that they are from, in codes.
const SOURCE_FORMAT: TextureFormat = TextureFormat::R8Unorm;
/// Slots of what colours are made of.
const N_COLOR_SLOTS: usize = 2;

/// How far past the toy its colours are extrapolated.
const REACH_PX: u32 = 3;

pub(crate) struct Pass {
    all: Draw,
    colors: Draw,
}

pub(crate) struct Inputs<'a> {
    pub(crate) plan: &'a Plan,
    pub(crate) globals: &'a Buffer,
    pub(crate) frame: &'a TextureView,
    pub(crate) validity: &'a TextureView,
    pub(crate) gbuffer: &'a gbuffer::Targets,
}

/// Of the toy box's size.
pub(crate) struct Targets {
    pub(crate) color: Texture,
    /// Each light's cosine times its visibility at the pixels that a colour is from.
    pub(crate) received: Texture,
    /// Base colour of these pixels, and how far they face upwards.
    pub(crate) base: Texture,
    /// Which pixels they are.
    source: Texture,
}

impl Targets {
    pub(crate) fn new(gpu: &Gpu, plan: &Plan) -> Self {
        let target = |label, format| Texture::target(gpu, label, plan.toy_box.size_px, format);
        Self {
            color: target("appearance", COLOR_FORMAT),
            received: target("appearance received", RECEIVED_FORMAT),
            base: target("appearance base", BASE_FORMAT),
            source: target("appearance source", SOURCE_FORMAT),
        }
    }
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let draw = |fragment, slots, targets| {
            let groups = [GLOBALS_GROUP, slots, &[], &[]];
            gpu.draw(&DrawSpec::fullscreen(&SHADER, fragment, groups, targets))
        };
        Self {
            all: draw(
                "fs_clean",
                SLOTS,
                &[COLOR_FORMAT, RECEIVED_FORMAT, BASE_FORMAT, SOURCE_FORMAT],
            ),
            colors: draw("fs_recolor", &SLOTS[..N_COLOR_SLOTS], &[COLOR_FORMAT]),
        }
    }

    /// Of a new view all, of a new picture of a known one the colours alone.
    pub(crate) fn encode(
        &self,
        recorder: &mut Recorder<'_>,
        inputs: &Inputs<'_>,
        is_new_view: bool,
        targets: &Targets,
    ) {
        let gbuffer = inputs.gbuffer;
        let of_view = [
            inputs.frame,
            // Of a new view the source is written, not read: the validity stands in its place.
            inputs.validity,
            inputs.validity,
            &gbuffer.depth.view,
            &gbuffer.normal.view,
            &gbuffer.received.view,
            &gbuffer.base.view,
        ];
        let of_picture: [_; N_COLOR_SLOTS] = [inputs.frame, &targets.source.view];
        let written = [&targets.color, &targets.received, &targets.base, &targets.source];
        let globals = |draw| recorder.bind(draw, GROUP_SCENE, &[inputs.globals.into()]);
        let bound =
            |draw, textures: &[Resource<'_>]| [globals(draw), recorder.bind(draw, GROUP_PASS, textures)];
        // Of a new view as well, so that the pictures of it that follow make no objects.
        let of_colors = bound(&self.colors, &of_picture.map(Into::into));
        let (draw, groups, n_written) = if is_new_view {
            (
                &self.all,
                bound(&self.all, &of_view.map(Into::into)),
                written.len(),
            )
        } else {
            (&self.colors, of_colors, 1)
        };
        let [color, received, base, source] = written.map(|texture| &texture.view);
        // Beyond what is drawn no colour has a source.
        let no_source = cleared_to(source, Color::WHITE);
        let written = [cleared(color), cleared(received), cleared(base), no_source].map(Some);
        let near = inputs.plan.near_physical_toy(REACH_PX);
        recorder.fullscreen_within(draw, &groups, &written[..n_written], near);
    }
}
