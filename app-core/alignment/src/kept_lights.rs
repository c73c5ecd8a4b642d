//! Estimated lights, as they are kept from view to view.

use std::sync::Arc;

use glam::DVec3;

use super::lights::{Watched, is_resized};
use super::photograph::{EstimatedLights, FoundLights};
use super::report::{AssumedLight, LightAlignment};
use crate::probe::TrackedLight;
use app_scene::geometry::used_lights::UsedLights;
use app_scene::scene::Light;

/// Loss without any light below which no shadow is visible: noise and the light model leave as
/// much.
///
/// Measured without a lamp .05 to .10, with lamps .5 and more.
const LEAST_SHADOWS: f64 = 0.2;
/// Lights count as unchanged while they leave no more unexplained than this multiple of the earlier
/// loss plus this fraction of the shadows.
///
/// A light that is a degree off exceeds it if its shadow is hard, one that is two degrees off if it
/// is soft.
const TIMES_UNEXPLAINED: f64 = 2.0;
const MORE_UNEXPLAINED: f64 = 0.02;
/// Lights that leave more of the shadows unexplained do not replace a list.
///
/// Measured: correct ones leave .003 to .049, through a phone's image processing and on varnish
/// too; a shadow on a step, a ramp or a mug .13 to .66, with any light.
const MOST_UNEXPLAINED: f64 = 0.1;
/// Lights that replace others, which leave too much, must leave no more than this fraction of it.
const OF_OTHERS: f64 = 0.5;
/// Relative change of the picture after which a failed search is repeated.
const DIFFERS: f64 = 0.25;

/// Estimated lights.
#[derive(Debug)]
pub(super) struct KeptLights {
    pub(super) given: Arc<[Light]>,
    /// `None` if the given lights stay.
    pub(super) applied: Option<Arc<[Light]>>,
    /// Empty if they were not estimated in the latest view.
    pub(super) report: Vec<LightAlignment>,
    pub(super) errors: Option<[f64; 2]>,
    /// `None` if lights were given.
    pub(super) discovered: Option<EstimatedLights>,
    /// The assumed light, if none was found.
    pub(super) assumed: Option<AssumedLight>,
    /// Whether one light is applied as a line of round ones.
    pub(super) is_long: bool,
    /// Whether what a list leaves unexplained in the latest view is of a thing before the toy.
    pub(super) is_beside_thing: bool,
    /// Whether a view that shows the toy at its place was searched for lights and things.
    pub(super) are_settled: bool,
    /// Number of views without a plate that followed one in which no light was found. They are searched
    /// again in the first, second, fourth, eighth... of these: each search takes seconds.
    pub(super) n_unlit: u32,
    /// Their loss in the view of the estimate.
    explained: Option<Watched>,
    /// The latest view; `None` if it shows none of their shadows.
    latest: Option<Watched>,
    /// The view of a failed search.
    in_vain: Option<Watched>,
    /// The same for a search in which nothing counts as a thing.
    in_vain_beside_no_thing: Option<Watched>,
}

impl KeptLights {
    /// Listed lights; `found` is `None` if the estimate failed.
    pub(super) fn listed(given: Arc<[Light]>, found: Option<FoundLights>) -> Self {
        let (applied, report, errors) = match found {
            Some(found) => (found.applied, found.report, Some(found.errors)),
            None => (None, Vec::new(), None),
        };
        Self {
            given,
            applied,
            report,
            errors,
            discovered: None,
            assumed: None,
            is_long: false,
            is_beside_thing: false,
            are_settled: false,
            n_unlit: 0,
            explained: None,
            latest: None,
            in_vain: None,
            in_vain_beside_no_thing: None,
        }
    }

