//! The things in a picture, and the warnings about them.

use super::Stage;
use super::footprint::Footprint;
use crate::frame::warning::{Thing, Warning};
use crate::geometry::displacement::is_same_view;
use crate::geometry::view::View;
use crate::gpu::Gpu;
use crate::passes::thing_marks::Things;
use crate::preset::Settings;
use app_scene::frame::FrameInput;
use app_scene::things::{Front, Mark, Things as GivenThings};

impl Stage {
    /// Sets the things of a picture, unless they are the same; the baseline ignores things.
    pub(super) fn take_things(&mut self, gpu: &Gpu, input: &FrameInput) {
        let given = input.things.as_ref();
        let given = given.filter(|things| matches!(self.settings, Settings::Model(_)) && things.has_any());
        let is_known = are_same(self.things.as_ref().map(Things::given), given);
        if !is_known {
            self.things = given.map(|given| Things::new(gpu, given));
        }
    }

    /// Whether shadows fall on things in a view: it must be that of their picture and of a plate,
    /// since both are transferred by a receiver's plane, which the things are not on.
    pub(super) fn has_raised_things(&self, footprint: &Footprint) -> bool {
        let things = self.things.as_ref().filter(|things| things.has_raised());
        things.is_some_and(|things| {
            let of_marks = View::new(self.size_px(), things.given().camera());
            let views = [&of_marks, &footprint.view];
            footprint.choice.is_same_view && is_same_view(views, &footprint.corners_in_world)
        })
    }

    /// The planes in anchor space before which the toy is drawn over the things before it, if the toy reaches there:
    /// nothing tells how near people are, and only from the near side is a point on that side nearer.
    pub(super) fn things_fronts(&self, footprint: &Footprint) -> Vec<Front> {
        let things = self.things.as_ref().filter(|_| self.people.marks().is_none());
        let things = things
            .map(Things::given)
            .filter(|things| things.count(Mark::BeforeToy) > 0);
        let fronts = things.map_or(&[][..], GivenThings::fronts);
        if fronts.is_empty() {
            return Vec::new();
        }
        let world_from_anchor = self.layout().world_from_anchor();
        let camera = footprint.view.camera_in(&world_from_anchor);
        let is_near = |front: &Front| {
            let mut toy = footprint.bounds.corners();
            front.distance_m(camera) > 0.0 && toy.any(|corner| front.distance_m(corner) > 0.0)
        };
        let in_anchor = fronts.iter().map(|front| front.in_space(&world_from_anchor));
        in_anchor.filter(is_near).collect()
    }

    /// Warnings about things beside the toy in the pictures.
    pub(super) fn thing_warnings(&self) -> impl Iterator<Item = Warning> {
        let things = self.things.as_ref();
        let reported = [
            (Mark::Thing, Thing::OnReceiver),
            (Mark::BeforeToy, Thing::BeforeToy),
            (Mark::WrongPlate, Thing::InPlateAlone),
        ];
        let all = things.into_iter().chain(self.people.marks());
        let count = move |mark| {
            let counts = all.clone().map(|things| things.given().count(mark));
            counts.sum::<usize>()
        };
        let n_in_plate = things.map_or(0, |things| things.given().n_in_plate_alone());
        // A thing before the toy mostly comes with a shadow.
        let is_reported = move |mark: Mark| match mark {
            Mark::Thing => count(mark) > count(Mark::BeforeToy),
            Mark::WrongPlate => n_in_plate > 0,
            _ => count(mark) > 0,
        };
        let reported = reported.into_iter().filter(move |(mark, _)| is_reported(*mark));
        reported.map(|(_, thing)| Warning::Thing(thing))
    }
}

/// Whether both mark the same pictures, or neither any.
pub(super) fn are_same(known: Option<&GivenThings>, given: Option<&GivenThings>) -> bool {
    match (known, given) {
        (None, None) => true,
        (Some(known), Some(given)) => known.is(given),
        _ => false,
    }
}
