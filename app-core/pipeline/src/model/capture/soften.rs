//! `soften`: the plate, blurred like the picture.

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

pub(crate) const SHADER: Shader = shader!("capture/soften", structs: [Taps]);
const SLOTS: &[Slot] = &[Slot::per_use::<Taps>(), Slot::Filtered, Slot::Sampler];

/// A grid of taps.
#[derive(Clone, Copy, Debug, PartialEq)]
struct TapGrid {
    /// Number of taps on either side of the centre, along each axis.
    n_beside: u32,
    /// Distance between taps, in standard deviations, for their Gaussian weights.
    spacing: f64,
    /// Variance that taps at this distance produce, relative to that of a Gaussian that is not cut
    /// off.
    variance: f64,
}

impl TapGrid {
    /// Distance in standard deviations between evenly spaced taps with the same weight.
    fn of_line(&self) -> f64 {
        let n = f64::from(2 * self.n_beside + 1);
        (12.0 / (n * n - 1.0)).sqrt()
    }
}

/// Grids for most blurs, and for wide ones, for which taps of the first grid would leave gaps.
const GRIDS: [TapGrid; 2] = [
    TapGrid {
        n_beside: 3,
        spacing: 0.75,
        variance: 0.939,
    },
    TapGrid {
        n_beside: 6,
        spacing: 0.4,
        variance: 0.930,
    },
];
/// Standard deviation from which a blur is a wide one.
const WIDE_PX: f64 = 2.4;
/// Variance in square pixels that bilinear interpolation adds to taps whose positions cover all
/// parts of a pixel, and the variance from which they do.
const BILINEAR_PX2: f64 = 1.0 / 6.0;
const ALL_OVER_PX2: f64 = 0.25;

shared_struct! {
    /// Taps along the axes of a blur.
    pub(crate) struct Taps {
        pub first_px: [f32; 2],
        pub second_px: [f32; 2],
        pub spacing: [f32; 2],
        pub _pad_0: [f32; 2],
    }
}

impl Taps {
    fn new(spread: Spread, grid: &TapGrid) -> Self {
        let along = |axis_px: DVec2, deviations: f64| {
            let step_px = deviations * own_px(axis_px.length());
            (step_px * axis_px.normalize_or(DVec2::ZERO)).as_vec2()
        };
        let [first_px, second_px] = spread.axes_px();
        let deviations = grid.spacing / grid.variance.sqrt();
        let [first_deviations, first_spacing] = if spread.is_line() {
            // All taps of a line have the same weight.
            [grid.of_line(), 0.0]
        } else {
            [deviations, grid.spacing]
        };
        let first = along(first_px, first_deviations);
        let second = along(second_px, deviations);
        #[allow(clippy::cast_possible_truncation, reason = "a handful of digits")]
        Self {
            first_px: first.to_array(),
            second_px: second.to_array(),
            spacing: [first_spacing as f32, grid.spacing as f32],
            _pad_0: [0.0; 2],
        }
    }
}

/// The standard deviation of the taps for a wanted one, since interpolation blurs each over the
/// pixels around it. Within a pixel that adds as much as the taps' mean distance from the centre,
/// .8 of the deviation.
fn own_px(wanted_px: f64) -> f64 {
    let wanted_px2 = wanted_px * wanted_px;
    if wanted_px2 < ALL_OVER_PX2 {
        wanted_px2 / 0.8
    } else {
        (wanted_px2 - BILINEAR_PX2).sqrt()
    }
}

pub(crate) struct Pass {
    coded: Draws,
    fine: Draws,
}

/// One draw for each of the grids.
type Draws = [Draw; GRIDS.len()];

/// Targets of the region's size, if the picture is softer than the renderings.
pub(crate) struct Targets {
    /// The plate before blurring.
    pub(crate) sharp: Option<Texture>,
}

impl Targets {
    pub(crate) fn new(gpu: &Gpu, plan: &Plan) -> Self {
        let target = || Texture::target(gpu, "sharp plate", plan.region.size_px, plan.plate_format());
        Self {
            sharp: plan.is_softened.then(target),
        }
    }
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let groups = [&[][..], SLOTS, &[], &[]];
        let draws = |format: TextureFormat| {
            GRIDS.map(|grid| {
                gpu.draw(&DrawSpec {
                    constants: vec![("N_BESIDE", grid.n_beside)],
                    ..DrawSpec::fullscreen(&SHADER, "fs_soften", groups, &[format])
                })
            })
        };
        Self {
            coded: draws(CODED_FORMAT),
            fine: draws(FINE_FORMAT),
        }
    }

    /// Blurs the original plate into the one that passes read; without a blur it is copied.
    pub(crate) fn encode(
        &self,
        recorder: &mut Recorder<'_>,
        (spread, sharp): (Spread, &Texture),
        softened: &Texture,
    ) {
        if spread == Spread::NONE {
            return recorder.copy(sharp, softened);
        }
        let draws = if softened.format() == CODED_FORMAT {
            &self.coded
        } else {
            &self.fine
        };
        let index = usize::from(spread.widest_px() >= WIDE_PX);
        let (draw, grid) = (&draws[index], &GRIDS[index]);
        let resources = [
            Resource::PerUse,
            (&sharp.view).into(),
            (&recorder.gpu.samplers.linear).into(),
        ];
        let group = recorder.bind_with(draw, GROUP_PASS, &Taps::new(spread, grid), &resources);
        recorder.fullscreen(draw, &[group], &[&softened.view]);
    }
}
