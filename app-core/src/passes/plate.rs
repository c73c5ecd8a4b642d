//! `plate`: the plate as this camera would have taken it.

use wgpu::TextureFormat;

use crate::gpu::bindings::{GROUP_PASS, GROUP_SCENE, Slot};
use crate::gpu::buffer::Buffer;
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Draw, DrawSpec};
use crate::gpu::recorder::Recorder;
use crate::gpu::shader::{Shader, part};
use crate::gpu::shared::{Mat3Columns, shared_struct};
use crate::gpu::texture::{Texture, TextureView};
use crate::passes::globals::{GLOBALS, GLOBALS_GROUP};
use crate::passes::parts::FULLSCREEN;
use crate::scene::MAX_RECEIVERS;

pub(crate) const SHADER: Shader = Shader::new(&[
    &GLOBALS,
    &FULLSCREEN,
    &part!("passes/plate", structs: [PlateView, PlateViews], constants: [MAX_PLATES]),
]);
const SLOTS: &[Slot] = &[Slot::uniform::<PlateViews>(), Slot::Layers];
/// Format of a plate that is finer than codes, as where gains have been applied; alpha marks photographed pixels.
pub(crate) const FINE_FORMAT: TextureFormat = TextureFormat::Rgba16Float;
/// Format of a plate in codes, as where all of it was photographed at one exposure.
pub(crate) const CODED_FORMAT: TextureFormat = TextureFormat::Rgba8UnormSrgb;
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

impl PlateViews {
    /// Whether a plate is brought to another exposure than its own.
    pub(crate) fn are_scaled(&self) -> bool {
        let plates = self.plates.iter().take(self.n_plates as usize);
        plates.flat_map(|plate| &plate.gain[..3]).any(|gain| *gain != 1.0)
    }
}

pub(crate) struct Pass {
    fine: Draw,
    coded: Draw,
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
        let draw = |format| gpu.draw(&DrawSpec::fullscreen(&SHADER, "fs_choose", groups, &[format]));
        Self {
            fine: draw(FINE_FORMAT),
            coded: draw(CODED_FORMAT),
        }
    }

    pub(crate) fn encode(&self, recorder: &mut Recorder<'_>, inputs: &Inputs<'_>, target: &Texture) {
        let draw = if target.format() == CODED_FORMAT {
            &self.coded
        } else {
            &self.fine
        };
        let groups = [
            recorder.bind(draw, GROUP_SCENE, &[inputs.globals.into()]),
            recorder.bind(draw, GROUP_PASS, &[inputs.views.into(), inputs.plates.into()]),
        ];
        recorder.fullscreen(draw, &groups, &[&target.view]);
    }
}
