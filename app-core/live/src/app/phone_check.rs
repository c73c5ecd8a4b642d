//! The first phone: tests that need a person's eyes, as questions over the camera's picture that
//! are answered with yes or no.

use glam::{DMat4, DVec2, DVec3};

use super::App;
use super::ghost::seen_at;
use super::notice::Notice;
use super::table::table_at;
use app_scene::camera_frame::CameraFrame;
use app_scene::card::PATTERN_M;
use app_scene::scene::Camera;

/// The questions, in their order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PhoneQuestion {
    /// Arrows along the world's axes stand on the table and do not move.
    Axes,
    /// They do not move while the phone is turned about its line of sight.
    Turned,
    /// The outline of the printed pattern lies on its edge.
    Square,
    /// White is white, black is black, and neither is tinted.
    Greys,
    /// Colours are those of the phone's own camera app.
    Colours,
    /// The picture is upright, not stretched, not mirrored.
    Upright,
    /// A drawn line of ten centimetres has that length.
    Ruler,
    /// The delay from the camera to the screen is less than a tenth of a second.
    Delay,
    /// Exposure is held.
    Held,
    /// The app comes back from the background.
    Return,
}

impl PhoneQuestion {
    /// All questions.
    pub const ALL: [Self; 10] = [
        Self::Axes,
        Self::Turned,
        Self::Square,
        Self::Greys,
        Self::Colours,
        Self::Upright,
        Self::Ruler,
        Self::Delay,
        Self::Held,
        Self::Return,
    ];
}

/// The meaning of a line over the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CheckInk {
    /// +X of the world.
    X,
    /// +Y, which is up.
    Y,
    /// +Z.
    Z,
    /// A length or an outline.
    Measure,
}

/// Questions in progress.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PhoneCheck {
    n_answered: usize,
    n_yes: usize,
    /// A place on the table, found at the position [`PLACE`] of the picture.
    world_from_place: Option<DMat4>,
}

/// First position of arrows and ruler in the picture, as shares of its width and height: beside the
/// area that a sheet covers.
const PLACE: DVec2 = DVec2::new(0.35, 0.55);
/// Length of arrows and of the ruler, in metres.
const LENGTH_M: f64 = 0.1;
/// An arrow's head, as shares of the arrow's length along it and to either side.
const HEAD: [f64; 2] = [0.15, 0.06];
/// Number of marks of the ruler, and their length to either side, in metres; the first and the last
/// are longer.
const N_MARKS: u32 = 11;
const MARK_M: [f64; 2] = [0.002, 0.006];

impl PhoneCheck {
    fn question(&self) -> Option<PhoneQuestion> {
        PhoneQuestion::ALL.get(self.n_answered).copied()
    }

    pub(super) fn holds_exposure(&self) -> bool {
        self.question() == Some(PhoneQuestion::Held)
    }

    pub(super) fn shows_card(&self) -> bool {
        self.question() == Some(PhoneQuestion::Square)
    }

    /// The place belongs to another world.
    pub(super) fn forget_place(&mut self) {
        self.world_from_place = None;
    }
}

impl App {
    /// The present question, and its number, from 1 on; `None` if there is none.
    #[must_use]
    pub fn phone_question(&self) -> Option<(PhoneQuestion, usize)> {
        let check = self.phone_check.as_ref()?;
        Some((check.question()?, check.n_answered + 1))
    }

    /// Lines of the question, in pixels of the camera's picture; empty if there is no place for
    /// them yet.
    #[must_use]
    pub fn check_lines_px(&self) -> Vec<(CheckInk, [DVec2; 2])> {
        let (Some(check), Some(latest)) = (&self.phone_check, &self.latest) else {
            return Vec::new();
        };
        // Without the frame's pose the lines would be at wrong positions.
        let Some(camera) = latest.camera() else {
            return Vec::new();
        };
        let lines = match (check.question(), check.world_from_place, latest.world_from_card) {
            (Some(PhoneQuestion::Axes | PhoneQuestion::Turned), Some(place), _) => {
                arrows(place.w_axis.truncate())
            }
            (Some(PhoneQuestion::Ruler), Some(place), _) => ruler(&place),
            (Some(PhoneQuestion::Square), _, Some(card)) => square(&card),
            _ => Vec::new(),
        };
        let seen = lines
            .into_iter()
            .filter_map(|(ink, ends)| Some((ink, seen(&camera, ends)?)));
        seen.collect()
    }

