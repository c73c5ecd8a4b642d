//! The toy's pose, by its outline in the picture.
//!
//! Coarse to fine. Where the pose is many pixels off, colours tell toy from surroundings (`odds`), and lines across the outline where
//! the one becomes the other (`lines`). Then each pixel beside the outline tells how much of it the toy covers (`matte`). Each
//! round is one Gauss-Newton step of all six numbers (`motion`).

mod contour;
mod lines;
mod matte;
mod motion;
mod odds;
mod resting;

use glam::{DMat4, DVec2, DVec3, IVec2};

use super::picture::{Level, Pyramid};
use super::raster::{Coverage, Rasterizer, project};
use super::report::PoseDeviation;
use super::rigid_motion::{Matrix6, RigidMotion, Vector6};
use super::shape::Shape;
use app_scene::scene::{Intrinsics, PoseUncertainty};
use contour::{Element, contour};
use matte::Band;
use motion::{Held, Measured, solve};
use odds::Odds;

pub(super) use resting::find_resting;

/// Colours are learned this far around the toy, over how far lines reach.
const LEARNED_AROUND: i32 = 3;
/// Rounds by matting, at the largest level: ever narrower bands, and how often each.
const FINE: [(Band, usize); 4] = [
    (band(8.0, 2.0), 2),
    (band(4.0, 1.0), 3),
    (band(2.5, 0.5), 3),
    (FINEST, 6),
];
/// The first of them are left out where the outline is within a pixel or two.
const N_WIDE_BANDS: usize = 1;
const FINEST: Band = band(1.5, 0.2);
/// By which poses that are far from one another are compared.
const WIDE: Band = band(4.0, 2.0);
/// Root mean square of the outline in the wide band, in pixels, below which no coarse rounds are needed.
const NEAR_PX: f64 = 0.6;
/// Of its robust scale, a band's loss below which most of the outline is within it.
const FINE_ENOUGH: f64 = 0.7;
/// A step that moves the toy by less, over its radius, is the last of its band.
const LAST_STEP: f64 = 1e-6;
/// A step that the outline does not tell is held back as by this deviation, over the toy's radius (Levenberg 1944).
const STEP: f64 = 0.2;
/// Deviation of one piece of the outline, for the weight of that against the pictures.
const PIECE_PX: f64 = 0.3;
/// Fewer pieces of the outline than that tell no pose.
const LEAST_PIECES: usize = 40;
/// Of the outline, what has to be measured.
const LEAST_MEASURED: f64 = 0.3;

/// How much less of the outline a better pose may have measured: a different part of it may be thin, or beside a corner.
const LESS_SEEN: f64 = 0.1;

const fn band(half_px: f64, robust_px: f64) -> Band {
    Band { half_px, robust_px }
}

/// The outline of a pose against the picture's.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fit {
    /// Of the finest band, robust, in square pixels.
    pub(super) loss_px2: f64,
    /// The same of the wide band.
    wide_loss_px2: f64,
    /// Of the outline, what was measured in the finest band.
    share: f64,
}

impl Fit {
    /// Root mean square distance of the outline, in pixels: by the finest band where that is wide enough to tell.
    pub(super) fn outline_px(&self) -> f64 {
        let fine_px = self.loss_px2.sqrt();
        if fine_px < FINE_ENOUGH * FINEST.robust_px {
            fine_px
        } else {
            self.wide_loss_px2.sqrt().max(fine_px)
        }
    }

    fn is_far(&self) -> bool {
        self.wide_loss_px2 > NEAR_PX * NEAR_PX
    }
}

/// A pose that was found.
#[derive(Clone, Debug)]
pub(super) struct Found {
    /// Moves the toy from where it was given, in camera space.
    pub(super) motion: DMat4,
    /// As given.
    pub(super) given: Fit,
    /// As found.
    pub(super) found: Fit,
    /// One deviation of what was found.
    pub(super) deviation: PoseDeviation,
}

