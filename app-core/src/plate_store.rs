//! The scene's plates on the device: those that the latest view is made of.

use glam::DVec3;

use crate::exposure::match_plates;
use crate::gpu::Gpu;
use crate::gpu::layout::MAX_PLATES;
use crate::gpu::texture::Texture;
use crate::scene::Scene;

/// An array of plates.
pub(crate) struct PlateStore {
    pub(crate) pictures: Texture,
    /// Which of the scene's plates each layer has.
    loaded: Vec<Option<usize>>,
    /// What brings each of the scene's plates to the exposure of the first.
    pub(crate) gains: Vec<DVec3>,
}

impl PlateStore {
    pub(crate) fn new(gpu: &Gpu, scene: &Scene) -> Self {
        let n_layers = scene.plates.len().clamp(1, MAX_PLATES);
        #[allow(clippy::cast_possible_truncation, reason = "at most four")]
        let pictures = Texture::pictures(gpu, "plates", [scene.width_px, scene.height_px], n_layers as u32);
        Self {
            pictures,
            loaded: vec![None; n_layers],
            gains: match_plates(scene),
        }
    }

    /// Uploads the plates at `indices`, in their order, as far as they are not there already.
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
