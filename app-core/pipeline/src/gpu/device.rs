//! The device, with a count of the objects it creates: a frame that changes only pose, picture or
//! view creates none.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use wgpu::util::DeviceExt;

use super::handle::DeviceHandle;

/// A kind of object of the device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Vertices, uniforms, storage.
    Buffer,
    /// Textures for any use.
    Texture,
    /// Views of textures.
    View,
    /// Samplers.
    Sampler,
    /// Bind groups.
    BindGroup,
    /// Layouts of bind groups and of pipelines.
    Layout,
    /// Shader modules.
    Module,
    /// Render and compute pipelines.
    Pipeline,
    /// Query sets.
    QuerySet,
}

impl Kind {
    /// Every kind.
    pub const ALL: [Self; 9] = [
        Self::Buffer,
        Self::Texture,
        Self::View,
        Self::Sampler,
        Self::BindGroup,
        Self::Layout,
        Self::Module,
        Self::Pipeline,
        Self::QuerySet,
    ];
}

/// A device and the number of objects it created, including those that were dropped.
#[derive(Debug)]
pub(crate) struct Device {
    pub(crate) raw: wgpu::Device,
    identity: Arc<()>,
    counts: [AtomicU64; Kind::ALL.len()],
}

impl Device {
    pub(crate) fn new(raw: wgpu::Device) -> Self {
        Self {
            raw,
            identity: Arc::default(),
            counts: Default::default(),
        }
    }

    /// The device, for textures that the core does not own.
    pub(crate) fn handle(&self) -> DeviceHandle {
        DeviceHandle::new(self.raw.clone(), Arc::clone(&self.identity))
    }

    /// Number of objects created so far, in the order of [`Kind::ALL`].
    pub(crate) fn n_created(&self) -> [u64; Kind::ALL.len()] {
        self.counts.each_ref().map(|count| count.load(Ordering::Relaxed))
    }

    pub(crate) fn buffer(&self, descriptor: &wgpu::BufferDescriptor<'_>) -> wgpu::Buffer {
        self.count(Kind::Buffer);
        self.raw.create_buffer(descriptor)
    }

    pub(crate) fn filled_buffer(&self, descriptor: &wgpu::util::BufferInitDescriptor<'_>) -> wgpu::Buffer {
        self.count(Kind::Buffer);
        self.raw.create_buffer_init(descriptor)
    }

    pub(crate) fn texture(&self, descriptor: &wgpu::TextureDescriptor<'_>) -> wgpu::Texture {
        self.count(Kind::Texture);
        self.raw.create_texture(descriptor)
    }

    pub(crate) fn view(
        &self,
        texture: &wgpu::Texture,
        descriptor: &wgpu::TextureViewDescriptor<'_>,
    ) -> wgpu::TextureView {
        self.count(Kind::View);
        texture.create_view(descriptor)
    }

    pub(crate) fn sampler(&self, descriptor: &wgpu::SamplerDescriptor<'_>) -> wgpu::Sampler {
        self.count(Kind::Sampler);
        self.raw.create_sampler(descriptor)
    }

    pub(crate) fn bind_group(&self, descriptor: &wgpu::BindGroupDescriptor<'_>) -> wgpu::BindGroup {
        self.count(Kind::BindGroup);
        self.raw.create_bind_group(descriptor)
    }

    pub(crate) fn bind_group_layout(
        &self,
        descriptor: &wgpu::BindGroupLayoutDescriptor<'_>,
    ) -> wgpu::BindGroupLayout {
        self.count(Kind::Layout);
        self.raw.create_bind_group_layout(descriptor)
    }

    pub(crate) fn pipeline_layout(
        &self,
        descriptor: &wgpu::PipelineLayoutDescriptor<'_>,
    ) -> wgpu::PipelineLayout {
        self.count(Kind::Layout);
        self.raw.create_pipeline_layout(descriptor)
    }

    pub(crate) fn module(&self, descriptor: wgpu::ShaderModuleDescriptor<'_>) -> wgpu::ShaderModule {
        self.count(Kind::Module);
        self.raw.create_shader_module(descriptor)
    }

    pub(crate) fn render_pipeline(
        &self,
        descriptor: &wgpu::RenderPipelineDescriptor<'_>,
    ) -> wgpu::RenderPipeline {
        self.count(Kind::Pipeline);
        self.raw.create_render_pipeline(descriptor)
    }

    pub(crate) fn compute_pipeline(
        &self,
        descriptor: &wgpu::ComputePipelineDescriptor<'_>,
    ) -> wgpu::ComputePipeline {
        self.count(Kind::Pipeline);
        self.raw.create_compute_pipeline(descriptor)
    }

    pub(crate) fn query_set(&self, descriptor: &wgpu::QuerySetDescriptor<'_>) -> wgpu::QuerySet {
        self.count(Kind::QuerySet);
        self.raw.create_query_set(descriptor)
    }

    /// A command encoder, one per submission; it is not counted.
    pub(crate) fn encoder(&self) -> wgpu::CommandEncoder {
        self.raw
            .create_command_encoder(&wgpu::CommandEncoderDescriptor::default())
    }

    fn count(&self, kind: Kind) {
        self.counts[kind as usize].fetch_add(1, Ordering::Relaxed);
    }
}
