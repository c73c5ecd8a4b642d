//! The app on a desktop: the same logic, interface, core and work as on a phone, fed by a session in place of a camera.

pub mod desktop;
pub mod fault;
pub mod feed;
pub mod moment;
pub mod tour;
pub mod window;
