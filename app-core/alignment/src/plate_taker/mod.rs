//! Takes a plate with a hand-held camera: selects good pictures of the empty place, and averages
//! them.

mod reduced;
mod registration;
mod stack;

use glam::DQuat;

use app_scene::camera_frame::CameraImage;
use app_scene::scene::{Camera, Plate, check};
use reduced::Reduced;
use registration::{Registration, register};
use stack::Stack;

/// Number of averaged pictures: noise becomes a quarter.
const N_PICTURES: u32 = 16;
/// Smallest time between two of them, so that slow motion becomes visible: some .9 s in total.
const BETWEEN_S: f64 = 0.06;
/// Give up waiting after this time, and use the best pictures so far.
const PATIENCE_S: f64 = 5.0;
/// Largest movement within one view.
const STILL_PX: f64 = 0.4;
/// The same by poses, with their tracker's noise.
const STILL_M: f64 = 0.01;
const STILL_RAD: f64 = 0.026;
/// Largest movement between pictures for which things in the way can be distinguished from it.
const COMPARABLE_PX: f64 = 12.0;
/// Detail over the highest so far, below which a picture is blurred.
const SHARP: f32 = 0.6;
/// Detail over noise below which a place has no texture.
const DETAILED: f32 = 1.0;
/// Time in which the highest detail decays to a third: another view may have less.
const DETAIL_LASTS_S: f64 = 5.0;
/// Change of exposure between pictures of one mean.
const SAME_GAIN: f64 = 0.02;
/// Smallest fraction of a picture's tiles that an obstacle covers.
const SOMETHING: f64 = 0.002;
/// Largest fraction that a hand covers; above, the camera has moved.
const EVERYTHING: f64 = 0.5;
/// Time after which a changed place counts as permanent.
const STAYS_S: f64 = 1.5;

/// A camera's picture that may become part of a plate.
#[derive(Clone, Debug)]
pub struct PlateShot {
    /// The picture.
    pub image: CameraImage,
    /// The camera of the picture; `None` if it is not tracked.
    pub camera: Option<Camera>,
    /// Seconds since the shot before.
    pub elapsed_s: f64,
}

/// The result for a shot.
#[derive(Clone, Debug)]
pub enum PlateStep {
    /// The shot adds nothing to the current plate.
    Refused(PlateRefusal),
    /// The plate grows.
    Growing {
        /// Number of pictures in it.
        n: u32,
        /// Number of pictures that it needs.
        n_needed: u32,
    },
    /// The plate is complete, and the next shot begins another.
    Taken {
        /// The mean of `n` pictures.
        plate: Plate,
        /// At least one: fewer than needed if the camera was not held still for long.
        n: u32,
    },
}

/// The reason why a shot is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlateRefusal {
    /// Its picture is smaller than 8 pixels per side, or its bytes do not fit its size.
    NoPicture,
    /// Its camera is not tracked, or its numbers are out of range.
    NoCamera,
    /// The camera has moved: the current view is abandoned.
    Moving,
    /// It is less sharp than others were: out of focus, or with motion blur.
    Blurred,
    /// Something moves in it, for example a hand.
    Obstructed,
    /// The camera changes its exposure: the current plate is abandoned.
    Exposure,
}

/// Takes a plate from the shots of a hand-held camera.
///
/// Shots of the same view to a fraction of a pixel, of full sharpness, without movement in them,
/// are averaged in linear light; noise falls with the root of their number. If the camera is not
/// held still long enough, the best result so far is used: the most pictures of one view, or the
/// sharpest one.
///
/// The tests run on a picture reduced to some 160 squares along its longer side, compared with the
/// shot before and with the first of the view. Measured by `tests/tests/estimates/plate_taker.rs`
/// in codes of 8 bit: a picture whose noise is 3.01 comes out with 0.81, the sum of a sixteenth of
/// its variance and the rounding to codes; after a hand has crossed it with 0.80, no pixel more
/// than 4.1 off.
///
/// Not detected: a hand that rests in the picture without any movement from the first shot on;
/// something that covers less than half of a tile of four squares, 48 pixels of 1920; and movement
/// over a place without any texture, which does no harm.
#[derive(Clone, Debug, Default)]
pub struct PlateTaker {
    before: Option<(Reduced, Camera)>,
    stack: Option<Stack>,
    /// The best earlier view.
    kept: Option<Stack>,
    most_detail: f32,
    /// Waiting time in which only movement or blur prevented progress.
    waited_s: f64,
    since_added_s: f64,
    /// Time that something has been in the way.
    obstructed_s: f64,
}

impl PlateTaker {
    /// Judges a shot, and uses it.
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
            // The next shot will show whether anything moves in it.
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

    /// The use of a shot.
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
                // The thing has stopped moving: it was in the way before, and is not now.
                self.stack = None;
                UseOf::Anew(None)
            }
            // Another view or exposure begins here.
            Some(refusal) => UseOf::Anew(Some(refusal)),
            None if has_detail(reduced.detail) && reduced.detail * SHARP > stack.reduced.detail => {
                // The earlier pictures were out of focus.
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

    /// Ends the view, and keeps it if it is better than the kept one.
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

/// The use of a shot.
#[derive(Clone, Copy, Debug)]
enum UseOf {
    Not(PlateRefusal),
    /// One more of its view.
    Another,
    /// The first of another view, with the reason.
    Anew(Option<PlateRefusal>),
}

fn growing(n: u32) -> PlateStep {
    PlateStep::Growing {
        n,
        n_needed: N_PICTURES,
    }
}

/// The reduced picture, if it can be judged.
fn checked(image: &CameraImage) -> Option<Reduced> {
    image.is_of_size(image.size_px()).then(|| Reduced::new(image))?
}

/// The reason why two shots show different views; `None` if they differ by at most `most_px` of
/// movement.
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

/// Whether poses are as close as those of a camera that stands still, within the tracker's noise.
fn is_near(cameras: [&Camera; 2]) -> bool {
    let [one, other] = cameras.map(|camera| camera.world_from_camera);
    let rotations = [one, other].map(|pose| DQuat::from_mat4(&pose).normalize());
    let moved_m = one.w_axis.truncate().distance(other.w_axis.truncate());
    moved_m < STILL_M && rotations[0].angle_between(rotations[1]) < STILL_RAD
}
