//! The last rounds: a pose estimated from the codes beside the outline, freely and on its plane,
//! and the choice between them.

use super::blur;
use super::edge::{self, Optics};
use super::matte::Band;
use super::motion::Measured;
use super::paint::{Light, Lit, Paint};
use super::placement::{Information, Placement, SIZE};
use super::settle::{Balance, Known, LEAST_EVIDENCE, Misfit, smoothed_px};
use super::standing::{Ground, Plane, Standing};
use super::texture::{LAST_SPREAD, Likeness, Texture};
use super::{FINE, Fit, Found, Posed, Search, Subject, WIDE, enough};
use crate::picture::Level;
use crate::report::{PoseDeviation, most_model_px};
use crate::rigid_motion::RigidMotion;

/// Evidence, half of the decisive amount, for which a toy of another size is found on its plane, or for which a toy that
/// is given on one of its feet is put on three.
///
/// Measured: a heron that is given on one foot, another .7 mm above the plane, is as likely on three feet by .3, and
/// then .6 mm off.
const UNDOUBTED: f64 = 0.5 * LEAST_EVIDENCE;
/// Largest number of rounds of one search; each leaves about half of the residual.
const N_ROUNDS: usize = 8;
/// Size of the last step, over the toy's radius: a thousandth of a pixel.
const LAST_STEP: f64 = 2e-5;
/// Additional width of the band on either side, in pixels, so that poses some pixels apart can be
/// compared.
pub(super) const COMPARED_PX: f64 = 1.0;
/// Feet within this distance of the plane, in metres, count as on it: about the deviation of
/// standing feet.
const ON_PLANE_M: f64 = 2e-4;
/// Feet within this distance of the plane, in metres, may be where they are given as well as on it.
///
/// Measured, models of a fifth of the triangles that are given 2.3 mm too high: 5 to 8 mm off along the view at these
/// heights, where they are as likely.
const NEAR_PLANE_M: f64 = 1e-3;
/// Largest inclination from the given pose, in radians, with which a toy that would topple has its lowest points as high
/// above each other as they are given.
///
/// Measured: two of 24 starts, inclined by up to 15 degrees, ended 1.8 and 2.7 mm off at such heights.
const UPRIGHT_RAD: f64 = 0.05;
/// Largest loss of a matching outline in square pixels, and its increase per pixel of blur. Correct
/// outlines came to .04 in sharp pictures, compressed or not, and to .12 in pictures with a blur of
/// 2 px.
const MET_PX2: f64 = 0.06;
const MET_OF_SPREAD: f64 = 0.04;
/// The same of an outline whose pieces scatter about the picture's: the toy may be hardly brighter than the table.
///
/// Measured: up to .107 for a pale llama on dark wood, and .2 and more, or .2 px and more along some centimetres, for
/// outlines of wrong poses.
const ROUGH_PX2: f64 = 0.12;
/// Largest logarithm of a size difference; beyond, it is another toy; also the largest error of a
/// world's scale.
const MOST_SIZE: f64 = 0.03;

/// Largest loss of measured outline for a better pose: other parts of it may be thin, or near a
/// corner.
const LESS_SEEN: f64 = 0.1;

/// Knowledge before the last rounds.
#[derive(Clone, Copy)]
struct Seen<'a> {
    lit: Option<Lit<'a>>,
    optics: Optics,
    accuracy: Accuracy,
    /// `None` if the toy has none, or another one than its model.
    texture: Option<&'a Texture>,
}

/// The light on the toy and the camera's edge response, by the codes beside the outline of a placement.
pub(super) struct Explained {
    /// `None` if too little of the toy is visible.
    light: Option<Light>,
    pub(super) optics: Optics,
    /// What they leave unexplained.
    misfit: f64,
}

impl Explained {
    fn seen<'a>(&'a self, paint: &'a Paint) -> Seen<'a> {
        Seen {
            lit: self.light.as_ref().map(|light| Lit { paint, light }),
            optics: self.optics,
            accuracy: Accuracy::Codes,
            texture: None,
        }
    }
}

/// The way in which the outline is compared.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Accuracy {
    /// By the codes beside it, to hundredths of a pixel; farther than half a pixel all errors count
    /// alike.
    Codes,
    /// By the toy's coverage of a wide band: the outline of a model that is not quite the toy.
    Area,
}

