//! Handle to a core's device for other modules.

use std::fmt;
use std::sync::Arc;

/// A device for textures that a platform shares. Two handles are equal if they come from the same
/// core: devices of two instances may be equal by wgpu's own comparison.
#[derive(Clone)]
pub struct DeviceHandle {
    raw: wgpu::Device,
    identity: Arc<()>,
}

impl DeviceHandle {
    pub(super) fn new(raw: wgpu::Device, identity: Arc<()>) -> Self {
        Self { raw, identity }
    }

    /// The device of wgpu.
    #[must_use]
    pub fn raw(&self) -> &wgpu::Device {
        &self.raw
    }

    /// Whether both are the same device.
    pub(crate) fn is(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.identity, &other.identity)
    }
}

impl fmt::Debug for DeviceHandle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "DeviceHandle({})", self.raw.adapter_info().name)
    }
}
