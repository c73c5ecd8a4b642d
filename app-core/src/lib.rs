//! Shadow retargeting: a static toy in a camera picture moves, with its own real shadow, re-made from samples of it.
//!
//! The method is that of Casas et al. 2018 and 2019 («Image Based Proximate Shadow Retargeting»; «Enhanced Shadow
//! Retargeting with Light-Source Estimation Using Flat Fresnel Lenses»), with an additive model in its place where
//! that is more accurate: see the architecture below.
//!
//! A [`Core`] takes a scene, then frames, and makes a picture of each:
//!
//! ```
//! use std::{error::Error, fs, path::Path, sync::Arc};
//!
//! use app_core::frame::FrameInput;
//! use app_core::gpu::AdapterChoice;
//! use app_core::preset::Preset;
//! use app_core::scene::Pose;
//! use app_core::session::{Capture, FileError, Files, Session, check_path};
//! use app_core::toy::NodePose;
//! use app_core::{Core, wgpu};
//! use glam::DQuat;
//!
//! /// The folder of a recorded session: the core opens no file itself.
//! struct Folder;
//!
//! impl Files for Folder {
//!     fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, FileError> {
//!         check_path(path)?;
//!         let file = Path::new("../tests/sessions/llama").join(path);
//!         let bytes = fs::read(file).map_err(|error| FileError::Io(error.to_string()))?;
//!         if bytes.len() as u64 > max_bytes {
//!             return Err(FileError::TooLarge { max_bytes });
//!         }
//!         Ok(bytes)
//!     }
//! }
//!
//! fn main() -> Result<(), Box<dyn Error>> {
//!     let session = Capture::open(Folder)?;
//!     let instance = wgpu::Instance::default();
//!     let mut core = pollster::block_on(Core::headless(&instance, &AdapterChoice::Fastest))?;
//!     core.set_scene(session.scene().clone(), Preset::Balanced)?;
//!
//!     // A frame brings the camera's picture, where camera, toy and lights are, and the pose to be shown: here a moment of a clip.
//!     let mut input = FrameInput::from(&session.frame(0)?);
//!     let report = core.frame(&input)?;
//!     for warning in &report.warnings {
//!         println!("{warning}");
//!     }
//!     let picture = core.read_picture()?;
//!     assert_eq!([picture.width_px, picture.height_px], [640, 360]);
//!     assert!(picture.rgba8 != input.image.rgba().rgba8);
//!
//!     // A pose of the app's own: the llama turns its head. The scene is known by now, so that this frame costs far less.
//!     let toy = &session.scene().toy;
//!     let head = toy.find_node("head")?;
//!     let mut transform = toy.authored_transform(head)?.ok_or("authored as a matrix")?;
//!     transform.rotation = transform.rotation * DQuat::from_rotation_y(0.4);
//!     input.shown_pose = Pose::Nodes(Arc::new(NodePose {
//!         parent_from_node: vec![(head, transform)],
//!         ..NodePose::default()
//!     }));
//!     core.frame(&input)?;
//!     // Without reading anything back, the picture can be had as a texture to draw on with.
//!     assert_eq!(core.picture()?.width(), 640);
//!     Ok(())
//! }
//! ```
//!
//! Where poses come from a tracker, or lights from a person, [`alignment::Aligner`] first corrects them by the picture.
//! An app that has a device of its own brings it with [`Core::on_device`]; one that shows a window uses
//! [`Core::on_surface`] and [`Core::present`]. [`Core::warm_up`] compiles on another thread, or in slices.
//!
//! [glossary]: #glossary
//! [passes]: #passes
//! [session format]: session/index.html#the-session-format
//! [spaces]: #spaces-and-units
#![doc = include_str!("../doc/architecture.md")]
#![doc = include_str!("../doc/spaces.md")]
#![doc = include_str!("../doc/passes.md")]
#![doc = include_str!("../doc/glossary.md")]
#![forbid(unsafe_code)]

pub mod alignment;
pub mod app;
pub mod camera_frame;
pub mod card;
pub mod core;
pub mod frame;
pub mod governor;
pub mod gpu;
pub mod interface;
pub mod ledger;
pub mod live;
pub mod preset;
pub mod probe;
pub mod profile;
pub mod recording;
pub mod scene;
pub mod self_test;
pub mod session;
pub mod toy;

mod baseline;
mod disjoint;
mod geometry;
pub mod lens;
mod model;
mod passes;
mod plan;
mod plates;
mod readback;
mod stage;
mod words;

pub use crate::core::{Core, CoreError};
pub use wgpu;

/// Internals for the project's own tests and harness. They change without notice.
#[doc(hidden)]
pub mod internals {
    pub use crate::baseline::plan::BaselinePlan;
    pub use crate::baseline::planned as planned_by_baseline;
    pub use crate::baseline::uniform::Baseline as BaselineUniform;
    pub use crate::core::inspect::Inspect;
    pub use crate::geometry::anchored::AnchoredReceiver;
    pub use crate::geometry::bounds::{Bounds, Sphere};
    pub use crate::geometry::color::linear_from_srgb;
    pub use crate::geometry::facing::Viewers;
    pub use crate::geometry::light_points::{ambient_directions, light_in_plane, light_points};
    pub use crate::geometry::outline::Outline;
    pub use crate::geometry::reach::Reach;
    pub use crate::geometry::rect::{PixelRect, PlaneRect};
    pub use crate::geometry::scene_layout::SceneLayout;
    pub use crate::geometry::seen::{mark_seen, seen_rect};
    pub use crate::geometry::shadow_atlas::ShadowAtlas;
    pub use crate::geometry::silhouette::{
        ByCamera, Edges, Landing, OntoReceiver, Projection, Shape, Silhouette, find_silhouette,
    };
    pub use crate::geometry::tiles::{CountedTiles, PixelBox, Tiles};
    pub use crate::geometry::view::View;
    pub use crate::geometry::whole_shadow::Caster as ShadowCaster;
    pub use crate::gpu::context::phone_limits;
    pub use crate::gpu::device::Kind;
    pub use crate::gpu::meter::Memory;
    pub use crate::gpu::shader::{Part, Shader};
    pub use crate::gpu::shared::{Member, Mirror, NumberKind};
    pub use crate::model::diagnostics::conditioning::light_conditioning;
    pub use crate::model::diagnostics::evidence::{Evidence, PixelEvidence};
    pub use crate::model::diagnostics::outliers::{OUTLIER_ALL, OUTLIER_NONE, SHADOW_EVENNESS, outliers};
    pub use crate::model::lighting::self_shadow::SelfShadow;
    pub use crate::model::plan::Plan;
    pub use crate::model::planned as planned_by_model;
    pub use crate::model::state::grids::{Grid, Grids, MAX_CELLS, grids_over, holds};
    pub use crate::model::state::solution::{Fit, N_COLUMNS, N_FIT_SUMS, ReceiverFit};
    pub use crate::model::state::tints::{TINT_SIDE, TintGrid, TintMap};
    pub use crate::passes::globals::{Globals, globals};
    pub use crate::passes::plate::{PlateView, PlateViews};
    pub use crate::plan::{Change, LeftOut, SceneFacts};
    pub use crate::plates::exposure::match_plates;
    pub use crate::plates::overlap::compared_plates;
    pub use crate::readback::inject::InjectedVisibility;
    pub use crate::readback::{FloatMap, Map};
    pub use crate::session::tags::{exif_orientation, png_chunks};

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