    /// Lights without a list; a probe's estimate stays if no shadow shows the light.
    pub(super) fn discovered(given: Arc<[Light]>, found: EstimatedLights, by_probe: &[TrackedLight]) -> Self {
        let lights: Arc<[Light]> = match &found {
            Ok(found) => found.iter().map(|found| found.light).collect(),
            Err(_) => by_probe.iter().map(|by_probe| by_probe.light).collect(),
        };
        Self {
            applied: (found.is_ok() || !by_probe.is_empty()).then_some(lights),
            discovered: Some(found),
            ..Self::listed(given, None)
        }
    }

    /// Whether the unexplained part of visible shadows is so large that other lights must have cast
    /// them.
    pub(super) fn leaves_too_much(watched: Watched) -> bool {
        watched.shadows >= LEAST_SHADOWS && watched.unexplained > MOST_UNEXPLAINED
    }

    /// Whether these lights leave too much of the latest view's shadows unexplained.
    pub(super) fn leave_too_much(&self) -> bool {
        self.latest.is_some_and(Self::leaves_too_much)
    }

    /// The same, if these are the listed ones.
    pub(super) fn is_list_that_leaves_too_much(&self) -> bool {
        self.discovered.is_none() && self.leave_too_much()
    }

    /// Whether these lights were found, and explain what others, which leave `by_others`, do not.
    pub(super) fn stand_in_for(&self, watched: Watched, by_others: Watched) -> bool {
        self.are_found() && watched.unexplained <= MOST_UNEXPLAINED.min(OF_OTHERS * by_others.unexplained)
    }

    /// With a line of lights in place of one.
    pub(super) fn as_line(&self, line: Arc<[Light]>) -> Self {
        let mut report = self.report.clone();
        for light in &mut report {
            light.is_applied = true;
        }
        Self {
            applied: Some(line),
            report,
            is_long: true,
            errors: self.errors,
            discovered: self.discovered.clone(),
            ..Self::listed(Arc::clone(&self.given), None)
        }
    }

    /// With the list in place of the estimates near it.
    pub(super) fn left_as_given(mut self) -> Self {
        self.applied = None;
        for light in &mut self.report {
            light.is_applied = false;
        }
        self
    }

    /// Whether little of the shadows is unexplained.
    pub(super) fn are_explained(watched: Watched) -> bool {
        watched.unexplained <= MOST_UNEXPLAINED
    }

    /// The fraction of the latest view's shadows that a list leaves unexplained, if that is too much.
    pub(super) fn misfit(&self) -> Option<f64> {
        let is_misfit = self.is_list_that_leaves_too_much() && !self.is_beside_thing;
        self.latest.filter(|_| is_misfit).map(|latest| latest.unexplained)
    }

    /// With an assumed light, if there is no other.
    pub(super) fn or_assumed(self, assumed: Option<AssumedLight>) -> Self {
        if self.applied.is_some() {
            return self;
        }
        let light = assumed.map(|assumed| Arc::from([assumed.light]));
        Self {
            applied: light,
            assumed,
            ..self
        }
    }

    /// With the view in which they were found, or searched without success.
    pub(super) fn seen(self, watched: Option<Watched>) -> Self {
        let is_found = self.are_found() && !watched.is_some_and(Self::leaves_too_much);
        Self {
            explained: watched.filter(|_| is_found),
            in_vain: watched.filter(|_| !is_found),
            latest: watched,
            ..self
        }
    }

    /// In place of others, which fail to explain a view that these explain; these must explain
    /// others as well as those did.
    pub(super) fn in_place_of(self, others: &Self, now: Watched) -> Self {
        let unexplained = others
            .explained
            .map_or(now.unexplained, |before| before.unexplained.min(now.unexplained));
        Self {
            explained: Some(Watched { unexplained, ..now }),
            latest: Some(now),
            ..self
        }
    }

    /// A list with these lights in place of those that are used of it; `None` if the list stays.
    pub(super) fn in_list(&self, listed: &[Light], used: &UsedLights) -> Option<Arc<[Light]>> {
        let applied = self.applied.as_ref()?;
        let are_of_list = self.discovered.is_none() && !self.is_long;
        Some(if are_of_list {
            used.replaced(listed, applied)
        } else {
            Arc::clone(applied)
        })
    }

