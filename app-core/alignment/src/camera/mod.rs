//! Estimates the camera of a photograph from the receivers beside the toy.
//!
//! A plate gives the brightness of each point of a receiver. Those points are projected into the
//! photograph, and its camera is moved until the pixels there have the same brightness: direct
//! alignment of a known surface, coarse to fine, by Gauss-Newton steps on the camera's six numbers
//! (`step`). Toy and shadow are outliers. The first plate's camera is fixed; those of the other
//! plates and of frames are relative to it.
//!
//! Source: Lucas and Kanade 1981; in the taxonomy of Baker and Matthews 2004 the forward additive
//! form, with the photograph's gradient.

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

/// Number of plates that a camera is aligned to: those with the nearest cameras.
const N_PLATES: usize = 2;
/// Number of pictures whose brightness is cached: those plates, and the photograph.
const N_REMEMBERED: usize = N_PLATES + 1;
/// Largest number of rounds in a level.
const N_ROUNDS: usize = 15;
/// Scale of Cauchy's weights, for the steps, and of Geman and McClure's loss, which is constant for
/// all outliers, in square roots of linear light: in the largest level, and its increase in each
/// smaller one.
const ROBUST: f64 = 0.04;
const ROBUST_STEP: f64 = 0.02;
/// Largest number of a plate's points: in the largest level, and in those where starts are
/// compared.
const MOST_POINTS: usize = 20_000;
const MOST_POINTS_BELOW: usize = 5_000;
/// Number of textured points, in the largest level, that an estimate needs.
const LEAST_POINTS: usize = 500;
/// An estimated camera is applied if points of the receivers move by more than this, in pixels,
const LEAST_PX: f64 = 0.1;
/// and if the loss falls by this fraction or more for moves of at least this many pixels; by
/// proportionally less for smaller moves. Tiles that match the next ones fall by .13 and less,
/// those that match themselves by a third.
const FALL: f64 = 0.25;
const FALL_PX: f64 = 1.5;
/// For a camera given as equal to a plate's, to the last digit (a stand), the loss must fall by
/// this fraction at least, however small the move. Soft shadows on a plain table reduce it by .09;
/// a camera that was nudged by .4 px before a wooden one by .21.
const HELD_FALL: f64 = 0.15;
/// Largest loss that an estimated camera may leave; an outlier's is 1, so most points must be explained.
/// Right cameras leave .004 to .26. If the only texture of an even table is a toy that was pushed aside in
/// the plate, a camera that follows it by 41 px leaves .61.
const MOST_LEFT: f64 = 0.5;

/// An estimated camera.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    /// The estimated pose.
    pub(super) world_from_camera: DMat4,
    /// Root mean square shift of the receivers' points in the picture, in pixels.
    pub(super) moved_px: f64,
    /// Distance that the camera moved, in metres.
    pub(super) moved_m: f64,
    /// Angle that it turned, in radians.
    pub(super) turned_rad: f64,
    /// Mean robust loss with the given and with the estimated camera, for the same points.
    pub(super) losses: [f64; 2],
    /// Whether it was given as equal to a plate's, to the last digit: a camera on a stand.
    is_held: bool,
}

impl Found {
    /// Whether the change is visible, improves the loss by more than noise, and explains most points.
    pub(super) fn is_better(&self) -> bool {
        let [given, found] = self.losses;
        let least = if self.is_held { HELD_FALL } else { 0.0 };
        let fall = (FALL * (self.moved_px / FALL_PX).min(1.0)).max(least);
        self.moved_px > LEAST_PX && found < MOST_LEFT.min((1.0 - fall) * given)
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

/// The camera as estimated, or as given if the estimate is no better.
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

/// Estimates cameras in one scene, one after the other; caches the plates used last.
#[derive(Debug, Default)]
pub(super) struct Finder {
    decoded: Vec<(Arc<Image>, Arc<Brightness>)>,
}

impl Finder {
    /// Estimates the camera of `image`, starting from the given one; `None` without a plate or with
    /// too little texture. Withheld pixels are not read. The result stays within the given camera's
    /// uncertainty.
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
                    // The estimate moves points within camera space; the camera moves by the
                    // inverse.
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
