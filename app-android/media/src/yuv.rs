//! Pictures in the layouts of Android's video encoders: YCbCr by BT.709, video range, chroma at
//! half the size.

/// The layout of a picture's samples for an encoder, in bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    /// Columns and rows, both even.
    pub size_px: [usize; 2],
    /// Distance between rows of luma.
    pub stride: usize,
    /// Number of rows of luma, including padding.
    pub slice_height: usize,
    /// Whether Cb and Cr are interleaved in one plane (NV12), or in two planes (I420).
    pub is_interleaved: bool,
}

/// By Rec. ITU-R BT.709-6, table 3.
const KR: f32 = 0.2126;
const KB: f32 = 0.0722;

impl Layout {
    /// Number of bytes of a picture.
    #[must_use]
    pub fn n_bytes(&self) -> usize {
        let [columns, rows] = self.size_px;
        let chroma_rows = rows / 2;
        // The last row ends with its samples, as encoders count.
        let chroma = if self.is_interleaved {
            (chroma_rows - 1) * self.stride + columns
        } else {
            (self.slice_height / 2 + chroma_rows - 1) * (self.stride / 2) + columns / 2
        };
        self.stride * self.slice_height + chroma
    }

    /// Positions of Cb and Cr of a block of two by two pixels.
    fn chroma_at(&self, column: usize, row: usize) -> [usize; 2] {
        let begin = self.stride * self.slice_height;
        if self.is_interleaved {
            let cb = begin + row * self.stride + 2 * column;
            return [cb, cb + 1];
        }
        let plane = self.stride / 2 * (self.slice_height / 2);
        let cb = begin + row * (self.stride / 2) + column;
        [cb, cb + plane]
    }

    /// Writes a picture of `row_px` columns, red, green, blue and alpha; pixels beyond the layout's
    /// size are left out. Returns false if either buffer is too short.
    pub fn fill(&self, rgba: &[u8], row_px: usize, bytes: &mut [u8]) -> bool {
        let [columns, rows] = self.size_px;
        if bytes.len() < self.n_bytes() || row_px < columns || rgba.len() < 4 * row_px * rows {
            return false;
        }
        for (y, row) in rgba.chunks_exact(4 * row_px).take(rows).enumerate() {
            let luma = &mut bytes[y * self.stride..][..columns];
            for (luma, pixel) in luma.iter_mut().zip(row.chunks_exact(4)) {
                *luma = code(16.0 + 219.0 / 255.0 * luma_of(rgb(pixel)));
            }
        }
        for y in 0..rows / 2 {
            let two = &rgba[8 * row_px * y..][..8 * row_px];
            let (upper, lower) = two.split_at(4 * row_px);
            for x in 0..columns / 2 {
                let block = [&upper[8 * x..][..8], &lower[8 * x..][..8]];
                let [cb, cr] = self.chroma_at(x, y);
                [bytes[cb], bytes[cr]] = chroma_of(block);
            }
        }
        true
    }
}

fn rgb(pixel: &[u8]) -> [f32; 3] {
    [pixel[0], pixel[1], pixel[2]].map(f32::from)
}

fn luma_of([r, g, b]: [f32; 3]) -> f32 {
    KR * r + (1.0 - KR - KB) * g + KB * b
}

/// Cb and Cr of the mean of four pixels, two in each row.
fn chroma_of(rows: [&[u8]; 2]) -> [u8; 2] {
    let mut mean = [0.0; 3];
    for pixel in rows.into_iter().flat_map(|row| row.chunks_exact(4)) {
        for (mean, code) in mean.iter_mut().zip(rgb(pixel)) {
            *mean += code / 4.0;
        }
    }
    let luma = luma_of(mean);
    let [cb, cr] = [(mean[2], KB), (mean[0], KR)].map(|(colour, k)| (colour - luma) / (2.0 * (1.0 - k)));
    [cb, cr].map(|chroma| code(128.0 + 224.0 / 255.0 * chroma))
}

#[allow(clippy::cast_possible_truncation, reason = "the conversion saturates")]
fn code(value: f32) -> u8 {
    value.round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Codes of the primaries in BT.709's video range, as in any table of test signals at full
    /// amplitude.
    const KNOWN: [([u8; 3], [u8; 3]); 6] = [
        ([255, 255, 255], [235, 128, 128]),
        ([0, 0, 0], [16, 128, 128]),
        ([255, 0, 0], [63, 102, 240]),
        ([0, 255, 0], [173, 42, 26]),
        ([0, 0, 255], [32, 240, 118]),
        ([255, 255, 0], [219, 16, 138]),
    ];

    #[test]
    fn primaries_have_their_known_codes() {
        for (rgb, [y, cb, cr]) in KNOWN {
            let layout = Layout {
                size_px: [2, 2],
                stride: 2,
                slice_height: 2,
                is_interleaved: true,
            };
            let mut bytes = [0; 6];
            let pixel = [rgb[0], rgb[1], rgb[2], 255];
            assert!(layout.fill(&pixel.repeat(4), 2, &mut bytes));
            assert_eq!(bytes, [y, y, y, y, cb, cr], "{rgb:?}");
        }
    }

    #[test]
    fn samples_lie_where_the_encoder_looks_for_them() {
        // Four columns, the last two of which are left out, and rows that are black but for the
        // last two, which are red.
        let mut rgba = [0, 0, 0, 255].repeat(4 * 2);
        rgba.extend([255, 0, 0, 255].repeat(4 * 2));
        let layout = Layout {
            size_px: [2, 4],
            stride: 6,
            slice_height: 5,
            is_interleaved: true,
        };
        let mut bytes = vec![7; layout.n_bytes()];
        assert_eq!(bytes.len(), 30 + 6 + 2);
        assert!(layout.fill(&rgba, 4, &mut bytes));
        assert_eq!(
            (&bytes[..3], &bytes[18..21]),
            (&[16, 16, 7][..], &[63, 63, 7][..])
        );
        assert_eq!(
            (&bytes[30..33], &bytes[36..]),
            (&[128, 128, 7][..], &[102, 240][..])
        );
        let planar = Layout {
            slice_height: 6,
            is_interleaved: false,
            ..layout
        };
        let mut bytes = vec![7; planar.n_bytes()];
        assert_eq!(bytes.len(), 36 + 9 + 3 + 1);
        assert!(planar.fill(&rgba, 4, &mut bytes));
        assert_eq!([bytes[36], bytes[39], bytes[45], bytes[48]], [128, 102, 128, 240]);
        assert!(!planar.fill(&rgba, 4, &mut bytes[1..]), "too short a buffer");
        assert!(!planar.fill(&rgba[1..], 4, &mut bytes), "too short a picture");
    }
}
