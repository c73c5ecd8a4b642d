//! Planes of luma and chroma as phones' cameras deliver them: strided, padded, interleaved in
//! either order.

use thiserror::Error;

use super::encoding::YcbcrEncoding;

/// One component's bytes in a camera's buffer.
#[derive(Clone, Copy, Debug)]
pub struct Plane<'a> {
    /// Bytes from the component's first on; they may end with its last, within a row.
    pub bytes: &'a [u8],
    /// Bytes from one row to the next.
    pub row_stride: usize,
    /// Bytes from one sample of a row to the next: 2 if two components are interleaved.
    pub pixel_stride: usize,
}

/// A picture of luma and two chroma components of half its width and height, rounded up (4:2:0). A
/// chroma sample lies in the centre of its four luma samples, as in JPEG.
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
    /// The colour encoding.
    pub encoding: YcbcrEncoding,
}

/// Invalid planes.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum PlaneError {
    /// The size is zero or above the limit.
    #[error("camera planes: {} x {} px; 1 to 8192 of each are possible", size_px[0], size_px[1])]
    Size {
        /// Width and height.
        size_px: [u32; 2],
    },
    /// Rows or samples overlap.
    #[error(
        "camera planes, {plane}: rows {row_stride} and samples {pixel_stride} bytes apart cannot hold {n_columns} samples a row"
    )]
    Stride {
        /// Name of the component.
        plane: &'static str,
        /// Bytes from row to row.
        row_stride: usize,
        /// Bytes from sample to sample.
        pixel_stride: usize,
        /// Samples in a row.
        n_columns: usize,
    },
    /// The bytes end before the last sample.
    #[error("camera planes, {plane}: {n_bytes} bytes, {n_bytes_needed} are needed")]
    TooShort {
        /// Name of the component.
        plane: &'static str,
        /// Number of bytes.
        n_bytes: usize,
        /// Number of bytes up to the last sample.
        n_bytes_needed: usize,
    },
}

/// Largest number of pixels along a side.
const MAX_SIDE_PX: u32 = 8192;

/// Refuses an invalid size.
pub(super) fn check_size(size_px: [u32; 2]) -> Result<(), PlaneError> {
    if size_px.iter().all(|side| (1..=MAX_SIDE_PX).contains(side)) {
        Ok(())
    } else {
        Err(PlaneError::Size { size_px })
    }
}

/// Size of the chroma of a picture.
#[must_use]
pub fn half_size_px(size_px: [u32; 2]) -> [u32; 2] {
    size_px.map(|side| side.div_ceil(2))
}

impl<'a> Planes<'a> {
    /// Luma, and interleaved Cb and Cr, row by row without padding.
    pub(super) fn packed(&self) -> Result<[Vec<u8>; 2], PlaneError> {
        check_size(self.size_px)?;
        let size = self.size_px.map(|side| side as usize);
        let half = half_size_px(self.size_px).map(|side| side as usize);
        self.luma.check("luma", size)?;
        self.blue.check("Cb", half)?;
        self.red.check("Cr", half)?;
        let mut luma = Vec::with_capacity(size[0] * size[1]);
        for row in 0..size[1] {
            luma.extend(self.luma.row(row, size[0]));
        }
        let mut chroma = Vec::with_capacity(2 * half[0] * half[1]);
        for row in 0..half[1] {
            let [blue, red] = [&self.blue, &self.red].map(|plane| plane.row(row, half[0]));
            chroma.extend(blue.zip(red).flat_map(|(blue, red)| [blue, red]));
        }
        Ok([luma, chroma])
    }

    /// Luma, then interleaved Cb and Cr: the planes of iPhones, and of many Android phones.
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

    /// Luma, then interleaved Cr and Cb: the planes of other Android phones.
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

    /// Whether the bytes reach to the last sample.
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

    /// Samples of a row; `check` has succeeded before.
    fn row(&self, row: usize, n_columns: usize) -> impl Iterator<Item = u8> + 'a {
        let from = self.bytes.get(row * self.row_stride..).unwrap_or_default();
        from.iter().step_by(self.pixel_stride).take(n_columns).copied()
    }
}
