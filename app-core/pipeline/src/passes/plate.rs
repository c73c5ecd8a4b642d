//! `plate`: the plate as this camera would have taken it.

use wgpu::TextureFormat;

use crate::gpu::{
    Buffer, Draw, DrawSpec, GROUP_PASS, GROUP_SCENE, Gpu, Mat3Columns, Recorder, Shader, Slot, Texture,
    TextureView, shader, shared_struct,
};
use crate::passes::globals::GLOBALS_GROUP;
use app_scene::scene::MAX_RECEIVERS;

pub(crate) const SHADER: Shader =
    shader!("passes/plate", structs: [PlateView, PlateViews], constants: [MAX_PLATES]);
const SLOTS: &[Slot] = &[Slot::uniform::<PlateViews>(), Slot::Layers];
/// Format of a plate with more precision than codes, for instance after gains were applied; alpha
/// marks photographed pixels.
pub(crate) const FINE_FORMAT: TextureFormat = TextureFormat::Rgba16Float;
/// Format of a plate in codes, for a plate that was photographed at one exposure throughout.
pub(crate) const CODED_FORMAT: TextureFormat = TextureFormat::Rgba8UnormSrgb;
/// Maximum number of plates from which a view's plate is composed.
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
    /// Uniform of the plates from which a view's plate is composed.
    pub struct PlateViews {
        pub plates: [PlateView; MAX_PLATES],
        pub camera_in_plane: [[f32; 4]; MAX_RECEIVERS],
        pub n_plates: u32,
        pub _pad_0: u32,
        pub _pad_1: [u32; 2],
    }
}

impl PlateViews {
    /// Whether a plate is converted to an exposure other than its own.
    pub(crate) fn are_scaled(&self) -> bool {
        let plates = self.plates.iter().take(self.n_plates as usize);
        plates.flat_map(|plate| &plate.gain[..3]).any(|gain| *gain != 1.0)
    }
}

pub(crate) struct Pass {
    fine: Draws,
    coded: Draws,
}

/// Draws to a plate of one format.
struct Draws {
    choose: Draw,
    /// Draw for a plate that was taken by this very camera.
    copy: Draw,
}

pub(crate) struct Inputs<'a> {
    pub(crate) globals: &'a Buffer,
    pub(crate) views: &'a Buffer,
    /// An array of pictures, in the order of `views`.
    pub(crate) plates: &'a TextureView,
    /// Whether the first of them was taken by this very camera.
    pub(crate) is_same_view: bool,
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let groups = [GLOBALS_GROUP, SLOTS, &[], &[]];
        let draw = |fragment, format| gpu.draw(&DrawSpec::fullscreen(&SHADER, fragment, groups, &[format]));
        let draws = |format| Draws {
            choose: draw("fs_choose", format),
            copy: draw("fs_copy", format),
        };
        Self {
            fine: draws(FINE_FORMAT),
            coded: draws(CODED_FORMAT),
        }
    }

    pub(crate) fn encode(&self, recorder: &mut Recorder<'_>, inputs: &Inputs<'_>, target: &Texture) {
        let draws = if target.format() == CODED_FORMAT {
            &self.coded
        } else {
            &self.fine
        };
        let draw = if inputs.is_same_view {
            &draws.copy
        } else {
            &draws.choose
        };
        let groups = [
            recorder.bind(draw, GROUP_SCENE, &[inputs.globals.into()]),
            recorder.bind(draw, GROUP_PASS, &[inputs.views.into(), inputs.plates.into()]),
        ];
        recorder.fullscreen(draw, &groups, &[&target.view]);
    }
}
