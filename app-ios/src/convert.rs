//! Conversion of UIKit's points and the system's numbers to ours.

use app_core::app::Thermal;
use glam::DVec2;

/// Whole pixels from a size in UIKit's points. `None` while there is no area, as before the first layout.
pub fn size_px(size_points: [f64; 2], pixels_per_point: f64) -> Option<[u32; 2]> {
    let size_px = (DVec2::from(size_points) * pixels_per_point).round();
    // The conversion saturates; no number here is near a limit of u32.
    (size_px.min_element() >= 1.0).then(|| size_px.as_uvec2().to_array())
}

/// The phone's heat from an `NSProcessInfoThermalState`.
pub fn thermal(state: isize) -> Thermal {
    match state {
        ..=0 => Thermal::Nominal,
        1 => Thermal::Fair,
        2 => Thermal::Serious,
        3.. => Thermal::Critical,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heat_has_four_steps() {
        use Thermal::{Critical, Fair, Nominal, Serious};
        assert_eq!([0, 1, 2, 3].map(thermal), [Nominal, Fair, Serious, Critical]);
    }

    #[test]
    fn points_become_whole_pixels() {
        assert_eq!(size_px([844.0, 390.0], 3.0), Some([2532, 1170]));
        assert_eq!(size_px([0.0, 390.0], 3.0), None, "not laid out");
        assert_eq!(size_px([844.0, 390.0], 0.0), None, "no screen yet");
    }
}
