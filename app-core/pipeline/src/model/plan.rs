//! The plan of a scene: numbers of points, sizes of maps, and skipped work. Pure data, made without
//! a device.

use glam::UVec2;
use wgpu::TextureFormat;

use crate::geometry::rect::PixelRect;
use crate::geometry::shadow_atlas::ShadowAtlas;
use crate::passes::plate::{CODED_FORMAT, FINE_FORMAT};
use crate::passes::specular::Specular;
use crate::passes::toy_mesh::CasterLod;
use crate::plan::{SceneFacts, SkippedWork};
use crate::preset::ModelSettings;
use app_scene::reflection::Reflection;
use app_scene::scene::MAX_LIGHTS;
use app_scene::sharpness::Sharpness;
use app_scene::things::Front;

/// Steps of the reweighted least squares. Another step moved no direct fraction by 1e-3 in the
/// sessions from which the number was chosen.
const N_FIT_STEPS: u32 = 5;
/// Steps from a known solution, for a new view of a known scene: a second one changed shadow, toy and edge by at most .001
/// codes on a session of eight views.
const N_REFINE_STEPS: u32 = 1;
/// Steps of the fit of gain and intensities: the first has no weights, since a jump of the exposure
/// makes every pixel an outlier.
const N_INTENSITY_STEPS: u32 = 2;
/// Number of pixels that suffices for the fit's few unknowns; more only cost time. A quarter of
/// them is as good on six sessions, but not if the real shadow is only some thirty pixels large.
const MAX_FIT_PIXELS: u32 = 1 << 16;
/// Number of pixels that suffices for gain and intensities: on six sessions, whose shadows are some
/// hundred pixels large, shadow, toy and edge change by at most .0004 codes.
const MAX_INTENSITY_PIXELS: u32 = 1 << 14;
/// Maximum distance around the toy from which a pixel is read, including one pixel for rounding and
/// one for multisamples.
pub(crate) const AROUND_TOY_PX: u32 = 10;
/// Maximum distance in pixels between the self-shadow caster and the toy's shape: a caster that
/// protrudes would shade the surface.
const SELF_CASTER_PX: f64 = 1.0;
/// Triangles of the caster for ambient light, if that is accurate enough: its shadow has no edges.
const N_AMBIENT_TRIANGLES: u32 = 1000;
/// Invocations of one workgroup of the fit.
const FIT_WORKGROUP: u32 = 256;
/// Pixels that each invocation adds up before its workgroup does: the cost of the workgroup's sum
/// does not depend on them. With 1, 16 and 64 the fits of a view take 33, 12 and 12 ms on a
/// processor of two cores; no phone has been measured.
const FIT_PIXELS_EACH: u32 = 16;
/// Maximum number of workgroups of one sum.
pub(crate) const MAX_FIT_ROWS: u32 = MAX_FIT_PIXELS / (FIT_WORKGROUP * FIT_PIXELS_EACH);

/// The shapes that cast shadows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Casters {
    /// Caster for the lights, on receivers.
    pub light: CasterLod,
    /// Caster for the lights, on the toy itself.
    pub self_shadow: CasterLod,
    /// Caster for the ambient light.
    pub ambient: CasterLod,
}

impl Casters {
    fn new(facts: &SceneFacts, settings: &ModelSettings) -> Self {
        match settings.caster_px {
            Some(caster_px) => Self {
                light: CasterLod::Within(f64::from(caster_px) * facts.pixel_in_object),
                self_shadow: CasterLod::Within(SELF_CASTER_PX * facts.pixel_in_object),
                ambient: CasterLod::AtMost(N_AMBIENT_TRIANGLES),
            },
            None => Self {
                light: CasterLod::Own,
                self_shadow: CasterLod::Own,
                ambient: CasterLod::Own,
            },
        }
    }
}