impl Accuracy {
    /// Scale of the loss of a piece, in pixels: it counts at most the square of it.
    fn robust_px(self) -> f64 {
        match self {
            Self::Codes => Misfit::ROBUST_PX,
            Self::Area => WIDE.robust_px,
        }
    }
}

/// The source of a toy's size.
#[derive(Clone, Copy, PartialEq, Eq)]
enum SizeOf {
    Given,
    Found,
}

/// The result of a search.
#[derive(Clone)]
struct Settled {
    placement: Placement,
    measured: Vec<Measured>,
    misfit: Misfit,
    deviation: PoseDeviation,
    covariance: Information,
}

/// An estimate beside the given pose.
struct Compared {
    settled: Settled,
    /// The measured outline of the given pose.
    given: Vec<Measured>,
    /// Logarithm of the likelihood ratio of the estimate and the given pose.
    evidence: f64,
}

impl Compared {
    fn is_better(&self) -> bool {
        self.evidence >= LEAST_EVIDENCE
    }
}

impl Search<'_> {
    /// Estimates all six parameters, in all bands; standing, if the picture does not contradict it.
    pub(super) fn freed(&mut self, subject: Subject<'_>, given: Fit, motion: RigidMotion) -> Option<Found> {
        let Subject { shape, paint, ground } = subject;
        let light = self.light(paint, &Placement::of(motion));
        let lit = light.as_ref().map(|light| Lit { paint, light });
        let start = Placement::of(self.fine(motion, lit, wide_bands())?);
        let (explained, _) = self.explained(paint, &start);
        // The effects of camera and light on the outline are measured best near a match.
        let start = self.settled(explained.seen(paint), &start, None)?.placement;
        let (start, (explained, posed)) = self.explaining(paint, start);
        let seen = explained.seen(paint);
        let texture = posed
            .shaded
            .as_ref()
            .and_then(|shaded| Texture::new(shaded, self.pyramid.level(0), &posed.coverage));
        let (seen, free) = self.textured(seen, texture.as_ref(), &start)?;
        let standing = ground.and_then(|Ground { plane, .. }| Standing::on(shape, plane));
        let is_upright = |plane: &Plane| {
            free.placement.motion.turn_of(plane.normal).dot(plane.normal) >= UPRIGHT_RAD.cos()
        };
        let on_lowest = || {
            let ground = ground.filter(|ground| !ground.is_certain && is_upright(&ground.plane))?;
            Standing::on_lowest(shape, ground.plane)
        };
        let held = standing.clone().or_else(on_lowest);
        let ground = held.as_ref().zip(ground);
        let by_codes = self.compared(seen, free, ground);
        let is_found_by_codes = by_codes.is_better() || by_codes.settled.is_met(seen.optics);
        let best = if is_found_by_codes {
            by_codes
        } else {
            let by_area = self.by_area(seen, &start, ground);
            by_area.filter(Compared::is_better).unwrap_or(by_codes)
        };
        let settled = best.settled;
        let found = self.fit(&settled.placement)?;
        Some(Found {
            motion: settled.placement.matrix(),
            outlines_px: [
                outline_px(&given, &best.given, seen.optics),
                outline_px(&found, &settled.measured, seen.optics),
            ],
            is_less_seen: found.share <= given.share - LESS_SEEN,
            evidence: best.evidence,
            deviation: settled.deviation,
            covariance: settled.covariance.fixed_view::<6, 6>(0, 0).into_owned(),
            model_px: smoothed_px(&settled.measured),
            texture_correlation: settled.misfit.texture.map(|texture| texture.correlation),
            spread_px: seen.optics.spread_px,
            plate_spread_px: self.softened.as_ref().map_or(0.0, |(_, spread_px)| *spread_px),
            stands: standing.map(|standing| {
                let found = standing.stand(|point| settled.placement.apply(point));
                [standing.stand(|point| point), found]
            }),
        })
    }

    /// The pose by the coverage of a wide band, for a model that is not quite the toy.
    fn by_area(
        &mut self,
        seen: Seen<'_>,
        start: &Placement,
        ground: Option<(&Standing, Ground)>,
    ) -> Option<Compared> {
        let seen = Seen {
            accuracy: Accuracy::Area,
            ..seen
        };
        let free = self.settled(seen, start, None)?;
        Some(self.compared(seen, free, ground))
    }

    /// The pose on the toy's ground, compared with the given pose.
    fn compared(&mut self, seen: Seen<'_>, free: Settled, ground: Option<(&Standing, Ground)>) -> Compared {
        let settled = self.on_ground(seen, &free, ground);
        let as_given = Placement::of(RigidMotion::none(self.shape.centre, self.shape.radius_m));
        let given = self.edges(&as_given, seen).unwrap_or_default();
        let of_given = Misfit {
            texture: self.likeness(seen, &as_given),
            ..Misfit::of(&given, seen.accuracy.robust_px())
        };
        let is_better = |settled: &Settled| settled.misfit.likelier_than(&of_given) >= LEAST_EVIDENCE;
        let certain = ground.filter(|(_, ground)| ground.is_certain);
        // A plane that a toy need not stand on is no reason to leave its given place, and a free pose is none to leave a
        // plane that is as likely.
        let is_off_plane = certain.is_none() && free.misfit.likelier_than(&settled.misfit) >= UNDOUBTED;
        let settled = if is_off_plane && !is_better(&settled) && is_better(&free) {
            free
        } else {
            settled
        };
        let standing = certain.map_or(0.0, |(standing, _)| {
            standing.evidence(|point| settled.placement.apply(point))
        });
        Compared {
            evidence: settled.misfit.likelier_than(&of_given) + standing,
            settled,
            given,
        }
    }

    /// The toy on its ground, as far as it stands there; the free pose if it floats.
    fn on_ground(&mut self, seen: Seen<'_>, free: &Settled, ground: Option<(&Standing, Ground)>) -> Settled {
        let settled = ground.and_then(|(standing, ground)| {
            if ground.is_certain {
                self.on_plane(seen, free, standing)
            } else {
                self.stood(seen, free, standing)
            }
        });
        settled.unwrap_or_else(|| free.clone())
    }

    /// The toy on its plane, whatever the picture; in another size if that is much likelier.
    fn on_plane(&mut self, seen: Seen<'_>, free: &Settled, standing: &Standing) -> Option<Settled> {
        let own = self.settled(seen, &free.placement, Some((standing, SizeOf::Given)))?;
        let resized = self.resized(seen, &own.placement, standing);
        let resized = resized.filter(|resized| resized.misfit.likelier_than(&own.misfit) >= LEAST_EVIDENCE);
        Some(resized.unwrap_or(own))
    }

    /// The toy on its plane in the size that explains its outline there; `None` if that is another
    /// toy's.
    fn resized(&mut self, seen: Seen<'_>, start: &Placement, standing: &Standing) -> Option<Settled> {
        let resized = self.settled(seen, start, Some((standing, SizeOf::Found)))?;
        (resized.placement.size.ln().abs() < MOST_SIZE).then_some(resized)
    }

    /// The toy on its plane, or with its feet at their given heights, whichever the picture shows; in another size if
    /// it contradicts the plane, and `None` if it contradicts all.
    fn stood(&mut self, seen: Seen<'_>, free: &Settled, standing: &Standing) -> Option<Settled> {
        let is_likely = |settled: &Settled| free.misfit.likelier_than(&settled.misfit) < LEAST_EVIDENCE;
        let on_plane = self.settled(seen, &free.placement, Some((standing, SizeOf::Given)))?;
        let given = self.at_given_heights(seen, free, standing);
        if is_likely(&on_plane) {
            let is_given = |given: &Settled| {
                given.misfit.likelier_than(&on_plane.misfit) > -head_start(standing) && is_likely(given)
            };
            return Some(given.filter(is_given).unwrap_or(on_plane));
        }
        // A higher toy looks like a larger one on its plane: one that is given on a foot has its size.
        let given = given.filter(is_likely);
        if given.is_some() && standing.nearest_m() <= ON_PLANE_M {
            return given;
        }
        let is_clear = |resized: &Settled| {
            is_likely(resized) && resized.misfit.likelier_than(&on_plane.misfit) >= UNDOUBTED
        };
        let resized = self.resized(seen, &free.placement, standing);
        resized.filter(is_clear).or(given)
    }

    /// The toy with its feet at their given heights; `None` if these are on the plane.
    fn at_given_heights(&mut self, seen: Seen<'_>, free: &Settled, standing: &Standing) -> Option<Settled> {
        let heights = (standing.away_m() > ON_PLANE_M).then(|| standing.as_given())?;
        self.settled(seen, &free.placement, Some((&heights, SizeOf::Given)))
    }

    pub(super) fn light(&mut self, paint: &Paint, placement: &Placement) -> Option<Light> {
        let posed = self.posed(placement, None);
        paint.light(placement, self.pyramid.level(0), &posed.coverage)
    }

    /// Estimates the pose freely, by the outline and by the toy's texture if it is the model's. It
    /// starts from the outline's result, or else from the given pose, since an outline may slide
    /// away from a texture.
    fn textured<'a>(
        &mut self,
        seen: Seen<'a>,
        texture: Option<&'a Texture>,
        start: &Placement,
    ) -> Option<(Seen<'a>, Settled)> {
        if texture.is_some() {
            let textured = Seen { texture, ..seen };
            let given = Placement::of(RigidMotion::none(self.shape.centre, self.shape.radius_m));
            for from in [start, &given] {
                let found = self.settled(textured, from, None);
                if let Some(found) = found.filter(|found| found.misfit.is_texture_of_model()) {
                    return Some((textured, found));
                }
            }
        }
        Some((seen, self.settled(seen, start, None)?))
    }

    fn likeness(&self, seen: Seen<'_>, placement: &Placement) -> Option<Likeness> {
        let k = &self.pyramid.level(0).intrinsics;
        seen.texture.and_then(|texture| texture.likeness(placement, k))
    }

    /// A placement found by rounds that know little of the toy's colours, or the given one if the
    /// codes beside its outline are explained better by a sharp picture: where the toy is as bright as
    /// the table, such rounds slide off a given pose that is right. A blur explains a poor model, too.
    ///
    /// Measured: with the toy pushed aside in the plate, a pale llama on dark wood had RMS errors of 10.0/23.2/29.5
    /// codes (shadow/toy/edge) without it, and 3.3/5.0/10.1 with it.
    fn explaining<'a>(&mut self, paint: &'a Paint, found: Placement) -> (Placement, (Explained, Posed<'a>)) {
        let given = Placement::of(RigidMotion::none(self.shape.centre, self.shape.radius_m));
        let by_given = self.explained(paint, &given);
        let softened = self.softened.take();
        let by_found = self.explained(paint, &found);
        if by_given.0.optics.spread_px < blur::SOFT_PX && by_given.0.misfit < by_found.0.misfit {
            self.softened = softened;
            return (given, by_given);
        }
        (found, by_found)
    }

    /// Light and camera at a placement, and the toy there in that light; if it is soft, with a blurred or
    /// the original plate, whichever explains more.
    pub(super) fn explained<'a>(
        &mut self,
        paint: &'a Paint,
        placement: &Placement,
    ) -> (Explained, Posed<'a>) {
        let posed = self.lit(paint, placement);
        let sharp = self.pyramid.level(0);
        let found = |level: &Level| blur::optics(&posed.beside(level), &posed.elements);
        self.softened = None;
        let (mut optics, mut misfit) = found(sharp);
        let spread_px = optics.spread_px;
        let is_soft = spread_px >= blur::SOFT_PX;
        if let Some(softened) = is_soft.then(|| sharp.with_plate_spread(spread_px)).flatten() {
            let (of_softened, its_misfit) = found(&softened);
            if its_misfit < misfit {
                self.softened = Some((softened, spread_px));
                (optics, misfit) = (of_softened, its_misfit);
            }
        }
        let explained = Explained {
            light: posed.shaded.as_ref().map(|shaded| shaded.light().clone()),
            optics,
            misfit,
        };
        (explained, posed)
    }

    /// The pieces measured by codes or by area; `None` if there are too few.
    fn edges(&mut self, placement: &Placement, seen: Seen<'_>) -> Option<Vec<Measured>> {
        if seen.accuracy == Accuracy::Area {
            return self
                .matte(placement, seen.lit, WIDE)
                .map(|(measured, _)| measured);
        }
        let posed = self.posed(placement, seen.lit);
        let softened = self.softened.as_ref().map(|(level, _)| level);
        let level = softened.unwrap_or_else(|| self.pyramid.level(0));
        let half_px = COMPARED_PX + seen.optics.half_px();
        let measured = edge::measure(&posed.beside(level), &posed.elements, seen.optics, half_px);
        enough(measured, &posed.elements).map(|(measured, _)| measured)
    }

    /// Optimises all free parameters; the feet of a standing toy are on their plane, and its size
    /// may be estimated.
    fn settled(
        &mut self,
        seen: Seen<'_>,
        start: &Placement,
        standing: Option<(&Standing, SizeOf)>,
    ) -> Option<Settled> {
        let pyramid = self.pyramid;
        let known = Known {
            k: &pyramid.level(0).intrinsics,
            radius_m: self.shape.radius_m,
            standing: standing.map(|(standing, _)| standing),
            most_robust_px: seen.accuracy.robust_px(),
            is_size_open: standing.is_some_and(|(_, size)| size == SizeOf::Found),
        };
        let rows = |round: usize, placement: &Placement| {
            let texture = seen
                .texture
                .map(|texture| texture.rows(round, placement, known.k));
            texture.unwrap_or_default()
        };
        let first_sharp = if seen.texture.is_some() { LAST_SPREAD } else { 0 };
        let mut placement = *start;
        let mut measured = self.edges(&placement, seen)?;
        for round in 0..first_sharp + N_ROUNDS {
            let step = Balance::new((&measured, rows(round, &placement)), &placement, known).step()?;
            placement = placement.then(&step, &self.uncertainty);
            measured = self.edges(&placement, seen)?;
            let is_short = step.fixed_rows::<SIZE>(0).norm() < LAST_STEP * self.shape.radius_m;
            if is_short && round >= first_sharp {
                break;
            }
        }
        let misfit = Misfit {
            texture: self.likeness(seen, &placement),
            ..Misfit::of(&measured, seen.accuracy.robust_px())
        };
        let depth_m = -placement.motion.centre().z;
        let balance = Balance::new((&measured, rows(usize::MAX, &placement)), &placement, known);
        let covariance = balance.covariance();
        Some(Settled {
            deviation: balance.deviation(&covariance, (misfit.loss_px2.sqrt(), depth_m)),
            covariance,
            misfit,
            placement,
            measured,
        })
    }
}

