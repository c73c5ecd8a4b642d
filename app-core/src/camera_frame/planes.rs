//! Planes of luma and chroma, as cameras of phones hand them over: strided, padded, interleaved either way.

use std::sync::{Arc, OnceLock};

use glam::Vec3;
use thiserror::Error;

use super::encoding::YcbcrEncoding;
use crate::scene::Image;

/// One component's bytes in a camera's buffer.
#[derive(Clone, Copy, Debug)]
pub struct Plane<'a> {
    /// From the component's first byte on; they may end with its last, in mid-row.
    pub bytes: &'a [u8],
    /// Bytes from one row to the next.
    pub row_stride: usize,
    /// Bytes from one sample of a row to the next: 2 where two components are interleaved.
    pub pixel_stride: usize,
}

/// A picture of luma and two chroma components of half its width and height, rounded up (4:2:0). A chroma sample lies
/// amid its four luma samples, as in JPEG.
#[derive(Clone, Copy, Debug)]
pub struct Planes<'a> {
    /// Width and height of the luma.
    pub size_px: [u32; 2],
    /// Luma, Y.
    pub luma: Plane<'a>,
    /// Blue difference, Cb.
    pub blue: Plane<'a>,
    /// Red difference, Cr.
    pub red: Plane<'a>,
    /// What the codes mean.
    pub encoding: YcbcrEncoding,
}

/// Planes that do not hold their picture.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum PlaneError {
    /// No pixel, or more than can be.
    #[error("camera planes: {} x {} px; 1 to 8192 of each are possible", size_px[0], size_px[1])]
    Size {
        /// Width and height.
        size_px: [u32; 2],
    },
    /// Rows or samples that overlap.
    #[error(
        "camera planes, {plane}: rows {row_stride} and samples {pixel_stride} bytes apart cannot hold {n_columns} samples a row"
    )]
    Stride {
        /// Which component.
        plane: &'static str,
        /// Bytes from row to row.
        row_stride: usize,
        /// Bytes from sample to sample.
        pixel_stride: usize,
        /// Samples in a row.
        n_columns: usize,
    },
    /// Bytes that end before the last sample.
    #[error("camera planes, {plane}: {n_bytes} bytes, {n_bytes_needed} are needed")]
    TooShort {
        /// Which component.
        plane: &'static str,
        /// As given.
        n_bytes: usize,
        /// Up to the last sample.
        n_bytes_needed: usize,
    },
}

/// Most pixels along a side.
const MAX_SIDE_PX: u32 = 8192;