    /// Begins with the first question, or ends.
    pub(super) fn check_phone(&mut self, is_on: bool) {
        self.phone_check = is_on.then(PhoneCheck::default);
    }

    /// Stores an answer and goes on to the next question.
    pub(super) fn answer(&mut self, is_yes: bool) {
        let Some(check) = &mut self.phone_check else {
            return;
        };
        let Some(question) = check.question() else { return };
        check.n_answered += 1;
        check.n_yes += usize::from(is_yes);
        let (n_yes, is_over) = (check.n_yes, check.question().is_none());
        self.note(&(question, is_yes));
        if is_over {
            self.phone_check = None;
            self.tell(Notice::PhoneChecked { n_yes });
        }
    }

    /// Finds the place of arrows and ruler, once.
    pub(super) fn place_check(&mut self, frame: &CameraFrame) {
        let (Some(check), Some(camera)) = (&mut self.phone_check, frame.camera()) else {
            return;
        };
        if check.world_from_place.is_some() {
            return;
        }
        let pixel = PLACE * DVec2::from(frame.image.size_px().map(f64::from));
        let table = self.table.clone().or_else(|| table_at(frame, &camera, pixel));
        check.world_from_place = table.and_then(|table| {
            let place_m = seen_at(&table.world_from_plane, &camera, pixel)?;
            Some(table.world_from_plane * DMat4::from_translation(DVec3::new(place_m.x, 0.0, place_m.y)))
        });
    }
}

type Line = (CheckInk, [DVec3; 2]);

/// Arrows along the axes of the world.
fn arrows(from: DVec3) -> Vec<Line> {
    let axes = [
        (CheckInk::X, DVec3::X, DVec3::Z),
        (CheckInk::Y, DVec3::Y, DVec3::X),
        (CheckInk::Z, DVec3::Z, DVec3::X),
    ];
    let arrow = |(ink, along, aside): (CheckInk, DVec3, DVec3)| {
        let tip = from + LENGTH_M * along;
        let barb = |side: f64| tip - LENGTH_M * (HEAD[0] * along + side * HEAD[1] * aside);
        [[from, tip], [barb(1.0), tip], [barb(-1.0), tip]].map(|ends| (ink, ends))
    };
    axes.into_iter().flat_map(arrow).collect()
}

/// A line on the table with a mark at each centimetre.
fn ruler(world_from_place: &DMat4) -> Vec<Line> {
    let at = |x: f64, z: f64| world_from_place.transform_point3(DVec3::new(x, 0.0, z));
    let half = 0.5 * LENGTH_M;
    let marks = (0..N_MARKS).map(|n| {
        let last = N_MARKS - 1;
        let x = LENGTH_M * f64::from(n) / f64::from(last) - half;
        let reach = MARK_M[usize::from(n == 0 || n == last)];
        [at(x, -reach), at(x, reach)]
    });
    let line = [at(-half, 0.0), at(half, 0.0)];
    let lines = std::iter::once(line).chain(marks);
    lines.map(|ends| (CheckInk::Measure, ends)).collect()
}

/// The edge of the card's pattern.
fn square(world_from_card: &DMat4) -> Vec<Line> {
    let half = 0.5 * PATTERN_M;
    let corners = [(-half, -half), (half, -half), (half, half), (-half, half)]
        .map(|(x, z)| world_from_card.transform_point3(DVec3::new(x, 0.0, z)));
    let edges = (0..4).map(|n| [corners[n], corners[(n + 1) % 4]]);
    edges.map(|ends| (CheckInk::Measure, ends)).collect()
}

/// A line of the world in pixels; `None` if an end is behind the camera.
fn seen(camera: &Camera, ends: [DVec3; 2]) -> Option<[DVec2; 2]> {
    let camera_from_world = camera.world_from_camera.inverse();
    let [from, to] = ends.map(|end| {
        camera
            .intrinsics
            .pixel_of(camera_from_world.transform_point3(end))
    });
    Some([from?, to?])
}
