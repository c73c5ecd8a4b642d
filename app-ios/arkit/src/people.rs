//! The mask of the people in a frame of ARKit, in plain numbers, and its conversion.

use app_core::people::People;
use glam::UVec2;

/// The constant `kCVPixelFormatType_OneComponent8`.
const ONE_BYTE: u32 = u32::from_be_bytes(*b"L008");

/// A pixel buffer of `ARFrame.segmentationBuffer`, while it is locked: 255 on a person, 0 elsewhere.
#[derive(Clone, Copy, Debug)]
pub struct RawMask<'a> {
    /// `OSType` of the pixel buffer.
    pub pixel_format: u32,
    /// Width and height.
    pub size_px: [usize; 2],
    /// The bytes of all rows.
    pub bytes: &'a [u8],
    /// Bytes per row.
    pub row_stride: usize,
}

/// The mask without the padding of its rows; `None` if it makes no sense.
#[must_use]
pub fn people(raw: &RawMask<'_>) -> Option<People> {
    let [width, height] = raw.size_px;
    let is_whole =
        width > 0 && width <= raw.row_stride && raw.row_stride.checked_mul(height)? <= raw.bytes.len();
    if raw.pixel_format != ONE_BYTE || !is_whole {
        return None;
    }
    let rows = raw.bytes.chunks_exact(raw.row_stride).take(height);
    let codes: Vec<u8> = rows.flat_map(|row| &row[..width]).copied().collect();
    let size_px = UVec2::new(width.try_into().ok()?, height.try_into().ok()?);
    People::new(size_px, codes)
}

#[cfg(test)]
mod tests {
    use super::*;

    const RAW: RawMask<'static> = RawMask {
        pixel_format: ONE_BYTE,
        size_px: [2, 2],
        bytes: &[0, 255, 9, 255, 0, 9],
        row_stride: 3,
    };

    #[test]
    fn a_mask_loses_the_padding_of_its_rows() {
        let people = people(&RAW).expect("a mask");
        assert_eq!(
            (people.size_px(), people.codes()),
            (UVec2::new(2, 2), &[0, 255, 255, 0][..])
        );
    }

    #[test]
    fn a_mask_that_makes_no_sense_is_left_out() {
        #[rustfmt::skip] // Each case has a line of its own.
        let wrong = [
            RawMask { pixel_format: 0, ..RAW },
            RawMask { size_px: [4, 2], ..RAW },
            RawMask { size_px: [0, 2], ..RAW },
            RawMask { size_px: [2, 0], ..RAW },
            RawMask { size_px: [2, 3], ..RAW },
            RawMask { size_px: [2, usize::MAX], ..RAW },
        ];
        for wrong in wrong {
            assert!(people(&wrong).is_none(), "{wrong:?}");
        }
    }
}
