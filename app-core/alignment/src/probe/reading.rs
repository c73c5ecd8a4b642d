//! Converts a highlight to a light: its centre, its uncertainty, and whether it is a light.

use glam::{DMat2, DMat4, DVec2, DVec3, UVec2};

use super::highlights::{Highlight, middle_px};
use super::reflection::Reflection;
use super::surface::Surface;
use super::{Reason, Rejected, SeenLight};

/// Step of difference quotients, in pixels.
const STEP_PX: f64 = 0.5;
/// Standard deviation of a highlight's centre, along each axis, in pixels.
///
/// Measured on rendered pictures with noise of a code: .005 to .09.
const MIDDLE_PX: f64 = 0.1;
/// Lower bound of a direction's standard deviation, in radians, from the poses of camera and probe.
const LEAST_DEVIATION_RAD: f64 = 0.0005;
/// Variance of the blur of a highlight by lens and pixels, along each axis, in square pixels.
const BLUR_PX2: f64 = 0.4;
/// The same for a clipped highlight, of which the surroundings count more.
///
/// On the safe side: lights of less than 4 degrees come out as points, one of 10 degrees as 6 to 8
/// across.
const BLOOM_PX2: f64 = 1.5;
/// Fraction of white above which a highlight counts as clipped.
const CUT_OFF: f64 = 0.95;
/// Largest ratio of length and width of a light, without blur.
const LONGEST: f64 = 3.0;
/// Largest angular radius of a light, in radians: 40 degrees across.
const WIDEST_RAD: f64 = 0.35;

/// The reflection of a line of sight, and its derivative in the picture.
struct Local {
    seen: Reflection,
    /// Change of the reflected direction over a pixel, along rows and along columns.
    per_px: [DVec3; 2],
}

impl Local {
    fn at(surface: &Surface<'_>, at_px: DVec2) -> Option<Self> {
        let change = |axis: DVec2| {
            let [more, less] = [1.0, -1.0].map(|side| surface.reflect(at_px + side * STEP_PX * axis));
            Some((more?.toward - less?.toward) / (2.0 * STEP_PX))
        };
        Some(Self {
            seen: surface.reflect(at_px)?,
            per_px: [change(DVec2::X)?, change(DVec2::Y)?],
        })
    }

    /// Solid angle of a pixel.
    fn solid_angle(&self) -> f64 {
        self.per_px[0].cross(self.per_px[1]).length()
    }

    /// Change of the direction along a direction of the picture, per pixel, squared.
    fn squared_change(&self, along: DVec2) -> f64 {
        (along.x * self.per_px[0] + along.y * self.per_px[1]).length_squared()
    }
}

/// The light of a highlight, in the world, or the reason why it is none.
pub(super) fn light(
    highlight: &Highlight,
    surface: &Surface<'_>,
    world_from_probe: &DMat4,
) -> Result<SeenLight, Rejected> {
    let middle = Middle::of(&highlight.weighted, surface);
    let reject = |reason| {
        let at_px = middle
            .as_ref()
            .map_or_else(|| first_px(&highlight.bright), |middle| middle.at_px);
        Rejected { at_px, reason }
    };
    let Some(middle) = middle.as_ref().filter(|_| !highlight.is_at_rim) else {
        return Err(reject(Reason::AtRim));
    };
    let Some(local) = Local::at(surface, middle.at_px) else {
        return Err(reject(Reason::AtRim));
    };
    let size = Size::of(middle, &local);
    if size.elongation > LONGEST {
        return Err(reject(Reason::Streak {
            elongation: size.elongation,
        }));
    }
    if size.angular_radius_rad > WIDEST_RAD {
        return Err(reject(Reason::TooWide {
            angular_radius_rad: size.angular_radius_rad,
        }));
    }
    if matches!(surface, Surface::Lens(_)) && middle.toward.y <= 0.0 {
        return Err(reject(Reason::BelowLens));
    }
    let per_px2: f64 = local.per_px.iter().map(|change| change.length_squared()).sum();
    let seen = Reflection {
        at: middle.at,
        toward: middle.toward,
    };
    let seen = seen.in_world(world_from_probe);
    Ok(SeenLight {
        origin_in_world: seen.at,
        direction_in_world: seen.toward,
        deviation_rad: (MIDDLE_PX * MIDDLE_PX * per_px2).sqrt().max(LEAST_DEVIATION_RAD),
        angular_radius_rad: size.angular_radius_rad,
        power: middle.power,
        at_px: middle.at_px,
    })
}

