//! The references compared with closed forms: with geometry and algebra, not with another program.

mod appearance;
mod box_filter;
mod composite;
mod eligible;
mod estimated;
mod fit;
mod flat;
mod opaque;
mod pcss;
mod plate;
mod precision;
mod residual;
mod search;
mod tint;
mod visibility;
