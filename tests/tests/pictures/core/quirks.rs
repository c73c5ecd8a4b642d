//! Drivers with known faults are recognised by the properties of their adapters.

use app_core::CoreError;
use app_core::app::Language;
use app_core::gpu::{GpuError, fault_on_surfaces};
use app_core::interface::of_no_graphics;
use app_core::wgpu::{AdapterInfo, Backend, DeviceType};

const IMAGINATION: u32 = 0x1010;
const ARM: u32 = 0x13b5;

fn fault(name: &str, vendor: u32, backend: Backend) -> Option<&'static str> {
    fault_on_surfaces(&AdapterInfo {
        name: name.to_owned(),
        vendor,
        ..AdapterInfo::new(DeviceType::IntegratedGpu, backend)
    })
}

#[test]
fn a_known_fault_is_that_of_one_driver_alone() {
    let name = "PowerVR B-Series BXM-8-256";
    assert!(fault(name, IMAGINATION, Backend::Vulkan).is_some());
    assert_eq!(fault(name, IMAGINATION, Backend::Gl), None);
    assert_eq!(fault(name, ARM, Backend::Vulkan), None);
    assert_eq!(
        fault("PowerVR D-Series DXT-48-1536", IMAGINATION, Backend::Vulkan),
        None
    );
}

#[test]
fn the_person_hears_why_nothing_is_drawn() {
    let (adapter, fault) = ("one".to_owned(), "it fails");
    let known = CoreError::Gpu(GpuError::KnownFault { adapter, fault });
    assert!(known.to_string().contains("one is not used: it fails"), "{known}");
    assert!(of_no_graphics(&known, Language::English).contains("known fault"));
    let reason = "no Vulkan".to_owned();
    let none = CoreError::Gpu(GpuError::NoAdapter { reason });
    assert!(of_no_graphics(&none, Language::English).contains("Vulkan 1.1"));
}