impl Found {
    /// Whether the outline's loss fell to less than a part in either band, and did not rise in the other; and not because less of the
    /// outline is seen. From far off it is the wide band that tells, since the finest counts all that is far as one.
    pub(super) fn is_better(&self, part: f64) -> bool {
        let (found, given) = (&self.found, &self.given);
        let fell_to = |part: f64| {
            [
                found.loss_px2 <= part * given.loss_px2,
                found.wide_loss_px2 <= part * given.wide_loss_px2,
            ]
        };
        fell_to(part).contains(&true)
            && !fell_to(1.0).contains(&false)
            && found.share > given.share - LESS_SEEN
    }
}

/// Finds the pose, starting from that of `shape`, no farther from it than that is uncertain; none where too little of the outline is
/// seen.
pub(super) fn find(shape: &Shape, pyramid: &Pyramid, uncertainty: &PoseUncertainty) -> Option<Found> {
    let mut search = Search::new(shape, pyramid, uncertainty);
    let start = RigidMotion::none(shape.centre, shape.radius_m);
    let given = search.fit(&start)?;
    let mut motion = start;
    if given.is_far() {
        motion = search.coarse(motion, None);
    }
    search.freed(given, motion)
}

/// How well a pose is known that another is looked for from.
#[derive(Clone, Copy, Debug)]
pub(super) enum Start {
    /// As given: some millimetres and degrees.
    Given,
    /// Its outline is within a pixel or two.
    Near,
}

/// The motion to the pose that fits best, and the distance of its outline in pixels; none where too little of that is seen.
pub(super) fn tried(shape: &Shape, pyramid: &Pyramid, start: Start) -> Option<(DMat4, f64)> {
    let mut search = Search::new(shape, pyramid, &PoseUncertainty::default());
    let mut motion = RigidMotion::none(shape.centre, shape.radius_m);
    let bands = match start {
        Start::Near => &FINE[N_WIDE_BANDS..],
        Start::Given => {
            if search.fit(&motion)?.is_far() {
                motion = search.coarse(motion, None);
            }
            &FINE[..]
        }
    };
    let motion = search.fine(motion, bands)?.motion;
    let fit = search.fit(&motion)?;
    Some((motion.matrix(), fit.outline_px()))
}

/// Places on the outline of a shape's triangles with their corners at `points`, in pixels of a picture.
pub(super) fn outline_px(
    raster: &mut Rasterizer,
    (points, shape): (&[DVec3], &Shape),
    k: &Intrinsics,
    size_px: IVec2,
) -> Vec<DVec2> {
    let (_, elements) = outline(raster, (points, shape), k, size_px);
    elements.into_iter().map(|element| element.at_px).collect()
}

fn outline(
    raster: &mut Rasterizer,
    (points, shape): (&[DVec3], &Shape),
    k: &Intrinsics,
    size_px: IVec2,
) -> (Coverage, Vec<Element>) {
    let coverage = raster.with_depth(&project(points.iter().copied(), k), &shape.faces, size_px);
    let elements = contour(&coverage, size_px);
    (coverage, elements)
}

struct Search<'a> {
    shape: &'a Shape,
    pyramid: &'a Pyramid,
    raster: Rasterizer,
    damping: Matrix6,
    uncertainty: PoseUncertainty,
}

impl<'a> Search<'a> {
    /// Rounds along lines: the level, and how far they reach in its pixels.
    const COARSE: [(usize, i32); 11] = [
        (2, 10),
        (2, 10),
        (2, 8),
        (2, 8),
        (2, 6),
        (2, 6),
        (2, 4),
        (1, 6),
        (1, 6),
        (1, 4),
        (1, 4),
    ];

    fn new(shape: &'a Shape, pyramid: &'a Pyramid, uncertainty: &PoseUncertainty) -> Self {
        Self {
            shape,
            pyramid,
            uncertainty: *uncertainty,
            raster: Rasterizer::default(),
            damping: Matrix6::identity() * (PIECE_PX / (STEP * shape.radius_m)).powi(2),
        }
    }

    fn outline(&mut self, motion: &RigidMotion, level: &Level) -> (Coverage, Vec<Element>) {
        let points = self.shape.points.iter().map(|point| motion.apply(*point));
        let points: Vec<DVec3> = points.collect();
        let posed = (&points[..], self.shape);
        outline(&mut self.raster, posed, &level.intrinsics, level.frame.size_px)
    }

