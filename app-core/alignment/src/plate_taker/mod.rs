//! The plate, taken by hand: which pictures of the empty place are good enough, and their mean.

mod reduced;
mod registration;
mod stack;

use glam::DQuat;

use app_scene::camera_frame::CameraImage;
use app_scene::scene::{Camera, Plate, check};
use reduced::Reduced;
use registration::{Registration, register};
use stack::Stack;

/// Pictures that are averaged: noise is a quarter.
const N_PICTURES: u32 = 16;
/// Time between two of them at least, so that what moves slowly has time to be seen: some .9 s in all.
const BETWEEN_S: f64 = 0.06;
/// After so long the best is taken that there is.
const PATIENCE_S: f64 = 5.0;
/// Movement up to which a picture is of the same view.
const STILL_PX: f64 = 0.4;
/// The same by poses, which carry their tracker's noise: more than that is none.
const STILL_M: f64 = 0.01;
const STILL_RAD: f64 = 0.026;
/// Movement from one picture to the next up to which things in the way are told from it.
const COMPARABLE_PX: f64 = 12.0;
/// Detail over the most that was seen, below which a picture is blurred.
const SHARP: f32 = 0.6;
/// Detail over noise, below which a place has none.
const DETAILED: f32 = 1.0;
/// Time in which the most detail seen counts for a third of itself only: another view may have less.
const DETAIL_LASTS_S: f64 = 5.0;
/// Change of exposure between pictures of one mean.
const SAME_GAIN: f64 = 0.02;
/// Part of a picture's tiles that something in the way covers at least.
const SOMETHING: f64 = 0.002;
/// Part of them that no hand covers: then the camera has moved.
const EVERYTHING: f64 = 0.5;
/// Time after which a place that has changed and stays so is taken to be as it is now.
const STAYS_S: f64 = 1.5;

/// A camera's picture that may become part of a plate.
#[derive(Clone, Debug)]
pub struct PlateShot {
    /// The picture.
    pub image: CameraImage,
    /// The camera that took it; none where it is not tracked.
    pub camera: Option<Camera>,
    /// Seconds since the shot before.
    pub elapsed_s: f64,
}

/// What became of a shot.
#[derive(Clone, Debug)]
pub enum PlateStep {
    /// It adds nothing to what was begun.
    Refused(PlateRefusal),
    /// The plate grows.
    Growing {
        /// Pictures in it.
        n: u32,
        /// Pictures that it is to have.
        n_needed: u32,
    },
    /// It is there, and the next shot begins another.
    Taken {
        /// The mean of `n` pictures.
        plate: Plate,
        /// At least one: fewer than were to be, where the camera was not held still for long.
        n: u32,
    },
}

/// Why a shot is of no use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlateRefusal {
    /// Its picture is smaller than 8 pixels a side, or its bytes are not those of its size.
    NoPicture,
    /// Its camera is not tracked, or its numbers are out of range.
    NoCamera,
    /// The camera has moved: the view that was begun is left.
    Moving,
    /// It is less sharp than others were: out of focus, or moved while it was exposed.
    Blurred,
    /// Something moves in it, such as a hand.
    Obstructed,
    /// The camera changes its exposure: what was begun is left.
    Exposure,
}

/// Takes a plate from the shots of a camera that somebody holds.
///
/// Shots that show the same view to a fraction of a pixel, as sharp as any, with nothing moving in them, are averaged in
/// linear light; noise goes down by the root of their number. Where the camera is not held still for so long, what there
/// is by then is taken: the most pictures of one view, or the sharpest one.
///
/// What is judged is a picture of some 160 squares along its longer side, held against the shot before and against the
/// first of the view.
/// Measured by `tests/tests/estimates/plate_taker.rs` in codes of 8 bit: a picture whose noise is 3.01 comes out with 0.81, what the
/// sixteenth part of its variance and the rounding to codes add up to; after a hand has crossed it with 0.80, no pixel more
/// than 4.1 off.
///
/// Not told: a hand that rests in the picture without any movement from the first shot on; something that covers less
/// than half of a tile of four squares, 48 pixels of 1920; and whether the camera moves over a place without any texture,
/// where it does no harm.
#[derive(Clone, Debug, Default)]
pub struct PlateTaker {
    before: Option<(Reduced, Camera)>,
    stack: Option<Stack>,
    /// The best so far of other views.
    kept: Option<Stack>,
    most_detail: f32,
    /// In which there was something to take, and only movement or blur kept it from growing.
    waited_s: f64,
    since_added_s: f64,
    /// How long something has been in the way.
    obstructed_s: f64,
}

impl PlateTaker {
    /// Judges a shot and goes on by it.
    pub fn offer(&mut self, shot: &PlateShot) -> PlateStep {
        let elapsed_s = if shot.elapsed_s.is_finite() {
            shot.elapsed_s.max(0.0)
        } else {
            0.0
        };
        let Some(reduced) = checked(&shot.image) else {
            return PlateStep::Refused(PlateRefusal::NoPicture);
        };
        let Some(camera) = shot.camera.filter(|camera| check::camera("", camera).is_ok()) else {
            return PlateStep::Refused(PlateRefusal::NoCamera);
        };
        let is_of_size = |(before, _): &(Reduced, Camera)| before.size_px == reduced.size_px;
        if !self.before.as_ref().is_some_and(is_of_size) {
            // Whether anything moves in it is told by the next.
            *self = Self {
                most_detail: reduced.detail,
                before: Some((reduced, camera)),
                ..Self::default()
            };
            return growing(0);
        }
        self.since_added_s += elapsed_s;
        #[allow(clippy::cast_possible_truncation, reason = "from 0 to 1")]
        let lasting = (-elapsed_s / DETAIL_LASTS_S).exp() as f32;
        self.most_detail = reduced.detail.max(self.most_detail * lasting);
        let use_of = self.judge(&reduced, &camera, elapsed_s);
        let waits = matches!(
            use_of,
            UseOf::Another | UseOf::Anew(_) | UseOf::Not(PlateRefusal::Moving | PlateRefusal::Blurred)
        );
        if waits && (self.stack.is_some() || self.kept.is_some()) {
            self.waited_s += elapsed_s;
        }
        let refusal = match use_of {
            UseOf::Not(refusal) => Some(refusal),
            UseOf::Anew(refusal) => {
                self.keep();
                self.stack = Some(Stack::new(shot.image.clone(), reduced.clone(), &camera));
                self.obstructed_s = 0.0;
                self.since_added_s = 0.0;
                refusal
            }
            UseOf::Another => {
                self.add(shot, &camera);
                None
            }
        };
        self.before = Some((reduced, camera));
        self.outcome(refusal)
    }

