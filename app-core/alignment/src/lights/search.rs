//! Estimates unknown lights one after the other, each at the direction that explains most of the
//! residual.
//!
//! A small picture determines their number: point lights all over the hemisphere are tried
//! (`hemisphere`), the best of them become lamps of any distance and size by Gauss-Newton steps
//! (`step`), and are kept as long as there is `evidence`. Larger pictures refine them, and give
//! their `uncertainty`.

use glam::{DVec2, DVec3};

use super::evidence::{doubtful, is_gain, outshines};
use super::hemisphere::{climb, lamp_from, lamps as hemisphere, peaks};
use super::initial_light::{Hints, best_initial_lights};
use super::lamp::{Lamp, disc};
use super::prior::Prior;
use super::refine::{MeasuredLight, Refined};
use super::shading::Shading;
use super::shadows::{LEAST_PIXELS, ROBUST_FAR, Shadows};
use super::unexplained::Unexplained;
use crate::no_light::NoLight;
use crate::picture::Pyramid;
use crate::raster::Rasterizer;
use crate::receivers::{SeenReceiver, up};
use crate::report::PoseDeviation;
use crate::shape::Shape;
use app_scene::scene::MAX_LIGHTS;

/// Number of directions that are followed for each further lamp; fewer if the best is clearly
/// better.
const N_STARTS: usize = 3;
const OF_BEST: f64 = 0.25;
/// Spreads that are tried there, and the number of points over the lamp.
const SPREADS: [f64; 4] = [0.01, 0.05, 0.15, 0.35];
const N_SPREAD_POINTS: usize = 12;
/// Smallest explained fraction of the residual for a start.
const LEAST_EXPLAINED: f64 = 0.01;
/// Rounds of one more lamp alone, and of all together.
const N_ALONE: usize = 5;
const N_TOGETHER: usize = 3;
/// Number of pictures larger than the searched one.
const N_LARGER_LEVELS: usize = 2;
/// Sides of the cells that vertices are merged in, in pixels: while lamps are counted, and later.
const SEARCH_CELL_PX: f64 = 0.5;
const CELL_PX: f64 = 0.1;
/// The centre of a lamp alone.
const POINT: [DVec2; 1] = [DVec2::ZERO];

/// Estimates the lamps whose shadows a picture shows; `pose` is the uncertainty of the toy's. If
/// there are guesses, lamps are searched around them, one for each; a light estimate is a start if
/// no other leads to a lamp, and is judged by evidence like any other.
pub(super) fn search_lights(
    shape: &Shape,
    receivers: &[SeenReceiver],
    pyramid: &Pyramid,
    pose: &PoseDeviation,
    hints: &Hints,
) -> Result<Vec<MeasuredLight>, NoLight> {
    let searched = pyramid.smallest_for_shadows();
    let coarse = shape.merged_in_px(SEARCH_CELL_PX, pyramid.level(searched));
    let mut raster = Rasterizer::default();
    let mut shadows = Shadows::new(&mut raster, (&coarse, receivers), pyramid.level(searched), None);
    shadows.is_rough = true;
    if shadows.pixels.len() < LEAST_PIXELS {
        return Err(NoLight::ReceiversUnseen);
    }
    let mut lamps = if hints.initial_lights.is_empty() {
        Search::new(shadows, &mut raster).all_lamps(hints.estimated)
    } else {
        best_initial_lights(&shadows, &mut raster, &hints.initial_lights)
    };
    for level in (searched.saturating_sub(N_LARGER_LEVELS)..=searched).rev() {
        let fine = shape.merged_in_px(CELL_PX, pyramid.level(level));
        let is_last = level == searched.saturating_sub(N_LARGER_LEVELS);
        let level = pyramid.level(level);
        let mut refined = Refined {
            shadows: Shadows::new(&mut raster, (&fine, receivers), level, Some(&lamps)),
            lamps,
        };
        refined.refine(&mut raster);
        if refined.lamps.is_empty() {
            break;
        }
        if refined.is_wide() || is_last {
            return Ok(refined.measured(&mut raster, pose));
        }
        lamps = refined.lamps;
    }
    Err(NoLight::NoneDominant)
}

/// Directions all over the hemisphere, in camera space, and the fraction of the residual of ambient
/// light that a point light in each would explain; `None` if too little of the receivers is
/// visible.
pub(crate) fn scores(
    shape: &Shape,
    receivers: &[SeenReceiver],
    pyramid: &Pyramid,
) -> Option<Vec<(DVec3, f64)>> {
    let searched = pyramid.smallest_for_shadows();
    let coarse = shape.merged_in_px(SEARCH_CELL_PX, pyramid.level(searched));
    let mut raster = Rasterizer::default();
    let shadows = Shadows::new(&mut raster, (&coarse, receivers), pyramid.level(searched), None);
    if shadows.pixels.len() < LEAST_PIXELS {
        return None;
    }
    let mut search = Search::new(shadows, &mut raster);
    let scores = search.scores(&[]);
    let directions = search.candidates.iter().map(|(lamp, _)| lamp.direction);
    Some(directions.zip(scores).collect())
}

/// Counts the lamps, in a small picture.
struct Search<'a> {
    shadows: Shadows<'a>,
    raster: &'a mut Rasterizer,
    /// Point lights, and the light that the toy blocks of each.
    candidates: Vec<(Lamp, Vec<f32>)>,
}