    /// The lights that frames are shown with.
    pub(super) fn in_use(&self) -> &[Light] {
        self.applied.as_deref().unwrap_or(&self.given)
    }

    pub(super) fn is_assumed(&self) -> bool {
        self.assumed.is_some()
    }

    pub(super) fn are_found(&self) -> bool {
        self.errors.is_some() || matches!(self.discovered, Some(Ok(_)))
    }

    /// Whether these are lamps that were estimated, and that explain the shadows of the latest view.
    pub(super) fn explain_shadows(&self) -> bool {
        let are_lamps = self.applied.is_some() && self.are_found() && !self.is_assumed() && !self.is_long;
        are_lamps && self.explain_latest()
    }

    /// Whether the latest view shows shadows, and these lights explain them.
    pub(super) fn explain_latest(&self) -> bool {
        let is_explained = |latest: Watched| latest.shadows >= LEAST_SHADOWS && Self::are_explained(latest);
        self.latest.is_some_and(is_explained)
    }

    /// Whether these are fewer lights than others of the same shadows, or as many that leave less
    /// unexplained.
    ///
    /// A llama's ramp showed two lights beside the things of two searches: one that is a degree off left
    /// .075, the right one .035.
    pub(super) fn explain_better_than(&self, others: &Self) -> bool {
        let [own, other] =
            [self, others].map(|lights| lights.latest.map_or(f64::INFINITY, |latest| latest.unexplained));
        let [n, n_others] = [self, others].map(|lights| lights.in_use().len());
        n < n_others || (n == n_others && own < other)
    }

    /// With these lights in place of the same estimated ones, as seen from the toy at a place.
    pub(super) fn move_to(&mut self, lights: Arc<[Light]>, place_in_world: DVec3) {
        for ((report, given), light) in self.report.iter_mut().zip(&*self.given).zip(&*lights) {
            report.move_to([given, light], place_in_world);
        }
        if let Some(Ok(found)) = &mut self.discovered {
            for (found, light) in found.iter_mut().zip(&*lights) {
                found.light = *light;
                found.seen_from(place_in_world);
            }
        }
        self.applied = Some(lights);
    }

    /// Adds another view, `None` if it does not show their shadows, and returns whether it needs other lights.
    pub(super) fn watch(&mut self, now: Option<Watched>) -> bool {
        self.latest = now.filter(|now| now.shadows >= LEAST_SHADOWS);
        let Some(now) = self.latest else {
            // An assumed light stays in a view that does not show the shadows.
            return now.is_none() && !self.is_assumed();
        };
        self.are_outdated(now, self.in_vain)
    }

    /// Whether lights that leave `now` unexplained replace these, which fail to explain a view: they must explain it as
    /// well as these explained theirs, or at all.
    pub(super) fn are_replaced_by(&self, now: Watched) -> bool {
        match self.explained {
            Some(then) => is_as_well_explained(now, then),
            None => Self::are_explained(now),
        }
    }

    /// With a view in which no better lights were found.
    pub(super) fn searched_in_vain(self, now: Watched) -> Self {
        Self {
            in_vain: Some(now),
            ..self
        }
    }

    /// Whether a view in which nothing counts as a thing needs other lights than these estimated ones.
    pub(super) fn are_doubtful(&self, now: Watched) -> bool {
        now.shadows >= LEAST_SHADOWS
            && self.are_found()
            && self.are_outdated(now, self.in_vain_beside_no_thing)
    }

    /// Whether exactly such a view was searched without success.
    pub(super) fn are_searched_beside_no_thing(&self, now: Watched) -> bool {
        self.in_vain_beside_no_thing == Some(now)
    }

    /// Whether these leave more of a view unexplained than of the one in which they were found, and it is unlike that of
    /// a failed search.
    fn are_outdated(&self, now: Watched, in_vain: Option<Watched>) -> bool {
        let is_as_before = self.explained.is_some_and(|then| is_as_well_explained(now, then));
        !is_as_before && !in_vain.is_some_and(|before| is_alike(before, now))
    }

