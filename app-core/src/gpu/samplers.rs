//! The samplers that passes share.

use super::device::Device;

#[derive(Debug)]
pub(crate) struct Samplers {
    /// Bilinear between texels, clamped to the edge.
    pub(crate) linear: wgpu::Sampler,
    /// Filtered comparison, 1 where the compared depth is as near as the map's, or nearer; depth is reversed.
    pub(crate) nearer: wgpu::Sampler,
}

impl Samplers {
    pub(crate) fn new(device: &Device) -> Self {
        let sampler = |label, compare| {
            device.sampler(&wgpu::SamplerDescriptor {
                label: Some(label),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                compare,
                ..Default::default()
            })
        };
        Self {
            linear: sampler("linear", None),
            // What is as near to the light as the map, or nearer, is lit.
            nearer: sampler("nearer", Some(wgpu::CompareFunction::GreaterEqual)),
        }
    }
}
