//! The references against closed forms: what geometry and algebra say, not what another program says.

mod appearance;
mod box_filter;
mod composite;
mod eligible;
mod estimated;
mod fit;
mod flat;
mod pcss;
mod plate;
mod precision;
mod residual;
mod search;
mod tint;
mod visibility;
