//! The last rounds: a pose by the codes beside the outline, freely and on its plane, and which of these the picture speaks for.

use super::edge::{self, Optics};
use super::matte::Band;
use super::motion::Measured;
use super::paint::{Light, Lit, Paint};
use super::placement::{Placement, SIZE};
use super::settle::{Balance, Known, LEAST_EVIDENCE, Misfit, smoothed_px};
use super::sides::Beside;
use super::standing::Standing;
use super::{FINE, Fit, Found, LESS_SEEN, Search, Subject, enough};
use crate::picture::Level;
use crate::report::{PoseDeviation, most_model_px};
use crate::rigid_motion::RigidMotion;

/// A toy on its plane is not doubted while the picture speaks against it by less; feet as high as they were given, or another size, are
/// then as likely as they are unlikely: half of what decides.
const UNDOUBTED: f64 = 0.5 * LEAST_EVIDENCE;
/// Plates are tried as soft as the photograph where that is spread by more, in pixels.
const SOFT_PX: f64 = 0.7;
/// How often light and optics are looked at anew, before the last time.
const N_LOOKS: usize = 1;
/// Most rounds; each leaves about half of what the one before left.
const N_ROUNDS: usize = 8;
/// A step that moves the toy by less, over its radius, is the last.
const LAST_STEP: f64 = 2e-5;
/// Half the band in which poses are compared that are some pixels apart, less what a spread adds.
const COMPARED_PX: f64 = 1.0;
/// Feet that are given nearer to the plane, in metres, are given on it.
const ON_PLANE_M: f64 = 2e-4;
/// Codes are those of an outline where its loss is less, in square pixels, and more so where the picture is spread by a pixel. Right
/// outlines came to .04 in sharp pictures, compressed or not, and to .12 in one that is spread by 2 px.
const MET_PX2: f64 = 0.06;
const MET_OF_SPREAD: f64 = 0.04;
/// Sizes beyond are not those of the same toy, as a logarithm.
const MOST_SIZE: f64 = 0.03;

/// What is known before the last rounds.
#[derive(Clone, Copy)]
struct Seen<'a> {
    lit: Option<Lit<'a>>,
    optics: Optics,
}

/// Where the search came to rest.
#[derive(Clone)]
struct Settled {
    placement: Placement,
    measured: Vec<Measured>,
    misfit: Misfit,
    deviation: PoseDeviation,
}

