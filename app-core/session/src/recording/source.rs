//! The source of a recording's bytes: the caller opens the file.

use std::io;

/// Read access to the bytes of one file, at any offset.
pub trait Source: Send + Sync {
    /// Size of the file, bytes.
    fn n_bytes(&self) -> u64;

    /// Fills `into` with the bytes from `at` on.
    ///
    /// # Errors
    /// When the system refuses, or the file is shorter.
    fn read_at(&self, at: u64, into: &mut [u8]) -> io::Result<()>;
}

impl Source for Vec<u8> {
    fn n_bytes(&self) -> u64 {
        self.len() as u64
    }

    fn read_at(&self, at: u64, into: &mut [u8]) -> io::Result<()> {
        let from = usize::try_from(at).ok();
        let bytes = from
            .and_then(|from| self.get(from..))
            .and_then(|rest| rest.get(..into.len()));
        into.copy_from_slice(bytes.ok_or(io::ErrorKind::UnexpectedEof)?);
        Ok(())
    }
}
