//! The app on a desktop: the same logic, interface, core and background work as on a phone, with a
//! session as its camera.

pub mod desktop;
pub mod fault;
pub mod feed;
pub mod moment;
pub mod tour;
pub mod window;
