//! The bytes of a pixel buffer in plain numbers.

/// The constant `kCVPixelFormatType_OneComponent8`.
pub(crate) const ONE_BYTE: u32 = u32::from_be_bytes(*b"L008");

/// A plane of a pixel buffer, while it is locked.
#[derive(Clone, Copy, Debug)]
pub struct RawPlane<'a> {
    /// The bytes of all rows.
    pub bytes: &'a [u8],
    /// Bytes per row.
    pub row_stride: usize,
}

/// A pixel buffer that is not planar, while it is locked.
#[derive(Clone, Copy, Debug)]
pub struct RawMap<'a> {
    /// `OSType` of the pixel buffer.
    pub pixel_format: u32,
    /// Width and height.
    pub size_px: [usize; 2],
    /// Its pixels.
    pub plane: RawPlane<'a>,
}

impl<'a> RawMap<'a> {
    /// The pixels of `N` bytes, row by row without padding; `None` if the buffer has another format
    /// or fewer bytes.
    pub(crate) fn rows<const N: usize>(
        &self,
        pixel_format: u32,
    ) -> Option<impl Iterator<Item = [u8; N]> + use<'a, N>> {
        let RawPlane { bytes, row_stride } = self.plane;
        let [width, height] = self.size_px;
        let n_row_bytes = width.checked_mul(N)?;
        let n_bytes = row_stride
            .checked_mul(height.checked_sub(1)?)?
            .checked_add(n_row_bytes)?;
        let fits = self.pixel_format == pixel_format
            && n_row_bytes > 0
            && n_row_bytes <= row_stride
            && n_bytes <= bytes.len();
        let rows = bytes.chunks(row_stride.max(1)).take(height);
        fits.then(|| rows.flat_map(move |row| row[..n_row_bytes].as_chunks::<N>().0.iter().copied()))
    }
}
