//! Pipelines, compiled once per device for all scenes and views.

use std::collections::HashMap;
use std::hash::Hash;
use std::mem;
use std::sync::Mutex;

use wgpu::{
    BlendComponent, BlendFactor, BlendOperation, BlendState, ColorTargetState, ColorWrites,
    DepthStencilState, Face, TextureFormat, VertexAttribute, VertexFormat, VertexStepMode,
};

use super::bindings::{BindingCache, Layout, N_GROUPS, Slot, locked};
use super::device::Device;
use super::shader::{Shader, ShaderTexts};

/// Slots of each group; empty if a shader has no such group.
pub(crate) type Groups = [&'static [Slot]; N_GROUPS];

/// A vertex stream of one attribute: its shader location and format.
pub(crate) type Stream = (u32, VertexFormat);

/// Description of a render pipeline, its cache key.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) struct DrawSpec {
    pub(crate) shader: &'static Shader,
    pub(crate) vertex: &'static str,
    pub(crate) fragment: &'static str,
    pub(crate) groups: Groups,
    /// One stream per vertex buffer, in the order of its slots.
    pub(crate) streams: &'static [Stream],
    pub(crate) targets: Vec<ColorTargetState>,
    pub(crate) n_samples: u32,
    pub(crate) depth: Option<DepthStencilState>,
    /// The culled side of triangles.
    pub(crate) culled: Option<Face>,
    /// Values of `override` constants.
    pub(crate) constants: Vec<(&'static str, u32)>,
}

impl DrawSpec {
    /// A fragment shader over a whole target.
    pub(crate) fn fullscreen(
        shader: &'static Shader,
        fragment: &'static str,
        groups: Groups,
        targets: &[TextureFormat],
    ) -> Self {
        Self {
            shader,
            vertex: "vs_fullscreen",
            fragment,
            groups,
            streams: &[],
            targets: targets.iter().map(|format| (*format).into()).collect(),
            n_samples: 1,
            depth: None,
            culled: None,
            constants: Vec::new(),
        }
    }
}

/// Description of a compute pipeline, its cache key.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) struct ComputeSpec {
    pub(crate) shader: &'static Shader,
    pub(crate) entry_point: &'static str,
    pub(crate) groups: Groups,
    /// Values of `override` constants.
    pub(crate) constants: Vec<(&'static str, u32)>,
}

/// A pipeline.
#[derive(Clone, Debug)]
pub(crate) struct Pipeline<T> {
    pub(crate) name: &'static str,
    pub(crate) slots: Groups,
    /// `None` if work is only counted.
    pub(super) compiled: Option<Compiled<T>>,
}

/// A pipeline on its device, and the layouts of its groups.
#[derive(Clone, Debug)]
pub(super) struct Compiled<T> {
    pub raw: T,
    pub(super) layouts: [Option<Layout>; N_GROUPS],
}

/// A render pipeline.
pub(crate) type Draw = Pipeline<wgpu::RenderPipeline>;
/// A compute pipeline.
pub(crate) type Compute = Pipeline<wgpu::ComputePipeline>;

/// Cache of everything compiled on a device.
#[derive(Default)]
pub(crate) struct PipelineCache {
    /// Source texts of the modules.
    texts: Mutex<ShaderTexts>,
    modules: Mutex<HashMap<&'static Shader, wgpu::ShaderModule>>,
    draws: Mutex<HashMap<DrawSpec, Draw>>,
    computes: Mutex<HashMap<ComputeSpec, Compute>>,
    /// The driver's own cache, which outlives the program.
    of_driver: Mutex<Option<wgpu::PipelineCache>>,
}

impl PipelineCache {
    /// The render pipeline of `spec`, compiled at the first call.
    pub(crate) fn draw(&self, device: &Device, bindings: &BindingCache, spec: &DrawSpec) -> Draw {
        cached(&self.draws, spec, || self.compile_draw(device, bindings, spec))
    }

    /// The compute pipeline of `spec`, compiled at the first call.
    pub(crate) fn compute(&self, device: &Device, bindings: &BindingCache, spec: &ComputeSpec) -> Compute {
        cached(&self.computes, spec, || {
            self.compile_compute(device, bindings, spec)
        })
    }

    /// Makes the driver read compiled pipelines from a cache and add new ones to it.
    pub(super) fn set_of_driver(&self, cache: wgpu::PipelineCache) {
        *locked(&self.of_driver) = Some(cache);
    }

    /// The content of the driver's cache.
    pub(super) fn data_of_driver(&self) -> Option<Vec<u8>> {
        locked(&self.of_driver).as_ref()?.get_data()
    }

    /// Compiles from other texts from now on, and returns the previous ones. What they change
    /// nothing of is kept.
    pub(crate) fn replace_texts(&self, texts: ShaderTexts) -> ShaderTexts {
        let mut now = locked(&self.texts);
        let before = mem::replace(&mut *now, texts);
        let mut modules = locked(&self.modules);
        modules.retain(|shader, _| shader.source_with(&now) == shader.source_with(&before));
        // Each pipeline was compiled from a module.
        locked(&self.draws).retain(|spec, _| modules.contains_key(&spec.shader));
        locked(&self.computes).retain(|spec, _| modules.contains_key(&spec.shader));
        before
    }

    /// Whether modules are compiled from the built-in texts.
    pub(crate) fn is_built_in(&self) -> bool {
        *locked(&self.texts) == ShaderTexts::default()
    }

    /// Drops everything, to be compiled anew.
    pub(crate) fn clear(&self) {
        locked(&self.modules).clear();
        locked(&self.draws).clear();
        locked(&self.computes).clear();
    }

    fn compile_draw(&self, device: &Device, bindings: &BindingCache, spec: &DrawSpec) -> Draw {
        let (layouts, layout) = pipeline_layout(device, bindings, spec.shader, spec.groups);
        let module = self.module(device, spec.shader);
        let constants = values(&spec.constants);
        let attributes: Vec<[VertexAttribute; 1]> = spec.streams.iter().map(attribute).collect();
        let buffers: Vec<_> = attributes.iter().map(|stream| Some(buffer(stream))).collect();
        let targets: Vec<_> = spec.targets.iter().cloned().map(Some).collect();
        let raw = device.render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(spec.shader.name),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some(spec.vertex),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &buffers,
            },
            primitive: wgpu::PrimitiveState {
                cull_mode: spec.culled,
                ..Default::default()
            },
            depth_stencil: spec.depth.clone(),
            multisample: wgpu::MultisampleState {
                count: spec.n_samples,
                ..Default::default()
            },
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some(spec.fragment),
                compilation_options: wgpu::PipelineCompilationOptions {
                    constants: &constants,
                    ..Default::default()
                },
                targets: &targets,
            }),
            multiview_mask: None,
            cache: locked(&self.of_driver).as_ref(),
        });
        Pipeline {
            name: spec.shader.name,
            slots: spec.groups,
            compiled: Some(Compiled { raw, layouts }),
        }
    }

    fn compile_compute(&self, device: &Device, bindings: &BindingCache, spec: &ComputeSpec) -> Compute {
        let (layouts, layout) = pipeline_layout(device, bindings, spec.shader, spec.groups);
        let raw = device.compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(spec.shader.name),
            layout: Some(&layout),
            module: &self.module(device, spec.shader),
            entry_point: Some(spec.entry_point),
            compilation_options: wgpu::PipelineCompilationOptions {
                constants: &values(&spec.constants),
                ..Default::default()
            },
            cache: locked(&self.of_driver).as_ref(),
        });
        Pipeline {
            name: spec.shader.name,
            slots: spec.groups,
            compiled: Some(Compiled { raw, layouts }),
        }
    }

    fn module(&self, device: &Device, shader: &'static Shader) -> wgpu::ShaderModule {
        cached(&self.modules, &shader, || {
            let source = shader.source_with(&locked(&self.texts));
            device.module(wgpu::ShaderModuleDescriptor {
                label: Some(shader.name),
                source: wgpu::ShaderSource::Wgsl(source.into()),
            })
        })
    }
}

