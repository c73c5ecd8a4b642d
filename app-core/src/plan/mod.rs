//! The plan of a scene: which passes run on which path, with which sizes and formats. Pure data, made without a device.
//!
//! Two paths: the capture path learns from the real toy and its real shadow, once; the frame path makes each picture.
//! A plan holds what the scene needs and names what it leaves out, with the reason.

mod passes;
mod published;

use glam::{DMat4, DVec3, UVec2};
use wgpu::TextureFormat;

use crate::gpu::layout::MAX_LIGHTS;
use crate::preset::Settings;
use crate::region::PixelRect;

pub use passes::{Change, Path, PlannedPass, runs};
pub use published::PublishedPlan;

use passes::{ESTIMATE_PASSES, PASSES};

/// A penumbra narrower than this is drawn as a hard edge.
const HARD_PENUMBRA_PX: f64 = 1.0;
/// Light points of a hard edge: one for each multisample position, so that it stays antialiased.
const N_HARD_POINTS: usize = 4;
/// Steps of the reweighted least squares; each more moved no share by 1e-3 on the sessions they were chosen on.
const N_FIT_STEPS: u32 = 5;
/// Steps from a solution that is known: for a new view of a known place, or a new picture of a known view.
const N_REFINE_STEPS: u32 = 2;
/// Workgroups of one sum, enough to fill a phone's cores.
const MAX_FIT_ROWS: u32 = 64;
/// Pixels enough to tell the fit's few unknowns; more only cost time.
const MAX_FIT_PIXELS: u32 = 1 << 16;
/// Invocations of one workgroup of the fit.
const FIT_WORKGROUP: u32 = 256;

/// Facts of a scene that decide its plan.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneFacts {
    /// What toy and shadows can reach.
    pub region: PixelRect,
    /// Width of each listed light's widest penumbra on the screen, in pixels.
    pub penumbra_px: Vec<f64>,
    /// Receivers that shadows are moved on, one to four.
    pub n_receivers: u32,
    /// One plate shows all of the region.
    pub is_plate_complete: bool,
}

/// How one light's visibility is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LightPlan {
    /// Points drawn: 4 for a hard edge, else a multiple of 16.
    pub n_points: usize,
}

/// How the toy's shadow on itself is made: an atlas of depth maps, one for each point of each light.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SelfShadowPlan {
    /// One entry a light.
    pub n_points: Vec<usize>,
    /// Tiles along each side of the atlas.
    pub n_columns: u32,
    /// Texels along each side of a tile.
    pub tile_px: u32,
}

impl SelfShadowPlan {
    fn new(lights: &[LightPlan], settings: &Settings) -> Self {
        let n_points: Vec<usize> = lights
            .iter()
            .map(|light| light.n_points.min(settings.n_self_shadow_points))
            .collect();
        let n_tiles: usize = n_points.iter().sum();
        Self {
            n_columns: (1..).find(|n| (n * n) as usize >= n_tiles).unwrap_or(1),
            n_points,
            tile_px: settings.self_shadow_tile_px,
        }
    }

    /// From the clip space of tile `index`, of which the part `used` along each side is drawn to, to that of the atlas.
    #[must_use]
    pub fn atlas_from_tile(&self, index: u32, used: f64) -> DMat4 {
        let side = 1.0 / f64::from(self.n_columns);
        let middle = |place: u32| side * f64::from(2 * place + 1) - 1.0;
        let at = DVec3::new(
            middle(index % self.n_columns),
            -middle(index / self.n_columns),
            0.0,
        );
        DMat4::from_translation(at) * DMat4::from_scale(DVec3::new(used * side, used * side, 1.0))
    }
}

/// What is allocated and run for a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The work region.
    pub region: PixelRect,
    /// One entry a light, at most four.
    pub lights: Vec<LightPlan>,
    /// Format of the visibility maps, one channel a light.
    pub visibility_format: TextureFormat,
    /// Directions of ambient light.
    pub n_ambient_directions: usize,
    /// Size of the ambient maps.
    pub ambient_px: UVec2,
    /// Receivers that shadows are moved on.
    pub n_receivers: u32,
    /// Whether what no plate shows is estimated.
    pub is_plate_estimated: bool,
    /// Draws of the shown toy, each by a part of a pixel beside the others.
    pub n_toy_draws: u32,
    /// Whether the noise of the real shadow is removed.
    pub is_noise_removed: bool,
    /// The toy's shadow on itself.
    pub self_shadow: SelfShadowPlan,
    /// Steps of a first fit.
    pub n_fit_steps: u32,
    /// Steps of a fit that starts from a known solution.
    pub n_refine_steps: u32,
    /// Every how many region pixels, along each side, the fit takes one.
    pub fit_stride_px: u32,
    /// Workgroups of one sum of the fit.
    pub n_fit_rows: u32,
    /// The passes in the order they run.
    pub passes: Vec<PlannedPass>,
    /// What the scene does not need.
    pub left_out: Vec<LeftOut>,
}

