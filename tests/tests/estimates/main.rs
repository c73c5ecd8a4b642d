//! Estimates from pictures: cameras, poses, lights, lenses and plates.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

mod alignment;
mod bundled;
mod discovery;
mod exposed_things;
mod focal_length;
mod from_photographs;
mod fronts;
mod gloss;
mod grain;
mod hands;
mod later_views;
mod lens_found;
mod lists;
mod model;
mod moved_lights;
mod moved_toy;
mod pale_toy;
mod planes;
mod plate_taker;
mod pose_filter;
mod probe;
mod probe_session;
mod real_pictures;
mod reflection;
mod sides;
mod softness;
mod texture;
mod thing_ends;
mod thing_watcher;
mod things;
mod uncertainty;
mod upright;
mod withheld;
mod world_scale;
mod wrong_plate;
