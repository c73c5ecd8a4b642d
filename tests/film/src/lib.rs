//! Programs for animators: they make a session from photographs, a film from a session and clips,
//! and in-between frames from photographed key poses.

#![forbid(unsafe_code)]

pub mod animate;
pub mod ease;
pub mod inbetween;
pub mod length;
pub mod new;
pub mod photograph;
pub mod quoted;
pub mod sheet;
pub mod small;
pub mod thumbnail;
pub mod video;