/// Values of `override` constants in the device's type.
fn values(constants: &[(&'static str, u32)]) -> Vec<(&'static str, f64)> {
    let values = constants.iter();
    values.map(|(name, value)| (*name, f64::from(*value))).collect()
}

fn pipeline_layout(
    device: &Device,
    bindings: &BindingCache,
    shader: &Shader,
    groups: Groups,
) -> ([Option<Layout>; N_GROUPS], wgpu::PipelineLayout) {
    let layouts = groups.map(|slots| (!slots.is_empty()).then(|| bindings.layout(device, slots)));
    let raw = layouts
        .each_ref()
        .map(|layout| layout.as_ref().map(|layout| &layout.raw));
    let n_groups = raw.iter().rposition(Option::is_some).map_or(0, |last| last + 1);
    let layout = device.pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(shader.name),
        bind_group_layouts: &raw[..n_groups],
        immediate_size: 0,
    });
    (layouts, layout)
}

/// The value under `key`. A missing one is created outside the lock, since compilation takes long.
fn cached<K: Clone + Eq + Hash, V: Clone>(
    cache: &Mutex<HashMap<K, V>>,
    key: &K,
    make: impl FnOnce() -> V,
) -> V {
    if let Some(value) = locked(cache).get(key) {
        return value.clone();
    }
    let made = make();
    locked(cache).entry(key.clone()).or_insert(made).clone()
}

fn attribute(&(shader_location, format): &Stream) -> [VertexAttribute; 1] {
    [VertexAttribute {
        format,
        offset: 0,
        shader_location,
    }]
}

fn buffer(attributes: &[VertexAttribute; 1]) -> wgpu::VertexBufferLayout<'_> {
    wgpu::VertexBufferLayout {
        array_stride: attributes[0].format.size(),
        step_mode: VertexStepMode::Vertex,
        attributes,
    }
}

/// Depth state with reversed depth that keeps the nearest surface.
pub(crate) fn nearest_surface() -> DepthStencilState {
    DepthStencilState {
        format: TextureFormat::Depth32Float,
        depth_write_enabled: Some(true),
        depth_compare: Some(wgpu::CompareFunction::Greater),
        stencil: wgpu::StencilState::default(),
        bias: wgpu::DepthBiasState::default(),
    }
}

/// A target that is multiplied by the drawn values.
pub(crate) fn multiplied(format: TextureFormat) -> ColorTargetState {
    let product = BlendComponent {
        src_factor: BlendFactor::Dst,
        dst_factor: BlendFactor::Zero,
        operation: BlendOperation::Add,
    };
    ColorTargetState {
        format,
        blend: Some(BlendState {
            color: product,
            alpha: product,
        }),
        write_mask: ColorWrites::ALL,
    }
}
