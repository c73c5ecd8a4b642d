//! Readback of the baseline's maps, for reports and tests.

use crate::baseline::Baseline;
use crate::gpu::{Gpu, GpuError};
use crate::readback::{FloatMap, Map, read_texture};

impl Baseline {
    /// Waits for the device and returns a map, if the baseline makes it.
    pub(crate) fn read_map(&self, gpu: &Gpu, map: Map) -> Result<Option<FloatMap>, GpuError> {
        let texture = match map {
            Map::Plate => self.plate.raw(),
            Map::Masks => self.targets.masks.mask.raw(),
            Map::Eligible => self.targets.eligible.labels.raw(),
            Map::Warp => self.targets.warp.maps.raw(),
            Map::Terms => self.targets.search.terms.raw(),
            Map::FilteredTerms => self.targets.box_filter.sums.raw(),
            Map::SearchTaps => self.targets.search.taps.raw(),
            Map::Visibility => self.targets.pcss.visibility.raw(),
            _ => return Ok(None),
        };
        read_texture(gpu, texture).map(Some)
    }
}
