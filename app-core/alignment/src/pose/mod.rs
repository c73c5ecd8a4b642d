//! Estimates the toy's pose from its outline in the picture.
//!
//! Coarse to fine. If the pose is many pixels off, colours distinguish the toy from its
//! surroundings (`odds`), and lines across the outline locate the boundary (`lines`). Then each
//! pixel beside the outline gives the toy's coverage of it (`matte`), each round being one
//! Gauss-Newton step of six numbers (`motion`). The last rounds predict the codes of the pixels
//! beside the outline (`edge`) from the colours on either side of it (`sides`): the plate, and the
//! model's own colours in the light of the photograph (`paint`). They also estimate the offset of
//! the whole outline, and with the feet of the toy on their plane (`standing`) its size (`settle`).
//! If the model has a texture, the same rounds fit that within the outline (`texture`).
//! One step selects the most likely of these poses (`decide`).

pub(super) mod adapt;
mod blur;
mod contour;
mod contour_segments;
mod decide;
mod directed;
mod edge;
mod field;
mod lines;
mod matte;
mod motion;
mod odds;
mod outline_blur;
mod owners;
mod paint;
mod placement;
mod regions;
mod resting;
mod settle;
mod sides;
mod standing;
mod texels;
mod texture;

use glam::{DMat4, DVec2, DVec3, IVec2};

use super::picture::{Level, Pyramid};
use super::raster::{Coverage, Rasterizer, project};
use super::report::{PoseDeviation, Stand, most_model_px};
use super::rigid_motion::{Matrix6, RigidMotion};
use super::shape::Shape;
use app_scene::scene::{Intrinsics, PoseUncertainty};
use contour::{Element, contour};
use matte::Band;
use motion::{Held, Measured, solve};
use odds::Odds;
use paint::{Lit, Shaded};
use placement::Placement;
use settle::STEP;
use sides::Beside;

pub(super) use blur::SOFT_PX;
pub(super) use directed::Directed;
pub(super) use outline_blur::OutlineBlur;
pub(super) use paint::{Paint, Surfel};
pub use regions::ViewDirection;
pub(super) use regions::{Standing, TINY_PIXELS, changed, guesses, standing_guesses};
pub(super) use resting::find_resting;
pub(super) use settle::LEAST_EVIDENCE;
pub(super) use standing::{Ground, Plane, feet, stand};

/// Reach of the learned colours around the toy, over the reach of lines.
const LEARNED_AROUND: i32 = 3;
/// Rounds by matting, at the largest level: ever narrower bands, and the number of rounds of each.
const FINE: [(Band, usize); 4] = [
    (band(8.0, 2.0), 2),
    (band(4.0, 1.0), 3),
    (band(2.5, 0.5), 3),
    (FINEST, 6),
];
/// Number of the first bands that are skipped if the outline is within a pixel or two.
const N_WIDE_BANDS: usize = 1;
const FINEST: Band = band(1.5, 0.2);
/// Band for the comparison of distant poses.
const WIDE: Band = band(4.0, 2.0);
/// Root mean square distance of the outline in the wide band, in pixels, below which no coarse
/// rounds are needed.
const NEAR_PX: f64 = 0.6;
/// Loss of a band, over its robust scale, below which most of the outline is within it.
const FINE_ENOUGH: f64 = 0.7;
/// Size of the last step of a band, over the toy's radius.
const LAST_STEP: f64 = 1e-6;
/// Standard deviation of one piece of the outline, for the weight of the prior.
const PIECE_PX: f64 = 0.3;
/// Number of the outline's pieces that an estimate needs.
const LEAST_PIECES: usize = 40;
/// Fraction of the outline that an estimate needs.
const LEAST_MEASURED: f64 = 0.3;

const fn band(half_px: f64, robust_px: f64) -> Band {
    Band { half_px, robust_px }
}

/// The distance between the outlines of a pose and of the picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fit {
    /// Robust loss of the finest band, in square pixels.
    loss_px2: f64,
    /// The same for the wide band.
    wide_loss_px2: f64,
    /// Measured fraction of the outline in the finest band.
    share: f64,
}