impl<'a> Search<'a> {
    fn new(shadows: Shadows<'a>, raster: &'a mut Rasterizer) -> Self {
        let candidates = hemisphere(&shadows.caster).into_iter().map(|lamp| {
            let taken = shadows.taken(raster, &lamp, &POINT);
            (lamp, taken)
        });
        let candidates = candidates.collect();
        Self {
            shadows,
            raster,
            candidates,
        }
    }

    fn all_lamps(mut self, estimated: Option<DVec3>) -> Vec<Lamp> {
        let mut lamps = Vec::new();
        while lamps.len() < MAX_LIGHTS {
            let peaks = self.peaks(&lamps);
            let more = self.one_more(&lamps, &peaks);
            let more = match estimated.filter(|_| more.is_none() && lamps.is_empty()) {
                Some(direction) => {
                    let lamp = lamp_from(&self.shadows.caster, direction);
                    self.one_more(&lamps, &[lamp])
                }
                None => more,
            };
            match more {
                Some(more) => lamps = more,
                None => break,
            }
        }
        lamps
    }

    /// The lamps with the best additional one, among the given directions; `None` without evidence
    /// for it.
    fn one_more(&mut self, lamps: &[Lamp], from: &[Lamp]) -> Option<Vec<Lamp>> {
        let before = self.shading(lamps);
        let starts = self.starts(lamps, from);
        let followed = starts.iter().filter_map(|start| {
            let more = self.follow(lamps, start)?;
            let shading = self.shading(&more);
            let is_significant =
                is_gain(before.loss, shading.loss) && doubtful(&more, &shading, &self.shadows).is_none();
            is_significant.then_some((shading.loss, more))
        });
        let best = followed.min_by(|a, b| a.0.total_cmp(&b.0));
        best.map(|(_, more)| more)
    }

    /// Adds a lamp from a start, first alone and then with the others; `None` if it is part of the
    /// surroundings.
    fn follow(&mut self, lamps: &[Lamp], start: &Lamp) -> Option<Vec<Lamp>> {
        let radius_m = self.shadows.caster.shape.radius_m;
        let mut more = [lamps, &[*start]].concat();
        let mut priors: Vec<Prior> = lamps.iter().map(Prior::held).collect();
        priors.push(Prior::free(start, radius_m));
        self.shadows
            .rounds(self.raster, (&mut more, &priors), (N_ALONE, ROBUST_FAR))?;
        let shading = self.shading(&more);
        if !outshines(&more, lamps.len(), &shading, up(self.shadows.caster.receivers)) {
            return None;
        }
        if !lamps.is_empty() {
            let priors: Vec<Prior> = more.iter().map(|lamp| Prior::free(lamp, radius_m)).collect();
            self.shadows
                .rounds(self.raster, (&mut more, &priors), (N_TOGETHER, ROBUST_FAR))?;
        }
        Some(more)
    }

    fn shading(&mut self, lamps: &[Lamp]) -> Shading {
        self.shadows.shading(self.raster, lamps, ROBUST_FAR)
    }

    /// Directions in which one more lamp explains most of the residual, best first.
    fn peaks(&mut self, lamps: &[Lamp]) -> Vec<Lamp> {
        let tried: Vec<Lamp> = self.candidates.iter().map(|(lamp, _)| *lamp).collect();
        let scores = self.scores(lamps);
        peaks(&tried, &scores).into_iter().take(N_STARTS).collect()
    }

    /// The fraction of the residual that one more lamp in each direction explains.
    fn scores(&mut self, lamps: &[Lamp]) -> Vec<f64> {
        let shading = self.shading(lamps);
        self.shadows.light(lamps, &shading);
        let taken = self.shadows.taken_of_all(self.raster, lamps);
        let shaded = self.shadows.shaded(&taken);
        let shading = shaded.fit(self.shadows.caster.receivers.len(), ROBUST_FAR);
        let unexplained = Unexplained::new(&shaded, &shading, ROBUST_FAR);
        let scores = self
            .candidates
            .iter()
            .map(|(_, taken)| unexplained.explained(taken));
        scores.collect()
    }

    /// The best of the directions for one more lamp, with its width.
    fn starts(&mut self, lamps: &[Lamp], from: &[Lamp]) -> Vec<Lamp> {
        let Self { shadows, raster, .. } = self;
        let taken = shadows.taken_of_all(raster, lamps);
        let shaded = shadows.shaded(&taken);
        let shading = shaded.fit(shadows.caster.receivers.len(), ROBUST_FAR);
        let unexplained = Unexplained::new(&shaded, &shading, ROBUST_FAR);
        let mut explained =
            |lamp: &Lamp, points: &[DVec2]| unexplained.explained(&shadows.taken(raster, lamp, points));
        let points = disc(N_SPREAD_POINTS);
        let climbed = from.iter().map(|peak| {
            let (score, lamp) = climb(peak, |lamp| explained(lamp, &POINT));
            SPREADS.into_iter().fold((score, lamp), |best, spread| {
                let wide = Lamp { spread, ..lamp };
                let score = explained(&wide, &points);
                if score > best.0 { (score, wide) } else { best }
            })
        });
        let mut climbed: Vec<(f64, Lamp)> = climbed.collect();
        climbed.sort_by(|a, b| b.0.total_cmp(&a.0));
        let most = climbed.first().map_or(0.0, |(score, _)| *score);
        let least = LEAST_EXPLAINED.max(OF_BEST * most);
        let followed = climbed.into_iter().filter(|(score, _)| *score >= least);
        followed.map(|(_, lamp)| lamp).collect()
    }
}
