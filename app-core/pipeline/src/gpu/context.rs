//! The device: requested with the limits of a phone on every machine.

use std::fmt;
use std::pin::pin;
use std::sync::Arc;
use std::task::{Context, Poll, Waker};

use thiserror::Error;

use super::bindings::{BindingCache, Layout, Resource, Slot};
use super::device::{Device, Kind};
use super::meter::{Memory, Meter};
use super::pipeline::{Compute, ComputeSpec, Draw, DrawSpec, Pipeline, PipelineCache};
use super::quirks::{fault_of_pipeline_caches, fault_on_surfaces};
use super::samplers::Samplers;
use super::shader::ShaderTexts;
use super::uniforms::Uniforms;

/// Choice of the graphics adapter.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum AdapterChoice {
    /// The fastest one.
    #[default]
    Fastest,
    /// The first whose name contains this text, in upper or lower case.
    Named(String),
}

/// The reason why there is no device.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum GpuError {
    /// No driver exists, or none can draw on the surface.
    #[error("no graphics adapter: {reason}")]
    NoAdapter {
        /// The reason why none is suitable.
        reason: String,
    },
    /// The adapter offers no device with the required limits.
    #[error("adapter {adapter} gives no device: {reason}")]
    NoDevice {
        /// Name of the adapter.
        adapter: String,
        /// The driver's message.
        reason: String,
    },
    /// The adapter's driver is known to fail.
    #[error("adapter {adapter} is not used: {fault}")]
    KnownFault {
        /// Name of the adapter.
        adapter: String,
        /// The fault, with its source.
        fault: &'static str,
    },
    /// The device refused work, mostly because memory ran out.
    #[error("the device refused work: {reason}")]
    Refused {
        /// The driver's first message.
        reason: String,
    },
    /// The surface cannot be drawn on.
    #[error("drawing on the surface: {reason}")]
    Surface {
        /// The driver's message.
        reason: String,
    },
    /// The surface is lost, but the device is not: another surface must be created for the same
    /// window.
    #[error("the surface is lost")]
    SurfaceLost,
    /// The device was lost, or a read-back failed.
    #[error("reading back from the device: {reason}")]
    ReadBack {
        /// The driver's message.
        reason: String,
    },
}

/// A device and everything that is created once on it; or no device, and the work is only counted.
#[derive(Default)]
pub struct Gpu {
    pub(crate) opened: Option<Opened>,
    pub(crate) samplers: Samplers,
    pub(super) meter: Meter,
}

/// Device and queue, and everything that is created once per device.
pub(crate) struct Opened {
    pub(crate) device: Device,
    pub(crate) queue: wgpu::Queue,
    /// The adapter; `None` for an adopted device.
    pub(crate) adapter: Option<wgpu::Adapter>,
    pub(super) uniforms: Uniforms,
    pipelines: PipelineCache,
    bindings: BindingCache,
    info: wgpu::AdapterInfo,
}

/// Features that are used if a device has them.
fn wished_features(info: &wgpu::AdapterInfo) -> wgpu::Features {
    let timestamps = wgpu::Features::TIMESTAMP_QUERY;
    if fault_of_pipeline_caches(info).is_some() {
        timestamps
    } else {
        timestamps | wgpu::Features::PIPELINE_CACHE
    }
}

/// The limits that every supported phone has; tests run under them too.
#[must_use]
pub fn phone_limits() -> wgpu::Limits {
    // Camera images are wider than the 2048 texels that the oldest devices offer.
    wgpu::Limits {
        max_texture_dimension_2d: 8192,
        ..wgpu::Limits::downlevel_defaults()
    }
}