impl Fit {
    /// Root mean square distance of the outline, in pixels: by the finest band if that is wide
    /// enough.
    fn outline_px(&self) -> f64 {
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

/// An estimated pose.
#[derive(Clone, Debug)]
pub(super) struct Found {
    /// Motion of the toy from its given pose, in camera space.
    pub(super) motion: DMat4,
    /// Root mean square distance of the outline, in pixels, for the given and the estimated pose.
    pub(super) outlines_px: [f64; 2],
    /// Whether less of the outline is visible than in the given pose.
    is_less_seen: bool,
    /// Logarithm of the likelihood ratio of the estimated and the given pose.
    pub(super) evidence: f64,
    /// Standard deviation of the estimate.
    pub(super) deviation: PoseDeviation,
    /// Covariance of a further step of the motion, by the scatter alone.
    pub(super) covariance: Matrix6,
    /// Distance of the model's outline along some centimetres, in pixels.
    pub(super) model_px: f64,
    /// Correlation of the model's texture with the picture's; `None` without a texture, or if the
    /// picture shows another one.
    pub(super) texture_correlation: Option<f64>,
    /// Standard deviation of the camera's blur of an edge, in pixels.
    pub(super) spread_px: f64,
    /// The blur that makes the plate as soft as the photograph; 0 if they are equally soft.
    pub(super) plate_spread_px: f64,
    /// Its position on its ground plane, as given and as estimated; `None` if it floats.
    pub(super) stands: Option<[Stand; 2]>,
}

impl Found {
    /// Whether the outline is the model's, within the accuracy of so soft a picture.
    pub(super) fn is_of_model(&self) -> bool {
        self.model_px < most_model_px(self.spread_px)
    }

    /// Whether the outline is within `most_px` of the picture's. If the texture is met, it may be
    /// within twice as much, but no farther than the given one: a mug behind the toy, or edges
    /// rounder than the model's, disturb the outline alone, and a post before the toy the texture,
    /// too.
    pub(super) fn is_met(&self, most_px: f64) -> bool {
        let [given_px, found_px] = self.outlines_px;
        let is_textured = self.texture_correlation.is_some();
        found_px <= most_px || (is_textured && found_px <= given_px.min(2.0 * most_px))
    }

    /// Whether the picture is sufficiently more likely with it, and not because less of the outline
    /// is visible.
    pub(super) fn is_better(&self) -> bool {
        self.evidence >= LEAST_EVIDENCE && !self.is_less_seen
    }
}

/// A toy whose pose is estimated.
#[derive(Clone, Copy)]
pub(super) struct Subject<'a> {
    /// The shape in its given pose.
    pub(super) shape: &'a Shape,
    /// Its colours there.
    pub(super) paint: &'a Paint,
    /// The ground that it may stand on; `None` if it floats.
    pub(super) ground: Option<Ground>,
}

/// Estimates the pose, starting from a subject's, within its uncertainty; `None` if too little of
/// the outline is visible.
pub(super) fn find(subject: Subject<'_>, pyramid: &Pyramid, uncertainty: &PoseUncertainty) -> Option<Found> {
    let shape = subject.shape;
    let mut search = Search::new(shape, pyramid, uncertainty);
    let start = RigidMotion::none(shape.centre, shape.radius_m);
    let given = search.fit(&Placement::of(start))?;
    let mut motion = start;
    if given.is_far() {
        motion = search.coarse(motion, None);
    }
    search.freed(subject, given, motion)
}

/// The accuracy of a start.
#[derive(Clone, Copy, Debug)]
pub(super) enum Start {
    /// A given pose: some millimetres and degrees.
    Given,
    /// A pose whose outline is within a pixel or two.
    Near,
}

/// The motion to the best pose, and the distance of its outline in pixels; `None` if too little of
/// it is visible.
pub(super) fn tried(shape: &Shape, pyramid: &Pyramid, start: Start) -> Option<(DMat4, f64)> {
    let mut search = Search::new(shape, pyramid, &PoseUncertainty::default());
    let mut motion = RigidMotion::none(shape.centre, shape.radius_m);
    let bands = match start {
        Start::Near => &FINE[N_WIDE_BANDS..],
        Start::Given => {
            if search.fit(&Placement::of(motion))?.is_far() {
                motion = search.coarse(motion, None);
            }
            &FINE[..]
        }
    };
    let motion = search.fine(motion, None, bands)?;
    let fit = search.fit(&Placement::of(motion))?;
    Some((motion.matrix(), fit.outline_px()))
}

/// The pixels of a level that a shape covers.
pub(super) fn covered(shape: &Shape, level: &Level) -> Coverage {
    let corners = project(shape.points.iter().copied(), &level.intrinsics);
    Rasterizer::default().with_depth(&corners, &shape.faces, level.frame.size_px)
}

/// Points on the outline of a shape's triangles with their corners at `points`, in pixels of a
/// picture.
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
    /// The largest level with its plate blurred like the photograph, and that blur in pixels;
    /// `None` if the plate is not blurred.
    softened: Option<(Level, f64)>,
}

