//! Shadow retargeting: a static toy in a camera picture moves, with its own real shadow, re-made
//! from samples of it.
//!
//! The method is that of Casas et al. 2018 and 2019 («Image Based Proximate Shadow Retargeting»; «Enhanced Shadow
//! Retargeting with Light-Source Estimation Using Flat Fresnel Lenses»), with an additive model in its place where
//! that is more accurate: see the [architecture].
//!
//! A [`Core`] takes a scene, then frames, and makes a picture of each:
//!
#![cfg_attr(feature = "fs", doc = "```")]
#![cfg_attr(not(feature = "fs"), doc = "```ignore")]
//! use std::{error::Error, sync::Arc};
//!
//! use app_core::frame::FrameInput;
//! use app_core::gpu::AdapterChoice;
//! use app_core::preset::Preset;
//! use app_core::scene::Pose;
//! use app_core::session::{Capture, Folder, Session};
//! use app_core::toy::NodePose;
//! use app_core::glam::DQuat;
//! use app_core::{Core, wgpu};
//!
//! fn main() -> Result<(), Box<dyn Error>> {
//!     // `Folder` needs the feature `fs`: the core itself reads through the trait `Files`.
//!     let session = Capture::open(Folder::open("../tests/sessions/llama")?)?;
//!     let instance = wgpu::Instance::default();
//!     let mut core = pollster::block_on(Core::headless(&instance, &AdapterChoice::Fastest))?;
//!     core.set_scene(session.scene().clone(), Preset::Balanced)?;
//!
//!     // A frame has the camera's picture, the poses of camera and toy, the lights, and the pose
//!     // to show: here a moment of a clip.
//!     let mut input = FrameInput::from(&session.frame(0)?);
//!     let report = core.frame(&input)?;
//!     for warning in &report.warnings {
//!         println!("{warning}");
//!     }
//!     let picture = core.read_picture()?;
//!     assert_eq!([picture.width_px, picture.height_px], [640, 360]);
//!     assert!(picture.rgba8 != input.image.rgba().rgba8);
//!
//!     // The app sets a pose: the llama turns its head. This frame costs far less, since the
//!     // scene is known.
//!     let toy = &session.scene().toy;
//!     let head = toy.find_node("head")?;
//!     let mut transform = toy.authored_transform(head)?.ok_or("authored as a matrix")?;
//!     transform.rotation = transform.rotation * DQuat::from_rotation_y(0.4);
//!     input.shown_pose = Pose::Nodes(Arc::new(NodePose {
//!         parent_from_node: vec![(head, transform)],
//!         ..NodePose::default()
//!     }));
//!     core.frame(&input)?;
//!     // The picture is also available as a texture, without readback.
//!     assert_eq!(core.picture()?.width(), 640);
//!     Ok(())
//! }
//! ```
//!
//! If poses come from a tracker, or lights from a person, [`alignment::Aligner`] first corrects
//! them against the picture.
//! An app with its own device uses [`Core::on_device`]; one with a window uses [`Core::on_surface`]
//! and [`Core::present`]. [`Core::warm_up`] compiles on another thread, or in slices.
//!
//! [`shadow_style`] makes the shown shadow stronger or weaker, harder or softer than the real one.
//! For further processing, [`Core::read_light`] reads the picture with more precision than codes,
//! and [`Core::read_layers`] in layers, from the clean plate to the toy with its alpha.
//!
//! The documents of `app-core/doc` explain the [architecture], the [spaces] and units, the [passes]
//! and the terms of the [glossary]; [`session`] has the format of sessions, [`recording`] that of
//! recordings. The programs in `app-core/examples` use a device of their own, a loop over poses,
//! a scene made of values alone, and a device's compiler and self-test.
#![forbid(unsafe_code)]

pub use app_pipeline::{Core, CoreError, governor, ledger, preset, profile, wgpu};
pub use app_scene::glam;
pub use app_scene::{
    camera_frame, card, depth, gloss, grain, lens, people, place_mesh, reflection, scene, shadow_style,
    sharpness, things, toy,
};

/// The main object of an app.
pub mod core {
    pub use app_pipeline::core::{Canvas, Core, CoreError, WarmUp, as_shown};
    pub use app_pipeline::readback::FloatMap;
    pub use app_pipeline::readback::layers::Layers;
}

/// The device, and textures that a platform shares with it.
pub mod gpu {
    pub use app_pipeline::gpu::{
        AdapterChoice, DeviceHandle, GpuError, LentError, LentTextures, ShaderTexts,
        fault_of_pipeline_caches, fault_on_surfaces, phone_limits,
    };
}

/// The input and the report of a frame.
pub mod frame {
    pub use app_pipeline::frame::*;
    pub use app_scene::frame::{FrameInput, Observations};
}

#[cfg(feature = "alignment")]
pub use app_alignment as alignment;
#[cfg(feature = "alignment")]
pub use app_alignment::probe;
#[cfg(feature = "live")]
pub use app_live::{app, interface, live, self_test};
#[cfg(feature = "session")]
pub use app_session as session;
#[cfg(feature = "session")]
pub use app_session::recording;

/// A document of `app-core/doc` as a separate page, so that its links are checked and the first
/// page stays short.
macro_rules! document {
    ($name:ident, $text:literal) => {
        // These definitions win over those of the documents themselves, which are of files.
        /// [architecture]: crate::architecture
        /// [glossary]: crate::glossary
        /// [passes]: crate::passes
        /// [session format]: crate::session
        /// [spaces]: crate::spaces
        ///
        #[cfg(doc)]
        #[doc = include_str!($text)]
        pub mod $name {}
    };
}

document!(architecture, "../doc/architecture.md");
document!(glossary, "../doc/glossary.md");
document!(passes, "../doc/passes.md");
document!(spaces, "../doc/spaces.md");

/// The program in the document on embedding is compiled with the tests.
#[cfg(doctest)]
#[doc = include_str!("../doc/embedding.md")]
mod embedding {}
