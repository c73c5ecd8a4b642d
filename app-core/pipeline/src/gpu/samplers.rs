//! The samplers that passes share.

use super::device::Device;

/// A sampler; empty if work is only counted.
#[derive(Debug, Default)]
pub(crate) struct Sampler(pub(super) Option<wgpu::Sampler>);

#[derive(Debug, Default)]
pub(crate) struct Samplers {
    /// Bilinear between texels, clamped to the edge.
    pub(crate) linear: Sampler,
    /// Filtered comparison, 1 if the compared depth is as near as the map's, or nearer; depth is
    /// reversed.
    pub(crate) nearer: Sampler,
}

impl Samplers {
    pub(crate) fn new(device: &Device) -> Self {
        let sampler = |label, compare| {
            Sampler(Some(device.sampler(&wgpu::SamplerDescriptor {
                label: Some(label),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                compare,
                ..Default::default()
            })))
        };
        Self {
            linear: sampler("linear", None),
            // A surface is lit if it is as near to the light as the map, or nearer.
            nearer: sampler("nearer", Some(wgpu::CompareFunction::GreaterEqual)),
        }
    }
}
