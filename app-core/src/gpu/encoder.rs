//! Encoding of one submission, each pass with its name and, where the device can, its time stamps.

use crate::plan::Path;

use super::{Gpu, GpuError};

/// Most passes of one submission that are timed.
const MAX_TIMED: u32 = 512;
/// Bytes of one time stamp.
const STAMP_BYTES: u64 = 8;

/// Device time of one pass.
#[derive(Clone, Debug, PartialEq)]
pub struct PassTime {
    /// The path it ran on.
    pub path: Path,
    /// The pass's name.
    pub pass: &'static str,
    /// Device time from its beginning to its end.
    pub gpu_ms: f64,
}

/// Commands being recorded.
pub(crate) struct Encoder {
    pub(crate) raw: wgpu::CommandEncoder,
    /// The path that passes are put down to.
    pub(crate) path: Path,
    timer: Option<Timer>,
}

struct Timer {
    queries: wgpu::QuerySet,
    passes: Vec<(Path, &'static str)>,
}

/// Time stamps of a submission, still on the device.
pub(crate) struct Stamps {
    buffer: wgpu::Buffer,
    passes: Vec<(Path, &'static str)>,
}

impl Encoder {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let raw = gpu
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let timer = gpu.has_timestamps().then(|| Timer {
            queries: gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("pass times"),
                ty: wgpu::QueryType::Timestamp,
                count: 2 * MAX_TIMED,
            }),
            passes: Vec::new(),
        });
        Self {
            raw,
            path: Path::Frame,
            timer,
        }
    }

    /// Begins a render pass under the name of its shader.
    pub(crate) fn render<'a>(
        &'a mut self,
        pass: &'static str,
        colors: &[Option<wgpu::RenderPassColorAttachment<'_>>],
        depth: Option<&wgpu::TextureView>,
        keep_depth: wgpu::StoreOp,
    ) -> wgpu::RenderPass<'a> {
        let timed = self.timer.as_mut().and_then(|timer| timer.next(self.path, pass));
        let stamps = timed.map(|(query_set, first)| wgpu::RenderPassTimestampWrites {
            query_set,
            beginning_of_pass_write_index: Some(first),
            end_of_pass_write_index: Some(first + 1),
        });
        self.raw.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(pass),
            color_attachments: colors,
            depth_stencil_attachment: depth.map(|view| wgpu::RenderPassDepthStencilAttachment {
                view,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(0.0),
                    store: keep_depth,
                }),
                stencil_ops: None,
            }),
            timestamp_writes: stamps,
            occlusion_query_set: None,
            multiview_mask: None,
        })
    }

    /// Runs a fragment shader over the whole of `target`.
    pub(crate) fn fullscreen(
        &mut self,
        pass: &'static str,
        pipeline: &wgpu::RenderPipeline,
        groups: &[(u32, &wgpu::BindGroup)],
        target: &wgpu::TextureView,
    ) {
        let mut render = self.render(pass, &[Some(cleared(target))], None, wgpu::StoreOp::Discard);
        render.set_pipeline(pipeline);
        for (index, group) in groups {
            render.set_bind_group(*index, *group, &[]);
        }
        render.draw(0..3, 0..1);
    }

    /// Runs a compute shader.
    pub(crate) fn compute(
        &mut self,
        pass: &'static str,
        pipeline: &wgpu::ComputePipeline,
        groups: &[(u32, &wgpu::BindGroup)],
        workgroups: [u32; 3],
    ) {
        let timed = self.timer.as_mut().and_then(|timer| timer.next(self.path, pass));
        let stamps = timed.map(|(query_set, first)| wgpu::ComputePassTimestampWrites {
            query_set,
            beginning_of_pass_write_index: Some(first),
            end_of_pass_write_index: Some(first + 1),
        });
        let mut compute = self.raw.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(pass),
            timestamp_writes: stamps,
        });
        compute.set_pipeline(pipeline);
        for (index, group) in groups {
            compute.set_bind_group(*index, *group, &[]);
        }
        compute.dispatch_workgroups(workgroups[0], workgroups[1], workgroups[2]);
    }

    /// Hands the commands to the device.
    pub(crate) fn submit(mut self, gpu: &Gpu) -> Option<Stamps> {
        let stamps = self
            .timer
            .take()
            .filter(|timer| !timer.passes.is_empty())
            .map(|timer| {
                let n_stamps = 2 * timer.passes.len() as u64;
                let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
                    label: Some("pass times"),
                    size: n_stamps * STAMP_BYTES,
                    usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
                    mapped_at_creation: false,
                });
                let n_queries = 2 * u32::try_from(timer.passes.len()).unwrap_or(MAX_TIMED);
                self.raw
                    .resolve_query_set(&timer.queries, 0..n_queries, &buffer, 0);
                Stamps {
                    buffer,
                    passes: timer.passes,
                }
            });
        gpu.queue.submit([self.raw.finish()]);
        stamps
    }
}

impl Timer {
    /// Where the stamps of the next pass go: its first of two places; none when all are taken.
    fn next(&mut self, path: Path, pass: &'static str) -> Option<(&wgpu::QuerySet, u32)> {
        let index = u32::try_from(self.passes.len())
            .ok()
            .filter(|index| *index < MAX_TIMED)?;
        self.passes.push((path, pass));
        Some((&self.queries, 2 * index))
    }
}

impl Stamps {
    /// Waits for the device and returns each pass's time, passes of one path and name summed, in order of their first run.
    pub(crate) fn read(self, gpu: &Gpu) -> Result<Vec<PassTime>, GpuError> {
        let bytes = gpu.read_buffer(&self.buffer)?;
        let stamps: Vec<u64> = bytemuck::pod_collect_to_vec(&bytes);
        let ms_per_tick = f64::from(gpu.queue.get_timestamp_period()) * 1e-6;
        let mut times: Vec<PassTime> = Vec::new();
        for (&(path, pass), stamp) in self.passes.iter().zip(stamps.chunks_exact(2)) {
            #[allow(
                clippy::cast_precision_loss,
                reason = "a difference of ticks within one frame is far below 2^52"
            )]
            let gpu_ms = stamp[1].saturating_sub(stamp[0]) as f64 * ms_per_tick;
            match times
                .iter_mut()
                .find(|time| (time.path, time.pass) == (path, pass))
            {
                Some(time) => time.gpu_ms += gpu_ms,
                None => times.push(PassTime { path, pass, gpu_ms }),
            }
        }
        Ok(times)
    }
}

/// An attachment that starts at zero and is kept.
pub(crate) fn cleared(view: &wgpu::TextureView) -> wgpu::RenderPassColorAttachment<'_> {
    wgpu::RenderPassColorAttachment {
        view,
        depth_slice: None,
        resolve_target: None,
        ops: wgpu::Operations {
            load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
            store: wgpu::StoreOp::Store,
        },
    }
}

/// A multisampled attachment that starts at zero, never leaves the chip and is resolved into `target`.
pub(crate) fn resolved<'a>(
    view: &'a wgpu::TextureView,
    target: &'a wgpu::TextureView,
) -> wgpu::RenderPassColorAttachment<'a> {
    wgpu::RenderPassColorAttachment {
        resolve_target: Some(target),
        ops: wgpu::Operations {
            load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
            store: wgpu::StoreOp::Discard,
        },
        ..cleared(view)
    }
}
