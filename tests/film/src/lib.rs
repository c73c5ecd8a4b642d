//! What an animator does on a desktop: photographs become a session, a session and clips a film, and key poses that were
//! photographed one by one get their in-between frames.

#![forbid(unsafe_code)]

pub mod inbetween;
pub mod sheet;
