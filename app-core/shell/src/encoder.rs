//! What encodes a video.

use std::io;
use std::path::Path;

use app_core::scene::Image;

/// Pictures a second, at most.
pub const HZ: u32 = 30;

/// Encodes pictures of one size into one file.
pub trait VideoEncoder {
    /// Adds the picture that is shown from `since_s` on, in seconds after the first, later than the one before; false where the
    /// file has no more room.
    ///
    /// # Errors
    /// As the encoder's and the file's.
    fn add(&mut self, picture: &Image, since_s: f64) -> io::Result<bool>;

    /// Makes the file whole; the last picture is shown until `until_s`.
    ///
    /// # Errors
    /// As the encoder's and the file's.
    fn finish(self: Box<Self>, until_s: f64) -> io::Result<()>;
}

/// Begins a file of pictures of so many pixels.
pub type BeginVideo = fn(&Path, [u32; 2]) -> io::Result<Box<dyn VideoEncoder>>;
