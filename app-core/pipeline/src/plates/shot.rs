//! A picture with its camera: the receivers that it shows, and their colours.

use glam::{DMat4, DVec2, DVec3};

use crate::geometry::anchored::AnchoredReceiver;
use crate::plates::choice::view_of;
use crate::plates::sight::{PointOn, Sight};
use app_scene::scene::{Image, Plate, Scene};

/// Half the side of the square that is averaged at a point, so that misaligned plates still agree.
const COMPARED_RADIUS_PX: i64 = 3;
/// Codes that are neither dominated by quantisation nor possibly clipped.
const USABLE_CODES: std::ops::RangeInclusive<u8> = 10..=250;

/// A plate or a frame.
pub(crate) struct Shot<'a> {
    image: &'a Image,
    sight: Sight<'a>,
    pub(crate) camera_in_world: DVec3,
}

impl<'a> Shot<'a> {
    pub(crate) fn new(scene: &Scene, plate: &'a Plate, receivers: &'a [AnchoredReceiver]) -> Self {
        let view = view_of(scene, plate);
        Self {
            image: &plate.image,
            sight: Sight::new(&view, receivers),
            camera_in_world: view.camera_in(&DMat4::IDENTITY),
        }
    }

    /// Width and height of the picture.
    pub(crate) fn size_px(&self) -> DVec2 {
        DVec2::new(f64::from(self.image.width_px), f64::from(self.image.height_px))
    }

    /// The point of a receiver at a pixel; `None` if there is no receiver, or only the back of one.
    pub(crate) fn nearest(&self, px: DVec2) -> Option<PointOn> {
        self.sight.nearest(px)
    }

    /// The image position of a point, possibly outside the picture.
    pub(crate) fn image_px_of(&self, point: PointOn) -> Option<DVec2> {
        self.sight.image_px_of(point)
    }

    /// Whether a pixel is in the picture, and neither too dark nor too bright.
    pub(crate) fn is_usable(&self, px: DVec2) -> bool {
        let [x, y] = pixel(px);
        self.usable_codes(x, y).is_some()
    }

    /// Mean linear colour around a pixel; `None` at the border, or if a code is too dark or too
    /// bright.
    pub(crate) fn mean_color(&self, px: DVec2, linear_of_code: &[f64; 256]) -> Option<DVec3> {
        let centre = pixel(px);
        let side = 2 * COMPARED_RADIUS_PX + 1;
        let mut sum = DVec3::ZERO;
        for k in 0..side * side {
            let codes = self.usable_codes(
                centre[0] + k % side - COMPARED_RADIUS_PX,
                centre[1] + k / side - COMPARED_RADIUS_PX,
            )?;
            sum += DVec3::from_array([0, 1, 2].map(|channel| linear_of_code[usize::from(codes[channel])]));
        }
        let n_pixels = (side * side) as f64;
        Some(sum / n_pixels)
    }

    fn usable_codes(&self, x: i64, y: i64) -> Option<&[u8]> {
        let (x, y) = (u32::try_from(x).ok()?, u32::try_from(y).ok()?);
        if x >= self.image.width_px || y >= self.image.height_px {
            return None;
        }
        let first = 4 * (y as usize * self.image.width_px as usize + x as usize);
        let codes = self.image.rgba8.get(first..first + 3)?;
        codes
            .iter()
            .all(|code| USABLE_CODES.contains(code))
            .then_some(codes)
    }
}

/// The scene's plates.
pub(crate) fn shots_of<'a>(scene: &'a Scene, receivers: &'a [AnchoredReceiver]) -> Vec<Shot<'a>> {
    let plates = scene.plates.iter();
    plates.map(|plate| Shot::new(scene, plate, receivers)).collect()
}

#[allow(
    clippy::cast_possible_truncation,
    reason = "a pixel of an image, or far beyond it"
)]
fn pixel(px: DVec2) -> [i64; 2] {
    // An infinitely distant position saturates, and stays outside the picture.
    [px.x.floor() as i64, px.y.floor() as i64].map(|at| at.clamp(-1 << 32, 1 << 32))
}
