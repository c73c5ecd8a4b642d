//! Drivers with faults that the core cannot work around.
//!
//! Only faults that reach what the core does have an entry. Known ones that do not: stale samples after storage writes to a texture
//! (Adreno 830; there is no storage texture here), arrays of bindings (Mali; there are none), reads out of a workgroup's arrays
//! (Mali; wgpu's bounds checks stay on). Wrong pictures of unknown cause (Adreno 725 and 740, wgpu issue 6340) are for the self-test
//! to find. Entries go when a driver is known to be mended.

use wgpu::{AdapterInfo, Backend};

/// A driver by what it tells of itself, and its fault.
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
    // Of the Pixel 10; other names of this maker's were not reported.
    name: "DXT-48",
    backend: Backend::Vulkan,
    fault: "its driver ends the program in vkCreatePipelineCache (godot issue 115171, open since January 2026)",
}];

/// On a surface alone: pictures that are not shown come out right with these.
const ON_SURFACES: [Quirk; 1] = [Quirk {
    vendor: IMAGINATION,
    name: "BXM-8-256",
    backend: Backend::Vulkan,
    fault: "its driver ends the program with the first picture on a screen (wgpu issue 7669, open since May 2025)",
}];

/// Why a driver is not asked to keep pipelines; none where it may be.
#[must_use]
pub fn fault_of_pipeline_caches(info: &AdapterInfo) -> Option<&'static str> {
    fault_in(&OF_PIPELINE_CACHES, info)
}

/// Why a driver is not to draw on a surface; none where it may.
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
