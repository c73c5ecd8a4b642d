//! Pipelines: each from one shader of the registry, with its layout taken from the shader.

use super::Gpu;
use super::shaders::Shader;

/// Group of what all passes share: the globals, and the fit where a pass uses it.
pub(crate) const GROUP_GLOBALS: u32 = 0;
/// Group of a pass's own inputs and outputs.
pub(crate) const GROUP_PASS: u32 = 1;
/// Group of what changes from draw to draw.
pub(crate) const GROUP_DRAW: u32 = 2;

/// Colour targets, multisampling, depth, blending and culling of a render pipeline.
pub(crate) struct RenderShape<'a> {
    pub(crate) targets: &'a [Option<wgpu::ColorTargetState>],
    pub(crate) n_samples: u32,
    pub(crate) depth: Option<wgpu::DepthStencilState>,
    /// Which side of a triangle is not drawn.
    pub(crate) culled: Option<wgpu::Face>,
    pub(crate) constants: &'a [(&'a str, f64)],
}

/// Entry points and vertex streams of a render pipeline.
pub(crate) struct Stages<'a> {
    pub(crate) vertex: &'a str,
    pub(crate) fragment: &'a str,
    pub(crate) buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
}

impl Gpu {
    pub(crate) fn module(&self, shader: &Shader) -> wgpu::ShaderModule {
        self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(shader.name),
            source: wgpu::ShaderSource::Wgsl(shader.source().into()),
        })
    }

    pub(crate) fn render_pipeline(
        &self,
        shader: &Shader,
        module: &wgpu::ShaderModule,
        stages: &Stages<'_>,
        shape: &RenderShape<'_>,
    ) -> wgpu::RenderPipeline {
        let options = wgpu::PipelineCompilationOptions {
            constants: shape.constants,
            ..Default::default()
        };
        self.device
            .create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(shader.name),
                layout: None,
                vertex: wgpu::VertexState {
                    module,
                    entry_point: Some(stages.vertex),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    buffers: stages.buffers,
                },
                primitive: wgpu::PrimitiveState {
                    cull_mode: shape.culled,
                    ..Default::default()
                },
                depth_stencil: shape.depth.clone(),
                multisample: wgpu::MultisampleState {
                    count: shape.n_samples,
                    ..Default::default()
                },
                fragment: Some(wgpu::FragmentState {
                    module,
                    entry_point: Some(stages.fragment),
                    compilation_options: options,
                    targets: shape.targets,
                }),
                multiview_mask: None,
                cache: None,
            })
    }

    /// A pipeline that runs a fragment shader over a whole target.
    pub(crate) fn fullscreen_pipeline(
        &self,
        shader: &Shader,
        fragment: &str,
        format: wgpu::TextureFormat,
        constants: &[(&str, f64)],
    ) -> wgpu::RenderPipeline {
        let stages = Stages {
            vertex: "vs_fullscreen",
            fragment,
            buffers: &[],
        };
        let shape = RenderShape {
            targets: &[Some(format.into())],
            n_samples: 1,
            depth: None,
            culled: None,
            constants,
        };
        self.render_pipeline(shader, &self.module(shader), &stages, &shape)
    }

    pub(crate) fn compute_pipeline(&self, shader: &Shader, entry_point: &str) -> wgpu::ComputePipeline {
        self.device
            .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(shader.name),
                layout: None,
                module: &self.module(shader),
                entry_point: Some(entry_point),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            })
    }

    /// Binds resources in order to the given binding numbers.
    pub(crate) fn bind(
        &self,
        layout: &wgpu::BindGroupLayout,
        resources: &[(u32, wgpu::BindingResource<'_>)],
    ) -> wgpu::BindGroup {
        let entries: Vec<_> = resources
            .iter()
            .map(|(binding, resource)| wgpu::BindGroupEntry {
                binding: *binding,
                resource: resource.clone(),
            })
            .collect();
        self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout,
            entries: &entries,
        })
    }

    /// Binds buffers to the binding numbers from 0 on, such as the globals and the fit.
    pub(crate) fn bind_buffers(
        &self,
        layout: &wgpu::BindGroupLayout,
        buffers: &[&wgpu::Buffer],
    ) -> wgpu::BindGroup {
        let resources = buffers.iter().map(|buffer| buffer.as_entire_binding());
        self.bind(layout, &(0..).zip(resources).collect::<Vec<_>>())
    }

    pub(crate) fn linear_sampler(&self) -> wgpu::Sampler {
        self.device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("linear"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        })
    }

    /// A buffer filled with `contents`.
    pub(crate) fn buffer(&self, label: &str, contents: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
        use wgpu::util::DeviceExt;
        self.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some(label),
            contents,
            usage: usage | wgpu::BufferUsages::COPY_DST,
        })
    }

    /// A uniform buffer of one struct.
    pub(crate) fn uniform<T: bytemuck::Pod>(&self, label: &str, value: &T) -> wgpu::Buffer {
        self.buffer(label, bytemuck::bytes_of(value), wgpu::BufferUsages::UNIFORM)
    }
}

/// A view as a binding.
pub(crate) fn view(view: &wgpu::TextureView) -> wgpu::BindingResource<'_> {
    wgpu::BindingResource::TextureView(view)
}

/// Reversed depth that keeps the nearest surface.
pub(crate) fn nearest_surface() -> wgpu::DepthStencilState {
    wgpu::DepthStencilState {
        format: wgpu::TextureFormat::Depth32Float,
        depth_write_enabled: Some(true),
        depth_compare: Some(wgpu::CompareFunction::Greater),
        stencil: wgpu::StencilState::default(),
        bias: wgpu::DepthBiasState::default(),
    }
}
