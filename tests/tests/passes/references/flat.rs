//! A region seen from straight above: one pixel is one centimetre of the receiver.

use app_pipeline::geometry::rect::PlaneRect;
use glam::{DMat3, DMat4, DVec2, DVec3, DVec4, UVec2};
use reference::grid::PlaneGrid;
use reference::model::{ReceiverPlane, ReceiverPoint, ReceiverSolution, Region, Solution};

/// Metres per pixel.
pub(crate) const PIXEL_M: f64 = 0.01;

/// The centre of the region is over the plane's origin.
pub(crate) fn region(size_px: UVec2, lights: Vec<DVec4>) -> Region {
    let half_m = 0.5 * PIXEL_M * size_px.as_dvec2();
    let receiver = ReceiverPlane {
        plane_from_anchor: DMat4::IDENTITY,
        plane_from_region_px: DMat3::from_cols(
            DVec3::new(PIXEL_M, 0.0, 0.0),
            DVec3::new(0.0, PIXEL_M, 0.0),
            (-half_m).extend(1.0),
        ),
        lights: lights.clone(),
        reference_in_plane: DVec2::ZERO,
        rect: PlaneRect {
            min: DVec2::splat(-10.0),
            max: DVec2::splat(10.0),
        },
    };
    Region {
        receivers: vec![receiver],
        size_px,
        border_px: [0.0; 4],
        light_radii: vec![0.0; lights.len()],
        lights,
        reflection: None,
    }
}

/// A point of the only receiver.
pub(crate) fn point(in_plane: DVec2) -> ReceiverPoint {
    ReceiverPoint {
        receiver: 0,
        in_plane,
    }
}

/// Cells of `cell_px` pixels over a region of `size_px`.
pub(crate) fn grid(size_px: UVec2, cell_px: u32) -> PlaneGrid {
    PlaneGrid {
        origin_in_plane: -0.5 * PIXEL_M * size_px.as_dvec2(),
        cell_m: PIXEL_M * f64::from(cell_px),
        size: (size_px + cell_px - 1) / cell_px,
    }
}

/// Two bulbs, one on each side.
pub(crate) fn two_bulbs() -> Vec<DVec4> {
    vec![DVec4::new(0.4, 0.6, 0.1, 1.0), DVec4::new(-0.5, 0.8, 0.3, 1.0)]
}

/// A solution in which all channels and lights differ.
pub(crate) fn truth(n_lights: usize) -> Solution {
    let direct_fractions = [DVec3::new(0.31, 0.35, 0.42), DVec3::new(0.24, 0.2, 0.11)];
    Solution {
        gain: DVec3::new(1.05, 0.98, 0.93),
        intensities: vec![DVec3::ONE; n_lights],
        receivers: vec![ReceiverSolution {
            bounce: DVec3::new(0.3, 0.12, 0.06),
            direct_fractions: direct_fractions[..n_lights].to_vec(),
            clipped: DVec3::ZERO,
        }],
        toy: vec![DVec3::splat(0.5); 2 + n_lights],
    }
}

/// Starting values of a fit: gain 1, and half of the light from all lights together.
pub(crate) fn start(n_lights: usize) -> Solution {
    let direct_fraction = 0.5 / n_lights as f64;
    Solution {
        gain: DVec3::ONE,
        intensities: vec![DVec3::ONE; n_lights],
        receivers: vec![ReceiverSolution {
            bounce: DVec3::splat(0.27),
            direct_fractions: vec![DVec3::splat(direct_fraction); n_lights],
            clipped: DVec3::ZERO,
        }],
        toy: vec![DVec3::ZERO; 2 + n_lights],
    }
}

/// Pseudo-random numbers in [0, 1), the same in every run: multiples of the golden ratio.
pub(crate) fn scatter(seed: u32, dimension: u32) -> f64 {
    // Powers of the plastic number's inverse make the dimensions independent.
    let step = 1.324_717_957_244_746_f64.powi(-(1 + i32::try_from(dimension).unwrap()));
    (0.5 + step * f64::from(seed) * f64::from(1 + dimension)).fract()
}