impl Gpu {
    /// Opens a device that can draw on `surface`, or on textures alone.
    ///
    /// # Errors
    /// If there is no adapter, if it falls short of the limits of a phone, or if its driver is
    /// known to fail on a surface.
    pub(crate) async fn open(
        instance: &wgpu::Instance,
        choice: &AdapterChoice,
        surface: Option<&wgpu::Surface<'static>>,
    ) -> Result<Self, GpuError> {
        let adapter = find_adapter(instance, choice, surface).await?;
        let info = adapter.get_info();
        if let Some(fault) = surface.and_then(|_| fault_on_surfaces(&info)) {
            return Err(GpuError::KnownFault {
                adapter: info.name,
                fault,
            });
        }
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("app-core"),
            required_features: adapter.features() & wished_features(&info),
            required_limits: phone_limits(),
            ..Default::default()
        };
        let (device, queue) =
            adapter
                .request_device(&descriptor)
                .await
                .map_err(|error| GpuError::NoDevice {
                    adapter: info.name,
                    reason: error.to_string(),
                })?;
        // Errors outside of `guarded`, such as the loss of the device, would end the program
        // without a handler.
        device.on_uncaptured_error(Arc::new(|_: wgpu::Error| ()));
        Self::new(device, queue, Some(adapter))
    }

    /// Adopts a device that the caller opened.
    ///
    /// # Errors
    /// If it falls short of the limits of a phone.
    pub(crate) fn adopt(device: wgpu::Device, queue: wgpu::Queue) -> Result<Self, GpuError> {
        if !phone_limits().check_limits(&device.limits()) {
            return Err(GpuError::NoDevice {
                adapter: device.adapter_info().name,
                reason: format!("it was opened with less than {:?}", phone_limits()),
            });
        }
        Self::new(device, queue, None)
    }

    fn new(
        device: wgpu::Device,
        queue: wgpu::Queue,
        adapter: Option<wgpu::Adapter>,
    ) -> Result<Self, GpuError> {
        let info = device.adapter_info();
        let device = Device::new(device);
        let (uniforms, samplers) = guarded(&device.raw, || (Uniforms::new(&device), Samplers::new(&device)))?;
        Ok(Self {
            opened: Some(Opened {
                pipelines: PipelineCache::default(),
                bindings: BindingCache::default(),
                info,
                uniforms,
                adapter,
                device,
                queue,
            }),
            samplers,
            meter: Meter::default(),
        })
    }

    /// Runs `work` on the device, and fails if the device refused any of it.
    pub(crate) fn guarded<T>(&self, work: impl FnOnce() -> T) -> Result<T, GpuError> {
        let Some(opened) = &self.opened else {
            return Ok(work());
        };
        let done = guarded(&opened.device.raw, work);
        if done.is_err() {
            // Refused objects must not be taken from a cache as if they were valid.
            opened.pipelines.clear();
            opened.bindings.clear();
        }
        done
    }

    /// The limits of all work.
    pub(crate) fn limits(&self) -> wgpu::Limits {
        let opened = self.opened.as_ref();
        opened.map_or_else(phone_limits, |opened| opened.device.raw.limits())
    }

    /// Bytes of textures and buffers that were created so far.
    pub(crate) fn memory(&self) -> Memory {
        self.meter.memory()
    }

    /// Number of objects created on the device so far, by kind.
    pub(crate) fn n_created(&self) -> [u64; Kind::ALL.len()] {
        self.opened
            .as_ref()
            .map_or([0; Kind::ALL.len()], |opened| opened.device.n_created())
    }

    /// The render pipeline of `spec`, compiled at the first call.
    pub(crate) fn draw(&self, spec: &DrawSpec) -> Draw {
        match &self.opened {
            Some(opened) => opened.pipelines.draw(&opened.device, &opened.bindings, spec),
            None => Pipeline {
                name: spec.shader.name,
                slots: spec.groups,
                compiled: None,
            },
        }
    }

    /// The compute pipeline of `spec`, compiled at the first call.
    pub(crate) fn compute(&self, spec: &ComputeSpec) -> Compute {
        match &self.opened {
            Some(opened) => opened.pipelines.compute(&opened.device, &opened.bindings, spec),
            None => Pipeline {
                name: spec.shader.name,
                slots: spec.groups,
                compiled: None,
            },
        }
    }

    /// Key under which pipelines are kept; `None` if they cannot be.
    pub(crate) fn pipelines_key(&self) -> Option<String> {
        let opened = self.opened.as_ref()?;
        let features = opened.device.raw.features();
        let info = &opened.info;
        features.contains(wgpu::Features::PIPELINE_CACHE).then(|| {
            format!(
                "{} {:x} {:x} {} {} {}",
                env!("CARGO_PKG_VERSION"),
                info.vendor,
                info.device,
                info.name,
                info.driver,
                info.driver_info
            )
        })
    }

    /// Compiles with a cache of the driver from now on.
    pub(crate) fn set_pipeline_cache(&self, cache: wgpu::PipelineCache) {
        if let Some(opened) = &self.opened {
            opened.pipelines.set_of_driver(cache);
        }
    }

    /// The content of that cache.
    pub(crate) fn pipeline_data(&self) -> Option<Vec<u8>> {
        self.opened.as_ref()?.pipelines.data_of_driver()
    }

    /// Compiles shaders from other texts from now on, and returns the previous texts. Pipelines in
    /// use stay unchanged.
    pub(crate) fn replace_shaders(&self, texts: ShaderTexts) -> ShaderTexts {
        let pipelines = self.opened.as_ref().map(|opened| &opened.pipelines);
        pipelines.map_or_else(ShaderTexts::default, |kept| kept.replace_texts(texts))
    }

    /// Whether shaders are compiled from the built-in texts.
    pub(crate) fn has_built_in_shaders(&self) -> bool {
        let opened = self.opened.as_ref();
        opened.is_none_or(|opened| opened.pipelines.is_built_in())
    }

    /// Drops all groups, and with them the resources that nothing else holds: for textures replaced
    /// by larger ones.
    pub(crate) fn release_groups(&self) {
        if let Some(opened) = &self.opened {
            opened.bindings.release_groups();
        }
    }

    /// Name of the adapter and of its driver, for reports.
    #[must_use]
    pub fn adapter_name(&self) -> String {
        self.opened.as_ref().map_or_else(
            || "no device".to_owned(),
            |opened| format!("{} ({})", opened.info.name, opened.info.driver_info),
        )
    }

    /// Whether the adapter is a software renderer on the CPU.
    #[must_use]
    pub fn is_software(&self) -> bool {
        let opened = self.opened.as_ref();
        opened.is_some_and(|opened| opened.info.device_type == wgpu::DeviceType::Cpu)
    }
}

