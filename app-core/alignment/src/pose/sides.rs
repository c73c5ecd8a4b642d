//! Extrapolates the two sides of the outline across the band of pixels beside it.
//!
//! On either side a ratio is extrapolated: of the photograph to the shaded model inside the
//! outline, and to the plate outside.

use glam::IVec2;

use super::contour::Element;
use super::paint::Shaded;
use crate::picture::{Color, Level};
use crate::raster::Coverage;

/// Lower bound of linear light in ratios, for a plate or a paint that is black in a channel.
const FLOOR: f32 = 5e-4;
/// Number of samples on either side of the band, and distance of the first from it, in pixels.
const N_SAMPLES: i32 = 3;
const BEYOND_PX: f64 = 0.75;
/// Uncovered fraction of a pixel that shows the toy alone; also the covered fraction of one that
/// shows the background alone.
const ALONE: f32 = 0.001;

/// The surroundings of a picture's outline.
#[derive(Clone, Copy)]
pub(super) struct Beside<'a> {
    /// The photograph, with its plate.
    pub(super) level: &'a Level,
    /// Coverage by the toy in its estimated place.
    pub(super) coverage: &'a Coverage,
    /// Its predicted colours there; `None` if unknown, and its colours are then extrapolated
    /// directly.
    pub(super) shaded: Option<&'a Shaded<'a>>,
}

/// The extrapolated ratios at one piece of the outline.
#[derive(Clone, Copy)]
pub(super) struct Sides {
    /// The toy over the shaded model.
    pub(super) toy: Color,
    /// The shaded model at the rim.
    rim: Color,
    /// The background over the plate; without a plate the background itself.
    background: Color,
}

impl Sides {
    /// Means just inside and just outside of a band of half the given width, along the normal;
    /// `None` if one side is not visible alone.
    pub(super) fn new(beside: &Beside<'_>, element: &Element, half_px: f64) -> Option<Self> {
        let Beside { level, coverage, .. } = beside;
        let (mut toy, mut model) = (Mean::default(), Mean::default());
        let (mut background, mut plate) = (Mean::default(), Mean::default());
        let mut rim = None;
        for sample in 0..N_SAMPLES {
            let distance_px = half_px + BEYOND_PX + f64::from(sample);
            let inside = element.pixel(-distance_px);
            if coverage.at(inside) > 1.0 - ALONE {
                toy.add(level.frame.get(inside)?);
                let shaded = beside.model(inside)?;
                rim = rim.or(Some(shaded));
                model.add(shaded);
            }
            let outside = element.pixel(distance_px);
            if coverage.at(outside) < ALONE {
                background.add(level.frame.get(outside)?);
                plate.add(beside.plate(outside)?);
            }
        }
        let rim = beside.model(element.pixel(-1.0)).or(rim)?;
        Some(Self {
            toy: toy.over(&model)?,
            background: background.over(&plate)?,
            rim,
        })
    }

    /// Toy and background alone at a pixel; `None` if the plate is unknown.
    pub(super) fn at(&self, beside: &Beside<'_>, at: IVec2) -> Option<[Color; 2]> {
        let plate = beside.plate(at)?;
        let model = beside.model(at).unwrap_or(self.rim);
        Some([carried(self.toy, model), carried(self.background, plate)])
    }
}

/// The colour of one side with this ratio to what it is compared with.
pub(super) fn carried(ratio: Color, on: Color) -> Color {
    [0, 1, 2].map(|channel| (ratio[channel] * (on[channel] + FLOOR) - FLOOR).max(0.0))
}

impl Beside<'_> {
    fn plate(&self, at: IVec2) -> Option<Color> {
        match &self.level.plate {
            Some(plate) => plate.get(at),
            None => Some([1.0; 3]),
        }
    }

    fn model(&self, at: IVec2) -> Option<Color> {
        match self.shaded {
            Some(shaded) => shaded.at(at),
            None => Some([1.0; 3]),
        }
    }
}

#[derive(Clone, Copy, Default)]
struct Mean {
    sum: Color,
    n: f32,
}

impl Mean {
    fn add(&mut self, color: Color) {
        self.sum = [0, 1, 2].map(|channel| self.sum[channel] + color[channel]);
        self.n += 1.0;
    }

    /// `None` without samples.
    fn over(&self, other: &Self) -> Option<Color> {
        let floor = self.n * FLOOR;
        (self.n > 0.0)
            .then(|| [0, 1, 2].map(|channel| (self.sum[channel] + floor) / (other.sum[channel] + floor)))
    }
}
