//! `present`: the camera image with the work region laid over it, code for code, or as much of it as is shown, for those who
//! read the picture.

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
/// Format of the finished picture: codes, as a screen takes them.
pub(crate) const OUTPUT_FORMAT: TextureFormat = TextureFormat::Rgba8Unorm;

shared_struct! {
    /// Position and size of the region, and how much of its picture is shown.
    pub(crate) struct Placement {
        pub origin_px: [u32; 2],
        pub size_px: [u32; 2],
        pub effect: f32,
        pub unused: f32,
    }
}

pub(crate) struct Pass {
    draw: Draw,
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let groups = [&[][..], SLOTS, &[], &[]];
        Self {
            draw: gpu.draw(&DrawSpec::fullscreen(
                &SHADER,
                "fs_place",
                groups,
                &[OUTPUT_FORMAT],
            )),
        }
    }

    /// With the camera image, all of it decoded.
    pub(crate) fn encode(
        &self,
        recorder: &mut Recorder<'_>,
        frame: Picture<'_>,
        region: Option<RegionOverlay<'_>>,
        target: &TextureView,
    ) {
        let placement = region.map_or(Placement::zeroed(), |overlay| Placement {
            origin_px: overlay.rect.origin_px.to_array(),
            size_px: overlay.rect.size_px.to_array(),
            effect: overlay.effect,
            unused: 0.0,
        });
        let region = region.map_or(frame, |overlay| overlay.picture);
        let resources = [Resource::PerUse, frame.codes.into(), region.codes.into()];
        let own = recorder.bind_with(&self.draw, GROUP_PASS, &placement, &resources);
        recorder.fullscreen(&self.draw, &[own], &[target]);
    }
}
