//! `pcss`: percentage-closer soft shadows of a posed toy for each light, in the edge region.

use wgpu::TextureFormat;

use crate::baseline::plan::BaselinePlan;
use crate::baseline::uniform::{SCENE_SLOTS, Scene};
use crate::gpu::{
    Draw, DrawSpec, GROUP_PASS, GROUP_SCENE, Gpu, Recorder, Shader, Slot, Texture, TextureView, half_float,
    shader,
};
use app_scene::scene::MAX_LIGHTS;

pub(crate) const SHADER: Shader = shader!("baseline/pcss");
const SLOTS: &[Slot] = &[Slot::Layers];

pub(crate) struct Pass {
    /// One draw per format of the map.
    draws: [(TextureFormat, Draw); 3],
}

/// Targets of the region's size.
pub(crate) struct Targets {
    /// One channel per light.
    pub(crate) visibility: Texture,
}

impl Targets {
    pub(crate) fn new(gpu: &Gpu, plan: &BaselinePlan) -> Self {
        let format = half_float(plan.n_lights as usize);
        Self {
            visibility: Texture::target(gpu, "visibility", plan.region.size_px, format),
        }
    }
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let groups = [SCENE_SLOTS, SLOTS, &[], &[]];
        let draw = |n_lights| {
            let format = half_float(n_lights);
            let spec = DrawSpec::fullscreen(&SHADER, "fs_soften", groups, &[format]);
            (format, gpu.draw(&spec))
        };
        Self {
            draws: [1, 2, MAX_LIGHTS].map(draw),
        }
    }

    pub(crate) fn encode(
        &self,
        recorder: &mut Recorder<'_>,
        scene: Scene<'_>,
        warp: &TextureView,
        targets: &Targets,
    ) {
        let format = targets.visibility.format();
        let Some((_, draw)) = self.draws.iter().find(|(of_draw, _)| *of_draw == format) else {
            return;
        };
        let groups = [
            recorder.bind(draw, GROUP_SCENE, &scene.resources()),
            recorder.bind(draw, GROUP_PASS, &[warp.into()]),
        ];
        recorder.fullscreen(draw, &groups, &[&targets.visibility.view]);
    }
}
