//! Counts of allocated and transferred data, with or without a device.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use super::work::Id;

/// Bytes of textures and buffers that a core created, by their descriptors: a driver may round them
/// up. Targets that never leave the chip, for which a tiler allocates no memory, are not included.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Memory {
    /// Bytes of the existing ones.
    pub held_bytes: u64,
    /// Largest number of bytes at a time.
    pub peak_bytes: u64,
    /// Bytes of all that were ever created.
    pub made_bytes: u64,
}

/// Identifier of the next resource, on any device.
static NEXT_ID: AtomicU64 = AtomicU64::new(0);

/// The counts of one device.
#[derive(Debug, Default)]
pub(crate) struct Meter {
    uploaded: AtomicU64,
    made: AtomicU64,
    held: Arc<HeldBytes>,
}

/// Bytes that are held now, and their maximum.
#[derive(Debug, Default)]
struct HeldBytes {
    now: AtomicU64,
    peak: AtomicU64,
}

impl Meter {
    /// A number that no other resource has.
    pub(super) fn id() -> Id {
        NEXT_ID.fetch_add(1, Ordering::Relaxed)
    }

    /// Counts the bytes of a resource until the returned value is dropped.
    pub(super) fn hold(&self, n_bytes: u64) -> CountedBytes {
        self.made.fetch_add(n_bytes, Ordering::Relaxed);
        let now = self.held.now.fetch_add(n_bytes, Ordering::Relaxed) + n_bytes;
        self.held.peak.fetch_max(now, Ordering::Relaxed);
        CountedBytes {
            of: Arc::clone(&self.held),
            n_bytes,
        }
    }

    /// Counts bytes that the processor transfers to the device.
    pub(super) fn upload(&self, n_bytes: usize) {
        self.uploaded.fetch_add(n_bytes as u64, Ordering::Relaxed);
    }

    /// Bytes that the processor transferred so far.
    pub(super) fn uploaded_bytes(&self) -> u64 {
        self.uploaded.load(Ordering::Relaxed)
    }

    pub(super) fn memory(&self) -> Memory {
        Memory {
            held_bytes: self.held.now.load(Ordering::Relaxed),
            peak_bytes: self.held.peak.load(Ordering::Relaxed),
            made_bytes: self.made.load(Ordering::Relaxed),
        }
    }
}

/// The counted bytes of one texture or buffer.
#[derive(Debug)]
pub(super) struct CountedBytes {
    of: Arc<HeldBytes>,
    n_bytes: u64,
}

impl Drop for CountedBytes {
    fn drop(&mut self) {
        self.of.now.fetch_sub(self.n_bytes, Ordering::Relaxed);
    }
}
