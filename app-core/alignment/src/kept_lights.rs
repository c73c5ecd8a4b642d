//! Lights that were looked for, as they are kept from view to view.

use std::sync::Arc;

use super::lights::Watched;
use super::photograph::{Discovered, FoundLights};
use super::report::{AssumedLight, LightAlignment};
use crate::probe::TrackedLight;
use app_scene::scene::Light;

/// Below that loss without any light no shadow is seen: it is what noise and the model of light leave.
///
/// Measured without a lamp .05 to .10, with lamps .5 and more.
const LEAST_SHADOWS: f64 = 0.2;
/// Lights are as they were while they leave no more unexplained than so many times what they did, and that part of the shadows.
///
/// A light that is a degree off exceeds it where its shadow is hard, one that is two degrees off where it is soft.
const TIMES_UNEXPLAINED: f64 = 2.0;
const MORE_UNEXPLAINED: f64 = 0.02;
/// Lights that leave more of the shadows unexplained stand in for no list.
///
/// Measured: right ones leave .003 to .049, through a phone's pipeline and on varnish too; a shadow on a step, a ramp or a mug .13 to .66,
/// whatever light is found for it.
const MOST_UNEXPLAINED: f64 = 0.1;
/// Others that stand in for some that leave too much leave no more than this part of it.
const OF_OTHERS: f64 = 0.5;
/// What was looked for in vain is looked for again where the picture differs by that part.
const DIFFERS: f64 = 0.25;

/// Lights that were looked for.
#[derive(Debug)]
pub(super) struct KeptLights {
    pub(super) given: Arc<[Light]>,
    /// None where those that were given stay.
    pub(super) applied: Option<Arc<[Light]>>,
    /// Empty where they were not found in the latest view.
    pub(super) report: Vec<LightAlignment>,
    pub(super) errors: Option<[f64; 2]>,
    /// None where lights were given.
    pub(super) discovered: Option<Discovered>,
    /// One that is assumed where none was found.
    pub(super) assumed: Option<AssumedLight>,
    /// Whether one light is applied as a line of round ones.
    pub(super) is_long: bool,
    /// What they left unexplained where they were found.
    explained: Option<Watched>,
    /// The latest view that shows their shadows.
    latest: Option<Watched>,
    /// A view in which they were looked for in vain.
    in_vain: Option<Watched>,
}

impl KeptLights {
    /// Those of a list; `found` is none where they were not to be found.
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
            explained: None,
            latest: None,
            in_vain: None,
        }
    }

    /// Those that nobody listed; what a probe tells stands where no shadow tells them.
    pub(super) fn discovered(given: Arc<[Light]>, found: Discovered, told: &[TrackedLight]) -> Self {
        let lights: Arc<[Light]> = match &found {
            Ok(found) => found.iter().map(|found| found.light).collect(),
            Err(_) => told.iter().map(|told| told.light).collect(),
        };
        Self {
            applied: (found.is_ok() || !told.is_empty()).then_some(lights),
            discovered: Some(found),
            ..Self::listed(given, None)
        }
    }

    /// Whether so much of shadows that are seen is left that these are not the lights that cast them.
    pub(super) fn leaves_too_much(watched: Watched) -> bool {
        watched.shadows >= LEAST_SHADOWS && watched.unexplained > MOST_UNEXPLAINED
    }

    /// Whether these were found, and explain what others, which leave `by_others`, do not.
    pub(super) fn stand_in_for(&self, watched: Watched, by_others: Watched) -> bool {
        self.are_found() && watched.unexplained <= MOST_UNEXPLAINED.min(OF_OTHERS * by_others.unexplained)
    }

    /// With a line of lights in place of the one.
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

    /// With the list in place of what was found near it.
    pub(super) fn left_as_given(mut self) -> Self {
        self.applied = None;
        for light in &mut self.report {
            light.is_applied = false;
        }
        self
    }

    /// The part of the latest shadows that a list leaves unexplained, where that is too much.
    pub(super) fn misfit(&self) -> Option<f64> {
        let latest = self.latest.filter(|_| self.discovered.is_none())?;
        Self::leaves_too_much(latest).then_some(latest.unexplained)
    }

    /// With a light that is assumed, where there is none else.
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

    /// In the view that they were found in, or looked for in vain.
    pub(super) fn seen(self, watched: Option<Watched>) -> Self {
        let is_found = self.are_found() && !watched.is_some_and(Self::leaves_too_much);
        Self {
            explained: watched.filter(|_| is_found),
            in_vain: watched.filter(|_| !is_found),
            latest: watched,
            ..self
        }
    }

    /// In place of others, which no longer explain a view that these explain: they are to explain others as well as those did.
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

    /// Takes note of another view, and tells whether it asks for other lights.
    pub(super) fn watch(&mut self, now: Watched) -> bool {
        if now.shadows < LEAST_SHADOWS {
            return false;
        }
        self.latest = Some(now);
        let is_as_before = self.explained.is_some_and(|then| is_as_well_explained(now, then));
        !is_as_before && !self.in_vain.is_some_and(|before| is_alike(before, now))
    }

    /// Whether lights that leave `now` unexplained stand in for these, which no longer explain a view.
    pub(super) fn are_replaced_by(&self, now: Watched) -> bool {
        self.explained.is_none_or(|then| is_as_well_explained(now, then))
    }

    /// Nothing better was found in a view.
    pub(super) fn searched_in_vain(&mut self, now: Watched) {
        self.in_vain = Some(now);
    }

    /// The part of the latest shadows that is unexplained; none where there are no lights.
    pub(super) fn unexplained(&self) -> Option<f64> {
        let latest = self.latest.filter(|_| !self.in_use().is_empty());
        latest.map(|latest| latest.unexplained)
    }

    /// The part of the latest shadows that is unexplained; none where they are as they were.
    pub(super) fn doubt(&self) -> Option<f64> {
        let (then, latest) = (self.explained?, self.latest?);
        (!is_as_well_explained(latest, then)).then_some(latest.unexplained)
    }
}

/// What is left, of all shadows or of those that there were: a lamp that is dimmed leaves as much as before of fainter shadows.
fn is_as_well_explained(now: Watched, then: Watched) -> bool {
    let of_these = TIMES_UNEXPLAINED * then.unexplained + MORE_UNEXPLAINED;
    now.unexplained <= of_these || now.left() <= TIMES_UNEXPLAINED * then.left()
}

/// Whether two views leave as much unexplained.
fn is_alike(before: Watched, now: Watched) -> bool {
    (now.left() - before.left()).abs() <= DIFFERS * before.left()
}
