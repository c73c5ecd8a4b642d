//! Plans, the work region, the points over a light and the presets: everything that is decided without a device.

mod light_points;
mod outline;
mod passes;
mod penumbra;
mod preset;
mod region;
mod resolution;
mod rig;
mod transforms;
mod unknown;
