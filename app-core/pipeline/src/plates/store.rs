//! The scene's plates on the device, as needed for the latest view.

use bytemuck::Zeroable;
use glam::{DVec3, UVec2};

use crate::geometry::anchored::AnchoredReceiver;
use crate::gpu::{Buffer, Gpu, Texture};
use crate::passes::plate::{MAX_PLATES, PlateViews};
use crate::plates::exposure::match_plates;
use app_scene::scene::Scene;

/// An array of plates.
pub(crate) struct PlateStore {
    pub(crate) pictures: Texture,
    /// Their cameras and exposures, for the latest view.
    pub(crate) views: Buffer,
    /// Index of the scene's plate in each layer.
    loaded: Vec<Option<usize>>,
    /// Gain of each of the scene's plates to the exposure of the first.
    pub(crate) gains: Vec<DVec3>,
}

impl PlateStore {
    pub(crate) fn new(gpu: &Gpu, scene: &Scene, receivers: &[AnchoredReceiver]) -> Self {
        let n_layers = scene.plates.len().clamp(1, MAX_PLATES);
        #[allow(clippy::cast_possible_truncation, reason = "at most four")]
        let pictures = Texture::pictures(
            gpu,
            "plates",
            UVec2::new(scene.width_px, scene.height_px),
            n_layers as u32,
        );
        Self {
            pictures,
            views: gpu.uniform("plate views", &PlateViews::zeroed()),
            loaded: vec![None; n_layers],
            gains: match_plates(scene, receivers),
        }
    }

    /// Makes all plates be uploaded again.
    pub(crate) fn forget(&mut self) {
        self.loaded.fill(None);
    }

    /// Uploads the plates at `indices`, in their order, unless they are loaded already.
    pub(crate) fn load(&mut self, gpu: &Gpu, scene: &Scene, indices: &[usize]) {
        for ((layer, slot), index) in (0..).zip(&mut self.loaded).zip(indices) {
            if *slot != Some(*index) {
                self.pictures
                    .write_layer(gpu, layer, &scene.plates[*index].image.rgba8);
                *slot = Some(*index);
            }
        }
    }
}
