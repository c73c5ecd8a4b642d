//! `present`: the camera image with the work region over it, in full or at the shown opacity, code
//! for code, for programs that read the picture.

use std::sync::OnceLock;

use bytemuck::Zeroable;
use wgpu::TextureFormat;

use crate::gpu::{
    Draw, DrawSpec, GROUP_PASS, Gpu, Recorder, Resource, Shader, Slot, TextureView, shader, shared_struct,
};
use crate::passes::pictures::{Picture, RegionOverlay};

pub(crate) const SHADER: Shader = shader!("passes/present", structs: [Placement]);
const SLOTS: &[Slot] = &[Slot::per_use::<Placement>(), Slot::Texture, Slot::Texture];
/// Format of the region's picture.
pub(crate) const REGION_FORMAT: TextureFormat = TextureFormat::Rgba8UnormSrgb;
/// Format of the finished picture: codes, as a screen expects them.
pub(crate) const OUTPUT_FORMAT: TextureFormat = TextureFormat::Rgba8Unorm;
/// Format of the region's picture and of the finished one in light.
pub(crate) const LIGHT_FORMAT: TextureFormat = TextureFormat::Rgba32Float;

shared_struct! {
    /// Position and size of the region, and its opacity.
    pub(crate) struct Placement {
        pub origin_px: [u32; 2],
        pub size_px: [u32; 2],
        pub effect: f32,
        pub unused: f32,
    }
}

pub(crate) struct Pass {
    draw: Draw,
    /// Compiled when the first picture in light is requested.
    of_light: OnceLock<Draw>,
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        Self {
            draw: draw(gpu, "fs_place", OUTPUT_FORMAT),
            of_light: OnceLock::new(),
        }
    }

    /// Draws the picture; the camera image is decoded in full.
    pub(crate) fn encode(
        &self,
        recorder: &mut Recorder<'_>,
        frame: Picture<'_>,
        region: Option<RegionOverlay<'_>>,
        target: &TextureView,
    ) {
        let placement = placement(region);
        let region = region.map_or(frame, |overlay| overlay.picture);
        let resources = [Resource::PerUse, frame.codes.into(), region.codes.into()];
        let own = recorder.bind_with(&self.draw, GROUP_PASS, &placement, &resources);
        recorder.fullscreen(&self.draw, &[own], &[target]);
    }

    /// The same in light, with the device's decoding.
    pub(crate) fn encode_light(
        &self,
        recorder: &mut Recorder<'_>,
        frame: Picture<'_>,
        region: Option<RegionOverlay<'_>>,
        target: &TextureView,
    ) {
        let gpu = recorder.gpu;
        let of_light = self.of_light.get_or_init(|| draw(gpu, "fs_light", LIGHT_FORMAT));
        let placement = placement(region);
        let region = region.map_or(frame, |overlay| overlay.picture);
        let resources = [Resource::PerUse, frame.light.into(), region.light.into()];
        let own = recorder.bind_with(of_light, GROUP_PASS, &placement, &resources);
        recorder.fullscreen(of_light, &[own], &[target]);
    }
}

fn draw(gpu: &Gpu, fragment: &'static str, format: TextureFormat) -> Draw {
    let groups = [&[][..], SLOTS, &[], &[]];
    gpu.draw(&DrawSpec::fullscreen(&SHADER, fragment, groups, &[format]))
}

fn placement(region: Option<RegionOverlay<'_>>) -> Placement {
    region.map_or(Placement::zeroed(), |overlay| Placement {
        origin_px: overlay.rect.origin_px.to_array(),
        size_px: overlay.rect.size_px.to_array(),
        effect: overlay.effect,
        unused: 0.0,
    })
}
