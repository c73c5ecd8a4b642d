//! The output of a frame, for display or readback.

use glam::UVec2;

use super::Stage;
use super::method::Method;
use crate::gpu::{Gpu, GpuError, Recorder, Texture};
use crate::passes::pictures::{ComposedFrame, Picture, RegionOverlay};
use crate::passes::present::{LIGHT_FORMAT, OUTPUT_FORMAT};
use crate::readback::decoding::{Decoding, SIDE};
use crate::readback::layers::Layers;
use crate::readback::{FloatMap, read_texture};

impl Stage {
    /// The latest picture; the region's part has yet to be drawn over the camera image.
    pub(crate) fn composed(&self, gpu: &Gpu) -> ComposedFrame<'_> {
        ComposedFrame {
            frame: self.camera.frame(gpu),
            region: self.overlay(),
            size_px: self.size_px(),
        }
    }

    fn overlay(&self) -> Option<RegionOverlay<'_>> {
        self.method()
            .zip(self.effect)
            .map(|(method, effect)| RegionOverlay {
                picture: method.picture(),
                rect: method.region(),
                #[allow(clippy::cast_possible_truncation, reason = "from 0 to 1")]
                effect: effect as f32,
            })
    }

    /// Draws that picture into a texture of its size, as codes.
    pub(crate) fn draw_picture(&self, gpu: &Gpu) -> &Texture {
        let output = self
            .output
            .get_or_init(|| Texture::target(gpu, "output", self.size_px(), OUTPUT_FORMAT));
        let mut recorder = Recorder::new(gpu, None);
        let frame = self.camera.decoded(&mut recorder);
        self.present
            .encode(&mut recorder, frame, self.overlay(), &output.view);
        recorder.submit();
        output
    }

    /// Processes frames that could pass through, too, so that they have layers.
    pub(crate) fn want_layers(&mut self) {
        self.is_layered = true;
    }

    /// Waits for the device and returns the latest picture in linear light, with more precision
    /// than codes in the retargeted pixels.
    pub(crate) fn read_light(&self, gpu: &Gpu) -> Result<FloatMap, GpuError> {
        let mut recorder = Recorder::new(gpu, None);
        let mut overlay = self.overlay();
        if let (Some(overlay), Some(Method::Model(model))) = (&mut overlay, self.method()) {
            let frame = self.camera.frame(gpu);
            let light = model.encode_light(&mut recorder, &self.toy, (frame, self.grain));
            overlay.picture = Picture {
                light: &light.view,
                codes: &light.view,
            };
        }
        self.read_in_light(recorder, overlay)
    }

    /// Waits for the device and returns the layers of the latest picture; empty ones if the camera
    /// image passes through, or if the method is the baseline.
    pub(crate) fn read_layers(&self, gpu: &Gpu) -> Result<Layers, GpuError> {
        let camera = self.read_in_light(Recorder::new(gpu, None), None)?;
        let mut layers = Layers::of_camera(camera);
        if let (Some(_), Some(Method::Model(model))) = (self.effect, self.method()) {
            let frame = self.camera.frame(gpu);
            let of_region = model.read_layers(gpu, &self.toy, frame)?;
            layers.lay(&of_region, model.region.rect(), self.decoding(gpu)?);
            layers.mark_receivers(|px| model.shows_receiver(px));
        }
        Ok(layers)
    }

    /// The camera image with the region's picture over it, as light.
    fn read_in_light(
        &self,
        mut recorder: Recorder<'_>,
        overlay: Option<RegionOverlay<'_>>,
    ) -> Result<FloatMap, GpuError> {
        let gpu = recorder.gpu;
        let decoding = self.decoding(gpu)?;
        let output = self
            .output_light
            .get_or_init(|| Texture::target(gpu, "output light", self.size_px(), LIGHT_FORMAT));
        let frame = self.camera.decoded(&mut recorder);
        self.present
            .encode_light(&mut recorder, frame, overlay, &output.view);
        recorder.submit();
        let mut map = read_texture(gpu, output.raw())?;
        decoding.correct(&mut map);
        Ok(map)
    }

    fn decoding(&self, gpu: &Gpu) -> Result<&Decoding, GpuError> {
        if let Some(known) = self.decoding.get() {
            return Ok(known);
        }
        let size_px = UVec2::splat(SIDE);
        let codes: Vec<u8> = (0..=u8::MAX).flat_map(|code| [code, code, code, 255]).collect();
        let codes = Texture::mipped(gpu, "codes", size_px, &[codes]);
        let coded = codes.codes(gpu);
        let picture = Picture {
            light: &codes.view,
            codes: &coded,
        };
        let target = Texture::target(gpu, "decoded codes", size_px, LIGHT_FORMAT);
        let mut recorder = Recorder::new(gpu, None);
        self.present
            .encode_light(&mut recorder, picture, None, &target.view);
        recorder.submit();
        let decoded = read_texture(gpu, target.raw())?;
        Ok(self.decoding.get_or_init(|| Decoding::new(&decoded)))
    }
}
