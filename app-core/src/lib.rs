//! Shadow retargeting: a static toy in a camera picture moves, with its own real shadow, re-made from samples of it.
//!
//! The method is that of Casas et al. 2018 and 2019 («Image Based Proximate Shadow Retargeting»; «Enhanced Shadow
//! Retargeting with Light-Source Estimation Using Flat Fresnel Lenses»), with an additive model in its place where
//! that is more accurate: see the architecture below.
#![doc = include_str!("../doc/architecture.md")]
#![doc = include_str!("../doc/spaces.md")]
#![doc = include_str!("../doc/passes.md")]
#![forbid(unsafe_code)]

pub mod core;
pub mod frame;
pub mod gpu;
pub mod preset;
pub mod scene;
pub mod session;
pub mod toy;

mod baseline;
mod geometry;
mod model;
mod passes;
mod plan;
mod plates;
mod readback;
mod stage;

pub use crate::core::{Core, CoreError};
pub use wgpu;

/// Internals for the project's own tests and harness. They change without notice.
#[doc(hidden)]
pub mod internals {
    pub use crate::baseline::plan::BaselinePlan;
    pub use crate::baseline::planned as planned_by_baseline;
    pub use crate::baseline::uniform::Baseline as BaselineUniform;
    pub use crate::geometry::anchored::AnchoredReceiver;
    pub use crate::geometry::bounds::{Bounds, Sphere};
    pub use crate::geometry::color::linear_from_srgb;
    pub use crate::geometry::light_points::{ambient_directions, light_in_plane, light_points};
    pub use crate::geometry::outline::Outline;
    pub use crate::geometry::reach::Reach;
    pub use crate::geometry::rect::{PixelRect, PlaneRect};
    pub use crate::geometry::scene_layout::SceneLayout;
    pub use crate::geometry::shadow_atlas::ShadowAtlas;
    pub use crate::geometry::view::View;
    pub use crate::gpu::context::phone_limits;
    pub use crate::gpu::device::Kind;
    pub use crate::gpu::shader::{Part, Shader};
    pub use crate::gpu::shared::{Member, Mirror, NumberKind};
    pub use crate::model::diagnostics::conditioning::light_conditioning;
    pub use crate::model::diagnostics::outliers::{OUTLIER_ALL, OUTLIER_NONE, SHADOW_EVENNESS, outliers};
    pub use crate::model::lighting::self_shadow::SelfShadow;
    pub use crate::model::plan::{LightPlan, Plan};
    pub use crate::model::planned as planned_by_model;
    pub use crate::model::state::grids::{Grid, Grids, MAX_CELLS, grids_over, holds};
    pub use crate::model::state::solution::{Fit, N_COLUMNS, N_FIT_SUMS, ReceiverFit};
    pub use crate::model::state::tints::{TINT_SIDE, TintGrid, TintMap};
    pub use crate::passes::globals::{Globals, globals};
    pub use crate::passes::plate::{PlateView, PlateViews};
    pub use crate::plan::{Change, LeftOut, SceneFacts};
    pub use crate::readback::inject::InjectedVisibility;
    pub use crate::readback::{FloatMap, Map};

    /// Every shader of the registry.
    pub fn shaders() -> impl Iterator<Item = &'static Shader> {
        let rooms = [
            crate::model::lighting::SHADERS,
            crate::model::capture::SHADERS,
            crate::model::frame::SHADERS,
            crate::passes::SHADERS,
            crate::baseline::SHADERS,
        ];
        rooms.into_iter().flatten().copied()
    }
}