    /// What a shot can be used for.
    fn judge(&mut self, reduced: &Reduced, camera: &Camera, elapsed_s: f64) -> UseOf {
        let has_detail = |detail: f32| detail > DETAILED * reduced.noise;
        if has_detail(self.most_detail) && reduced.detail < SHARP * self.most_detail {
            return UseOf::Not(PlateRefusal::Blurred);
        }
        let step = self
            .before
            .as_ref()
            .and_then(|(before, of_before)| judged([before, reduced], [of_before, camera], COMPARABLE_PX));
        if let Some(refusal) = step {
            return UseOf::Not(refusal);
        }
        let Some(stack) = &self.stack else {
            return UseOf::Anew(None);
        };
        match judged([&stack.reduced, reduced], [&stack.camera, camera], STILL_PX) {
            Some(PlateRefusal::Obstructed) => {
                self.obstructed_s += elapsed_s;
                if self.obstructed_s < STAYS_S {
                    return UseOf::Not(PlateRefusal::Obstructed);
                }
                // It does not move any more: so it was in the way before, and is not now.
                self.stack = None;
                UseOf::Anew(None)
            }
            // Another view or exposure begins here.
            Some(refusal) => UseOf::Anew(Some(refusal)),
            None if has_detail(reduced.detail) && reduced.detail * SHARP > stack.reduced.detail => {
                // What there is was out of focus.
                self.stack = None;
                UseOf::Anew(None)
            }
            None => {
                self.obstructed_s = 0.0;
                UseOf::Another
            }
        }
    }

    fn add(&mut self, shot: &PlateShot, camera: &Camera) {
        if let Some(stack) = &mut self.stack
            && self.since_added_s >= BETWEEN_S
        {
            stack.add(&shot.image, camera);
            self.since_added_s = 0.0;
        }
    }

    /// Ends the view, and keeps it where it is better than the one that is kept.
    fn keep(&mut self) {
        let Some(stack) = self.stack.take() else { return };
        let value = |stack: &Stack| (stack.n, stack.reduced.detail);
        if self.kept.as_ref().is_none_or(|kept| value(kept) < value(&stack)) {
            self.kept = Some(stack);
        }
    }

    fn outcome(&mut self, refusal: Option<PlateRefusal>) -> PlateStep {
        let n = self.stack.as_ref().map_or(0, |stack| stack.n);
        if n >= N_PICTURES || self.waited_s >= PATIENCE_S {
            self.keep();
            if let Some(stack) = self.kept.take() {
                *self = Self::default();
                return PlateStep::Taken {
                    plate: stack.plate(),
                    n: stack.n,
                };
            }
        }
        refusal.map_or(growing(n), PlateStep::Refused)
    }
}

/// What a shot is used for.
#[derive(Clone, Copy, Debug)]
enum UseOf {
    Not(PlateRefusal),
    /// One more of its view.
    Another,
    /// The first of another view, for a reason.
    Anew(Option<PlateRefusal>),
}

fn growing(n: u32) -> PlateStep {
    PlateStep::Growing {
        n,
        n_needed: N_PICTURES,
    }
}

/// Made small, where there is a picture at all.
fn checked(image: &CameraImage) -> Option<Reduced> {
    image.is_of_size(image.size_px()).then(|| Reduced::new(image))?
}

/// Why one shot does not show what the other shows; none where it does, to so many pixels of movement.
fn judged(shots: [&Reduced; 2], cameras: [&Camera; 2], most_px: f64) -> Option<PlateRefusal> {
    if !is_near(cameras) {
        return Some(PlateRefusal::Moving);
    }
    let Some(Registration {
        moved_px,
        gain,
        changed,
    }) = register(shots[0], shots[1])
    else {
        return Some(PlateRefusal::Moving);
    };
    if moved_px > most_px || changed > EVERYTHING {
        Some(PlateRefusal::Moving)
    } else if changed > SOMETHING {
        Some(PlateRefusal::Obstructed)
    } else if (gain - 1.0).abs() > SAME_GAIN {
        Some(PlateRefusal::Exposure)
    } else {
        None
    }
}

/// Whether poses are as near to each other as those of one camera that stands still, by a tracker that is noisy.
fn is_near(cameras: [&Camera; 2]) -> bool {
    let [one, other] = cameras.map(|camera| camera.world_from_camera);
    let rotations = [one, other].map(|pose| DQuat::from_mat4(&pose).normalize());
    let moved_m = one.w_axis.truncate().distance(other.w_axis.truncate());
    moved_m < STILL_M && rotations[0].angle_between(rotations[1]) < STILL_RAD
}
