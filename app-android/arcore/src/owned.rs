//! Objects of ARCore that are released when they are dropped.

use std::ptr::NonNull;

/// An object that was created or acquired, and the function that releases it.
pub(super) struct Owned<T> {
    object: NonNull<T>,
    give_back: unsafe extern "C" fn(*mut T),
}

impl<T> Owned<T> {
    /// The object that `create` wrote to its output; `None` if it is null.
    ///
    /// # Safety
    /// `create` leaves its output unchanged, or writes an object there that nothing else releases
    /// and that `give_back` accepts.
    pub(super) unsafe fn new(
        create: impl FnOnce(&mut *mut T),
        give_back: unsafe extern "C" fn(*mut T),
    ) -> Option<Self> {
        let mut object = std::ptr::null_mut();
        create(&mut object);
        NonNull::new(object).map(|object| Self { object, give_back })
    }

    pub(super) fn as_ptr(&self) -> *mut T {
        self.object.as_ptr()
    }
}

impl<T> Drop for Owned<T> {
    fn drop(&mut self) {
        // SAFETY: by the contract of `new`, the object is ours, and it is released only here.
        unsafe { (self.give_back)(self.object.as_ptr()) }
    }
}
