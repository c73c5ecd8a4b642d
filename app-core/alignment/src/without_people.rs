//! Pixels of people, which alignment must not read.

use glam::UVec2;

use super::picture::{Mask, places};
use app_scene::frame::FrameInput;

/// The pixels of people, each grown by a pixel of their mask; `None` if there are none.
pub(super) fn people(input: &FrameInput) -> Option<Mask> {
    let people = input.people.as_ref().filter(|people| people.has_any())?;
    let size_px = UVec2::from_array(input.image.size_px());
    let mut mask = Mask::new(size_px.as_ivec2());
    for at in places(size_px.as_ivec2()) {
        if people.is_person((at.as_dvec2() + 0.5) / size_px.as_dvec2()) {
            mask.mark(at);
        }
    }
    Some(mask.grown(size_px.x.div_ceil(people.size_px().x).cast_signed()))
}
