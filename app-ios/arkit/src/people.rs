//! The mask of the people in a frame of ARKit, and its conversion.

use app_core::people::People;
use glam::UVec2;

use crate::map::{ONE_BYTE, RawMap};

/// The mask of `ARFrame.segmentationBuffer`, 255 on a person and 0 elsewhere, without the padding of
/// its rows; `None` if the buffer is not of the documented format.
#[must_use]
pub fn people(raw: &RawMap<'_>) -> Option<People> {
    let codes: Vec<u8> = raw.rows::<1>(ONE_BYTE)?.map(|[code]| code).collect();
    let [width, height] = raw.size_px.map(u32::try_from);
    People::new(UVec2::new(width.ok()?, height.ok()?), codes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::RawPlane;

    const RAW: RawMap<'static> = RawMap {
        pixel_format: ONE_BYTE,
        size_px: [2, 2],
        plane: RawPlane {
            bytes: &[0, 255, 9, 255, 0, 9],
            row_stride: 3,
        },
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
            RawMap { pixel_format: 0, ..RAW },
            RawMap { size_px: [4, 2], ..RAW },
            RawMap { size_px: [0, 2], ..RAW },
            RawMap { size_px: [2, 0], ..RAW },
            RawMap { size_px: [2, 3], ..RAW },
            RawMap { size_px: [2, usize::MAX], ..RAW },
        ];
        for wrong in wrong {
            assert!(people(&wrong).is_none(), "{wrong:?}");
        }
    }
}