    /// The pieces that can be measured, and how many of all these are.
    fn matte(&mut self, motion: &RigidMotion, band: Band) -> Option<(Vec<Measured>, f64)> {
        let level = self.pyramid.level(0);
        let (coverage, elements) = self.outline(motion, level);
        let measured = matte::measure(level, &coverage, &elements, band);
        let share = measured.len() as f64 / elements.len() as f64;
        (measured.len() >= LEAST_PIECES && share >= LEAST_MEASURED).then_some((measured, share))
    }

    fn fit(&mut self, motion: &RigidMotion) -> Option<Fit> {
        let (fine, share) = self.matte(motion, FINEST)?;
        let (wide, _) = self.matte(motion, WIDE)?;
        Some(Fit {
            loss_px2: FINEST.loss_px2(&fine),
            wide_loss_px2: WIDE.loss_px2(&wide),
            share,
        })
    }

    /// Freely, or held to a plane.
    fn coarse(&mut self, motion: RigidMotion, held: Option<&Held>) -> RigidMotion {
        self.by_lines(motion, held, &Self::COARSE)
    }

    fn by_lines(
        &mut self,
        mut motion: RigidMotion,
        held: Option<&Held>,
        rounds: &[(usize, i32)],
    ) -> RigidMotion {
        for (level, reach_px) in rounds.iter().copied() {
            let level = self.pyramid.level(level);
            let (coverage, elements) = self.outline(&motion, level);
            let odds = Odds::learn(level, &coverage, LEARNED_AROUND * reach_px);
            let measured = lines::measure(&elements, &coverage, &odds, reach_px);
            let k = &level.intrinsics;
            let step = match held {
                Some(held) => held.solve(&measured, k, &motion, &self.damping),
                None => solve(&measured, k, &motion, &self.damping).map(|(step, _)| step),
            };
            if let Some(step) = step {
                motion = motion.then(&step).within(&self.uncertainty);
            }
        }
        motion
    }

    fn fine(&mut self, mut motion: RigidMotion, bands: &[(Band, usize)]) -> Option<Converged> {
        let mut last = None;
        for (band, n_rounds) in bands {
            for _ in 0..*n_rounds {
                let (measured, _) = self.matte(&motion, *band)?;
                let k = &self.pyramid.level(0).intrinsics;
                let (step, information): (Vector6, _) = solve(&measured, k, &motion, &self.damping)?;
                motion = motion.then(&step).within(&self.uncertainty);
                last = Some(Converged {
                    motion,
                    information,
                    mean_weight: mean_weight(&measured),
                });
                if step.norm() < LAST_STEP * self.shape.radius_m {
                    break;
                }
            }
        }
        last
    }

    /// With all six freedoms, in all bands.
    fn freed(&mut self, given: Fit, motion: RigidMotion) -> Option<Found> {
        let Converged {
            motion,
            information,
            mean_weight,
        } = self.fine(motion, &FINE)?;
        let found = self.fit(&motion)?;
        Some(Found {
            motion: motion.matrix(),
            given,
            deviation: deviation(&information, mean_weight * found.loss_px2, self.shape.radius_m),
            found,
        })
    }
}

/// Where the search came to rest.
struct Converged {
    motion: RigidMotion,
    information: Matrix6,
    mean_weight: f64,
}

/// Of the pieces that were measured, by length; at least one is.
fn mean_weight(measured: &[Measured]) -> f64 {
    let weighted = |one: &Measured| (one.element.length_px, one.precision * one.robust);
    let (sum, total) = measured
        .iter()
        .map(weighted)
        .fold((0.0, 0.0), |(sum, total), (length, weight)| {
            (sum + length * weight, total + length)
        });
    sum / total
}

/// One deviation of a pose, by the information on it and the variance of a piece of unit weight.
fn deviation(information: &Matrix6, unit_variance: f64, radius_m: f64) -> PoseDeviation {
    // It was solved with, so that it has an inverse.
    let covariance = information.try_inverse().unwrap_or_else(Matrix6::identity);
    let root = |index: usize| (covariance[(index, index)].max(0.0) * unit_variance).sqrt();
    PoseDeviation {
        lateral_m: root(3).hypot(root(4)),
        depth_m: root(5),
        rotation_rad: root(0).hypot(root(1)).hypot(root(2)) / radius_m,
    }
}
