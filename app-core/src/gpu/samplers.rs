//! The samplers that passes share.

use super::device::Device;

#[derive(Debug)]
pub(crate) struct Samplers {
    /// Between texels, up to the border.
    pub(crate) linear: wgpu::Sampler,
    /// 1 where the map is no nearer than what is compared with it, filtered; depth is reversed.
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
