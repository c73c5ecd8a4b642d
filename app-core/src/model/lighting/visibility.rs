//! `visibility`: visibility of the lights from the hidden light points that `occlusion` counted.

use wgpu::TextureFormat;

use crate::gpu::bindings::{GROUP_PASS, Resource, Slot};
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Draw, DrawSpec};
use crate::gpu::recorder::Recorder;
use crate::gpu::shader::{Shader, part};
use crate::gpu::texture::{Texture, TextureView, fractions, half_float};
use crate::model::lighting::occlusion::HIDDEN;
use crate::model::plan::Plan;
use crate::passes::parts::FULLSCREEN;
use crate::scene::MAX_LIGHTS;

pub(crate) const SHADER: Shader = Shader::new(&[&FULLSCREEN, &HIDDEN, &part!("lighting/visibility")]);
/// The number of light points that were drawn of each light, and the maps of hidden ones.
const SLOTS: &[Slot] = &[
    Slot::per_use::<[u32; MAX_LIGHTS]>(),
    Slot::Texture,
    Slot::Texture,
    Slot::Texture,
    Slot::Texture,
];

pub(crate) struct Pass {
    /// One for each format of a map.
    draws: Vec<(TextureFormat, Draw)>,
}

/// Counts of hidden light points per texel, and the number that was drawn, of each light.
pub(crate) struct Inputs<'a> {
    pub(crate) counted: &'a [(&'a TextureView, u32)],
}

/// Visibility maps of one pose.
pub(crate) struct Targets {
    /// One channel per light, in fractions of 8 bits: it has no more than 64 points.
    pub(crate) lights: Texture,
    /// At a fraction of the resolution, in 16 bits: drivers may filter 8 bits in no more than those.
    pub(crate) ambient: Texture,
}

impl Targets {
    pub(crate) fn new(gpu: &Gpu, plan: &Plan) -> Self {
        let format = fractions(plan.n_lights);
        Self {
            lights: Texture::target(gpu, "visibility", plan.region.size_px, format),
            ambient: Texture::target(gpu, "ambient", plan.ambient_px, half_float(1)),
        }
    }
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let of_format = |format: TextureFormat| {
            let spec = DrawSpec::fullscreen(&SHADER, "fs_average", [&[], SLOTS, &[], &[]], &[format]);
            (format, gpu.draw(&spec))
        };
        Self {
            draws: [half_float(1), fractions(1), fractions(2), fractions(MAX_LIGHTS)]
                .map(of_format)
                .into(),
        }
    }

    /// Writes all channels of a map at once.
    pub(crate) fn encode(&self, recorder: &mut Recorder<'_>, inputs: &Inputs<'_>, map: &Texture) {
        let of_format = self.draws.iter().find(|(format, _)| *format == map.format());
        let (Some((_, draw)), Some((first, _))) = (of_format, inputs.counted.first()) else {
            return;
        };
        let mut n_points = [0; MAX_LIGHTS];
        // The first stands in for lights that there are not.
        let mut hidden = [*first; MAX_LIGHTS];
        for (light, (view, n)) in inputs.counted.iter().take(MAX_LIGHTS).enumerate() {
            (hidden[light], n_points[light]) = (*view, *n);
        }
        let [a, b, c, d] = hidden.map(Resource::from);
        let resources = [Resource::PerUse, a, b, c, d];
        let own = recorder.bind_with(draw, GROUP_PASS, &n_points, &resources);
        recorder.fullscreen(draw, &[own], &[&map.view]);
    }
}
