//! Other things in a picture: things on the table, and things in front of the toy.

use std::sync::Arc;

use glam::{DMat4, DVec3, DVec4, UVec2};

use crate::scene::Camera;

/// The content of a pixel in place of a receiver or the toy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mark {
    /// No thing: a receiver or the toy.
    #[default]
    None,
    /// A thing: the camera's pixel stays, and the toy is drawn over it.
    Thing,
    /// A thing in front of the toy: the camera's pixel stays, the toy is drawn behind it, but for what is before its
    /// fronts, and no colour of the toy is taken from it.
    BeforeToy,
    /// A receiver whose plate shows something else; it is treated as not photographed there.
    WrongPlate,
    /// The same where the toy hides the receiver, whose pattern is known: the plate in a light that
    /// gives it the pattern's colours. They count as an estimate.
    CompletedPlate {
        /// Square root of the light relative to the plate, of 255 for [`MOST_COMPLETED`], for each
        /// channel.
        light: [u8; 3],
    },
    /// A receiver whose plate shows it in a shadow that the picture does not have.
    ShadedPlate {
        /// Light that remains in the plate, of 255, for each channel; 0 counts as 1.
        left: [u8; 3],
    },
    /// A part of a thing that the toy hides. The plate shows it, in another light.
    HiddenThing {
        /// Light relative to the plate, of 255, for each channel.
        light: [u8; 3],
    },
    /// A part of a thing that the toy hides, and that no plate shows: the plate in a light that gives
    /// it the thing's colours.
    PaintedThing {
        /// Square root of the light relative to the plate, of 255 for [`MOST_PAINTED`], for each
        /// channel.
        light: [u8; 3],
    },
}

/// Largest light of a painted thing, relative to the plate: that of skin over a dark slate. Codes of its square
/// root leave 1.6 % of a light of 1 undetermined, a code and a half.
pub const MOST_PAINTED: f32 = 16.0;

/// Largest light of a completed plate, relative to the plate: that of a white tile over a black shoe. Codes
/// leave 3 % of a light of 1 undetermined, two codes and a half.
pub const MOST_COMPLETED: f32 = 64.0;

/// Step of the heights of raised points, in metres.
pub const HEIGHT_STEP_M: f32 = 1e-5;

/// A point of a thing above the first receiver, on which the toy's shadow may fall.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RaisedPoint {
    /// In steps; 0 for no such point.
    height: u16,
    /// Of 255.
    of_lights: u8,
}

impl RaisedPoint {
    /// A point at a height in metres and the lights' share of its light in the plate, from 0 to 1.
    /// No point if it is higher than .655 m, the highest code.
    #[must_use]
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to the codes; 0 for NaN"
    )]
    pub fn new(height_m: f64, of_lights: f32) -> Self {
        let height = (height_m / f64::from(HEIGHT_STEP_M)).round();
        if height > f64::from(u16::MAX) {
            return Self::default();
        }
        Self {
            height: height.max(0.0) as u16,
            of_lights: (255.0 * of_lights).round().clamp(0.0, 255.0) as u8,
        }
    }

    /// Height in steps of [`HEIGHT_STEP_M`]; 0 for no such point.
    #[must_use]
    pub fn height(self) -> u16 {
        self.height
    }

    /// The lights' share of its light in the plate, of 255.
    #[must_use]
    pub fn of_lights(self) -> u8 {
        self.of_lights
    }
}

impl Mark {
    /// A receiver whose plate has this share of its light, for each channel.
    #[must_use]
    pub fn shaded_plate(left: [f32; 3]) -> Self {
        Self::ShadedPlate {
            left: left.map(code_of),
        }
    }

    /// A thing that the toy hides, in this share of the plate's light, for each channel.
    #[must_use]
    pub fn hidden_thing(light: [f32; 3]) -> Self {
        Self::HiddenThing {
            light: light.map(code_of),
        }
    }