impl Settled {
    /// Whether the outline is the picture's, so that no other pose is.
    fn is_met(&self, optics: Optics) -> bool {
        self.misfit.loss_px2 < met_px2(optics)
    }
}

/// Evidence for the plane with which feet are still taken to be at their given heights. A toy whose lowest foot is given
/// on its plane was put there, and its other feet may hang in the air; one that is given a millimetre away was not.
fn head_start(standing: &Standing) -> f64 {
    if standing.lowest_m().abs() <= ON_PLANE_M {
        UNDOUBTED
    } else if standing.away_m() <= NEAR_PLANE_M {
        0.0
    } else {
        -UNDOUBTED
    }
}

/// All bands by area except the finest, which is replaced by codes.
fn wide_bands() -> &'static [(Band, usize)] {
    &FINE[..FINE.len() - 1]
}

/// Largest loss of a matching outline, in square pixels.
fn met_px2(optics: Optics) -> f64 {
    MET_PX2 + MET_OF_SPREAD * optics.spread_px
}

/// Root mean square distance of an outline, in pixels: by the codes beside it if they belong to
/// this outline, since noise and sharpening do not bias them, and else by area.
fn outline_px(fit: &Fit, measured: &[Measured], optics: Optics) -> f64 {
    let loss_px2 = Misfit::of(measured, Misfit::ROBUST_PX).loss_px2;
    let is_near = loss_px2 < ROUGH_PX2 + MET_OF_SPREAD * optics.spread_px;
    if is_near && smoothed_px(measured) < most_model_px(optics.spread_px) {
        fit.outline_px().min(loss_px2.sqrt())
    } else {
        fit.outline_px()
    }
}
