//! A device of the tests' own, for values that the core does not expose: the driver's decoding of
//! sRGB, and `fill` on any cells.

use std::sync::LazyLock;

use app_core::gpu::GpuError;
use app_core::wgpu;
use app_pipeline::model::state::grids::{Grid, Grids};
use app_pipeline::shaders;
use glam::UVec2;
use wgpu::util::DeviceExt;

use crate::alone::Bindings;

const DECODE: &str = "
@group(1) @binding(0) var codes: texture_2d<f32>;
@group(1) @binding(1) var<storage, read_write> linear: array<vec4f>;
@compute @workgroup_size(256)
fn cs_decode(@builtin(local_invocation_index) code: u32) { linear[code] = textureLoad(codes, vec2u(code, 0u), 0); }
";

pub(crate) struct Device {
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
}

impl Device {
    /// The only device of all tests.
    pub(crate) fn shared() -> &'static Self {
        static DEVICE: LazyLock<Device> = LazyLock::new(Device::open);
        &DEVICE
    }

    fn open() -> Self {
        let instance = wgpu::Instance::default();
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            ..Default::default()
        };
        let adapter = pollster::block_on(instance.request_adapter(&options)).unwrap_or_else(|error| {
            panic!(
                "{}",
                GpuError::NoAdapter {
                    reason: error.to_string()
                }
            )
        });
        let descriptor = wgpu::DeviceDescriptor {
            required_limits: wgpu::Limits::downlevel_defaults(),
            ..Default::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor)).unwrap();
        Self { device, queue }
    }

    /// The linear value that shaders get for each code of an sRGB texture.
    ///
    /// Drivers may round, and a software driver uses a polynomial: the inputs of a stage are the
    /// values that its shader read.
    pub(crate) fn decoded(&self) -> Vec<f64> {
        let codes: Vec<u8> = (0..=255u8).flat_map(|code| [code, code, code, 255]).collect();
        let texture = self.device.create_texture_with_data(
            &self.queue,
            &wgpu::TextureDescriptor {
                label: None,
                size: wgpu::Extent3d {
                    width: 256,
                    height: 1,
                    depth_or_array_layers: 1,
                },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: wgpu::TextureFormat::Rgba8UnormSrgb,
                usage: wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            },
            wgpu::util::TextureDataOrder::LayerMajor,
            &codes,
        );
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let linear = self.storage(bytemuck::cast_slice(&[[f32::NAN; 4]; 256]));
        self.run(
            DECODE,
            "cs_decode",
            &[
                wgpu::BindingResource::TextureView(&view),
                linear.as_entire_binding(),
            ],
        );
        self.read(&linear)
            .iter()
            .map(|texel| f64::from(texel[0]))
            .collect()
    }

    /// Runs the `fill` of the registry over cells of values times certainties and their certainties.
    pub(crate) fn fill(&self, size: UVec2, cells: &[[f32; 4]]) -> Vec<[f32; 4]> {
        // Other cells of another receiver come first.
        const FIRST_CELL: usize = 3;
        let mut grids = Grids::default();
        grids.grids[0] = Grid {
            first_cell: u32::try_from(FIRST_CELL).unwrap(),
            size: size.to_array(),
            ..Grid::default()
        };
        let grids = self.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: None,
            contents: bytemuck::bytes_of(&grids),
            usage: wgpu::BufferUsages::UNIFORM,
        });
        // Coarser levels start as unwritten memory: they must not be read.
        let mut pyramid = vec![[f32::NAN; 4]; FIRST_CELL];
        pyramid.extend(cells);
        pyramid.resize(2 * cells.len() + 256, [f32::NAN; 4]);
        let pyramid = self.storage(bytemuck::cast_slice(&pyramid));
        let source = shaders().find(|shader| shader.name == "fill").unwrap().source();
        self.run(
            &source,
            "cs_pull_push",
            &[grids.as_entire_binding(), pyramid.as_entire_binding()],
        );
        self.read(&pyramid)[FIRST_CELL..][..cells.len()].to_vec()
    }

    pub(crate) fn storage(&self, contents: &[u8]) -> wgpu::Buffer {
        self.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: None,
            contents,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
        })
    }

    /// One workgroup of a compute shader whose resources are in group 1.
    fn run(&self, source: &str, entry_point: &str, resources: &[wgpu::BindingResource<'_>]) {
        let own: Bindings<'_> = (0..).zip(resources.iter().cloned()).collect();
        self.compute(source, entry_point, [&[], &own], [1, 1, 1]);
    }

    pub(crate) fn read(&self, buffer: &wgpu::Buffer) -> Vec<[f32; 4]> {
        let copy = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: buffer.size(),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut encoder = self
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_buffer_to_buffer(buffer, 0, &copy, 0, buffer.size());
        self.queue.submit([encoder.finish()]);
        copy.map_async(wgpu::MapMode::Read, .., |mapped| mapped.unwrap());
        self.device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
        bytemuck::pod_collect_to_vec(&copy.get_mapped_range(..).unwrap())
    }
}
