//! Bindings of shaders: the slots of a bind group, and a cache of bind groups.

use std::collections::HashMap;
use std::num::NonZeroU64;
use std::sync::{Mutex, MutexGuard, PoisonError};

use wgpu::{
    BindingType, BufferBindingType, SamplerBindingType, ShaderStages, TextureSampleType, TextureViewDimension,
};

use super::device::Device;
use super::meter::Meter;
use super::resource::{Buffer, TextureView};
use super::samplers::Sampler;
use super::uniforms::Uniforms;
use super::work::Bound;

/// Group shared by all passes: the globals, and a method's own uniforms.
pub(crate) const GROUP_SCENE: usize = 0;
/// Group of a pass's own inputs and outputs.
pub(crate) const GROUP_PASS: usize = 1;
/// Group of resources that change from draw to draw.
pub(crate) const GROUP_DRAW: usize = 2;
/// Bind groups available on a phone.
pub(crate) const N_GROUPS: usize = 4;

/// Type of a binding; its index among the slots is its binding number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Slot {
    /// A uniform of this many bytes, in a buffer of its own.
    Uniform(usize),
    /// A uniform of this many bytes, written for each use at a dynamic offset.
    PerUse(usize),
    /// A read-only storage buffer.
    Read,
    /// A storage buffer for reading and writing, in compute shaders.
    ReadWrite,
    /// A texture whose texels are loaded.
    Texture,
    /// A texture array whose texels are loaded.
    Layers,
    /// A texture of unsigned integers.
    WholeNumbers,
    /// A filterable texture.
    Filtered,
    /// A depth map of the drawn pixels.
    Depth,
    /// A depth map from a light, which is sampled at any position.
    ShadowMap,
    /// The sampler that filters.
    Sampler,
    /// The sampler that compares depths.
    Comparison,
}

impl Slot {
    /// A uniform in a buffer of its own.
    pub(crate) const fn uniform<T>() -> Self {
        Self::Uniform(size_of::<T>())
    }

    /// A uniform that is written for each use.
    pub(crate) const fn per_use<T>() -> Self {
        Self::PerUse(size_of::<T>())
    }

    /// Number of bytes of a buffer of `n_bytes` that a shader can access through the slot.
    fn seen_bytes(self, n_bytes: u64) -> u64 {
        match self {
            Self::Uniform(size) | Self::PerUse(size) => size as u64,
            _ => n_bytes,
        }
    }

    fn layout_entry(self, binding: u32) -> wgpu::BindGroupLayoutEntry {
        let drawn = ShaderStages::FRAGMENT | ShaderStages::COMPUTE;
        let buffer = |ty, has_dynamic_offset, n_bytes| BindingType::Buffer {
            ty,
            has_dynamic_offset,
            min_binding_size: NonZeroU64::new(n_bytes as u64),
        };
        let texture = |sample_type, view_dimension| BindingType::Texture {
            sample_type,
            view_dimension,
            multisampled: false,
        };
        let loaded = TextureSampleType::Float { filterable: false };
        let (visibility, ty) = match self {
            Self::Uniform(n) => (
                drawn | ShaderStages::VERTEX,
                buffer(BufferBindingType::Uniform, false, n),
            ),
            Self::PerUse(n) => (
                drawn | ShaderStages::VERTEX,
                buffer(BufferBindingType::Uniform, true, n),
            ),
            Self::Read => (
                drawn,
                buffer(BufferBindingType::Storage { read_only: true }, false, 0),
            ),
            Self::ReadWrite => (
                ShaderStages::COMPUTE,
                buffer(BufferBindingType::Storage { read_only: false }, false, 0),
            ),
            Self::Texture => (drawn, texture(loaded, TextureViewDimension::D2)),
            Self::Layers => (drawn, texture(loaded, TextureViewDimension::D2Array)),
            Self::WholeNumbers => (drawn, texture(TextureSampleType::Uint, TextureViewDimension::D2)),
            Self::Filtered => (
                drawn,
                texture(
                    TextureSampleType::Float { filterable: true },
                    TextureViewDimension::D2,
                ),
            ),
            Self::Depth | Self::ShadowMap => {
                (drawn, texture(TextureSampleType::Depth, TextureViewDimension::D2))
            }
            Self::Sampler => (drawn, BindingType::Sampler(SamplerBindingType::Filtering)),
            Self::Comparison => (drawn, BindingType::Sampler(SamplerBindingType::Comparison)),
        };
        wgpu::BindGroupLayoutEntry {
            binding,
            visibility,
            ty,
            count: None,
        }
    }
}

