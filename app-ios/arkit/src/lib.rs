//! Camera frames of ARKit: one file reads them into plain numbers, and all other code also runs on
//! a desktop.

pub mod convert;
pub mod depth;
pub mod frame;
pub mod map;
pub mod people;

#[cfg(target_os = "ios")]
pub mod camera;
#[cfg(target_os = "ios")]
mod card;
#[cfg(target_os = "ios")]
mod coaching;
#[cfg(target_os = "ios")]
mod pixels;
#[cfg(target_os = "ios")]
pub mod read;
#[cfg(target_os = "ios")]
mod scan;
#[cfg(target_os = "ios")]
pub mod session;
#[cfg(target_arch = "aarch64")]
pub mod shim;
#[cfg(target_os = "ios")]
mod textures;
