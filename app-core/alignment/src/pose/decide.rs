//! The last rounds: a pose by the codes beside the outline, freely and on its plane, and which of these the picture speaks for.

use super::edge::{self, Optics};
use super::matte::Band;
use super::motion::Measured;
use super::paint::{Light, Lit, Paint};
use super::placement::{Placement, SIZE};
use super::settle::{Balance, Known, LEAST_EVIDENCE, Misfit, smoothed_px};
use super::standing::{Ground, Standing};
use super::texture::{LAST_SPREAD, Likeness, Texture};
use super::{FINE, Fit, Found, Search, Subject, enough};
use crate::picture::Level;
use crate::report::{PoseDeviation, most_model_px};
use crate::rigid_motion::RigidMotion;

/// If the picture speaks against a toy on its plane by more than that, half of what decides, its feet are tried as high as they were given,
/// and the toy in another size; these are taken if they are likelier by as much.
const UNDOUBTED: f64 = 0.5 * LEAST_EVIDENCE;
/// If a photograph is spread by more, in pixels, its plate is tried as soft as it is. A picture of a sharp lens, compressed or not, is
/// spread by .6 at most.
const SOFT_PX: f64 = 0.7;
/// Most rounds of one search; each leaves about half of what the one before left.
const N_ROUNDS: usize = 8;
/// A step that moves the toy by less, over its radius, is the last: a thousandth of a pixel.
const LAST_STEP: f64 = 2e-5;
/// The band is wider by as much on either side than an edge of that spread needs, in pixels, so that poses some pixels apart can be compared.
pub(super) const COMPARED_PX: f64 = 1.0;
/// Feet that are given nearer to the plane, in metres, are given on it: about the deviation of feet that stand.
const ON_PLANE_M: f64 = 2e-4;
/// An outline is met if its loss is less, in square pixels, and by how much more for each pixel of spread. Right outlines came to .04 in
/// sharp pictures, compressed or not, and to .12 in pictures that are spread by 2 px.
const MET_PX2: f64 = 0.06;
const MET_OF_SPREAD: f64 = 0.04;
/// A toy whose size differs by more, as a logarithm, is another toy; as much as the scale of a world may be off.
const MOST_SIZE: f64 = 0.03;

/// How much less of the outline a better pose may have measured: a different part of it may be thin, or beside a corner.
const LESS_SEEN: f64 = 0.1;

/// What is known before the last rounds.
#[derive(Clone, Copy)]
struct Seen<'a> {
    lit: Option<Lit<'a>>,
    optics: Optics,
    /// None if the toy has none, or another one than its model.
    texture: Option<&'a Texture>,
}

/// Where the size of a toy comes from.
#[derive(Clone, Copy, PartialEq, Eq)]
enum SizeOf {
    Given,
    Found,
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
        let Subject { shape, paint, ground } = subject;
        let light = self.light(paint, &Placement::of(motion));
        let lit = light.as_ref().map(|light| Lit { paint, light });
        let start = Placement::of(self.fine(motion, lit, wide_bands())?);
        let light = self.light(paint, &start);
        let seen = self.seen(&start, light.as_ref().map(|light| Lit { paint, light }));
        // What a camera and the light do to the outline is seen best once that is nearly met.
        let start = self.settled(seen, &start, None)?.placement;
        let light = self.light(paint, &start);
        let seen = self.seen(&start, light.as_ref().map(|light| Lit { paint, light }));
        let texture = seen.lit.and_then(|lit| self.texture(lit, &start));
        let (seen, free) = self.textured(seen, texture.as_ref(), &start)?;
        let standing = ground.and_then(|Ground { plane, .. }| Standing::on(shape, plane));
        let certain = standing
            .as_ref()
            .filter(|_| ground.is_some_and(|ground| ground.is_certain));
        let settled = match (certain, &standing) {
            (Some(standing), _) => self.on_plane(seen, &free, standing),
            (None, Some(standing)) => self.stood(seen, &free, standing),
            (None, None) => None,
        };
        let settled = settled.unwrap_or_else(|| free.clone());
        let as_given = Placement::of(RigidMotion::none(shape.centre, shape.radius_m));
        let as_given = self.edges(&as_given, seen).unwrap_or_default();
        let of_given = Misfit {
            texture: self.likeness(
                seen,
                &Placement::of(RigidMotion::none(shape.centre, shape.radius_m)),
            ),
            ..Misfit::of(&as_given)
        };
        let standing_evidence = certain.map_or(0.0, |standing| {
            standing.evidence(|point| settled.placement.apply(point))
        });
        let is_refused = certain.is_none() && settled.misfit.likelier_than(&of_given) < LEAST_EVIDENCE;
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
            texture_correlation: settled.misfit.texture.map(|texture| texture.correlation),
            spread_px: seen.optics.spread_px,
            plate_spread_px: self.softened.as_ref().map_or(0.0, |(_, spread_px)| *spread_px),
            stands: standing.map(|standing| {
                let found = standing.stand(|point| settled.placement.apply(point));
                [standing.stand(|point| point), found]
            }),
        })
    }

    /// The toy on its plane, whatever the picture says; in another size where that is so much likelier.
    fn on_plane(&mut self, seen: Seen<'_>, free: &Settled, standing: &Standing) -> Option<Settled> {
        let own = self.settled(seen, &free.placement, Some((standing, SizeOf::Given)))?;
        let resized = self.resized(seen, &own.placement, standing);
        let resized = resized.filter(|resized| resized.misfit.likelier_than(&own.misfit) >= LEAST_EVIDENCE);
        Some(resized.unwrap_or(own))
    }

    /// The toy on its plane in the size that explains its outline there; none if that is another toy's.
    fn resized(&mut self, seen: Seen<'_>, start: &Placement, standing: &Standing) -> Option<Settled> {
        let resized = self.settled(seen, start, Some((standing, SizeOf::Found)))?;
        (resized.placement.size.ln().abs() < MOST_SIZE).then_some(resized)
    }

    /// The toy on its plane, in its own size or in another, or with its feet as high as they are given; none where the picture
    /// speaks against all of these.
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

    /// What the camera spreads the outline by.
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
            texture: None,
        }
    }

    /// The model's paint about where the toy is; none if it has no texture there.
    fn texture(&mut self, lit: Lit<'_>, placement: &Placement) -> Option<Texture> {
        let posed = self.posed(placement, Some(lit));
        Texture::new(posed.shaded.as_ref()?, self.pyramid.level(0), &posed.coverage)
    }

    /// Freely, by the outline and by the toy's texture if that is its model's; from where the outline is, or else, since an outline may
    /// slide away from a texture, from where the toy was given.
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

    /// What the camera does to an outline; where it is soft, with the plate as soft or as it was taken, whichever explains more.
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

    /// The pieces by the codes beside them; none where that is too little.
    fn edges(&mut self, placement: &Placement, seen: Seen<'_>) -> Option<Vec<Measured>> {
        let posed = self.posed(placement, seen.lit);
        let softened = self.softened.as_ref().map(|(level, _)| level);
        let level = softened.unwrap_or_else(|| self.pyramid.level(0));
        let half_px = COMPARED_PX + seen.optics.half_px();
        let measured = edge::measure(&posed.beside(level), &posed.elements, seen.optics, half_px);
        enough(measured, &posed.elements).map(|(measured, _)| measured)
    }

    /// With all that is free; the feet of a toy that stands are on their plane, and its size may be looked for.
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
            ..Misfit::of(&measured)
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
