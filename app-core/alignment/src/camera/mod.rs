//! The camera of a photograph, by what the receivers look like beside the toy.
//!
//! A plate says how bright each point of a receiver is. Those points are projected into the photograph, and its camera is moved
//! until they meet pixels as bright: direct alignment of a known surface, coarse to fine, by Gauss-Newton steps on the
//! camera's six numbers (`step`). Toy and shadow are outliers. The first plate's camera is held; those of the other plates and
//! of frames are relative to it.
//!
//! Source: Lucas and Kanade 1981; in the taxonomy of Baker and Matthews 2004 the forward additive form, with the photograph's
//! gradient.

mod brightness;
mod points;
mod step;

use std::sync::Arc;

use glam::{DMat4, DVec3};

use super::picture::Mask;
use super::receivers::nearest;
use super::report::CameraAlignment;
use crate::rigid_motion::RigidMotion;
use app_scene::scene::{Camera, Image, Plate, PoseUncertainty, Receiver, check};
use brightness::Brightness;
use points::{Point, points_of};
use step::Search;

/// Plates that a camera is aligned to: those taken nearest to it.
const N_PLATES: usize = 2;
/// Pictures whose brightness is remembered: those plates, and the photograph.
const N_REMEMBERED: usize = N_PLATES + 1;
/// Most rounds in a level.
const N_ROUNDS: usize = 15;
/// Scale of Cauchy's weights, by which points pull, and of Geman and McClure's loss, which stays the same for all outliers, in
/// square roots of linear light: in the largest level, and how much more in each smaller one.
const ROBUST: f64 = 0.04;
const ROBUST_STEP: f64 = 0.02;
/// Most points of a plate: in the largest level, and in those where starts are tried.
const MOST_POINTS: usize = 20_000;
const MOST_POINTS_BELOW: usize = 5_000;
/// Fewer points with texture than that, in the largest level, tell no camera.
const LEAST_POINTS: usize = 500;
/// A found camera is applied where points of the receivers move by more, in pixels,
const LEAST_PX: f64 = 0.1;
/// and the loss falls by that part or more, once they move by so many pixels; by less in proportion where they move less. Tiles
/// that meet the next ones fall by .13 and less, those that meet themselves by a third.
const FALL: f64 = 0.25;
const FALL_PX: f64 = 1.5;
/// A camera that is given as that of a plate, to the last digit, stands on something: the loss falls by that part at least, however
/// little they move. Soft shadows on a plain table let it fall by .09; a camera that was nudged by .4 px before a wooden one by .21.
const HELD_FALL: f64 = 0.15;

/// A camera that was found.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    /// The pose that was found.
    pub(super) world_from_camera: DMat4,
    /// Root mean square that points of the receivers move in the picture, in pixels.
    pub(super) moved_px: f64,
    /// Distance in metres that the camera moved.
    pub(super) moved_m: f64,
    /// Angle in radians that it turned.
    pub(super) turned_rad: f64,
    /// Mean robust loss with the given and with the found camera, of the same points.
    pub(super) losses: [f64; 2],
    /// Whether it was given as that of a plate, to the last digit: a camera on a stand.
    is_held: bool,
}

impl Found {
    /// Whether it moves the picture by enough to show, and explains it better by more than noise.
    pub(super) fn is_better(&self) -> bool {
        let [given, found] = self.losses;
        let least = if self.is_held { HELD_FALL } else { 0.0 };
        let fall = (FALL * (self.moved_px / FALL_PX).min(1.0)).max(least);
        self.moved_px > LEAST_PX && found < (1.0 - fall) * given
    }

    fn report(&self, is_applied: bool) -> CameraAlignment {
        CameraAlignment {
            is_applied,
            moved_px: self.moved_px,
            moved_m: self.moved_m,
            turned_rad: self.turned_rad,
            errors: self.losses,
        }
    }
}

/// A camera as found: as given, where that explains the picture no better.
pub(super) fn corrected(given: &Camera, found: Option<Found>) -> (Camera, Option<CameraAlignment>) {
    let Some(found) = found else {
        return (*given, None);
    };
    let corrected = Camera {
        world_from_camera: found.world_from_camera,
        ..*given
    };
    let is_applied = found.is_better() && check::camera("camera", &corrected).is_ok();
    let camera = if is_applied { corrected } else { *given };
    (camera, Some(found.report(is_applied)))
}

/// Finds cameras in one scene, one after the other; remembers the plates used last.
#[derive(Debug, Default)]
pub(super) struct Finder {
    decoded: Vec<(Arc<Image>, Arc<Brightness>)>,
}

impl Finder {
    /// Finds the camera of `image`, starting from the one given; none where there is no plate or too little texture. Of what is
    /// withheld nothing is read. It is moved no farther than the one given is uncertain.
    pub(super) fn find(
        &mut self,
        (image, camera, withheld): (&Arc<Image>, &Camera, Option<&Mask>),
        (plates, receivers): (&[Plate], &[Receiver]),
        uncertainty: &PoseUncertainty,
    ) -> Option<Found> {
        if plates.is_empty() {
            return None;
        }
        let near = nearest(plates, camera).into_iter().take(N_PLATES);
        let plates: Vec<(&Plate, Arc<Brightness>)> =
            near.map(|plate| (plate, self.brightness(&plate.image))).collect();
        let photograph = match withheld {
            Some(_) => Arc::new(Brightness::of(image, withheld)),
            None => self.brightness(image),
        };
        let camera_from_world = camera.world_from_camera.inverse();
        let mut motion = None;
        for (level, picture) in photograph.levels().iter().enumerate().rev() {
            let most = if level == 0 {
                MOST_POINTS
            } else {
                MOST_POINTS_BELOW
            };
            let templates: Vec<Vec<Point>> = plates
                .iter()
                .filter_map(|(plate, brightness)| {
                    let of_level = (&plate.camera, brightness.levels().get(level)?);
                    Some(points_of(of_level, receivers, &camera_from_world, most))
                })
                .collect();
            let robust = ROBUST + ROBUST_STEP * level as f64;
            let search = Search::new((camera, uncertainty), picture, &templates, robust);
            if level == 0 && search.n_points() < LEAST_POINTS {
                return None;
            }
            let found = match motion {
                None => search.run_from(&search.starts(), N_ROUNDS),
                Some(motion) => search.run(motion, N_ROUNDS),
            };
            if level == 0 {
                return Some(Found {
                    // Points are moved within camera space; the camera moves the other way.
                    world_from_camera: camera.world_from_camera * found.matrix().inverse(),
                    moved_px: search.moved_px(&found),
                    moved_m: found.moved_m(),
                    turned_rad: found.turned_rad(),
                    is_held: plates.iter().any(|(plate, _)| plate.camera == *camera),
                    losses: [RigidMotion::about_camera(DVec3::ZERO), found]
                        .map(|motion| search.loss(&motion)),
                });
            }
            motion = Some(found);
        }
        None
    }

    fn brightness(&mut self, image: &Arc<Image>) -> Arc<Brightness> {
        let known = self.decoded.iter().position(|(of, _)| Arc::ptr_eq(of, image));
        let latest = match known {
            Some(place) => self.decoded.remove(place),
            None => (Arc::clone(image), Arc::new(Brightness::of(image, None))),
        };
        let brightness = Arc::clone(&latest.1);
        self.decoded.push(latest);
        if self.decoded.len() > N_REMEMBERED {
            self.decoded.remove(0);
        }
        brightness
    }
}
