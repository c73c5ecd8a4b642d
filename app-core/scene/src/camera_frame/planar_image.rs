//! A picture as planes of luma and chroma: its own, or lent by the platform.

use std::any::Any;
use std::sync::{Arc, OnceLock};

use glam::Vec3;

use super::encoding::YcbcrEncoding;
use super::planes::{PlaneError, Planes, check_size, half_size_px};
use crate::scene::Image;

/// Planes without padding, with interleaved Cb and Cr, in the layout of textures.
pub struct PlanarImage {
    size_px: [u32; 2],
    encoding: YcbcrEncoding,
    /// Luma and chroma; for a lent picture, copied on demand.
    bytes: OnceLock<[Vec<u8>; 2]>,
    lent: Option<Box<dyn LentPlanes>>,
    /// The decoded picture, made on demand.
    rgba: OnceLock<Arc<Image>>,
}

/// Planes in the platform's memory: passes read them in place.
///
/// They keep the platform's buffer, which is copied only for callers that read pixels on the
/// processor, as an alignment does about once a second.
pub trait LentPlanes: Any + Send + Sync {
    /// Copies the planes; `None` if the platform does not permit reading them.
    fn read(&self) -> Option<PlanarImage>;
}

impl PlanarImage {
    /// Copies `planes`, so that the camera's buffer can be returned.
    ///
    /// # Errors
    /// When they do not hold a picture of their size.
    pub fn new(planes: &Planes<'_>) -> Result<Self, PlaneError> {
        Ok(Self {
            size_px: planes.size_px,
            encoding: planes.encoding,
            bytes: OnceLock::from(planes.packed()?),
            lent: None,
            rgba: OnceLock::new(),
        })
    }

    /// A picture in the platform's memory.
    ///
    /// # Errors
    /// When the size is invalid.
    pub fn lent(
        size_px: [u32; 2],
        encoding: YcbcrEncoding,
        lent: impl LentPlanes,
    ) -> Result<Self, PlaneError> {
        check_size(size_px)?;
        Ok(Self {
            size_px,
            encoding,
            bytes: OnceLock::new(),
            lent: Some(Box::new(lent)),
            rgba: OnceLock::new(),
        })
    }

    /// Width and height.
    #[must_use]
    pub fn size_px(&self) -> [u32; 2] {
        self.size_px
    }

    /// The colour encoding.
    #[must_use]
    pub fn encoding(&self) -> YcbcrEncoding {
        self.encoding
    }

    /// Luma, row by row.
    #[must_use]
    pub fn luma(&self) -> &[u8] {
        &self.bytes()[0]
    }

    /// Cb and Cr interleaved, row by row, of half the size, rounded up.
    #[must_use]
    pub fn chroma(&self) -> &[u8] {
        &self.bytes()[1]
    }

    /// The platform's planes, if they are lent and of this type.
    #[must_use]
    pub fn lent_as<T: LentPlanes>(&self) -> Option<&T> {
        let lent: &dyn Any = &**self.lent.as_ref()?;
        lent.downcast_ref()
    }

    /// A copy, if the planes are lent.
    pub(super) fn kept(&self) -> Option<Self> {
        self.lent.as_ref().map(|_| Self {
            size_px: self.size_px,
            encoding: self.encoding,
            bytes: OnceLock::from(self.bytes().clone()),
            lent: None,
            rgba: self.rgba.clone(),
        })
    }

    /// The picture as sRGB codes with alpha 255: decoded at the first call, for callers that read
    /// pixels on the processor.
    #[must_use]
    pub fn rgba(&self) -> &Arc<Image> {
        self.rgba.get_or_init(|| Arc::new(self.decode()))
    }

    /// Luma and chroma. Unreadable planes, or planes of another size, are black: nothing is found
    /// in them.
    fn bytes(&self) -> &[Vec<u8>; 2] {
        self.bytes.get_or_init(|| {
            let read = self.lent.as_ref().and_then(|lent| lent.read());
            let same = read.filter(|read| read.size_px == self.size_px);
            let bytes = same.and_then(|read| read.bytes.into_inner());
            bytes.unwrap_or_else(|| {
                let n_pixels = |[columns, rows]: [u32; 2]| columns as usize * rows as usize;
                let n_chroma = 2 * n_pixels(half_size_px(self.size_px));
                [vec![0; n_pixels(self.size_px)], vec![128; n_chroma]]
            })
        })
    }

    fn decode(&self) -> Image {
        let srgb_from_ycbcr = self.encoding.srgb_from_ycbcr();
        let [width, height] = self.size_px;
        let mut rgba8 = Vec::with_capacity(4 * self.luma().len());
        let mut at = self.luma().iter();
        for y in 0..height {
            for x in 0..width {
                let luma = f32::from(at.next().copied().unwrap_or_default());
                let [blue, red] = self.chroma_at([x, y]);
                let srgb = srgb_from_ycbcr.decode(Vec3::new(luma, blue, red) / 255.0);
                rgba8.extend(srgb.to_array().map(code));
                rgba8.push(255);
            }
        }
        Image {
            width_px: width,
            height_px: height,
            rgba8,
        }
    }

    /// Chroma in codes at a pixel, bilinear between the four samples around it, and clamped at the
    /// edge.
    fn chroma_at(&self, pixel: [u32; 2]) -> [f32; 2] {
        let [columns, rows] = half_size_px(self.size_px);
        let [across, down] = [(pixel[0], columns), (pixel[1], rows)].map(|(at, n)| neighbours(at, n));
        let mut sum = [0.0; 2];
        for (row, row_weight) in down {
            for (column, weight) in across {
                let first = 2 * (row as usize * columns as usize + column as usize);
                for (sum, offset) in sum.iter_mut().zip(0..) {
                    let sample = self.chroma().get(first + offset).copied().unwrap_or_default();
                    *sum += row_weight * weight * f32::from(sample);
                }
            }
        }
        sum
    }
}

/// The two chroma samples next to a luma sample: its own with weight three quarters, and its
/// neighbour.
fn neighbours(luma: u32, n: u32) -> [(u32, f32); 2] {
    let own = luma / 2;
    let other = if luma.is_multiple_of(2) {
        own.saturating_sub(1)
    } else {
        (own + 1).min(n - 1)
    };
    [(own, 0.75), (other, 0.25)]
}

#[allow(clippy::cast_possible_truncation, reason = "from 0 to 255")]
fn code(srgb: f32) -> u8 {
    (255.0 * srgb).round() as u8
}
