//! Receiver pixels beside the toy, from which the shadow is read.

use glam::{DVec3, IVec2};

use super::background::{Background, QUADRATIC, polynomial};
use crate::picture::{Color, Level, noise_deviation, places};
use crate::raster::Coverage;
use crate::receivers::{SeenReceiver, receiver_at};

/// Margin around the toy, in which pixels may be mixed with it, and its growth with the blur of the
/// photograph.
const CLEAR_PX: i32 = 2;
const CLEAR_OF_BLUR: f64 = 1.5;
/// Error of the light model, over the plate.
const UNEXPLAINED: f32 = 0.02;
/// Linear light of the codes 4 and 250, the range of reliable pixels.
const DARKEST: f32 = 0.0012;
const BRIGHTEST: f32 = 0.956;

/// A pixel of a receiver.
#[derive(Clone, Copy, Debug)]
pub(super) struct ReceiverPixel {
    /// Position, in pixels of the level.
    pub(super) at: IVec2,
    /// Index of the receiver.
    pub(super) receiver: usize,
    /// The receiver's point there, in camera space.
    pub(super) point: DVec3,
    /// Terms of the gain there, a polynomial over the plane; 1 and zeros for a constant gain.
    pub(super) gain: [f32; QUADRATIC],
    /// Colour of the photograph.
    pub(super) frame: Color,
    /// Colour of the plate.
    pub(super) plate: Color,
    /// One over the expected variance of each channel; 0 for an unreliable one.
    pub(super) precision: Color,
}

impl ReceiverPixel {
    /// One whose colours nobody asks for, of the only receiver.
    pub(super) fn bare(at: IVec2, point: DVec3) -> Self {
        Self {
            at,
            receiver: 0,
            point,
            gain: [0.0; QUADRATIC],
            frame: [0.0; 3],
            plate: [0.0; 3],
            precision: [0.0; 3],
        }
    }

    /// Whether all channels of it say something.
    pub(super) fn has_evidence(&self) -> bool {
        self.precision.iter().all(|precision| *precision > 0.0)
    }
}

/// Receiver pixels clear of the toy, row by row; without a plate, compared with the background
/// model. `around` is the toy's centre in camera space, and the unit of length for the gain's
/// terms, in metres.
pub(super) fn receiver_pixels(
    level: &Level,
    (coverage, background): (&Coverage, Option<&Background<QUADRATIC>>),
    receivers: &[SeenReceiver],
    around: (DVec3, f64),
    is_wanted: impl Fn(IVec2) -> bool,
) -> Vec<ReceiverPixel> {
    // A single receiver has no interreflection, and a plate shows its texture.
    let is_even = receivers.len() == 1 && level.plate.is_some();
    let n_terms = if is_even { 1 } else { QUADRATIC };
    #[allow(clippy::cast_possible_truncation, reason = "some pixels")]
    let clear_px = CLEAR_PX + (CLEAR_OF_BLUR * level.softened_px).round() as i32;
    let clear = places(level.frame.size_px).filter(|at| is_wanted(*at) && !coverage.is_near(*at, clear_px));
    let pixels = clear.filter_map(|at| {
        let (receiver, point) = receiver_at(receivers, &level.intrinsics, at)?;
        let frame = level.frame.get(at)?;
        let (plate, texture) = match (&level.plate, background) {
            (Some(plate), _) => (plate.get(at)?, 0.0),
            (None, background) => background?.at(receivers, receiver, point)?,
        };
        let unexplained = UNEXPLAINED.hypot(texture);
        let precision = [0, 1, 2].map(|channel| precision(frame[channel], plate[channel], unexplained));
        let terms = polynomial(&receivers[receiver], point, around);
        #[allow(clippy::cast_possible_truncation, reason = "a place, to 7 digits")]
        let gain = std::array::from_fn(|term| if term < n_terms { terms[term] as f32 } else { 0.0 });
        Some(ReceiverPixel {
            at,
            receiver,
            point,
            gain,
            frame,
            plate,
            precision,
        })
    });
    pixels.collect()
}

fn precision(frame: f32, plate: f32, unexplained: f32) -> f32 {
    let is_useful = |value: f32| value > DARKEST && value < BRIGHTEST;
    if is_useful(frame) && is_useful(plate) {
        let deviation = noise_deviation(frame).hypot(unexplained * plate);
        1.0 / (deviation * deviation)
    } else {
        0.0
    }
}
