//! Drivers with faults that the core cannot work around.
//!
//! Only faults that affect the core have an entry. Known faults that do not: stale samples after
//! storage writes to a texture (Adreno 830; the core uses no storage texture), arrays of bindings
//! (Mali; there are none), out-of-bounds reads of a workgroup's arrays (Mali; wgpu's bounds checks
//! stay on). Wrong pictures of unknown cause (Adreno 725 and 740, wgpu issue 6340) are left to the
//! self-test. An entry is removed when a driver is known to be fixed.

use wgpu::{AdapterInfo, Backend};

/// A driver, by its adapter's properties, and its fault.
struct Quirk {
    /// PCI vendor.
    vendor: u32,
    /// Part of the adapter's name.
    name: &'static str,
    backend: Backend,
    fault: &'static str,
}

/// PCI vendor of Imagination Technologies.
const IMAGINATION: u32 = 0x1010;

/// Caches of compiled pipelines.
const OF_PIPELINE_CACHES: [Quirk; 1] = [Quirk {
    vendor: IMAGINATION,
    // Adapter of the Pixel 10; no fault of the vendor's other adapters was reported.
    name: "DXT-48",
    backend: Backend::Vulkan,
    fault: "its driver ends the program in vkCreatePipelineCache (godot issue 115171, open since January 2026)",
}];

/// Faults on a surface alone: off-screen pictures are correct with these drivers.
const ON_SURFACES: [Quirk; 1] = [Quirk {
    vendor: IMAGINATION,
    name: "BXM-8-256",
    backend: Backend::Vulkan,
    fault: "its driver ends the program with the first picture on a screen (wgpu issue 7669, open since May 2025)",
}];

/// The reason not to use a driver's pipeline cache; `None` if it may be used.
#[must_use]
pub fn fault_of_pipeline_caches(info: &AdapterInfo) -> Option<&'static str> {
    fault_in(&OF_PIPELINE_CACHES, info)
}

/// The reason not to draw on a surface with a driver; `None` if it may draw.
#[must_use]
pub fn fault_on_surfaces(info: &AdapterInfo) -> Option<&'static str> {
    fault_in(&ON_SURFACES, info)
}

fn fault_in(quirks: &[Quirk], info: &AdapterInfo) -> Option<&'static str> {
    let is_meant = |quirk: &&Quirk| {
        info.vendor == quirk.vendor && info.backend == quirk.backend && info.name.contains(quirk.name)
    };
    quirks.iter().find(is_meant).map(|quirk| quirk.fault)
}
