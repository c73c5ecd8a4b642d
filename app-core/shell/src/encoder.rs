//! The interface of video encoders.

use std::io;
use std::path::Path;

use app_core::scene::Image;

/// Maximum number of pictures a second.
pub const HZ: u32 = 30;

/// Encodes pictures of one size into one file.
pub trait VideoEncoder {
    /// Adds the picture that is shown from `since_s` on, in seconds after the first, later than the
    /// previous one; returns false if the file has no space for it.
    ///
    /// # Errors
    /// Those of the encoder and the file.
    fn add(&mut self, picture: &Image, since_s: f64) -> io::Result<bool>;

    /// Completes the file; the last picture is shown until `until_s`.
    ///
    /// # Errors
    /// Those of the encoder and the file.
    fn finish(self: Box<Self>, until_s: f64) -> io::Result<()>;
}

/// Begins a file of pictures of this size in pixels.
pub type BeginVideo = fn(&Path, [u32; 2]) -> io::Result<Box<dyn VideoEncoder>>;
