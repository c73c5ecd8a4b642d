//! `soften`: the plate, made as soft as the picture.

use app_scene::sharpness::Spread;
use glam::DVec2;
use wgpu::TextureFormat;

use crate::gpu::bindings::{GROUP_PASS, Resource, Slot};
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Draw, DrawSpec};
use crate::gpu::recorder::Recorder;
use crate::gpu::shader::{Shader, shader};
use crate::gpu::shared::shared_struct;
use crate::gpu::texture::Texture;
use crate::model::plan::Plan;
use crate::passes::plate::{CODED_FORMAT, FINE_FORMAT};

pub(crate) const SHADER: Shader = shader!("capture/soften", structs: [Axis]);
const SLOTS: &[Slot] = &[Slot::per_use::<Axis>(), Slot::Filtered, Slot::Sampler];
/// Pixels to either side that are looked at, three deviations: of the softest picture, and of most.
const REACHES_PX: [u32; 2] = [12, 6];
/// Deviations that are looked at.
const REACH: f64 = 3.0;

shared_struct! {
    /// An axis of a spread.
    pub(crate) struct Axis {
        pub direction: [f32; 2],
        pub deviation_px: f32,
        pub _pad: f32,
    }
}

impl Axis {
    /// As long as the standard deviation along it; across the picture where it has none.
    fn new(axis_px: DVec2) -> Self {
        #[allow(clippy::cast_possible_truncation, reason = "some pixels")]
        let deviation_px = axis_px.length() as f32;
        Self {
            direction: axis_px.normalize_or(DVec2::X).as_vec2().to_array(),
            deviation_px,
            _pad: 0.0,
        }
    }
}

/// Whether the plate is sharper than the picture.
pub(crate) fn is_needed(plan: &Plan) -> bool {
    plan.sharpness.plate_spread != Spread::NONE
}

pub(crate) struct Pass {
    coded: Draws,
    fine: Draws,
}

/// For each of the reaches.
type Draws = [Draw; REACHES_PX.len()];

/// Of the region's size, where a picture is softer than what is laid into it.
pub(crate) struct Targets {
    stages: Option<Stages>,
}

struct Stages {
    /// The plate as it was taken.
    sharp: Texture,
    /// Spread along the first axis.
    half: Texture,
}

impl Targets {
    pub(crate) fn new(gpu: &Gpu, plan: &Plan) -> Self {
        let target = |label| Texture::target(gpu, label, plan.region.size_px, plan.plate_format());
        Self {
            stages: plan.is_softened.then(|| Stages {
                sharp: target("sharp plate"),
                half: target("half softened plate"),
            }),
        }
    }

    /// The plate as it was taken, if there is one beside the plate that passes read.
    pub(crate) fn sharp(&self) -> Option<&Texture> {
        self.stages.as_ref().map(|stages| &stages.sharp)
    }
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let groups = [&[][..], SLOTS, &[], &[]];
        let draws = |format: TextureFormat| {
            REACHES_PX.map(|reach_px| {
                gpu.draw(&DrawSpec {
                    constants: vec![("REACH_PX", reach_px)],
                    ..DrawSpec::fullscreen(&SHADER, "fs_soften", groups, &[format])
                })
            })
        };
        Self {
            coded: draws(CODED_FORMAT),
            fine: draws(FINE_FORMAT),
        }
    }

    /// Spreads the plate as it was taken onto the one that passes read.
    pub(crate) fn encode(
        &self,
        recorder: &mut Recorder<'_>,
        spread: Spread,
        targets: &Targets,
        softened: &Texture,
    ) {
        let Some(Stages { sharp, half }) = &targets.stages else {
            return;
        };
        let is_narrow = REACH * spread.widest_px() <= f64::from(REACHES_PX[1]) + 0.5;
        let [first, second] = spread.axes_px().map(Axis::new);
        for (axis, from, onto) in [(first, sharp, half), (second, half, softened)] {
            let draws = if onto.format() == CODED_FORMAT {
                &self.coded
            } else {
                &self.fine
            };
            let draw = &draws[usize::from(is_narrow)];
            let resources = [
                Resource::PerUse,
                (&from.view).into(),
                (&recorder.gpu.samplers.linear).into(),
            ];
            let group = recorder.bind_with(draw, GROUP_PASS, &axis, &resources);
            recorder.fullscreen(draw, &[group], &[&onto.view]);
        }
    }
}