fn first_px(bright: &[UVec2]) -> DVec2 {
    bright.first().map_or(DVec2::ZERO, |pixel| middle_px(*pixel))
}

/// Means over a highlight, in the probe's space.
struct Middle {
    /// Weighted by light times solid angle: a light's disc is uniform in the sky, not in the
    /// mirror.
    toward: DVec3,
    at: DVec3,
    /// Weighted by light alone, like the variance.
    at_px: DVec2,
    variance_px2: DMat2,
    /// Contribution of blur to that along each axis.
    blur_px2: f64,
    power: f64,
}

impl Middle {
    fn of(weighted: &[(UVec2, f64)], surface: &Surface<'_>) -> Option<Self> {
        let (mut toward, mut at, mut power) = (DVec3::ZERO, DVec3::ZERO, 0.0);
        let (mut at_px, mut light) = (DVec2::ZERO, 0.0);
        for (pixel, weight) in weighted {
            let place_px = middle_px(*pixel);
            let Some(local) = Local::at(surface, place_px) else {
                continue;
            };
            let share = weight * local.solid_angle();
            toward += share * local.seen.toward;
            at += share * local.seen.at;
            power += share;
            at_px += *weight * place_px;
            light += weight;
        }
        if power <= 0.0 || light <= 0.0 {
            return None;
        }
        let at_px = at_px / light;
        let peak = weighted.iter().map(|(_, weight)| *weight).fold(0.0, f64::max);
        let blur_px2 = if peak > CUT_OFF { BLOOM_PX2 } else { BLUR_PX2 };
        let mut variance_px2 = DMat2::ZERO;
        for (pixel, weight) in weighted {
            let off = middle_px(*pixel) - at_px;
            variance_px2 += DMat2::from_cols(off * off.x, off * off.y) * (weight / light);
        }
        // Only the light's own extent is uniform in the sky; blur is uniform in the picture, around
        // the centre there.
        let variance = 0.5 * (variance_px2.x_axis.x + variance_px2.y_axis.y);
        let of_light = if variance > blur_px2 {
            1.0 - blur_px2 / variance
        } else {
            0.0
        };
        let middle = surface.reflect(at_px)?;
        Some(Self {
            toward: middle.toward.lerp(toward / power, of_light).try_normalize()?,
            at: middle.at.lerp(at / power, of_light),
            at_px,
            variance_px2,
            blur_px2,
            power,
        })
    }
}

/// Length and width of a highlight as angles, without blur.
struct Size {
    elongation: f64,
    angular_radius_rad: f64,
}

impl Size {
    /// A uniform disc has a variance of a quarter of its squared radius along each axis. Length is
    /// measured in units of the width and of blur: a highlight is not long just because the mirror
    /// stretches a pixel.
    fn of(middle: &Middle, local: &Local) -> Self {
        let (long, [most_px2, least_px2]) = axes(&middle.variance_px2);
        let [per_long2, per_wide2] = [long, long.perp()].map(|along| local.squared_change(along));
        let spread =
            |variance_px2: f64, blur_px2: f64, per_px2: f64| (variance_px2 - blur_px2).max(0.0) * per_px2;
        let length = spread(most_px2, BLUR_PX2, per_long2);
        let width = spread(least_px2, BLUR_PX2, per_wide2) + BLUR_PX2 * per_long2;
        let of_light =
            spread(most_px2, middle.blur_px2, per_long2) + spread(least_px2, middle.blur_px2, per_wide2);
        Self {
            elongation: (length / width.max(f64::MIN_POSITIVE)).sqrt(),
            angular_radius_rad: 2.0 * (0.5 * of_light).sqrt(),
        }
    }
}

/// Unit vector of the long axis of a symmetric matrix, and its eigenvalues, the larger first.
fn axes(matrix: &DMat2) -> (DVec2, [f64; 2]) {
    let [a, b, d] = [matrix.x_axis.x, matrix.x_axis.y, matrix.y_axis.y];
    let angle = 0.5 * (2.0 * b).atan2(a - d);
    let half = 0.5 * (a - d).hypot(2.0 * b);
    let mean = 0.5 * (a + d);
    (DVec2::from_angle(angle), [mean + half, mean - half])
}