/// Work that a scene does not need.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LeftOut {
    /// What is left out.
    pub what: &'static str,
    /// Why.
    pub why: &'static str,
}

impl Plan {
    /// Plans a scene. Lights beyond the fourth are left out.
    #[must_use]
    pub fn new(facts: &SceneFacts, settings: &Settings) -> Self {
        let size_px = facts.region.size_px;
        let lights: Vec<LightPlan> = facts
            .penumbra_px
            .iter()
            .take(MAX_LIGHTS)
            .map(|px| LightPlan {
                n_points: if *px < HARD_PENUMBRA_PX {
                    N_HARD_POINTS
                } else {
                    settings.n_light_points
                },
            })
            .collect();
        let fit_stride_px = fit_stride_px(size_px);
        let n_fit_pixels = (size_px / fit_stride_px).element_product();
        Self {
            region: facts.region,
            visibility_format: visibility_format(lights.len()),
            left_out: left_out(facts, &lights),
            n_ambient_directions: settings.n_ambient_directions,
            ambient_px: (size_px + settings.ambient_divisor - 1) / settings.ambient_divisor,
            n_receivers: facts.n_receivers,
            is_plate_estimated: !facts.is_plate_complete,
            n_toy_draws: settings.n_toy_draws,
            is_noise_removed: settings.is_noise_removed,
            self_shadow: SelfShadowPlan::new(&lights, settings),
            n_fit_steps: N_FIT_STEPS,
            n_refine_steps: N_REFINE_STEPS,
            fit_stride_px,
            n_fit_rows: n_fit_pixels.div_ceil(FIT_WORKGROUP).clamp(1, MAX_FIT_ROWS),
            passes: PASSES
                .iter()
                .filter(|pass| !(facts.is_plate_complete && ESTIMATE_PASSES.contains(&pass.name)))
                .filter(|pass| settings.is_noise_removed || pass.name != "detail")
                .copied()
                .collect(),
            lights,
        }
    }
}

impl Plan {
    /// The plan of another view of the same place: lights keep their points, so that nothing changes but what is seen.
    #[must_use]
    pub fn for_view(&self, facts: &SceneFacts, settings: &Settings) -> Self {
        Self {
            lights: self.lights.clone(),
            self_shadow: self.self_shadow.clone(),
            ..Self::new(facts, settings)
        }
    }
}

/// The narrowest format of a visibility map that has a channel a light.
fn visibility_format(n_lights: usize) -> TextureFormat {
    match n_lights {
        0 | 1 => TextureFormat::R16Float,
        2 => TextureFormat::Rg16Float,
        _ => TextureFormat::Rgba16Float,
    }
}

/// The smallest stride that leaves no more than [`MAX_FIT_PIXELS`], and at least one pixel along each side.
fn fit_stride_px(size_px: UVec2) -> u32 {
    let largest = size_px.min_element().max(1);
    (1..=largest)
        .find(|stride| (size_px / *stride).element_product() <= MAX_FIT_PIXELS)
        .unwrap_or(largest)
}

fn left_out(facts: &SceneFacts, lights: &[LightPlan]) -> Vec<LeftOut> {
    let mut left_out = Vec::new();
    if facts.is_plate_complete {
        left_out.push(LeftOut {
            what: "estimate of the plate",
            why: "a plate was taken from this camera",
        });
    }
    if facts.n_receivers < 2 {
        left_out.push(LeftOut {
            what: "further receivers",
            why: "one is listed",
        });
    }
    if lights.len() < 2 {
        left_out.push(LeftOut {
            what: "overlap of shadows",
            why: "one light is listed",
        });
    }
    if lights.iter().all(|light| light.n_points == N_HARD_POINTS) {
        left_out.push(LeftOut {
            what: "penumbra",
            why: "every light's penumbra is narrower than a pixel",
        });
    }
    left_out
}
