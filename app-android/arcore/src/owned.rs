//! Objects of ARCore that are given back when they are dropped.

use std::ptr::NonNull;

/// An object that was created or acquired, and the function that it is given back with.
pub(super) struct Owned<T> {
    object: NonNull<T>,
    give_back: unsafe extern "C" fn(*mut T),
}

impl<T> Owned<T> {
    /// What `create` put in the place that it was given; none if that is nothing.
    ///
    /// # Safety
    /// `create` leaves its place alone, or puts an object there that nobody else gives back and that `give_back` takes.
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
        // SAFETY: by the contract of `new`, the object is ours, and this is the one time that it is given back.
        unsafe { (self.give_back)(self.object.as_ptr()) }
    }
}
