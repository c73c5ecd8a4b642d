//! The uniform of the baseline's settings.

use crate::geometry::scene_layout::SceneLayout;
use crate::gpu::{Buffer, Mirrors, Resource, Slot, mirrors, shared_struct};
use crate::passes::globals::Globals;
use crate::preset::BaselineSettings;
use app_scene::geometry::bounds::Bounds;
use app_scene::scene::{MAX_RECEIVERS, Surface};

/// WGSL part of the uniform.
pub(crate) const BASELINE: Mirrors = mirrors!("common/baseline", structs: [Baseline]);
/// Slots that the baseline's passes share: the globals and the settings.
pub(crate) const SCENE_SLOTS: &[Slot] = &[Slot::uniform::<Globals>(), Slot::uniform::<Baseline>()];

shared_struct! {
    /// The settings, and properties of the scene.
    pub struct Baseline {
        pub tallest_m: [f32; MAX_RECEIVERS],
        pub textured_receivers: u32,
        pub is_constant: u32,
        pub constant_ratio: f32,
        pub eligible_margin_px: i32,
        pub ring_step_px: f32,
        pub n_ring_directions: u32,
        pub n_rings: u32,
        pub box_radius_px: i32,
        pub seam_px: i32,
        pub n_blocker_taps: u32,
        pub n_filter_taps: u32,
        pub _pad: u32,
    }
}

/// Resources of [`SCENE_SLOTS`].
#[derive(Clone, Copy)]
pub(crate) struct Scene<'a> {
    pub(crate) globals: &'a Buffer,
    pub(crate) baseline: &'a Buffer,
}

impl<'a> Scene<'a> {
    pub(crate) fn resources(&self) -> [Resource<'a>; 2] {
        [self.globals.into(), self.baseline.into()]
    }
}

/// The settings, and the properties of receivers that the globals do not hold. `toy`
/// bounds the toy in every pose, in anchor space.
pub(crate) fn uniform(layout: &SceneLayout<'_>, toy: &Bounds, settings: &BaselineSettings) -> Baseline {
    let mut tallest_m = [0.0; MAX_RECEIVERS];
    let mut textured_receivers = 0;
    let world_from_anchor = layout.world_from_anchor();
    for (index, receiver) in layout.receivers.iter().take(MAX_RECEIVERS).enumerate() {
        let plane_from_anchor = receiver.world_from_plane.inverse() * world_from_anchor;
        tallest_m[index] = narrowed(toy.transformed(&plane_from_anchor).max.y);
        textured_receivers |= u32::from(receiver.surface == Surface::Textured) << index;
    }
    let ratio = settings.constant_ratio;
    Baseline {
        tallest_m,
        textured_receivers,
        is_constant: u32::from(ratio.is_some()),
        constant_ratio: ratio.map_or(0.0, |of_all| ratio_per_light(of_all, layout.lights.len())),
        eligible_margin_px: settings.eligible_margin_px,
        ring_step_px: settings.ring_step_px,
        n_ring_directions: settings.n_ring_directions,
        n_rings: settings.n_rings,
        box_radius_px: settings.box_radius_px,
        seam_px: settings.seam_px,
        n_blocker_taps: settings.n_blocker_taps,
        n_filter_taps: settings.n_filter_taps,
        _pad: 0,
    }
}

/// The ratio of each light. The product over all lights is `of_all`, because shadows of AR products
/// multiply.
fn ratio_per_light(of_all: f32, n_lights: usize) -> f32 {
    let n_lights = n_lights.max(1) as f32;
    of_all.powf(n_lights.recip())
}

#[allow(clippy::cast_possible_truncation, reason = "a shader takes no more")]
fn narrowed(value: f64) -> f32 {
    value as f32
}