impl Opened {
    /// The layout of a group of `slots`.
    pub(super) fn layout(&self, slots: &'static [Slot]) -> Layout {
        self.bindings.layout(&self.device, slots)
    }

    /// The group of `resources`, in the order of the layout's slots, from the cache if it is there.
    pub(super) fn bind(&self, layout: &Layout, resources: &[Resource<'_>]) -> Option<wgpu::BindGroup> {
        self.bindings
            .group(&self.device, &self.uniforms, layout, resources)
    }
}

impl fmt::Debug for Gpu {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Gpu({})", self.adapter_name())
    }
}

/// Collects the errors of `work` on this thread, whatever other handlers the device has.
fn guarded<T>(device: &wgpu::Device, work: impl FnOnce() -> T) -> Result<T, GpuError> {
    let filters = [
        wgpu::ErrorFilter::Internal,
        wgpu::ErrorFilter::OutOfMemory,
        wgpu::ErrorFilter::Validation,
    ];
    let mut scopes = filters.map(|filter| Some(device.push_error_scope(filter)));
    let done = work();
    let mut refused = None;
    for scope in scopes.iter_mut().rev() {
        let error = scope.take().and_then(|scope| ready(scope.pop()).flatten());
        refused = refused.or(error);
    }
    match refused {
        Some(error) => Err(GpuError::Refused {
            reason: error.to_string(),
        }),
        None => Ok(done),
    }
}

/// The value of a future that is ready at once, as an error scope always is outside the web.
fn ready<T>(future: impl Future<Output = T>) -> Option<T> {
    let mut context = Context::from_waker(Waker::noop());
    match pin!(future).poll(&mut context) {
        Poll::Ready(value) => Some(value),
        Poll::Pending => None,
    }
}

async fn find_adapter(
    instance: &wgpu::Instance,
    choice: &AdapterChoice,
    surface: Option<&wgpu::Surface<'static>>,
) -> Result<wgpu::Adapter, GpuError> {
    match choice {
        AdapterChoice::Fastest => instance
            .request_adapter(&wgpu::RequestAdapterOptions {
                power_preference: wgpu::PowerPreference::HighPerformance,
                compatible_surface: surface,
                ..Default::default()
            })
            .await
            .map_err(|e| GpuError::NoAdapter {
                reason: e.to_string(),
            }),
        AdapterChoice::Named(wanted) => {
            let adapters = instance.enumerate_adapters(wgpu::Backends::all()).await;
            let names: Vec<String> = adapters.iter().map(|a| a.get_info().name).collect();
            let fits = |adapter: &wgpu::Adapter| {
                adapter
                    .get_info()
                    .name
                    .to_lowercase()
                    .contains(&wanted.to_lowercase())
                    && surface.is_none_or(|s| adapter.is_surface_supported(s))
            };
            adapters
                .into_iter()
                .find(fits)
                .ok_or_else(|| GpuError::NoAdapter {
                    reason: format!("there is none named \"{wanted}\"; available: {names:?}"),
                })
        }
    }
}
