//! `plate`: the plate as this camera would have taken it.

use wgpu::TextureFormat;

use crate::gpu::bindings::{GROUP_PASS, GROUP_SCENE, Slot};
use crate::gpu::buffer::Buffer;
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Draw, DrawSpec};
use crate::gpu::recorder::Recorder;
use crate::gpu::shader::{Shader, part};
use crate::gpu::shared::{Mat3Columns, shared_struct};
use crate::gpu::texture::TextureView;
use crate::passes::globals::{GLOBALS, GLOBALS_GROUP};
use crate::passes::parts::FULLSCREEN;
use crate::scene::MAX_RECEIVERS;

pub(crate) const SHADER: Shader = Shader::new(&[
    &GLOBALS,
    &FULLSCREEN,
    &part!("passes/plate", structs: [PlateView, PlateViews], constants: [MAX_PLATES]),
]);
const SLOTS: &[Slot] = &[Slot::uniform::<PlateViews>(), Slot::Layers];
/// Format of a plate: finer than codes, since gains have been applied; alpha marks photographed pixels.
pub(crate) const PLATE_FORMAT: TextureFormat = TextureFormat::Rgba16Float;
/// Maximum number of plates that a view's plate is made of.
pub(crate) const MAX_PLATES: usize = 4;

shared_struct! {
    /// Uniform of one plate.
    pub struct PlateView {
        pub plate_px_from_plane: [Mat3Columns; MAX_RECEIVERS],
        pub camera_in_plane: [[f32; 4]; MAX_RECEIVERS],
        pub gain: [f32; 4],
    }
}

shared_struct! {
    /// Uniform of the plates that a view's plate is made of.
    pub struct PlateViews {
        pub plates: [PlateView; MAX_PLATES],
        pub camera_in_plane: [[f32; 4]; MAX_RECEIVERS],
        pub n_plates: u32,
        pub is_same_view: u32,
        pub _pad: [u32; 2],
    }
}

pub(crate) struct Pass {
    draw: Draw,
}

pub(crate) struct Inputs<'a> {
    pub(crate) globals: &'a Buffer,
    pub(crate) views: &'a Buffer,
    /// An array of pictures, in the order of `views`.
    pub(crate) plates: &'a TextureView,
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let groups = [GLOBALS_GROUP, SLOTS, &[], &[]];
        Self {
            draw: gpu.draw(&DrawSpec::fullscreen(
                &SHADER,
                "fs_choose",
                groups,
                &[PLATE_FORMAT],
            )),
        }
    }

    pub(crate) fn encode(&self, recorder: &mut Recorder<'_>, inputs: &Inputs<'_>, target: &TextureView) {
        let groups = [
            recorder.bind(&self.draw, GROUP_SCENE, &[inputs.globals.into()]),
            recorder.bind(
                &self.draw,
                GROUP_PASS,
                &[inputs.views.into(), inputs.plates.into()],
            ),
        ];
        recorder.fullscreen(&self.draw, &groups, &[target]);
    }
}
