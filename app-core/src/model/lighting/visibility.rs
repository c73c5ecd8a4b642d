//! `visibility`: visibility of a light from the hidden light points that `occlusion` counted.

use wgpu::{ColorTargetState, ColorWrites, TextureFormat};

use crate::gpu::bindings::{GROUP_PASS, Resource, Slot};
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Draw, DrawSpec};
use crate::gpu::recorder::{Recorder, cleared, loaded};
use crate::gpu::shader::{Shader, part};
use crate::gpu::texture::{Texture, TextureView, half_float};
use crate::model::lighting::occlusion::HIDDEN;
use crate::model::plan::Plan;
use crate::passes::parts::FULLSCREEN;
use crate::scene::MAX_LIGHTS;

pub(crate) const SHADER: Shader = Shader::new(&[&FULLSCREEN, &HIDDEN, &part!("lighting/visibility")]);
/// The number of light points that were drawn, and the map of hidden ones.
const SLOTS: &[Slot] = &[Slot::per_use::<u32>(), Slot::Texture];
const CHANNELS: [ColorWrites; MAX_LIGHTS] = [
    ColorWrites::RED,
    ColorWrites::GREEN,
    ColorWrites::BLUE,
    ColorWrites::ALPHA,
];

pub(crate) struct Pass {
    /// Each writes one channel of a map of one format.
    draws: Vec<(TextureFormat, Vec<Draw>)>,
}

/// Counts of hidden light points per texel, and the number that was drawn.
pub(crate) struct Inputs<'a> {
    pub(crate) hidden: &'a TextureView,
    pub(crate) n_points: u32,
}

/// Visibility maps of one pose.
pub(crate) struct Targets {
    /// One channel per light.
    pub(crate) lights: Texture,
    /// At a fraction of the resolution.
    pub(crate) ambient: Texture,
}

impl Targets {
    pub(crate) fn new(gpu: &Gpu, plan: &Plan) -> Self {
        let format = half_float(plan.n_lights);
        Self {
            lights: Texture::target(gpu, "visibility", plan.region.size_px, format),
            ambient: Texture::target(gpu, "ambient", plan.ambient_px, half_float(1)),
        }
    }
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let spec = |format: TextureFormat, write_mask| DrawSpec {
            targets: vec![ColorTargetState {
                write_mask,
                ..format.into()
            }],
            ..DrawSpec::fullscreen(&SHADER, "fs_average", [&[], SLOTS, &[], &[]], &[])
        };
        let of_format = |n_lights: usize| {
            let format = half_float(n_lights);
            let draws = CHANNELS[..n_lights].iter();
            (format, draws.map(|mask| gpu.draw(&spec(format, *mask))).collect())
        };
        Self {
            draws: [1, 2, MAX_LIGHTS].map(of_format).into(),
        }
    }

    /// Writes one channel of a map: the first starts it afresh, the others add to it.
    pub(crate) fn encode(
        &self,
        recorder: &mut Recorder<'_>,
        inputs: &Inputs<'_>,
        (map, channel): (&Texture, usize),
    ) {
        let of_format = self.draws.iter().find(|(format, _)| *format == map.format());
        let Some(draw) = of_format.and_then(|(_, draws)| draws.get(channel)) else {
            return;
        };
        let own = recorder.bind_with(
            draw,
            GROUP_PASS,
            &inputs.n_points,
            &[Resource::PerUse, inputs.hidden.into()],
        );
        let attachment = if channel == 0 {
            cleared(&map.view)
        } else {
            loaded(&map.view)
        };
        recorder.fullscreen_onto(draw, &[own], &[Some(attachment)]);
    }
}
