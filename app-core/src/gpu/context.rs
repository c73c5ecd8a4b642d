//! The device: asked for with the limits of a phone, whatever the machine could offer.

use std::sync::{Arc, Mutex, PoisonError};

use thiserror::Error;

/// Which graphics adapter to use.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum AdapterChoice {
    /// The fastest one.
    #[default]
    Fastest,
    /// The first whose name contains this text, whatever the case.
    Named(String),
}

/// Why there is no device.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum GpuError {
    /// There is no driver, or none that can draw on the surface.
    #[error(
        "no graphics adapter: {reason}; on Debian or Ubuntu `apt-get install mesa-vulkan-drivers` brings a software one"
    )]
    NoAdapter {
        /// What was found.
        reason: String,
    },
    /// The adapter gave no device with the limits that we need.
    #[error("adapter {adapter} gives no device: {reason}")]
    NoDevice {
        /// Name of the adapter.
        adapter: String,
        /// What the driver said.
        reason: String,
    },
    /// The device refused work: out of memory, most often.
    #[error("the device refused work: {reason}")]
    Refused {
        /// What the driver said first.
        reason: String,
    },
    /// The device was lost, or a read-back failed.
    #[error("reading back from the device: {reason}")]
    ReadBack {
        /// What the driver said.
        reason: String,
    },
}

/// Device and queue, and what is known of them.
#[derive(Debug)]
pub struct Gpu {
    pub(crate) adapter: wgpu::Adapter,
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
    info: wgpu::AdapterInfo,
    has_timestamps: bool,
    /// The first thing the device refused since it was last asked.
    refused: Arc<Mutex<Option<String>>>,
}

/// The limits that every phone we aim at has; tests run under them too.
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
    /// When there is no adapter, or it falls short of the limits of a phone.
    pub async fn open(
        instance: &wgpu::Instance,
        choice: &AdapterChoice,
        surface: Option<&wgpu::Surface<'static>>,
    ) -> Result<Self, GpuError> {
        let adapter = find_adapter(instance, choice, surface).await?;
        let info = adapter.get_info();
        let has_timestamps = adapter.features().contains(wgpu::Features::TIMESTAMP_QUERY);
        let required_features = if has_timestamps {
            wgpu::Features::TIMESTAMP_QUERY
        } else {
            wgpu::Features::empty()
        };
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("app-core"),
            required_features,
            required_limits: phone_limits(),
            ..Default::default()
        };
        let (device, queue) = adapter
            .request_device(&descriptor)
            .await
            .map_err(|e| GpuError::NoDevice {
                adapter: info.name.clone(),
                reason: e.to_string(),
            })?;
        // Without a handler a picture too large for the device's memory would end the program.
        let refused = Arc::new(Mutex::new(None));
        let first = Arc::clone(&refused);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            let mut first = first.lock().unwrap_or_else(PoisonError::into_inner);
            first.get_or_insert_with(|| error.to_string());
        }));
        Ok(Self {
            refused,
            adapter,
            device,
            queue,
            info,
            has_timestamps,
        })
    }

    /// Fails once for what the device refused since the last call.
    pub(crate) fn check(&self) -> Result<(), GpuError> {
        let first = self.refused.lock().unwrap_or_else(PoisonError::into_inner).take();
        first.map_or(Ok(()), |reason| Err(GpuError::Refused { reason }))
    }

    /// Name of the adapter and of its driver, for reports.
    #[must_use]
    pub fn adapter_name(&self) -> String {
        format!("{} ({})", self.info.name, self.info.driver_info)
    }

    /// Whether the adapter is a processor that plays at being a graphics card.
    #[must_use]
    pub fn is_software(&self) -> bool {
        self.info.device_type == wgpu::DeviceType::Cpu
    }

    /// Whether passes can be timed on the device itself.
    #[must_use]
    pub fn has_timestamps(&self) -> bool {
        self.has_timestamps
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
                    reason: format!("none is named \"{wanted}\", there are {names:?}"),
                })
        }
    }
}
