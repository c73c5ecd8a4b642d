//! Java pointers for calls of ARCore.

use std::ffi::c_void;

/// Two pointers of Java: the environment of this thread, and the activity.
#[derive(Clone, Copy, Debug)]
pub struct Java {
    /// `JNIEnv *`.
    pub env: *mut c_void,
    /// `jobject` of the activity.
    pub activity: *mut c_void,
}

/// A provider of these pointers.
pub trait JavaHost {
    /// The pointers, valid on this thread until the next call.
    fn java(&mut self) -> Java;
}
