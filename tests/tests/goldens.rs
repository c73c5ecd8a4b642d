//! What each preset makes of the bundled session, against the golden pictures.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

use app_core::core::Core;
use app_core::gpu::AdapterChoice;
use app_core::preset::Preset;
use app_core::wgpu;
use harness::golden::{Goldens, ON_HARDWARE, ON_SOFTWARE, SOFTWARE_ADAPTER, name_of, render};

/// The fastest adapter, and the software one besides where both are there. No adapter at all is a failure.
fn cores() -> Vec<Core> {
    let instance = wgpu::Instance::default();
    let open = |choice: &AdapterChoice| pollster::block_on(Core::headless(&instance, choice));
    let mut cores = vec![open(&AdapterChoice::Fastest).unwrap()];
    if !cores[0].gpu().is_software() {
        cores.extend(open(&AdapterChoice::Named(SOFTWARE_ADAPTER.to_owned())));
    }
    cores
}

#[test]
fn every_preset_makes_its_golden() {
    let mut failures = Vec::new();
    for mut core in cores() {
        let checks = if core.gpu().is_software() {
            ON_SOFTWARE
        } else {
            ON_HARDWARE
        };
        for &preset in Preset::ALL {
            let name = name_of(preset);
            let picture = render(&mut core, preset).unwrap();
            let on = core.gpu().adapter_name();
            match Goldens::of_project().check(&name, &picture, checks) {
                Ok(difference) => println!(
                    "{name} on {on}: largest difference {}, {:.5} % above 0, {:.5} % above 2",
                    difference.max_abs,
                    100.0 * difference.share_above(0.0),
                    100.0 * difference.share_above(2.0)
                ),
                Err(error) => failures.push(format!("on {on}: {error}")),
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}
