//! The device against the references, each stage fed with the device's own inputs of that stage, so that errors do not
//! add up. Small synthetic scenes of odd sizes, whose truth is known.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

mod composite;
mod coverage;
mod device;
mod errors;
mod estimate;
mod fill;
mod fit;
mod inject;
mod levels;
mod moving;
mod occlusion;
mod overlap;
mod photo;
mod place;
mod plate;
mod published;
mod residual;
mod run;
mod self_shadow;
mod toy;
mod unknown;