impl Search<'_> {
    /// With all six freedoms, in all bands; standing, where the picture does not speak against it.
    pub(super) fn freed(&mut self, subject: Subject<'_>, given: Fit, motion: RigidMotion) -> Option<Found> {
        let Subject { shape, paint, plane } = subject;
        let light = self.light(paint, &Placement::of(motion));
        let lit = light.as_ref().map(|light| Lit { paint, light });
        let mut start = Placement::of(self.fine(motion, lit, wide_bands())?);
        // What a camera and the light do to the outline is seen best where that is nearly met.
        for _ in 0..N_LOOKS {
            let light = self.light(paint, &start);
            let lit = light.as_ref().map(|light| Lit { paint, light });
            let optics = self.optics(&start, lit);
            start = self
                .settled(Seen { lit, optics }, &start, (None, N_ROUNDS))?
                .placement;
        }
        let light = self.light(paint, &start);
        let seen = {
            let lit = light.as_ref().map(|light| Lit { paint, light });
            let optics = self.optics(&start, lit);
            Seen { lit, optics }
        };
        let free = self.settled(seen, &start, (None, N_ROUNDS))?;
        let standing = plane.and_then(|(plane, is_certain)| Some((Standing::on(shape, plane)?, is_certain)));
        let settled = match &standing {
            Some((standing, true)) => self.on_plane(seen, &free, standing),
            Some((standing, false)) => self.stood(seen, &free, standing),
            None => None,
        };
        let settled = settled.unwrap_or_else(|| free.clone());
        let as_given = Placement::of(RigidMotion::none(shape.centre, shape.radius_m));
        let as_given = self.edges(&as_given, seen).unwrap_or_default();
        let of_given = Misfit::of(&as_given);
        let is_certain = standing.as_ref().is_some_and(|(_, is_certain)| *is_certain);
        let standing_evidence = match &standing {
            Some((standing, true)) => standing.evidence(|point| settled.placement.apply(point)),
            _ => 0.0,
        };
        let is_refused = !is_certain && settled.misfit.likelier_than(&of_given) < LEAST_EVIDENCE;
        // A plane that a toy need not stand on is no reason to leave it where it is not.
        let settled = if is_refused && free.misfit.likelier_than(&of_given) >= LEAST_EVIDENCE {
            free
        } else {
            settled
        };
        let found = self.fit(&settled.placement)?;
        Some(Found {
            motion: settled.placement.matrix(),
            outlines_px: [
                outline_px(&given, &as_given, seen.optics),
                outline_px(&found, &settled.measured, seen.optics),
            ],
            is_less_seen: found.share <= given.share - LESS_SEEN,
            evidence: settled.misfit.likelier_than(&of_given) + standing_evidence,
            deviation: settled.deviation,
            model_px: smoothed_px(&settled.measured),
            spread_px: seen.optics.spread_px,
            plate_spread_px: self.softened.as_ref().map_or(0.0, |(_, spread_px)| *spread_px),
            stands: standing.map(|(standing, _)| {
                let found = standing.stand(|point| settled.placement.apply(point));
                [standing.stand(|point| point), found]
            }),
        })
    }

    /// The toy on its plane, whatever the picture says; in another size where that is so much likelier.
    fn on_plane(&mut self, seen: Seen<'_>, free: &Settled, standing: &Standing) -> Option<Settled> {
        let own = self.settled(seen, &free.placement, (Some((standing, false)), N_ROUNDS))?;
        let resized = self.settled(seen, &own.placement, (Some((standing, true)), N_ROUNDS));
        let resized = resized.filter(|resized| {
            let is_same_toy = resized.placement.size.ln().abs() < MOST_SIZE;
            is_same_toy && resized.misfit.likelier_than(&own.misfit) >= LEAST_EVIDENCE
        });
        Some(resized.unwrap_or(own))
    }

    /// The toy on its plane, in its own size or in another, or with its feet as high as they are given; none where the picture
    /// speaks against all of these.
    fn stood(&mut self, seen: Seen<'_>, free: &Settled, standing: &Standing) -> Option<Settled> {
        let is_likely = |settled: &Settled| free.misfit.likelier_than(&settled.misfit) < LEAST_EVIDENCE;
        let on_plane = self.settled(seen, &free.placement, (Some((standing, false)), N_ROUNDS))?;
        let is_given_elsewhere = standing.away_m() > ON_PLANE_M;
        let costs = free.misfit.likelier_than(&on_plane.misfit);
        if costs < UNDOUBTED || (costs < LEAST_EVIDENCE && !is_given_elsewhere) {
            return Some(on_plane);
        }
        let mut others = Vec::new();
        if is_given_elsewhere {
            let heights = standing.as_given();
            others.extend(self.settled(seen, &free.placement, (Some((&heights, false)), N_ROUNDS)));
        }
        let resized = self.settled(seen, &free.placement, (Some((standing, true)), N_ROUNDS));
        others.extend(resized.filter(|resized| resized.placement.size.ln().abs() < MOST_SIZE));
        let best = others
            .into_iter()
            .filter(|other| is_likely(other) && other.misfit.likelier_than(&on_plane.misfit) >= UNDOUBTED)
            .min_by(|a, b| a.misfit.loss_px2.total_cmp(&b.misfit.loss_px2));
        best.or_else(|| is_likely(&on_plane).then_some(on_plane))
    }

    fn light(&mut self, paint: &Paint, placement: &Placement) -> Option<Light> {
        let level = self.pyramid.level(0);
        let (coverage, _) = self.outline(placement, level);
        paint.light(placement, level, &coverage)
    }

    /// What the camera does to an outline; where it is soft, with the plate as soft or as it was taken, whichever explains more.
    fn optics(&mut self, placement: &Placement, lit: Option<Lit<'_>>) -> Optics {
        let sharp = self.pyramid.level(0);
        let (coverage, elements) = self.outline(placement, sharp);
        let shaded = lit.map(|lit| lit.shaded(placement, sharp, &coverage));
        let found = |level: &Level| {
            let beside = Beside {
                level,
                coverage: &coverage,
                shaded: shaded.as_ref(),
            };
            Optics::found(&beside, &elements)
        };
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

    /// The pieces by the codes beside them; none where that is too little.
    fn edges(&mut self, placement: &Placement, seen: Seen<'_>) -> Option<Vec<Measured>> {
        let (coverage, elements) = self.outline(placement, self.pyramid.level(0));
        let softened = self.softened.as_ref().map(|(level, _)| level);
        let level = softened.unwrap_or_else(|| self.pyramid.level(0));
        let shaded = seen.lit.map(|lit| lit.shaded(placement, level, &coverage));
        let beside = Beside {
            level,
            coverage: &coverage,
            shaded: shaded.as_ref(),
        };
        let half_px = COMPARED_PX + seen.optics.half_px();
        let measured = edge::measure(&beside, &elements, seen.optics, half_px);
        enough(measured, &elements).map(|(measured, _)| measured)
    }

    /// With all that is free; standing with or without its size, for so many rounds.
    fn settled(
        &mut self,
        seen: Seen<'_>,
        start: &Placement,
        (standing, n_rounds): (Option<(&Standing, bool)>, usize),
    ) -> Option<Settled> {
        let pyramid = self.pyramid;
        let known = Known {
            k: &pyramid.level(0).intrinsics,
            radius_m: self.shape.radius_m,
            standing: standing.map(|(standing, _)| standing),
            is_size_open: standing.is_some_and(|(_, is_size_open)| is_size_open),
        };
        let mut placement = *start;
        let mut measured = self.edges(&placement, seen)?;
        for _ in 0..n_rounds {
            let step = Balance::new(&measured, &placement, known).step()?;
            placement = placement.then(&step, &self.uncertainty);
            measured = self.edges(&placement, seen)?;
            if step.fixed_rows::<SIZE>(0).norm() < LAST_STEP * self.shape.radius_m {
                break;
            }
        }
        let misfit = Misfit::of(&measured);
        let depth_m = -placement.motion.centre().z;
        let balance = Balance::new(&measured, &placement, known);
        Some(Settled {
            deviation: balance.deviation(misfit.loss_px2.sqrt(), depth_m),
            misfit,
            placement,
            measured,
        })
    }
}

/// All bands by area but the finest, which codes stand in for.
fn wide_bands() -> &'static [(Band, usize)] {
    &FINE[..FINE.len() - 1]
}

/// Root mean square distance of an outline, in pixels: by the codes beside it where they are those of this outline, which noise and
/// sharpening leave as it is, and else by area.
fn outline_px(fit: &Fit, measured: &[Measured], optics: Optics) -> f64 {
    let loss_px2 = Misfit::of(measured).loss_px2;
    let is_near = loss_px2 < MET_PX2 + MET_OF_SPREAD * optics.spread_px;
    if is_near && smoothed_px(measured) < most_model_px(optics.spread_px) {
        fit.outline_px().min(loss_px2.sqrt())
    } else {
        fit.outline_px()
    }
}