impl<'a> Search<'a> {
    /// Rounds along lines: the level, and the reach in its pixels.
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
            softened: None,
            raster: Rasterizer::default(),
            damping: Matrix6::identity() * (PIECE_PX / (STEP * shape.radius_m)).powi(2),
        }
    }

    fn outline(&mut self, placement: &Placement, level: &Level) -> (Coverage, Vec<Element>) {
        let points = self.shape.points.iter().map(|point| placement.apply(*point));
        let points: Vec<DVec3> = points.collect();
        let posed = (&points[..], self.shape);
        outline(&mut self.raster, posed, &level.intrinsics, level.frame.size_px)
    }

    /// The toy in its estimated place, in the largest level.
    fn posed<'b>(&mut self, placement: &Placement, lit: Option<Lit<'b>>) -> Posed<'b> {
        let level = self.pyramid.level(0);
        let (coverage, elements) = self.outline(placement, level);
        Posed {
            shaded: lit.map(|lit| lit.shaded(placement, level, &coverage)),
            coverage,
            elements,
        }
    }

    /// The toy in its estimated place, in the light that the photograph shows on it.
    fn lit<'b>(&mut self, paint: &'b Paint, placement: &Placement) -> Posed<'b> {
        let level = self.pyramid.level(0);
        let (coverage, elements) = self.outline(placement, level);
        Posed {
            shaded: paint.lit(placement, level, &coverage),
            coverage,
            elements,
        }
    }

    /// The measurable pieces, and their fraction of all.
    fn matte(
        &mut self,
        placement: &Placement,
        lit: Option<Lit<'_>>,
        band: Band,
    ) -> Option<(Vec<Measured>, f64)> {
        let posed = self.posed(placement, lit);
        let beside = posed.beside(self.pyramid.level(0));
        enough(matte::measure(&beside, &posed.elements, band), &posed.elements)
    }

    fn fit(&mut self, placement: &Placement) -> Option<Fit> {
        let posed = self.posed(placement, None);
        let beside = posed.beside(self.pyramid.level(0));
        let measured = |band| enough(matte::measure(&beside, &posed.elements, band), &posed.elements);
        let ((fine, share), (wide, _)) = (measured(FINEST)?, measured(WIDE)?);
        Some(Fit {
            loss_px2: FINEST.loss_px2(&fine),
            wide_loss_px2: WIDE.loss_px2(&wide),
            share,
        })
    }

    /// Freely, or on a plane.
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
            let (coverage, elements) = self.outline(&Placement::of(motion), level);
            let odds = Odds::learn(level, &coverage, LEARNED_AROUND * reach_px);
            let measured = lines::measure(&elements, &coverage, &odds, reach_px);
            let k = &level.intrinsics;
            let step = match held {
                Some(held) => held.solve(&measured, k, &motion, &self.damping),
                None => solve(&measured, k, &motion, &self.damping),
            };
            if let Some(step) = step {
                motion = motion.then(&step).within(&self.uncertainty);
            }
        }
        motion
    }

    fn fine(
        &mut self,
        mut motion: RigidMotion,
        lit: Option<Lit<'_>>,
        bands: &[(Band, usize)],
    ) -> Option<RigidMotion> {
        for (band, n_rounds) in bands {
            for _ in 0..*n_rounds {
                let (measured, _) = self.matte(&Placement::of(motion), lit, *band)?;
                let k = &self.pyramid.level(0).intrinsics;
                let step = solve(&measured, k, &motion, &self.damping)?;
                motion = motion.then(&step).within(&self.uncertainty);
                if step.norm() < LAST_STEP * self.shape.radius_m {
                    break;
                }
            }
        }
        Some(motion)
    }
}

/// A toy in its estimated place: its coverage, its outline, and its predicted colours if known.
struct Posed<'a> {
    coverage: Coverage,
    elements: Vec<Element>,
    shaded: Option<Shaded<'a>>,
}

impl Posed<'_> {
    fn beside<'b>(&'b self, level: &'b Level) -> Beside<'b> {
        Beside {
            level,
            coverage: &self.coverage,
            shaded: self.shaded.as_ref(),
        }
    }
}

/// Measured pieces, and their fraction of the outline; `None` if that is too small.
fn enough(measured: Vec<Measured>, elements: &[Element]) -> Option<(Vec<Measured>, f64)> {
    let share = measured.len() as f64 / elements.len().max(1) as f64;
    (measured.len() >= LEAST_PIECES && share >= LEAST_MEASURED).then_some((measured, share))
}