/// Sizes and numbers of everything that is allocated and run for a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The work region.
    pub region: PixelRect,
    /// Pixels of the region that can show the physical toy, counted from its corner.
    pub physical_toy: Option<PixelRect>,
    /// The toy box: pixels of the region that contain the toy in every pose and the neighbours that
    /// are read around it, counted from the region's corner.
    pub toy_box: PixelRect,
    /// The physical box: the same for the physical pose alone.
    pub physical_box: PixelRect,
    /// Number of lights whose shadows are retargeted, at most four.
    pub n_lights: usize,
    /// Width in pixels of each light's widest penumbra.
    pub penumbrae_px: Vec<f64>,
    /// Number of points over each light. A hard light has several, too: they antialias its edge.
    pub n_light_points: Vec<usize>,
    /// Reflection of the first receiver, which takes one more channel of visibilities, behind those
    /// of the lights. `None` if the receiver is matt, or if the lights use all channels.
    pub reflection: Option<Reflection>,
    /// Number of directions of ambient light.
    pub n_ambient_directions: usize,
    /// Size of the ambient maps.
    pub ambient_px: UVec2,
    /// Number of receivers on which shadows are retargeted.
    pub n_receivers: u32,
    /// Whether the plate is estimated in its missing parts.
    pub is_plate_estimated: bool,
    /// Whether the plate is stored with more precision than codes.
    pub is_plate_fine: bool,
    /// Draws of the shown toy, each with an offset of a fraction of a pixel.
    pub n_toy_draws: u32,
    /// Samples per pixel in each of these draws, 4 or 1.
    pub n_toy_samples: u32,
    /// Number of positions within a pixel over which the shown toy's coverage is counted.
    pub n_coverage_positions: u32,
    /// Whether the real shadow is denoised.
    pub is_noise_removed: bool,
    /// Whether the real shadow is withheld from all but the first fits.
    pub is_shadow_withheld: bool,
    /// Whether things beside the toy are marked.
    pub has_things: bool,
    /// Whether shadows fall on these.
    pub has_raised_things: bool,
    /// The planes in anchor space before which the toy is drawn over things before it; empty if it is drawn behind
    /// them.
    pub things_fronts: Vec<Front>,
    /// The toy's shadow on itself.
    pub self_shadow: ShadowAtlas,
    /// Meshes that cast shadows.
    pub casters: Casters,
    /// Estimated sharpness of the picture.
    pub sharpness: Sharpness,
    /// Whether plate and toy colours are softened to match the picture.
    pub is_softened: bool,
    /// Specular reflection of the toy.
    pub specular: Specular,
    /// Steps of a first fit.
    pub n_fit_steps: u32,
    /// Steps of a fit that starts from a known solution.
    pub n_refine_steps: u32,
    /// Steps of a fit of gain and intensities.
    pub n_intensity_steps: u32,
    /// Sampling stride of the fit, in region pixels, along each side.
    pub fit_stride_px: u32,
    /// Sampling stride of the fit of gain and intensities.
    pub intensity_fit_stride_px: u32,
    /// Work that the scene does not need.
    pub skipped: Vec<SkippedWork>,
}

impl Plan {
    /// Plans a scene. Lights beyond the fourth are ignored.
    #[must_use]
    pub fn new(facts: &SceneFacts, settings: &ModelSettings) -> Self {
        let size_px = facts.region.size_px;
        let n_lights = facts.penumbrae_px.len().min(MAX_LIGHTS);
        let penumbrae_px = facts.penumbrae_px[..n_lights].to_vec();
        Self {
            region: facts.region,
            physical_toy: in_region(facts.physical_toy, &facts.region),
            toy_box: box_in_region(facts.toy_box, facts, settings),
            physical_box: box_in_region(facts.physical_box, facts, settings),
            skipped: skipped(facts, n_lights),
            n_ambient_directions: settings.n_ambient_directions,
            ambient_px: (size_px + settings.ambient_divisor - 1) / settings.ambient_divisor,
            n_receivers: facts.n_receivers,
            is_plate_estimated: !facts.is_plate_complete,
            is_plate_fine: settings.is_plate_fine
                || !facts.is_plate_complete
                || facts.are_plates_scaled
                || facts.reflection.is_some(),
            reflection: facts.reflection.filter(|_| n_lights < MAX_LIGHTS),
            n_toy_draws: settings.n_toy_draws,
            n_toy_samples: settings.n_toy_samples,
            n_coverage_positions: settings.n_coverage_positions,
            is_noise_removed: settings.is_noise_removed,
            is_shadow_withheld: settings.is_shadow_withheld,
            has_things: facts.has_things,
            has_raised_things: facts.has_raised_things,
            things_fronts: facts.things_fronts.clone(),
            self_shadow: self_shadow(n_lights, settings),
            casters: Casters::new(facts, settings),
            sharpness: facts.sharpness,
            is_softened: facts.is_softened,
            specular: Specular::new(&facts.gloss, facts.angular_radii_rad.iter().copied()),
            n_fit_steps: N_FIT_STEPS,
            n_refine_steps: N_REFINE_STEPS,
            n_intensity_steps: N_INTENSITY_STEPS,
            fit_stride_px: stride_px(size_px, MAX_FIT_PIXELS),
            intensity_fit_stride_px: stride_px(size_px, MAX_INTENSITY_PIXELS),
            n_lights,
            n_light_points: penumbrae_px
                .iter()
                .map(|width_px| n_light_points(*width_px, settings))
                .collect(),
            penumbrae_px,
        }
    }
}

impl Plan {
    /// Number of channels of the visibilities.
    #[must_use]
    pub fn n_channels(&self) -> usize {
        self.n_lights + usize::from(self.reflection.is_some())
    }

