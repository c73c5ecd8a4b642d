//! The passes, one a module, each under the one name that its shader, label and time stamp have.
//!
//! A pass is immutable after `new`; `encode` takes all it reads and writes and decides nothing.

pub(crate) mod appearance;
pub(crate) mod box_filter;
pub(crate) mod census;
pub(crate) mod composite;
pub(crate) mod coverage;
pub(crate) mod detail;
pub(crate) mod eligible;
pub(crate) mod estimate;
pub(crate) mod evidence;
pub(crate) mod fill;
pub(crate) mod fit;
pub(crate) mod lit;
pub(crate) mod masks;
pub(crate) mod motion;
pub(crate) mod object;
pub(crate) mod occlusion;
pub(crate) mod pcss;
pub(crate) mod plate;
pub(crate) mod present;
pub(crate) mod residual;
pub(crate) mod retarget;
pub(crate) mod search;
pub(crate) mod self_shadow;
pub(crate) mod tint;
pub(crate) mod toy;
pub(crate) mod toy_mesh;
pub(crate) mod visibility;
pub(crate) mod warp;
pub(crate) mod withhold;
