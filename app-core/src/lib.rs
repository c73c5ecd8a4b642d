//! Shadow retargeting: a static toy in a camera picture moves, with its own real shadow, re-made from samples of it.
//!
//! The method is that of Casas et al. 2018 and 2019 («Image Based Proximate Shadow Retargeting»; «Enhanced Shadow
//! Retargeting with Light-Source Estimation Using Flat Fresnel Lenses»), with a model of our own in its place where that
//! is more accurate: see the architecture below.
#![doc = include_str!("../doc/architecture.md")]
#![doc = include_str!("../doc/spaces.md")]
#![doc = include_str!("../doc/passes.md")]
#![forbid(unsafe_code)]

pub mod core;
pub mod frame;
pub mod gpu;
pub mod grids;
pub mod inject;
pub mod light_points;
pub mod light_tiles;
pub mod maps;
pub mod outline;
pub mod plan;
pub mod preset;
pub mod region;
pub mod resolution;
pub mod scene;
pub mod session;
pub mod toy;
pub mod unknown;
pub mod view;

mod capture;
mod clip_reach;
mod counting;
mod exposure;
mod knowledge;
mod learner;
mod lighting;
mod passes;
mod pipeline;
mod plate_store;
mod plates;
mod pool;
mod published;
mod stage;
mod standing;
mod window;
mod work;

pub use crate::core::{Core, CoreError};
pub use wgpu;
