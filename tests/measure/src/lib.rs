//! The measuring programs, and the photographer that renders their scenes.

pub mod ball;
pub mod bench;
pub mod count;
pub mod glb;
pub mod heap;
mod median;
pub mod moved;
pub mod photographer;
pub mod planar;
pub mod process;
pub mod profiled;
pub mod random;
pub mod scaling;
pub mod sized;
pub mod stability;
