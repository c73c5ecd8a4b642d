//! What a driver has compiled is handed out, and taken back by the next device.

use app_core::preset::Preset;
use app_core::{Core, wgpu};

/// Compiles a preset on a device of its own, with what an earlier one has kept; what is kept then.
fn compiled(data: Option<&[u8]>) -> Option<Vec<u8>> {
    let core: Core = harness::open_core();
    core.pipelines_key()?;
    let device = core.device()?;
    let descriptor = wgpu::PipelineCacheDescriptor {
        label: None,
        data,
        fallback: true,
    };
    // SAFETY: the data are none, or what a device of the same driver has handed out.
    core.set_pipeline_cache(unsafe { device.raw().create_pipeline_cache(&descriptor) });
    for step in core.warm_up(Preset::Fast) {
        step.expect("a pass");
    }
    core.pipeline_data()
}

#[test]
fn compiled_pipelines_are_handed_from_device_to_device() {
    let Some(first) = compiled(None) else {
        eprintln!("not tested here: this driver hands out no pipelines");
        return;
    };
    assert!(first.len() > 100, "{} bytes", first.len());
    let again = compiled(Some(&first)).expect("a driver that has handed some out");
    // What was known is not compiled, and kept, once more.
    assert!(
        again.len() < first.len() + first.len() / 10,
        "{} bytes became {}",
        first.len(),
        again.len()
    );
    assert!(
        harness::open_core().pipeline_data().is_none(),
        "nobody asked for it"
    );
}