    /// Records such a view in which no better lights were found.
    pub(super) fn searched_beside_no_thing_in_vain(&mut self, now: Option<Watched>) {
        self.in_vain_beside_no_thing = now;
    }

    /// The unexplained fraction of the latest view's shadows; `None` if it shows none, and without lights.
    pub(super) fn unexplained(&self) -> Option<f64> {
        let latest = self.latest.filter(|_| !self.in_use().is_empty());
        latest.map(|latest| latest.unexplained)
    }

    /// The unexplained fraction of the latest view's shadows; `None` if it shows none, or if they are unchanged.
    pub(super) fn doubt(&self) -> Option<f64> {
        let (then, latest) = (self.explained?, self.latest?);
        (!is_as_well_explained(latest, then)).then_some(latest.unexplained)
    }
}

impl LightAlignment {
    /// With another estimate of the light, as seen from a place: `[given, estimate]`.
    fn move_to(&mut self, [given, light]: [&Light; 2], place_in_world: DVec3) {
        let both = [given, light];
        if let [Some(given), Some(light)] = both.map(|light| light.direction_from(place_in_world)) {
            self.turned_rad = given.angle_between(light);
        }
        if let [Some(given_m), Some(light_m)] = both.map(|light| light.distance_m_from(place_in_world)) {
            self.distance_ratio = light_m / given_m;
        }
        if let [Some(given), Some(light)] = both.map(|light| light.slope_from(place_in_world)) {
            self.size_ratio = (given > 0.0).then_some(light / given);
            self.is_resized = is_resized([given, light]);
        }
    }
}

/// Compares the loss relative to present and to earlier shadows: a dimmed lamp leaves as much as
/// before of fainter shadows.
fn is_as_well_explained(now: Watched, then: Watched) -> bool {
    let of_these = TIMES_UNEXPLAINED * then.unexplained + MORE_UNEXPLAINED;
    now.unexplained <= of_these || now.left() <= TIMES_UNEXPLAINED * then.left()
}

/// Whether two views leave equally much unexplained.
fn is_alike(before: Watched, now: Watched) -> bool {
    (now.left() - before.left()).abs() <= DIFFERS * before.left()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHADOWS: f64 = 5.0;

    fn left(unexplained: f64) -> Watched {
        Watched {
            shadows: SHADOWS,
            unexplained,
        }
    }

    /// A list whose lights were estimated in a view that leaves this much unexplained.
    fn list_in(unexplained: f64) -> KeptLights {
        let found = FoundLights {
            applied: None,
            report: Vec::new(),
            errors: [1.0; 2],
        };
        KeptLights::listed(Arc::from([]), Some(found)).seen(Some(left(unexplained)))
    }

    #[test]
    fn lights_that_leave_too_much_replace_none_that_leave_as_much() {
        let mut list = list_in(0.3);
        assert!(list.watch(Some(left(0.45))));
        assert!(!list.are_replaced_by(left(0.3)));
        assert!(!list.are_replaced_by(left(1.0)));
        assert!(list.are_replaced_by(left(0.05)));
        // The same view again is not searched again.
        let mut list = list.searched_in_vain(left(0.45));
        assert!(!list.watch(Some(left(0.45))));
    }

    #[test]
    fn lights_must_explain_a_view_as_well_as_others_explained_theirs() {
        let list = list_in(0.01);
        assert!(list.are_replaced_by(left(0.03)));
        assert!(!list.are_replaced_by(left(0.08)));
    }

    #[test]
    fn a_view_without_shadows_leaves_nothing_unexplained() {
        let mut list = list_in(0.3);
        assert_eq!(list.misfit().unwrap(), 0.3);
        for faint in [
            None,
            Some(Watched {
                shadows: 0.1,
                unexplained: 1.0,
            }),
        ] {
            list.watch(faint);
            assert_eq!((list.misfit(), list.doubt()), (None, None));
        }
    }
}
