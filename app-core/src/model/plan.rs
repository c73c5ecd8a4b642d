//! The plan of a scene: numbers of points, sizes of maps, and what is left out. Pure data, made without a device.
//!
//! Both paths take their order from it (`capture::order`, `frame::order`).

use glam::UVec2;

use crate::geometry::rect::PixelRect;
use crate::geometry::shadow_atlas::ShadowAtlas;
use crate::plan::{LeftOut, SceneFacts};
use crate::preset::ModelSettings;
use crate::scene::MAX_LIGHTS;

/// A penumbra narrower than this is drawn as a hard edge.
const HARD_PENUMBRA_PX: f64 = 1.0;
/// Light points of a hard edge: one for each position within a pixel, so that it stays antialiased.
const N_HARD_POINTS: usize = 4;
/// Steps of the reweighted least squares; each more moved no direct fraction by 1e-3 on the sessions they were chosen
/// on.
const N_FIT_STEPS: u32 = 5;
/// Steps from a known solution: for a new view of a known scene, or a new picture of a known view.
const N_REFINE_STEPS: u32 = 2;
/// Workgroups of one sum, enough to fill a phone's cores.
pub(crate) const MAX_FIT_ROWS: u32 = 64;
/// Pixels that suffice for the fit's few unknowns; more only cost time.
const MAX_FIT_PIXELS: u32 = 1 << 16;
/// Invocations of one workgroup of the fit.
const FIT_WORKGROUP: u32 = 256;

/// The plan of one light's visibility.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LightPlan {
    /// Points drawn: 4 for a hard edge, else a multiple of 16.
    pub n_points: usize,
}

/// Sizes and numbers of all that is allocated and run for a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The work region.
    pub region: PixelRect,
    /// Pixels of the region that can show the physical toy, counted from its corner.
    pub physical_toy: Option<PixelRect>,
    /// One entry a light, at most four.
    pub lights: Vec<LightPlan>,
    /// Directions of ambient light.
    pub n_ambient_directions: usize,
    /// Size of the ambient maps.
    pub ambient_px: UVec2,
    /// Receivers that shadows are moved on.
    pub n_receivers: u32,
    /// Whether the plate is estimated where none was photographed.
    pub is_plate_estimated: bool,
    /// Draws of the shown toy, each offset by a fraction of a pixel.
    pub n_toy_draws: u32,
    /// Whether the real shadow is denoised.
    pub is_noise_removed: bool,
    /// Whether the real shadow is withheld from all but the first fits.
    pub is_shadow_withheld: bool,
    /// The toy's shadow on itself.
    pub self_shadow: ShadowAtlas,
    /// Steps of a first fit.
    pub n_fit_steps: u32,
    /// Steps of a fit that starts from a known solution.
    pub n_refine_steps: u32,
    /// Sampling stride of the fit, in region pixels, along each side.
    pub fit_stride_px: u32,
    /// Workgroups of one sum of the fit.
    pub n_fit_rows: u32,
    /// Work that the scene does not need.
    pub left_out: Vec<LeftOut>,
}

impl Plan {
    /// Plans a scene. Lights beyond the fourth are left out.
    #[must_use]
    pub fn new(facts: &SceneFacts, settings: &ModelSettings) -> Self {
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
            physical_toy: in_region(facts.physical_toy, &facts.region),
            left_out: left_out(facts, &lights),
            n_ambient_directions: settings.n_ambient_directions,
            ambient_px: (size_px + settings.ambient_divisor - 1) / settings.ambient_divisor,
            n_receivers: facts.n_receivers,
            is_plate_estimated: !facts.is_plate_complete,
            n_toy_draws: settings.n_toy_draws,
            is_noise_removed: settings.is_noise_removed,
            is_shadow_withheld: settings.is_shadow_withheld,
            self_shadow: self_shadow(&lights, settings),
            n_fit_steps: N_FIT_STEPS,
            n_refine_steps: N_REFINE_STEPS,
            fit_stride_px,
            n_fit_rows: n_fit_pixels.div_ceil(FIT_WORKGROUP).clamp(1, MAX_FIT_ROWS),
            lights,
        }
    }
}

impl Plan {
    /// Pixels of the region at most `reach_px` from those that show the physical toy: their corner, counted from the
    /// region's, and their size.
    #[must_use]
    pub fn near_physical_toy(&self, reach_px: u32) -> Option<(UVec2, UVec2)> {
        // What rounding adds in 32 bits is less than a pixel.
        let near = self.physical_toy?.grown(reach_px + 1, self.region.size_px);
        Some((near.origin_px, near.size_px))
    }

    /// The plan of another view of the same scene: lights keep their points, so that only the view changes.
    #[must_use]
    pub fn for_view(&self, facts: &SceneFacts, settings: &ModelSettings) -> Self {
        Self {
            lights: self.lights.clone(),
            self_shadow: self.self_shadow.clone(),
            ..Self::new(facts, settings)
        }
    }
}

/// The part of a rectangle of the image that lies in the region, counted from that one's corner.
fn in_region(rect: Option<PixelRect>, region: &PixelRect) -> Option<PixelRect> {
    let common = rect?.common(region)?;
    Some(PixelRect {
        origin_px: common.origin_px - region.origin_px,
        ..common
    })
}

/// An atlas for the toy's shadow on itself.
fn self_shadow(lights: &[LightPlan], settings: &ModelSettings) -> ShadowAtlas {
    let n_points = lights
        .iter()
        .map(|light| light.n_points.min(settings.n_self_shadow_points));
    ShadowAtlas::new(n_points.collect(), settings.self_shadow_tile_px)
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
            why: "plates show all of the region",
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
