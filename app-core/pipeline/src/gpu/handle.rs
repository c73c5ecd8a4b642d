//! A core's device as others may have it.

use std::fmt;
use std::sync::Arc;

/// A device for textures that a platform lends. Two are the same one if they came of the same core: devices of two instances may
/// be equal by wgpu's own comparison.
#[derive(Clone)]
pub struct DeviceHandle {
    raw: wgpu::Device,
    identity: Arc<()>,
}

impl DeviceHandle {
    pub(super) fn new(raw: wgpu::Device, identity: Arc<()>) -> Self {
        Self { raw, identity }
    }

    /// wgpu's own.
    #[must_use]
    pub fn raw(&self) -> &wgpu::Device {
        &self.raw
    }

    /// Whether both are one device.
    pub(crate) fn is(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.identity, &other.identity)
    }
}

impl fmt::Debug for DeviceHandle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "DeviceHandle({})", self.raw.adapter_info().name)
    }
}
