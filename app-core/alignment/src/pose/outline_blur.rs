//! The blur of the outline of a toy at its place, as [`sharpness`](crate::softness::sharpness) asks for it.

use std::cell::OnceCell;

use super::directed::{self, Directed};
use super::placement::Placement;
use super::{Posed, Search, Subject};
use crate::picture::{Level, Pyramid};
use crate::rigid_motion::RigidMotion;
use crate::shape::Shape;
use app_scene::scene::PoseUncertainty;
use app_scene::sharpness::Spread;

/// A toy at its place in a photograph. Lengths are in pixels of the largest level.
pub(crate) struct OutlineBlur<'a> {
    subject: Subject<'a>,
    pyramid: &'a Pyramid,
    /// What explains the outline, once it was asked for.
    explained: OnceCell<Explained<'a>>,
}

/// The toy in the light on it, beside a plate that is as soft.
struct Explained<'a> {
    posed: Posed<'a>,
    /// The largest level with its plate blurred; `None` if it is not.
    softened: Option<Level>,
    spread_px: f64,
}

impl<'a> OutlineBlur<'a> {
    pub(crate) fn new(subject: Subject<'a>, pyramid: &'a Pyramid) -> Self {
        Self {
            subject,
            pyramid,
            explained: OnceCell::new(),
        }
    }

    pub(crate) fn shape(&self) -> &Shape {
        self.subject.shape
    }

    /// The standard deviation of the camera's blur; `None` if too little of the outline is visible, or if
    /// it is more than `most_px` from the picture's, which looks like a blur.
    pub(crate) fn spread_px(&self, most_px: f64) -> Option<f64> {
        let (mut search, placement) = self.search();
        let fit = search.fit(&placement)?;
        (fit.outline_px() <= most_px).then(|| self.explained().spread_px)
    }

    /// The camera's blur by direction; `None` if too few directions tell.
    pub(crate) fn directed(&self) -> Option<Directed> {
        let Explained { posed, .. } = self.explained();
        directed::directed(&posed.beside(self.level()), &posed.elements)
    }

    /// The standard deviation of a round blur beside a known one.
    pub(crate) fn beyond_px(&self, known: Spread) -> f64 {
        let Explained { posed, .. } = self.explained();
        directed::beyond(&posed.beside(self.level()), &posed.elements, known)
    }

    fn level(&self) -> &Level {
        let softened = self.explained().softened.as_ref();
        softened.unwrap_or_else(|| self.pyramid.level(0))
    }

    fn explained(&self) -> &Explained<'a> {
        self.explained.get_or_init(|| {
            let (mut search, placement) = self.search();
            let (explained, posed) = search.explained(self.subject.paint, &placement);
            Explained {
                posed,
                softened: search.softened.map(|(level, _)| level),
                spread_px: explained.optics.spread_px,
            }
        })
    }

    fn search(&self) -> (Search<'a>, Placement) {
        let shape = self.subject.shape;
        let search = Search::new(shape, self.pyramid, &PoseUncertainty::default());
        let placement = Placement::of(RigidMotion::none(shape.centre, shape.radius_m));
        (search, placement)
    }
}