    /// A thing that neither the picture nor its plate shows, in this light relative to the plate, for each
    /// channel; `None` if it is more than the plate can be given, or unknown.
    #[must_use]
    pub fn painted_thing(light: [f32; 3]) -> Option<Self> {
        let is_possible = light.iter().all(|light| (0.0..=MOST_PAINTED).contains(light));
        let light = light.map(|light| code_of((light / MOST_PAINTED).sqrt()));
        is_possible.then_some(Self::PaintedThing { light })
    }

    /// A receiver whose plate is wrong, in this light relative to the plate, for each channel, or in the
    /// most that a mark can give it; `None` if it is unknown.
    #[must_use]
    pub fn completed_plate(light: [f32; 3]) -> Option<Self> {
        let is_known = light.iter().all(|light| *light >= 0.0);
        let light = light.map(|light| code_of((light / MOST_COMPLETED).sqrt()));
        is_known.then_some(Self::CompletedPlate { light })
    }

    /// Whether the mark has the light of a thing that the toy hides.
    #[must_use]
    pub fn is_behind_toy(self) -> bool {
        matches!(self, Self::HiddenThing { .. } | Self::PaintedThing { .. })
    }

    /// Index in the counts; `None` for no mark.
    fn kind(self) -> Option<usize> {
        match self {
            Self::None => None,
            Self::Thing | Self::HiddenThing { .. } | Self::PaintedThing { .. } => Some(0),
            Self::BeforeToy => Some(1),
            Self::WrongPlate | Self::CompletedPlate { .. } => Some(2),
            Self::ShadedPlate { .. } => Some(3),
        }
    }
}

/// Code of a share; 1 at least.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "clamped to the codes; 0 for NaN"
)]
fn code_of(share: f32) -> u8 {
    (255.0 * share).round().clamp(1.0, 255.0) as u8
}

/// Largest number of planes behind which things before the toy are.
pub const MAX_FRONTS: usize = 2;

/// A plane that parts a space in two, of which the side with positive distances is the near one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Front {
    /// Unit normal and distance of the origin, in metres.
    plane: DVec4,
}

impl Front {
    /// The plane at a point, with a normal to the near side; `None` if that has no direction.
    #[must_use]
    pub fn at(point: DVec3, to_near_side: DVec3) -> Option<Self> {
        let normal = to_near_side.try_normalize()?;
        let plane = normal.extend(-normal.dot(point));
        plane.is_finite().then_some(Self { plane })
    }

    /// The same plane in another space of the same scale.
    #[must_use]
    pub fn in_space(&self, here_from_there: &DMat4) -> Self {
        Self {
            plane: here_from_there.transpose() * self.plane,
        }
    }

    /// Distance of a point in metres, negative on the far side.
    #[must_use]
    pub fn distance_m(&self, point: DVec3) -> f64 {
        self.plane.dot(point.extend(1.0))
    }

    /// Normal and distance of the origin, in metres.
    #[must_use]
    pub fn plane(&self) -> DVec4 {
        self.plane
    }
}

/// Marks on the pixels of a picture.
#[derive(Clone, Debug)]
pub struct Things {
    size_px: UVec2,
    marks: Arc<[Mark]>,
    /// Number of pixels with each mark except `None`.
    counts: [u32; 4],
    /// The camera that took the picture.
    camera: Camera,
    /// The point of a thing at each pixel; empty if none is known.
    raised: Arc<Vec<RaisedPoint>>,
    /// Where things before the toy end.
    fronts: Vec<Front>,
}

impl Things {
    /// Marks of a picture's pixels, rows from the top; `None` if their number is wrong.
    #[must_use]
    pub fn new(size_px: UVec2, marks: impl Into<Arc<[Mark]>>, camera: Camera) -> Option<Self> {
        let marks = marks.into();
        let n_pixels = u64::from(size_px.x) * u64::from(size_px.y);
        let counts = counts(&marks);
        (marks.len() as u64 == n_pixels).then_some(Self {
            size_px,
            marks,
            counts,
            camera,
            raised: Arc::default(),
            fronts: Vec::new(),
        })
    }

