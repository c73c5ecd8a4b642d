//! The depths of an ARKit frame in plain numbers, and their conversion.

use app_core::depth::{Depth, millimetres};
use glam::UVec2;

use crate::map::{ONE_BYTE, RawMap};

/// The constant `kCVPixelFormatType_DepthFloat32`.
const METRES: u32 = u32::from_be_bytes(*b"fdep");
/// `ARConfidenceLevel` from which on a depth counts: medium.
const LEAST_CONFIDENCE: u8 = 1;

/// The content of `ARDepthData`, unchanged.
#[derive(Clone, Copy, Debug)]
pub struct RawDepth<'a> {
    /// Metres along the view.
    pub metres: RawMap<'a>,
    /// `ARConfidenceLevel` of each pixel, if it is known.
    pub confidence: Option<RawMap<'a>>,
}

/// The depths, without those of low confidence; `None` if the buffers are not of the documented
/// formats and of one size.
#[must_use]
pub fn depth(raw: &RawDepth<'_>) -> Option<Depth> {
    let size_px = raw.metres.size_px;
    let metres = raw.metres.rows::<4>(METRES)?;
    let metres = metres.map(f32::from_ne_bytes);
    let depths_mm: Vec<u16> = match &raw.confidence {
        Some(map) if map.size_px != size_px => return None,
        Some(map) => {
            let confidences = map.rows::<1>(ONE_BYTE)?;
            let trusted = metres.zip(confidences);
            trusted
                .map(|(metres, [confidence])| {
                    if confidence < LEAST_CONFIDENCE {
                        0
                    } else {
                        millimetres(metres)
                    }
                })
                .collect()
        }
        None => metres.map(millimetres).collect(),
    };
    let [width, height] = size_px.map(u32::try_from);
    Depth::new(UVec2::new(width.ok()?, height.ok()?), depths_mm)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::RawPlane;

    fn bytes(metres: &[f32]) -> Vec<u8> {
        metres.iter().flat_map(|metres| metres.to_ne_bytes()).collect()
    }

    fn map(pixel_format: u32, bytes: &[u8], row_stride: usize) -> RawMap<'_> {
        RawMap {
            pixel_format,
            size_px: [2, 2],
            plane: RawPlane { bytes, row_stride },
        }
    }

    #[test]
    fn depths_are_millimetres_without_padding_and_without_low_confidence() {
        // A padding of one pixel.
        let metres = bytes(&[0.3, 0.4004, 9.0, 0.5, 0.6, 9.0]);
        let raw = RawDepth {
            metres: map(METRES, &metres, 12),
            confidence: None,
        };
        let all = depth(&raw).expect("depths");
        assert_eq!(
            (all.size_px().to_array(), all.depths_mm()),
            ([2, 2], &[300, 400, 500, 600][..])
        );
        let trusted = RawDepth {
            confidence: Some(map(ONE_BYTE, &[2, 0, 9, 1, 2], 3)),
            ..raw
        };
        assert_eq!(depth(&trusted).expect("depths").depths_mm(), [300, 0, 500, 600]);
    }

    #[test]
    fn numbers_that_are_no_depths_are_unknown() {
        let metres = bytes(&[f32::NAN, -1.0, f32::INFINITY, 70.0]);
        let raw = RawDepth {
            metres: map(METRES, &metres, 8),
            confidence: None,
        };
        assert_eq!(depth(&raw).expect("depths").depths_mm(), [0; 4]);
    }

    #[test]
    fn buffers_of_another_form_are_refused() {
        let metres = bytes(&[0.3; 4]);
        let good = map(METRES, &metres, 8);
        let other_size = RawMap {
            size_px: [1, 4],
            ..map(ONE_BYTE, &[2; 4], 1)
        };
        let wrong = [
            (map(ONE_BYTE, &metres, 8), None),
            (map(METRES, &metres[..12], 8), None),
            (map(METRES, &metres, 7), None),
            (map(METRES, &[], 0), None),
            (
                RawMap {
                    size_px: [usize::MAX, 2],
                    ..good
                },
                None,
            ),
            (
                RawMap {
                    size_px: [0, 0],
                    ..good
                },
                None,
            ),
            (good, Some(map(METRES, &metres, 8))),
            (good, Some(other_size)),
        ];
        for (metres, confidence) in wrong {
            let raw = RawDepth { metres, confidence };
            assert!(depth(&raw).is_none(), "{raw:?}");
        }
        assert!(
            depth(&RawDepth {
                metres: good,
                confidence: None
            })
            .is_some()
        );
    }
}