impl<'a> Planes<'a> {
    /// Luma, then Cb and Cr by turns: iPhones' planes, and those of many Android phones.
    #[must_use]
    pub fn nv12(
        size_px: [u32; 2],
        (luma, luma_stride): (&'a [u8], usize),
        (chroma, chroma_stride): (&'a [u8], usize),
        encoding: YcbcrEncoding,
    ) -> Self {
        let [blue, red] = interleaved(chroma, chroma_stride);
        Self {
            size_px,
            luma: Plane::packed(luma, luma_stride),
            blue,
            red,
            encoding,
        }
    }

    /// Luma, then Cr and Cb by turns: the other Android phones'.
    #[must_use]
    pub fn nv21(
        size_px: [u32; 2],
        (luma, luma_stride): (&'a [u8], usize),
        (chroma, chroma_stride): (&'a [u8], usize),
        encoding: YcbcrEncoding,
    ) -> Self {
        let [red, blue] = interleaved(chroma, chroma_stride);
        Self {
            size_px,
            luma: Plane::packed(luma, luma_stride),
            blue,
            red,
            encoding,
        }
    }

    /// Three planes, each with its row stride: luma, Cb, Cr.
    #[must_use]
    pub fn i420(
        size_px: [u32; 2],
        luma: (&'a [u8], usize),
        blue: (&'a [u8], usize),
        red: (&'a [u8], usize),
        encoding: YcbcrEncoding,
    ) -> Self {
        let [luma, blue, red] = [luma, blue, red].map(|(bytes, stride)| Plane::packed(bytes, stride));
        Self {
            size_px,
            luma,
            blue,
            red,
            encoding,
        }
    }
}

fn interleaved(bytes: &[u8], row_stride: usize) -> [Plane<'_>; 2] {
    let from = |first| Plane {
        bytes: bytes.get(first..).unwrap_or_default(),
        row_stride,
        pixel_stride: 2,
    };
    [from(0), from(1)]
}

impl<'a> Plane<'a> {
    fn packed(bytes: &'a [u8], row_stride: usize) -> Self {
        Self {
            bytes,
            row_stride,
            pixel_stride: 1,
        }
    }

    /// Whether all samples are there.
    fn check(&self, plane: &'static str, [n_columns, n_rows]: [usize; 2]) -> Result<(), PlaneError> {
        let stride = PlaneError::Stride {
            plane,
            row_stride: self.row_stride,
            pixel_stride: self.pixel_stride,
            n_columns,
        };
        let in_row = (n_columns - 1).checked_mul(self.pixel_stride);
        let in_rows = (n_rows - 1).checked_mul(self.row_stride);
        let (Some(in_row), Some(in_rows)) = (in_row, in_rows) else {
            return Err(stride);
        };
        let rows_overlap = n_rows > 1 && self.row_stride <= in_row;
        if self.pixel_stride == 0 || rows_overlap {
            return Err(stride);
        }
        let n_bytes_needed = in_rows
            .checked_add(in_row)
            .and_then(|last| last.checked_add(1))
            .ok_or(stride)?;
        if self.bytes.len() < n_bytes_needed {
            return Err(PlaneError::TooShort {
                plane,
                n_bytes: self.bytes.len(),
                n_bytes_needed,
            });
        }
        Ok(())
    }

    /// Samples of a row, which `check` has found to be there.
    fn row(&self, row: usize, n_columns: usize) -> impl Iterator<Item = u8> + 'a {
        let from = self.bytes.get(row * self.row_stride..).unwrap_or_default();
        from.iter().step_by(self.pixel_stride).take(n_columns).copied()
    }
}

/// Planes without padding, the chroma as Cb and Cr by turns, as textures take them.
pub struct PlanarImage {
    size_px: [u32; 2],
    encoding: YcbcrEncoding,
    luma: Vec<u8>,
    chroma: Vec<u8>,
    /// Decoded, once somebody asks for it.
    rgba: OnceLock<Arc<Image>>,
}

impl PlanarImage {
    /// Copies `planes`, so that the camera's buffer may be given back.
    ///
    /// # Errors
    /// When they do not hold a picture of their size.
    pub fn new(planes: &Planes<'_>) -> Result<Self, PlaneError> {
        let size_px = planes.size_px;
        if size_px.iter().any(|side| !(1..=MAX_SIDE_PX).contains(side)) {
            return Err(PlaneError::Size { size_px });
        }
        let size = size_px.map(|side| side as usize);
        let half = half_size_px(size_px).map(|side| side as usize);
        planes.luma.check("luma", size)?;
        planes.blue.check("Cb", half)?;
        planes.red.check("Cr", half)?;
        let mut luma = Vec::with_capacity(size[0] * size[1]);
        for row in 0..size[1] {
            luma.extend(planes.luma.row(row, size[0]));
        }
        let mut chroma = Vec::with_capacity(2 * half[0] * half[1]);
        for row in 0..half[1] {
            let [blue, red] = [&planes.blue, &planes.red].map(|plane| plane.row(row, half[0]));
            chroma.extend(blue.zip(red).flat_map(|(blue, red)| [blue, red]));
        }
        Ok(Self {
            size_px,
            encoding: planes.encoding,
            luma,
            chroma,
            rgba: OnceLock::new(),
        })
    }

    /// Width and height.
    #[must_use]
    pub fn size_px(&self) -> [u32; 2] {
        self.size_px
    }

    /// What the codes mean.
    #[must_use]
    pub fn encoding(&self) -> YcbcrEncoding {
        self.encoding
    }

    /// Luma, row by row.
    #[must_use]
    pub fn luma(&self) -> &[u8] {
        &self.luma
    }

    /// Cb and Cr by turns, row by row, of half the size, rounded up.
    #[must_use]
    pub fn chroma(&self) -> &[u8] {
        &self.chroma
    }

    /// As sRGB codes with alpha 255: decoded at the first call, for whoever reads pixels on the processor.
    #[must_use]
    pub fn rgba(&self) -> &Arc<Image> {
        self.rgba.get_or_init(|| Arc::new(self.decode()))
    }

    fn decode(&self) -> Image {
        let srgb_from_ycbcr = self.encoding.srgb_from_ycbcr();
        let [width, height] = self.size_px;
        let mut rgba8 = Vec::with_capacity(4 * self.luma.len());
        let mut at = self.luma.iter();
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

    /// Chroma in codes at a pixel, bilinear between the four samples around it, and that of the edge beyond it.
    fn chroma_at(&self, pixel: [u32; 2]) -> [f32; 2] {
        let [columns, rows] = half_size_px(self.size_px);
        let [across, down] = [(pixel[0], columns), (pixel[1], rows)].map(|(at, n)| neighbours(at, n));
        let mut sum = [0.0; 2];
        for (row, row_weight) in down {
            for (column, weight) in across {
                let first = 2 * (row as usize * columns as usize + column as usize);
                for (sum, offset) in sum.iter_mut().zip(0..) {
                    let sample = self.chroma.get(first + offset).copied().unwrap_or_default();
                    *sum += row_weight * weight * f32::from(sample);
                }
            }
        }
        sum
    }
}

/// The chroma sample that a luma sample is of, with three quarters, and that on its other side.
fn neighbours(luma: u32, n: u32) -> [(u32, f32); 2] {
    let own = luma / 2;
    let other = if luma.is_multiple_of(2) {
        own.saturating_sub(1)
    } else {
        (own + 1).min(n - 1)
    };
    [(own, 0.75), (other, 0.25)]
}

/// Size of the chroma of a picture.
pub(crate) fn half_size_px(size_px: [u32; 2]) -> [u32; 2] {
    size_px.map(|side| side.div_ceil(2))
}

#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "from 0 to 255"
)]
fn code(srgb: f32) -> u8 {
    (255.0 * srgb).round() as u8
}
