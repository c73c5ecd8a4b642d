//! What an animator does on a desktop: photographs become a session, a session and clips a film, and key poses that were
//! photographed one by one get their in-between frames.

#![forbid(unsafe_code)]

pub mod animate;
pub mod ease;
pub mod inbetween;
pub mod length;
pub mod new;
pub mod photograph;
pub mod sheet;
pub mod small;
pub mod thumbnail;
pub mod video;
