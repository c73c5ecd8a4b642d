//! Time stamps: device time of each pass of the latest submission, on request.

use super::context::{Gpu, GpuError, Opened};
use super::pass_run::{PassGroup, PassTime};

/// Maximum number of timed passes of one submission.
const MAX_TIMED: u32 = 512;
/// Bytes of one time stamp.
const STAMP_BYTES: u64 = 8;

/// Stamps on the device, and the passes they belong to.
pub(crate) struct Timer {
    queries: wgpu::QuerySet,
    stamps: wgpu::Buffer,
    passes: Vec<(PassGroup, &'static str)>,
}

impl Timer {
    /// Returns `None` if the device has no time stamps.
    pub(crate) fn new(gpu: &Gpu) -> Option<Self> {
        let Opened { device, .. } = gpu.opened.as_ref()?;
        if !device.raw.features().contains(wgpu::Features::TIMESTAMP_QUERY) {
            return None;
        }
        Some(Self {
            queries: device.query_set(&wgpu::QuerySetDescriptor {
                label: Some("pass times"),
                ty: wgpu::QueryType::Timestamp,
                count: 2 * MAX_TIMED,
            }),
            stamps: device.buffer(&wgpu::BufferDescriptor {
                label: Some("pass times"),
                size: 2 * u64::from(MAX_TIMED) * STAMP_BYTES,
                usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            }),
            passes: Vec::new(),
        })
    }

    /// Drops the records of the previous submission.
    pub(crate) fn start(&mut self) {
        self.passes.clear();
    }

    /// Query index of the first of the next pass's two stamps; `None` if all are used.
    pub(crate) fn next(&mut self, group: PassGroup, pass: &'static str) -> Option<(&wgpu::QuerySet, u32)> {
        let index = u32::try_from(self.passes.len())
            .ok()
            .filter(|index| *index < MAX_TIMED)?;
        self.passes.push((group, pass));
        Some((&self.queries, 2 * index))
    }

    /// Encodes the copy of the stamps to their buffer.
    pub(crate) fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        let n_queries = 2 * u32::try_from(self.passes.len()).unwrap_or(MAX_TIMED);
        if n_queries > 0 {
            encoder.resolve_query_set(&self.queries, 0..n_queries, &self.stamps, 0);
        }
    }

    /// Waits for the device and returns each pass's time, passes of one path and name summed, in
    /// order of their first run.
    pub(crate) fn read(&self, gpu: &Gpu) -> Result<Vec<PassTime>, GpuError> {
        let Some(opened) = &gpu.opened else {
            return Ok(Vec::new());
        };
        let bytes = opened.read_buffer(&self.stamps)?;
        let stamps: Vec<u64> = bytemuck::pod_collect_to_vec(&bytes);
        let ms_per_tick = f64::from(opened.queue.get_timestamp_period()) * 1e-6;
        let mut times: Vec<PassTime> = Vec::new();
        for (&(path, pass), stamp) in self.passes.iter().zip(stamps.chunks_exact(2)) {
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
