//! The things of a level, and the marks that follow from them.

use glam::{DVec2, IVec2};

use super::grown::Grown;
use super::known::Known;
use super::planes::FoundPlane;
use super::seeds::Colored;
use super::shade::Brightness;
use crate::lights::Compared;
use crate::picture::{Color, Mask, places};
use app_scene::things::{Mark, Things};

/// Things in a level.
pub(super) struct Found<'a> {
    /// Planes of things, if they are wanted.
    pub(super) planes: Vec<FoundPlane>,
    /// Things that plate and frame show.
    pub(super) grown: Option<Grown>,
    /// For each, whether it is before the toy.
    pub(super) before: Vec<Known>,
    /// For each, whether it is a thing although it is not before the toy.
    pub(super) alone: Vec<Known>,
    /// For each pixel, whether it is in a thing, but shows a receiver that is not part of it.
    pub(super) on_planes: Vec<bool>,
    /// The wrong part of the plate.
    pub(super) wrong: Option<Mask>,
    /// The light in the plate, if a shadow lies on it that the frame does not show.
    pub(super) in_plate: Option<&'a Brightness>,
    /// The light on the parts of things that the toy hides.
    pub(super) on_things: Option<Brightness>,
    /// Things that the frame alone shows, such as a hand.
    pub(super) in_frame: Option<InFrame>,
    /// The comparison of the level's pixels.
    pub(super) compared: &'a [Compared],
    /// The colours of the things that plate and frame show.
    pub(super) colored: Colored,
}

impl Found<'_> {
    /// Whether nothing is marked, and no plane is found.
    pub(super) fn is_empty(&self) -> bool {
        let in_frame = self.in_frame.iter().flat_map(|found| &found.marks);
        self.planes.is_empty()
            && self.grown.is_none()
            && self.wrong.is_none()
            && self.in_plate.is_none()
            && in_frame.into_iter().all(|mark| *mark == Mark::None)
    }

    fn is_before(&self, thing: usize) -> bool {
        self.before[thing] == Known::Marked
    }

    /// The state of each pixel of the level.
    pub(super) fn known(&self, size_px: IVec2) -> Vec<Known> {
        let known = |at: IVec2| {
            let in_plate = self.grown.as_ref().and_then(|grown| grown.of_pixel(at));
            let in_plate = in_plate.map(|thing| self.before[thing].max(self.alone[thing]));
            let in_frame = self.in_frame.as_ref();
            let in_frame = in_frame.and_then(|found| Some(found.known[found.grown.of_pixel(at)?]));
            in_plate.max(in_frame).unwrap_or_default()
        };
        places(size_px).map(known).collect()
    }

    /// The mark at a place in pixels of the level, for things in the plate.
    pub(super) fn at(&self, place: DVec2) -> Mark {
        let thing = self
            .grown
            .as_ref()
            .and_then(|grown| Some((grown, grown.at(place)?)));
        let is_on_plane = thing.is_some_and(|(grown, _)| {
            grown
                .index(place)
                .is_some_and(|index| self.on_planes.get(index).is_some_and(|is_on| *is_on))
        });
        match thing {
            Some(_) if is_on_plane => self.in_plate_at(place),
            Some((grown, thing)) if self.is_before(thing) && !grown.is_like_place(place) => Mark::BeforeToy,
            Some((_, thing)) if self.is_before(thing) || self.alone[thing] == Known::Marked => {
                self.behind_toy_at(place).unwrap_or(Mark::Thing)
            }
            _ => self.in_plate_at(place),
        }
    }

    /// Whether a place in pixels of the level is in a thing before the toy, without its shadow.
    pub(super) fn is_before_at(&self, place: DVec2) -> bool {
        let is_before = |grown: &Grown| {
            let thing = grown.at(place).filter(|_| !grown.is_shadow(place));
            thing.is_some_and(|thing| self.is_before(thing))
        };
        self.grown.as_ref().is_some_and(is_before)
    }

    /// The thing that plate and frame show at a place in pixels of the level, with its shadow.
    pub(super) fn thing_at(&self, place: DVec2) -> Option<usize> {
        self.grown.as_ref()?.at(place)
    }

    /// The same without its shadow.
    pub(super) fn body_at(&self, place: DVec2) -> Option<usize> {
        self.grown.as_ref()?.body_at(place, self.colored)
    }

    /// Whether a colour in codes is that of things in the plate.
    pub(super) fn is_own_color(&self, color: Color) -> bool {
        self.grown.as_ref().is_some_and(|grown| grown.is_own_color(color))
    }

    /// Whether a colour in codes is that of the place, not of things in the plate.
    pub(super) fn is_place_color(&self, color: Color) -> bool {
        self.grown
            .as_ref()
            .is_some_and(|grown| grown.is_place_color(color))
    }

    /// The same for a part of a thing that the toy hides; `None` if it does not, or if the light
    /// there is unknown.
    fn behind_toy_at(&self, place: DVec2) -> Option<Mark> {
        self.on_things.as_ref()?.at(place).map(Mark::hidden_thing)
    }

    /// The same for what the plate alone shows.
    fn in_plate_at(&self, place: DVec2) -> Mark {
        let wrong = self.wrong.as_ref();
        if wrong.is_some_and(|wrong| wrong.has(place.floor().as_ivec2())) {
            return Mark::WrongPlate;
        }
        let left = self.in_plate.and_then(|light| light.missing_at(place));
        left.map_or(Mark::None, Mark::shaded_plate)
    }

    /// Whether a colour in codes is that of things in the frame alone.
    pub(super) fn is_own_color_in_frame(&self, color: Color) -> bool {
        self.in_frame
            .as_ref()
            .is_some_and(|found| found.grown.is_own_color(color))
    }

    /// The same for things in the frame alone.
    pub(super) fn in_frame_at(&self, place: DVec2) -> Mark {
        let in_frame = self.in_frame.as_ref();
        let thing = in_frame.and_then(|in_frame| Some(in_frame.marks[in_frame.grown.at(place)?]));
        thing.unwrap_or_default()
    }
}

/// Things that the frame alone shows.
pub(super) struct InFrame {
    pub(super) grown: Grown,
    /// The mark of each thing: before the toy, beside it, or no mark.
    pub(super) marks: Vec<Mark>,
    pub(super) known: Vec<Known>,
}

/// Adopts the things of the next picture. Equal marks stay identical, so that nothing is learned
/// again.
pub(crate) fn adopt(known: &mut Option<Things>, now: Option<Things>) {
    let is_same = |known: &Things| now.as_ref().is_some_and(|now| now.is_like(known));
    if !known.as_ref().is_some_and(is_same) {
        *known = now;
    }
}
