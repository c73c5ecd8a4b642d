//! The toy's pose, by its outline in the picture.
//!
//! Coarse to fine. If the pose is many pixels off, colours distinguish the toy from its surroundings (`odds`), and lines across the outline
//! show where the one becomes the other (`lines`). Then each pixel beside the outline shows how much of it the toy covers (`matte`),
//! each round being one Gauss-Newton step of six numbers (`motion`). The last rounds predict the codes of the pixels beside the outline
//! (`edge`) from what lies on either side of it (`sides`): the plate, and the model's own colours in the light of the photograph (`paint`).
//! They solve for the offset of the whole outline as well, and with the feet of the toy on their plane (`standing`) for its size
//! (`settle`). Which of these poses the picture speaks for is one decision (`decide`).

pub(super) mod adapt;
mod contour;
mod decide;
mod edge;
mod field;
mod lines;
mod matte;
mod motion;
mod odds;
mod owners;
mod paint;
mod placement;
mod regions;
mod resting;
mod settle;
mod sides;
mod sightings;
mod standing;

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
use settle::{LEAST_EVIDENCE, STEP};
use sides::Beside;

pub(super) use paint::Paint;
pub use regions::ViewDirection;
pub(super) use regions::{Standing, TINY_PIXELS, changed, guesses, standing_guesses};
pub(super) use resting::find_resting;
pub(super) use standing::{Ground, Plane, feet};

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
/// Deviation of one piece of the outline, for the weight of that against the pictures.
const PIECE_PX: f64 = 0.3;
/// Fewer pieces of the outline than that tell no pose.
const LEAST_PIECES: usize = 40;
/// Of the outline, what has to be measured.
const LEAST_MEASURED: f64 = 0.3;

const fn band(half_px: f64, robust_px: f64) -> Band {
    Band { half_px, robust_px }
}

/// The outline of a pose against the picture's.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fit {
    /// Of the finest band, robust, in square pixels.
    loss_px2: f64,
    /// The same of the wide band.
    wide_loss_px2: f64,
    /// Of the outline, what was measured in the finest band.
    share: f64,
}

impl Fit {
    /// Root mean square distance of the outline, in pixels: by the finest band where that is wide enough to tell.
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

/// A pose that was found.
#[derive(Clone, Debug)]
pub(super) struct Found {
    /// Moves the toy from where it was given, in camera space.
    pub(super) motion: DMat4,
    /// Root mean square distance of the outline, in pixels, as given and as found.
    pub(super) outlines_px: [f64; 2],
    /// Whether less of the outline is seen than as given.
    is_less_seen: bool,
    /// Logarithm of how much likelier the picture is with what was found than with what was given.
    pub(super) evidence: f64,
    /// One deviation of what was found.
    pub(super) deviation: PoseDeviation,
    /// What the model's outline is off by along some centimetres of it, in pixels.
    pub(super) model_px: f64,
    /// Standard deviation of the spread that the camera gives an edge, in pixels.
    pub(super) spread_px: f64,
    /// That which makes the plate as soft as the photograph; 0 if it is so as it was taken.
    pub(super) plate_spread_px: f64,
    /// How it is on the plane that it is to stand on, as given and as found; none where it floats.
    pub(super) stands: Option<[Stand; 2]>,
}

impl Found {
    /// Whether the outline is that of the model, as far as so soft a picture shows it.
    pub(super) fn is_of_model(&self) -> bool {
        self.model_px < most_model_px(self.spread_px)
    }

    /// Whether the picture is that much likelier with it; and not because less of the outline is seen.
    pub(super) fn is_better(&self) -> bool {
        self.evidence >= LEAST_EVIDENCE && !self.is_less_seen
    }
}

/// A toy whose pose is looked for.
#[derive(Clone, Copy)]
pub(super) struct Subject<'a> {
    /// Where it is given.
    pub(super) shape: &'a Shape,
    /// Its colours there.
    pub(super) paint: &'a Paint,
    /// What it may stand on; none if it floats.
    pub(super) ground: Option<Ground>,
}

/// Finds the pose, starting from that of a subject, no farther from it than that is uncertain; none where too little of the outline is
/// seen.
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

/// Standard deviation of the spread that the camera gives the outline of a toy in its place, in pixels of the largest level; none where too
/// little of the outline is seen.
pub(super) fn spread_px(subject: Subject<'_>, pyramid: &Pyramid) -> Option<f64> {
    let shape = subject.shape;
    let mut search = Search::new(shape, pyramid, &PoseUncertainty::default());
    let placement = Placement::of(RigidMotion::none(shape.centre, shape.radius_m));
    search.fit(&placement)?;
    Some(search.spread_px(subject.paint, &placement))
}

/// What a shape covers of a level.
pub(super) fn covered(shape: &Shape, level: &Level) -> Coverage {
    let corners = project(shape.points.iter().copied(), &level.intrinsics);
    Rasterizer::default().with_depth(&corners, &shape.faces, level.frame.size_px)
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
    /// The largest level with its plate as soft as the photograph, and by how many pixels that was spread; none if the plate is so as it was
    /// taken.
    softened: Option<(Level, f64)>,
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

    /// The toy where it is thought to be, in the largest level.
    fn posed<'b>(&mut self, placement: &Placement, lit: Option<Lit<'b>>) -> Posed<'b> {
        let level = self.pyramid.level(0);
        let (coverage, elements) = self.outline(placement, level);
        Posed {
            shaded: lit.map(|lit| lit.shaded(placement, level, &coverage)),
            coverage,
            elements,
        }
    }

    /// The pieces that can be measured, and how many of all these are.
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
        let (fine, share) = self.matte(placement, None, FINEST)?;
        let (wide, _) = self.matte(placement, None, WIDE)?;
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

/// A toy where it is thought to be: what it covers, its outline, and what it should look like if that is known.
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

/// Pieces that were measured, and what of the outline they are; none where that is too little.
fn enough(measured: Vec<Measured>, elements: &[Element]) -> Option<(Vec<Measured>, f64)> {
    let share = measured.len() as f64 / elements.len().max(1) as f64;
    (measured.len() >= LEAST_PIECES && share >= LEAST_MEASURED).then_some((measured, share))
}