    /// Whether the maps have the sizes and formats of those of another plan.
    #[must_use]
    pub fn has_sizes_of(&self, other: &Self) -> bool {
        let sizes = |plan: &Self| {
            let counts = [plan.n_lights, plan.n_channels(), plan.n_ambient_directions];
            let boxes_px = [plan.toy_box.size_px, plan.physical_box.size_px];
            (
                plan.region.size_px,
                boxes_px,
                plan.ambient_px,
                counts,
                [plan.has_things, plan.has_raised_things],
            )
        };
        sizes(self) == sizes(other) && self.self_shadow == other.self_shadow
    }

    /// Format of the plate.
    pub(crate) fn plate_format(&self) -> TextureFormat {
        if self.is_plate_fine {
            FINE_FORMAT
        } else {
            CODED_FORMAT
        }
    }

    /// Workgroups of one sum of a fit that samples pixels with a stride.
    #[must_use]
    pub fn n_fit_rows(&self, stride_px: u32) -> u32 {
        let n_taken = (self.region.size_px / stride_px.max(1)).element_product();
        n_taken
            .div_ceil(FIT_WORKGROUP * FIT_PIXELS_EACH)
            .clamp(1, MAX_FIT_ROWS)
    }

    /// Parameters of a draw onto one of the boxes: its corner, and the size of the region that
    /// contains it.
    #[must_use]
    pub fn part_drawn(&self, of: &PixelRect) -> (UVec2, UVec2) {
        (of.origin_px, self.region.size_px)
    }

    /// Pixels of the physical box at most `reach_px` from those that show the physical toy: their corner, counted from the
    /// box's, and their size.
    #[must_use]
    pub fn near_physical_toy(&self, reach_px: u32) -> Option<(UVec2, UVec2)> {
        // The rounding error in 32 bits is less than a pixel.
        let near = self.physical_toy?.grown(reach_px + 1, self.region.size_px);
        let near = near.common(&self.physical_box)?;
        Some((near.origin_px - self.physical_box.origin_px, near.size_px))
    }
}

/// The part of a rectangle of the image that lies in the region, counted from the region's corner.
fn in_region(rect: Option<PixelRect>, region: &PixelRect) -> Option<PixelRect> {
    let common = rect?.common(region)?;
    Some(PixelRect {
        origin_px: common.origin_px - region.origin_px,
        ..common
    })
}

/// Converts a box of the image into one of the region. A withheld shadow and things mark pixels
/// anywhere in the region.
fn box_in_region(of_image: Option<PixelRect>, facts: &SceneFacts, settings: &ModelSettings) -> PixelRect {
    let whole = PixelRect {
        origin_px: UVec2::ZERO,
        size_px: facts.region.size_px,
    };
    if settings.is_shadow_withheld || facts.has_things {
        return whole;
    }
    in_region(of_image, &facts.region).unwrap_or(PixelRect {
        size_px: UVec2::ONE,
        ..whole
    })
}

/// Penumbra width up to which a light's points antialias an edge; fewer points would show as steps
/// of colour.
const HARD_PX: f64 = 4.0;

/// Number of points over a light. A soft light gets fewer if they still suffice for one per pixel
/// of its penumbra.
fn n_light_points(penumbra_px: f64, settings: &ModelSettings) -> usize {
    let is_narrow = penumbra_px > HARD_PX && penumbra_px <= settings.n_narrow_light_points as f64;
    if is_narrow {
        settings.n_narrow_light_points
    } else {
        settings.n_light_points
    }
}

/// An atlas for the toy's shadow on itself.
fn self_shadow(n_lights: usize, settings: &ModelSettings) -> ShadowAtlas {
    let n_points = settings.n_light_points.min(settings.n_self_shadow_points);
    ShadowAtlas::new(vec![n_points; n_lights], settings.self_shadow_tile_px)
}

/// The smallest stride that leaves at most `most` pixels, and at least one along each side.
fn stride_px(size_px: UVec2, most: u32) -> u32 {
    let largest = size_px.min_element().max(1);
    (1..=largest)
        .find(|stride| (size_px / *stride).element_product() <= most)
        .unwrap_or(largest)
}

fn skipped(facts: &SceneFacts, n_lights: usize) -> Vec<SkippedWork> {
    let mut skipped = Vec::new();
    if facts.is_plate_complete {
        skipped.push(SkippedWork {
            what: "estimate of the plate",
            reason: "plates show all of the region",
        });
    }
    if facts.n_receivers < 2 {
        skipped.push(SkippedWork {
            what: "further receivers",
            reason: "one is listed",
        });
    }
    if n_lights < 2 {
        skipped.push(SkippedWork {
            what: "overlap of shadows",
            reason: "one light is listed",
        });
    }
    skipped
}
