//! Dispatch to the additive model or to the baseline.

use crate::baseline;
use crate::baseline::Baseline;
use crate::frame::warning::Warning;
use crate::geometry::rect::PixelRect;
use crate::gpu::{Gpu, GpuError, Recorder};
use crate::model;
use crate::model::Model;
use crate::passes;
use crate::passes::list::WarmUp;
use crate::passes::pictures::{Picture, Pictures};
use crate::passes::toy_mesh::ToyMesh;
use crate::plan::{FrameDelta, SkippedWork};
use crate::preset::Settings;
use crate::readback::inject::InjectedVisibility;
use crate::readback::{FloatMap, Map};
use app_scene::scene::Image;
use app_scene::things::Front;

/// The compilation steps for all passes of frames with these settings.
pub(crate) fn warm_ups(settings: Settings) -> Vec<WarmUp> {
    let of_method = match settings {
        Settings::Model(_) => [
            model::lighting::WARM_UPS,
            model::capture::WARM_UPS,
            model::frame::WARM_UPS,
        ]
        .concat(),
        Settings::Baseline(_) => baseline::WARM_UPS.to_vec(),
    };
    [of_method.as_slice(), passes::WARM_UPS].concat()
}

/// The method of a scene.
pub(crate) enum Method {
    /// The additive model of the receivers.
    Model(Box<Model>),
    /// The published method.
    Baseline(Box<Baseline>),
}

impl Method {
    pub(crate) fn region(&self) -> PixelRect {
        match self {
            Self::Model(model) => model.region.rect(),
            Self::Baseline(baseline) => baseline.plan.region,
        }
    }

    /// Whether the toy's targets contain these pixels of the image, within the region.
    pub(crate) fn holds_toy(&self, needed: Option<PixelRect>) -> bool {
        let Self::Model(model) = self else { return true };
        let (region, toy_box) = (self.region(), model.region.plan.toy_box);
        let known = PixelRect {
            origin_px: toy_box.origin_px + region.origin_px,
            ..toy_box
        };
        let needed = needed.and_then(|needed| needed.common(&region));
        needed.is_none_or(|needed| known.contains(&needed))
    }

    /// Whether things before the toy have these fronts.
    pub(crate) fn has_fronts(&self, fronts: &[Front]) -> bool {
        let Self::Model(model) = self else { return true };
        model.region.plan.things_fronts == fronts
    }

    pub(crate) fn skipped(&self) -> &[SkippedWork] {
        match self {
            Self::Model(model) => &model.region.plan.skipped,
            Self::Baseline(baseline) => &baseline.plan.skipped,
        }
    }

    /// The region's picture.
    pub(crate) fn picture(&self) -> Picture<'_> {
        match self {
            Self::Model(model) => model.picture(),
            Self::Baseline(baseline) => baseline.picture(),
        }
    }

    /// The model, if it is the scene's method.
    pub(crate) fn model(&self) -> Option<&Model> {
        match self {
            Self::Model(model) => Some(model),
            Self::Baseline(_) => None,
        }
    }

    /// Updates the tiles around the toy in the picture, if the method uses them.
    pub(crate) fn update_coverage_tiles(&mut self, toy: &ToyMesh, delta: FrameDelta) {
        match self {
            Self::Model(model) => model.update_coverage_tiles(toy, delta),
            Self::Baseline(_) => {}
        }
    }

    /// Encodes the passes of a frame, and before them those that the change requires.
    pub(crate) fn encode(
        &self,
        recorder: &mut Recorder<'_>,
        toy: &ToyMesh,
        pictures: &Pictures<'_>,
        delta: FrameDelta,
    ) {
        match self {
            Self::Model(model) => model.encode(recorder, toy, pictures, delta),
            Self::Baseline(baseline) => baseline.encode(recorder, toy, pictures, delta),
        }
    }

    /// Replaces visibilities from the next frame on; see [`Inspect::inject_visibility`](crate::core::inspect::Inspect).
    pub(crate) fn inject(&mut self, gpu: &Gpu, maps: &InjectedVisibility) {
        match self {
            Self::Model(model) => model.inject(gpu, maps),
            Self::Baseline(baseline) => baseline.inject(gpu, maps),
        }
    }

    /// Waits for the device and returns a map, if this method makes it; `frame` is the picture from
    /// which the state was last estimated.
    pub(crate) fn read_map(
        &self,
        gpu: &Gpu,
        frame: Option<&Image>,
        map: Map,
    ) -> Result<Option<FloatMap>, GpuError> {
        match self {
            Self::Model(model) => model.read_map(gpu, frame, map),
            Self::Baseline(baseline) => baseline.read_map(gpu, map),
        }
    }

    /// Waits for the device and returns the baseline's warnings; the model's warnings come from its
    /// fit.
    pub(crate) fn read_warnings(
        &self,
        gpu: &Gpu,
        listed: (&[usize], &[usize]),
    ) -> Result<Vec<Warning>, GpuError> {
        match self {
            Self::Model(_) => Ok(Vec::new()),
            Self::Baseline(baseline) => baseline.read_warnings(gpu, listed),
        }
    }
}
