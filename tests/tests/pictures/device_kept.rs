//! The driver's compiled pipelines are exported, and accepted by the next device.

use app_core::preset::Preset;
use app_core::{Core, wgpu};

/// Compiles a preset on a new device with an earlier one's data. Returns the new data, or the
/// reason why the old ones were refused; `None` if the driver exports none.
fn compiled(data: Option<&[u8]>) -> Option<Result<Vec<u8>, String>> {
    let core: Core = harness::open_core();
    core.pipelines_key()?;
    let device = core.device()?;
    let descriptor = wgpu::PipelineCacheDescriptor {
        label: None,
        data,
        fallback: false,
    };
    let scope = device.raw().push_error_scope(wgpu::ErrorFilter::Validation);
    // SAFETY: the data are `None`, or were exported by a device of the same driver; wgpu checks
    // their header before the driver does.
    let cache = unsafe { device.raw().create_pipeline_cache(&descriptor) };
    if let Some(refused) = pollster::block_on(scope.pop()) {
        return Some(Err(refused.to_string()));
    }
    core.set_pipeline_cache(cache);
    for step in core.warm_up(Preset::Fast) {
        step.expect("a pass");
    }
    core.pipeline_data().map(Ok)
}

#[test]
fn compiled_pipelines_are_handed_from_device_to_device_and_nothing_else_is() {
    let Some(first) = compiled(None) else {
        eprintln!("not tested here: this driver hands out no pipelines");
        return;
    };
    let first = first.expect("an empty cache");
    let again = compiled(Some(&first))
        .expect("the same driver")
        .expect("what it has handed out");
    assert_eq!(again.len(), first.len(), "what was known is not kept once more");
    let mut of_another = first;
    // In the header, which names wgpu's version, the device and its driver.
    of_another[12] ^= 0xff;
    let refused = compiled(Some(&of_another)).expect("the same driver");
    assert!(refused.is_err(), "{refused:?}");
    assert!(
        harness::open_core().pipeline_data().is_none(),
        "nobody asked for it"
    );
}
