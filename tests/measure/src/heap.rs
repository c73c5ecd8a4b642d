//! Memory held by the Rust code of this process, without a driver's allocations in C.

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

/// The system's allocator, counted.
struct Counted {
    n_bytes: AtomicUsize,
}

#[global_allocator]
static HEAP: Counted = Counted {
    n_bytes: AtomicUsize::new(0),
};

/// MiB held at present.
#[must_use]
pub fn heap_mib() -> f64 {
    let n_bytes = HEAP.n_bytes.load(Ordering::Relaxed) as f64;
    n_bytes / f64::from(1 << 20)
}

impl Counted {
    /// Counts a block that replaces another, unless the allocation failed.
    fn count(&self, block: *mut u8, n_bytes: usize, n_bytes_before: usize) -> *mut u8 {
        if !block.is_null() {
            self.n_bytes.fetch_add(n_bytes, Ordering::Relaxed);
            self.n_bytes.fetch_sub(n_bytes_before, Ordering::Relaxed);
        }
        block
    }
}

// SAFETY: blocks are the system allocator's own, and counting neither allocates nor panics.
unsafe impl GlobalAlloc for Counted {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller keeps to the same contract.
        self.count(unsafe { System.alloc(layout) }, layout.size(), 0)
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as above.
        self.count(unsafe { System.alloc_zeroed(layout) }, layout.size(), 0)
    }

    unsafe fn realloc(&self, block: *mut u8, layout: Layout, n_bytes: usize) -> *mut u8 {
        // SAFETY: as above; the block is the system's.
        self.count(
            unsafe { System.realloc(block, layout, n_bytes) },
            n_bytes,
            layout.size(),
        )
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        self.n_bytes.fetch_sub(layout.size(), Ordering::Relaxed);
        // SAFETY: as above; the block is the system's.
        unsafe { System.dealloc(block, layout) }
    }
}
