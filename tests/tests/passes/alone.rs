//! Passes of the registry alone, without those before them, with numbers that occur in no scene.

use crate::device::Device;
use crate::errors::Errors;
use crate::resources::texture_of;
use app_core::wgpu;
use app_pipeline::shaders;
use glam::{DVec4, UVec2, Vec4};
use reference::raster::Raster;

/// A binding's number, and the bound resource.
pub(crate) type Binding<'a> = (u32, wgpu::BindingResource<'a>);
pub(crate) type Bindings<'a> = Vec<Binding<'a>>;

/// Format of the results: 32 bits, so that nothing is rounded to the format of the pass.
pub(crate) const RESULT_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;
const RESULT_BYTES: u32 = 16;
/// Rows of a copied texture begin on a multiple of this.
const ROW_ALIGNMENT: u32 = wgpu::COPY_BYTES_PER_ROW_ALIGNMENT;

/// A fragment shader over a whole target.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Draw<'a> {
    /// WGSL with an entry point `vs_fullscreen`.
    pub(crate) source: &'a str,
    pub(crate) fragment: &'a str,
    pub(crate) constants: &'a [(&'a str, f64)],
    /// Index of the requested output.
    pub(crate) output: usize,
    pub(crate) size: UVec2,
}

impl<'a> Draw<'a> {
    /// The first output, without constants.
    pub(crate) fn of(source: &'a str, fragment: &'a str, size: UVec2) -> Self {
        Self {
            source,
            fragment,
            constants: &[],
            output: 0,
            size,
        }
    }
}

/// The WGSL of a pass of the registry.
pub(crate) fn source(shader: &str) -> String {
    shaders().find(|one| one.name == shader).unwrap().source()
}

/// Proof that a comparison can fail: with each fault, a text and its replacement, `errors` of the
/// pass exceed `allowed`.
///
/// The text occurs once. If possible it contains no local, so that locals can be renamed.
pub(crate) fn check_faults(
    shader: &str,
    faults: &[(&str, &str)],
    allowed: f64,
    errors: impl Fn(&str) -> Errors,
) {
    let sound = source(shader);
    for (from, to) in faults {
        let n_places = sound.matches(from).count();
        assert_eq!(n_places, 1, "places of \"{from}\" in {shader}");
        let faulty = sound.replace(from, to);
        let worst = errors(&faulty).max();
        assert!(
            worst > allowed,
            "\"{to}\" for \"{from}\" in {shader} is not found: {worst:.2e}"
        );
    }
}

impl Device {
    /// The output of a fragment shader of the registry for the resources of groups 0 and 1.
    pub(crate) fn draw(&self, draw: Draw<'_>, groups: [&[Binding<'_>]; 2]) -> Raster<DVec4> {
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC;
        let texture = self
            .device
            .create_texture(&texture_of(draw.size, 1, RESULT_FORMAT, usage));
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let mut formats = vec![None; draw.output];
        formats.push(Some(RESULT_FORMAT.into()));
        let pipeline = self.pipeline((draw.source, draw.fragment, draw.constants), &formats, None);
        let mut targets = vec![None; draw.output];
        targets.push(Some(wgpu::RenderPassColorAttachment {
            view: &view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations::default(),
        }));
        self.draw_into(&pipeline, groups, &targets, None);
        self.read_texture(&texture, draw.size)
    }

    /// Runs a compute shader with the resources of groups 0 and 1.
    pub(crate) fn compute(
        &self,
        source: &str,
        entry_point: &str,
        groups: [&[Binding<'_>]; 2],
        workgroups: [u32; 3],
    ) {
        let module = self.module(source);
        let pipeline = self
            .device
            .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: None,
                layout: None,
                module: &module,
                entry_point: Some(entry_point),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            });
        let groups = self.groups(groups, |index| pipeline.get_bind_group_layout(index));
        let mut encoder = self.encoder();
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&pipeline);
        for (index, group) in &groups {
            pass.set_bind_group(*index, group, &[]);
        }
        pass.dispatch_workgroups(workgroups[0], workgroups[1], workgroups[2]);
        drop(pass);
        self.queue.submit([encoder.finish()]);
    }

    fn module(&self, source: &str) -> wgpu::ShaderModule {
        self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: None,
            source: wgpu::ShaderSource::Wgsl(source.into()),
        })
    }

    fn encoder(&self) -> wgpu::CommandEncoder {
        self.device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor::default())
    }

    pub(crate) fn pipeline(
        &self,
        (source, fragment, constants): (&str, &str, &[(&str, f64)]),
        targets: &[Option<wgpu::ColorTargetState>],
        depth_stencil: Option<wgpu::DepthStencilState>,
    ) -> wgpu::RenderPipeline {
        let module = self.module(source);
        self.device
            .create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: None,
                layout: None,
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some("vs_fullscreen"),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    buffers: &[],
                },
                primitive: wgpu::PrimitiveState::default(),
                depth_stencil,
                multisample: wgpu::MultisampleState::default(),
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: Some(fragment),
                    compilation_options: wgpu::PipelineCompilationOptions {
                        constants,
                        ..Default::default()
                    },
                    targets,
                }),
                multiview_mask: None,
                cache: None,
            })
    }

    pub(crate) fn draw_into(
        &self,
        pipeline: &wgpu::RenderPipeline,
        groups: [&[Binding<'_>]; 2],
        targets: &[Option<wgpu::RenderPassColorAttachment<'_>>],
        depth: Option<wgpu::RenderPassDepthStencilAttachment<'_>>,
    ) {
        let groups = self.groups(groups, |index| pipeline.get_bind_group_layout(index));
        let mut encoder = self.encoder();
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: targets,
            depth_stencil_attachment: depth,
            ..Default::default()
        });
        pass.set_pipeline(pipeline);
        for (index, group) in &groups {
            pass.set_bind_group(*index, group, &[]);
        }
        pass.draw(0..3, 0..1);
        drop(pass);
        self.queue.submit([encoder.finish()]);
    }

    /// The non-empty groups, by their number.
    fn groups(
        &self,
        groups: [&[Binding<'_>]; 2],
        layout: impl Fn(u32) -> wgpu::BindGroupLayout,
    ) -> Vec<(u32, wgpu::BindGroup)> {
        let used = (0..).zip(groups).filter(|(_, bindings)| !bindings.is_empty());
        let group = |(index, bindings): (u32, &[Binding<'_>])| {
            let entries: Vec<_> = bindings
                .iter()
                .map(|(binding, resource)| wgpu::BindGroupEntry {
                    binding: *binding,
                    resource: resource.clone(),
                })
                .collect();
            let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: None,
                layout: &layout(index),
                entries: &entries,
            });
            (index, group)
        };
        used.map(group).collect()
    }

    fn read_texture(&self, texture: &wgpu::Texture, size: UVec2) -> Raster<DVec4> {
        let row_bytes = (RESULT_BYTES * size.x).next_multiple_of(ROW_ALIGNMENT);
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: u64::from(row_bytes * size.y),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        let mut encoder = self.encoder();
        encoder.copy_texture_to_buffer(
            texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &buffer,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(row_bytes),
                    rows_per_image: None,
                },
            },
            texture.size(),
        );
        self.queue.submit([encoder.finish()]);
        let texels = self.read(&buffer);
        let row_texels = row_bytes / RESULT_BYTES;
        Raster::from_fn(size, |at| {
            Vec4::from(texels[(at.y * row_texels + at.x) as usize]).as_dvec4()
        })
    }
}