/// Resource bound to a slot.
#[derive(Clone, Copy)]
pub(crate) enum Resource<'a> {
    /// A whole buffer.
    Buffer(&'a Buffer),
    /// A texture.
    View(&'a TextureView),
    /// A sampler.
    Sampler(&'a Sampler),
    /// Uniforms that are written for each use.
    PerUse,
}

impl<'a> Resource<'a> {
    fn is_own(&self) -> bool {
        !matches!(self, Self::View(view) if !view.is_own)
    }

    /// The data that a resource moves through a slot.
    pub(super) fn bound(self, slot: Slot) -> Option<Bound> {
        match (self, slot) {
            (Self::Buffer(buffer), _) => Some(Bound::Buffer {
                id: buffer.id,
                n_bytes: slot.seen_bytes(buffer.n_bytes),
                is_written: slot == Slot::ReadWrite,
            }),
            (Self::View(view), _) => Some(Bound::View {
                id: view.id,
                shape: view.shape,
                is_whole: slot == Slot::ShadowMap,
            }),
            (Self::Sampler(_), _) => None,
            (Self::PerUse, _) => Some(Bound::Buffer {
                id: Meter::id(),
                n_bytes: slot.seen_bytes(0),
                is_written: false,
            }),
        }
    }
}

impl ResourceKey {
    fn binding<'a>(&'a self, slot: Slot, uniforms: &'a Uniforms) -> wgpu::BindingResource<'a> {
        match (self, slot) {
            (Self::Buffer(buffer), _) => buffer.as_entire_binding(),
            (Self::View(view), _) => wgpu::BindingResource::TextureView(view),
            (Self::Sampler(sampler), _) => wgpu::BindingResource::Sampler(sampler),
            (Self::PerUse, Slot::PerUse(n_bytes)) => uniforms.binding(n_bytes),
            // The device refuses it and names the binding.
            (Self::PerUse, _) => uniforms.binding(0),
        }
    }
}

impl<'a> From<&'a Buffer> for Resource<'a> {
    fn from(buffer: &'a Buffer) -> Self {
        Self::Buffer(buffer)
    }
}

impl<'a> From<&'a TextureView> for Resource<'a> {
    fn from(view: &'a TextureView) -> Self {
        Self::View(view)
    }
}

impl<'a> From<&'a Sampler> for Resource<'a> {
    fn from(sampler: &'a Sampler) -> Self {
        Self::Sampler(sampler)
    }
}

/// A resource as a cache key; it lives as long as the group that holds it.
#[derive(Clone, PartialEq, Eq, Hash)]
pub(super) enum ResourceKey {
    Buffer(wgpu::Buffer),
    View(wgpu::TextureView),
    Sampler(wgpu::Sampler),
    PerUse,
}

impl ResourceKey {
    /// Returns `None` for a resource that was only counted.
    pub(super) fn of(resource: &Resource<'_>) -> Option<Self> {
        Some(match *resource {
            Resource::Buffer(buffer) => Self::Buffer(buffer.raw.clone()?),
            Resource::View(view) => Self::View(view.raw.clone()?),
            Resource::Sampler(sampler) => Self::Sampler(sampler.0.clone()?),
            Resource::PerUse => Self::PerUse,
        })
    }
}

/// A group's slots, and the device's layout of them.
#[derive(Clone, Debug)]
pub(crate) struct Layout {
    pub(crate) slots: &'static [Slot],
    pub raw: wgpu::BindGroupLayout,
}

/// Cache key of a group: its slots and resources.
type GroupKey = (&'static [Slot], Vec<ResourceKey>);

/// Cached layouts by slots, and groups by slots and resources: each is created once.
#[derive(Default)]
pub(crate) struct BindingCache {
    layouts: Mutex<HashMap<&'static [Slot], Layout>>,
    groups: Mutex<HashMap<GroupKey, wgpu::BindGroup>>,
}

impl BindingCache {
    /// The layout of a group.
    pub(crate) fn layout(&self, device: &Device, slots: &'static [Slot]) -> Layout {
        let mut layouts = locked(&self.layouts);
        let layout = layouts.entry(slots).or_insert_with(|| {
            let entries: Vec<_> = (0..)
                .zip(slots)
                .map(|(binding, slot)| slot.layout_entry(binding))
                .collect();
            Layout {
                slots,
                raw: device.bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                    label: None,
                    entries: &entries,
                }),
            }
        });
        layout.clone()
    }

    /// The group of `resources`, in the order of the layout's slots, from the cache if it is there;
    /// `None` if a resource is on no device. A group with a texture that the core does not own
    /// lives no longer than its use.
    pub(crate) fn group(
        &self,
        device: &Device,
        uniforms: &Uniforms,
        layout: &Layout,
        resources: &[Resource<'_>],
    ) -> Option<wgpu::BindGroup> {
        let held: Vec<ResourceKey> = resources.iter().map(ResourceKey::of).collect::<Option<_>>()?;
        if !resources.iter().all(Resource::is_own) {
            return Some(make_group(device, uniforms, layout, &held));
        }
        let key = (layout.slots, held);
        let mut groups = locked(&self.groups);
        if let Some(group) = groups.get(&key) {
            return Some(group.clone());
        }
        let group = make_group(device, uniforms, layout, &key.1);
        groups.insert(key, group.clone());
        Some(group)
    }

    /// Drops everything, to be created anew.
    pub(crate) fn clear(&self) {
        locked(&self.layouts).clear();
        self.release_groups();
    }

    /// Drops all groups, and with them the resources that nothing else holds: for textures replaced
    /// by larger ones.
    pub(crate) fn release_groups(&self) {
        locked(&self.groups).clear();
    }
}

/// A group of the held resources, in the order of the layout's slots.
fn make_group(
    device: &Device,
    uniforms: &Uniforms,
    layout: &Layout,
    held: &[ResourceKey],
) -> wgpu::BindGroup {
    let entries: Vec<_> = (0..)
        .zip(layout.slots.iter().zip(held))
        .map(|(binding, (slot, resource))| wgpu::BindGroupEntry {
            binding,
            resource: resource.binding(*slot, uniforms),
        })
        .collect();
    device.bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &layout.raw,
        entries: &entries,
    })
}

/// The content of a mutex; a thread that panicked leaves a cache intact.
pub(super) fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