    /// With planes in the world behind which all things before the toy are, such as the height of a hand on the table,
    /// or the side and the height of a post: parts of the toy on a near side are drawn over them. The first
    /// [`MAX_FRONTS`] count.
    #[must_use]
    pub fn with_fronts(self, mut fronts: Vec<Front>) -> Self {
        fronts.truncate(MAX_FRONTS);
        Self { fronts, ..self }
    }

    /// The planes in the world behind which all things before the toy are; empty if they are unknown: then the toy
    /// is drawn behind them.
    #[must_use]
    pub fn fronts(&self) -> &[Front] {
        &self.fronts
    }

    /// With the points of things at the picture's pixels, rows from the top: new shadows fall on
    /// them; `None` if their number is wrong.
    #[must_use]
    pub fn with_raised(self, raised: Vec<RaisedPoint>) -> Option<Self> {
        let raised = Arc::new(raised);
        (raised.len() == self.marks.len()).then_some(Self { raised, ..self })
    }

    /// The point of a thing at a pixel of this index; none without any.
    #[must_use]
    pub fn raised(&self, index: usize) -> RaisedPoint {
        self.raised.get(index).copied().unwrap_or_default()
    }

    /// Whether the points of things are known.
    #[must_use]
    pub fn has_raised(&self) -> bool {
        !self.raised.is_empty()
    }

    /// Width and height of the picture in pixels.
    #[must_use]
    pub fn size_px(&self) -> UVec2 {
        self.size_px
    }

    /// The mark of each pixel, rows from the top.
    #[must_use]
    pub fn marks(&self) -> &[Mark] {
        &self.marks
    }

    /// Some of the marks alone, without points.
    #[must_use]
    pub fn only(&self, is_kept: impl Fn(Mark) -> bool) -> Self {
        let kept = |mark: &Mark| if is_kept(*mark) { *mark } else { Mark::None };
        let marks: Vec<Mark> = self.marks.iter().map(kept).collect();
        Self {
            counts: counts(&marks),
            marks: marks.into(),
            raised: Arc::default(),
            fronts: self.fronts.clone(),
            ..*self
        }
    }

    /// The camera that took the picture.
    #[must_use]
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Whether both share their memory, and so mark the same picture, and their things are as near.
    #[must_use]
    pub fn is(&self, other: &Self) -> bool {
        let are_shared = Arc::ptr_eq(&self.marks, &other.marks) && Arc::ptr_eq(&self.raised, &other.raised);
        are_shared && self.fronts == other.fronts
    }

    /// Whether both have equal contents.
    #[must_use]
    pub fn is_like(&self, other: &Self) -> bool {
        let are_equal = self.marks == other.marks && self.raised == other.raised;
        are_equal && self.camera == other.camera && self.fronts == other.fronts
    }

    /// Whether there is any mark.
    #[must_use]
    pub fn has_any(&self) -> bool {
        self.counts != [0; 4]
    }

    /// Number of pixels with a mark of this kind, in any light.
    #[must_use]
    pub fn count(&self, mark: Mark) -> usize {
        match mark.kind() {
            None => self.marks.iter().filter(|mark| mark.kind().is_none()).count(),
            Some(kind) => self.counts[kind] as usize,
        }
    }

    /// Number of pixels whose plate shows something that the picture does not.
    #[must_use]
    pub fn n_in_plate_alone(&self) -> usize {
        (self.counts[2] + self.counts[3]) as usize
    }

    /// Whether any pixel's plate needs another light.
    #[must_use]
    pub fn has_light(&self) -> bool {
        let has_light = |mark: &Mark| mark.is_behind_toy() || matches!(mark, Mark::CompletedPlate { .. });
        self.counts[3] > 0 || self.marks.iter().any(has_light)
    }
}

/// Number of marks of each kind.
fn counts(marks: &[Mark]) -> [u32; 4] {
    [0, 1, 2, 3].map(|kind| {
        let of_kind = marks.iter().filter(|mark| mark.kind() == Some(kind));
        u32::try_from(of_kind.count()).unwrap_or(u32::MAX)
    })
}
