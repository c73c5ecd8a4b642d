//! The last rounds: a pose estimated from the codes beside the outline, freely and on its plane,
//! and the choice between them.

use super::edge::{self, Optics};
use super::matte::Band;
use super::motion::Measured;
use super::paint::{Light, Lit, Paint};
use super::placement::{Placement, SIZE};
use super::settle::{Balance, Known, LEAST_EVIDENCE, Misfit, smoothed_px};
use super::standing::{Ground, Standing};
use super::texture::{LAST_SPREAD, Likeness, Texture};
use super::{FINE, Fit, Found, Search, Subject, WIDE, enough};
use crate::median::median;
use crate::picture::Level;
use crate::report::{PoseDeviation, most_model_px};
use crate::rigid_motion::RigidMotion;

/// Evidence against a toy on its plane, half of the decisive amount, above which the given height
/// of its feet and another size are tried; these are used if they are likelier by that amount.
const UNDOUBTED: f64 = 0.5 * LEAST_EVIDENCE;
/// Blur of a photograph, in pixels, above which an equally blurred plate is tried. A picture of a
/// sharp lens, compressed or not, has .6 at most.
const SOFT_PX: f64 = 0.7;
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
/// Largest loss of a matching outline in square pixels, and its increase per pixel of blur. Correct
/// outlines came to .04 in sharp pictures, compressed or not, and to .12 in pictures with a blur of
/// 2 px.
const MET_PX2: f64 = 0.06;
const MET_OF_SPREAD: f64 = 0.04;
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
        let light = self.light(paint, &start);
        let seen = self.seen(&start, light.as_ref().map(|light| Lit { paint, light }));
        // The effects of camera and light on the outline are measured best near a match.
        let start = self.settled(seen, &start, None)?.placement;
        let light = self.light(paint, &start);
        let seen = self.seen(&start, light.as_ref().map(|light| Lit { paint, light }));
        let texture = seen.lit.and_then(|lit| self.texture(lit, &start));
        let (seen, free) = self.textured(seen, texture.as_ref(), &start)?;
        let standing = ground.and_then(|Ground { plane, .. }| Standing::on(shape, plane));
        let ground = standing.as_ref().zip(ground);
        let by_codes = self.compared(seen, free, ground);
        let best = if by_codes.is_better() || by_codes.settled.is_measured() {
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
        // A plane that a toy need not stand on is no reason to leave its given place.
        let settled = if certain.is_none() && !is_better(&settled) && is_better(&free) {
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

    /// The toy on its plane, in its own size or in another, or with its feet at their given height;
    /// `None` if the picture contradicts all of these.
    fn stood(&mut self, seen: Seen<'_>, free: &Settled, standing: &Standing) -> Option<Settled> {
        let is_likely = |settled: &Settled| free.misfit.likelier_than(&settled.misfit) < LEAST_EVIDENCE;
        let on_plane = self.settled(seen, &free.placement, Some((standing, SizeOf::Given)))?;
        let is_given_elsewhere = standing.away_m() > ON_PLANE_M;
        let costs = free.misfit.likelier_than(&on_plane.misfit);
        if costs < UNDOUBTED || (costs < LEAST_EVIDENCE && !is_given_elsewhere) {
            return Some(on_plane);
        }
        let mut others = Vec::new();
        if is_given_elsewhere {
            let heights = standing.as_given();
            others.extend(self.settled(seen, &free.placement, Some((&heights, SizeOf::Given))));
        }
        others.extend(self.resized(seen, &free.placement, standing));
        let best = others
            .into_iter()
            .filter(|other| is_likely(other) && other.misfit.likelier_than(&on_plane.misfit) >= UNDOUBTED)
            .min_by(|a, b| a.misfit.loss_px2.total_cmp(&b.misfit.loss_px2));
        best.or_else(|| is_likely(&on_plane).then_some(on_plane))
    }

    /// The camera's blur of the outline.
    pub(super) fn spread_px(&mut self, paint: &Paint, placement: &Placement) -> f64 {
        let light = self.light(paint, placement);
        let lit = light.as_ref().map(|light| Lit { paint, light });
        self.optics(placement, lit).spread_px
    }

    pub(super) fn light(&mut self, paint: &Paint, placement: &Placement) -> Option<Light> {
        let posed = self.posed(placement, None);
        paint.light(placement, self.pyramid.level(0), &posed.coverage)
    }

    fn seen<'a>(&mut self, placement: &Placement, lit: Option<Lit<'a>>) -> Seen<'a> {
        let optics = self.optics(placement, lit);
        Seen {
            lit,
            optics,
            accuracy: Accuracy::Codes,
            texture: None,
        }
    }

    /// The model's paint near the toy's pose; `None` if it has no texture there.
    fn texture(&mut self, lit: Lit<'_>, placement: &Placement) -> Option<Texture> {
        let posed = self.posed(placement, Some(lit));
        Texture::new(posed.shaded.as_ref()?, self.pyramid.level(0), &posed.coverage)
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

    /// The camera's edge response; if it is soft, with a blurred or the original plate, whichever
    /// explains more.
    fn optics(&mut self, placement: &Placement, lit: Option<Lit<'_>>) -> Optics {
        let posed = self.posed(placement, lit);
        let sharp = self.pyramid.level(0);
        let found = |level: &Level| Optics::found(&posed.beside(level), &posed.elements);
        self.softened = None;
        let (optics, misfit) = found(sharp);
        let is_soft = optics.spread_px >= SOFT_PX;
        let softened = is_soft.then(|| sharp.with_plate_spread(optics.spread_px));
        let Some(softened) = softened.flatten() else {
            return optics;
        };
        let (of_softened, its_misfit) = found(&softened);
        if its_misfit < misfit {
            self.softened = Some((softened, optics.spread_px));
            of_softened
        } else {
            optics
        }
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
        Some(Settled {
            deviation: balance.deviation(misfit.loss_px2.sqrt(), depth_m),
            misfit,
            placement,
            measured,
        })
    }
}

impl Settled {
    /// Whether most of the outline is near enough for codes to say how far away it is.
    fn is_measured(&self) -> bool {
        let offsets_px = self.measured.iter().map(|one| one.offset_px.abs());
        median(offsets_px, f64::total_cmp).is_some_and(|offset_px| offset_px < COMPARED_PX)
    }
}

/// All bands by area except the finest, which is replaced by codes.
fn wide_bands() -> &'static [(Band, usize)] {
    &FINE[..FINE.len() - 1]
}

/// Root mean square distance of an outline, in pixels: by the codes beside it if they belong to
/// this outline, since noise and sharpening do not bias them, and else by area.
fn outline_px(fit: &Fit, measured: &[Measured], optics: Optics) -> f64 {
    let loss_px2 = Misfit::of(measured, Misfit::ROBUST_PX).loss_px2;
    let is_near = loss_px2 < MET_PX2 + MET_OF_SPREAD * optics.spread_px;
    if is_near && smoothed_px(measured) < most_model_px(optics.spread_px) {
        fit.outline_px().min(loss_px2.sqrt())
    } else {
        fit.outline_px()
    }
}
