//! The pipeline on a device that the program opened itself, like an engine that draws more than
//! this picture.
//!
//! `cargo run -p app-core --features fs --example own_device`

use std::error::Error;

use app_core::camera_frame::Display;
use app_core::frame::FrameInput;
use app_core::preset::Preset;
use app_core::session::{Capture, Folder, Session};
use app_core::{Core, gpu, wgpu};

/// The project's session: a jointed wooden llama on a table, under one bulb.
const SESSION: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/sessions/llama");

pub(crate) fn main() -> Result<(), Box<dyn Error>> {
    // Every device with the limits of a phone is suitable. It may have higher limits, and any
    // features.
    let instance = wgpu::Instance::default();
    let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()))?;
    let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
        required_limits: gpu::phone_limits(),
        ..wgpu::DeviceDescriptor::default()
    }))?;
    // Device and queue are handles: the program keeps its own.
    let mut core = Core::on_device(device.clone(), queue.clone())?;

    let session = Capture::open(Folder::open(SESSION)?)?;
    core.set_scene(session.scene().clone(), Preset::Balanced)?;
    let input = FrameInput::from(&session.frame(0)?);
    core.frame(&input)?;

    // The picture can stay on the device: as a texture of the core's, to be bound or copied from
    // ...
    let picture = core.picture()?;
    println!("{} x {} px", picture.width(), picture.height());

    // ... or drawn on a texture of the program's own, of any size and in the display's rotation.
    let screen = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("own screen"),
        size: wgpu::Extent3d {
            width: 360,
            height: 640,
            depth_or_array_layers: 1,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8Unorm,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    core.draw_on(&screen, Display::default())?;
    // The program's own work on the same queue runs after it.
    queue.submit([]);

    // The picture that is read back is not the photograph: the llama looks in another direction.
    let made = core.read_picture()?;
    let photograph = input.image.rgba();
    assert_ne!(made.rgba8, photograph.rgba8);
    let n_changed = made.rgba8.chunks(4).zip(photograph.rgba8.chunks(4));
    let n_changed = n_changed
        .filter(|(made, photographed)| made != photographed)
        .count();
    println!("{n_changed} pixels differ from the photograph");
    Ok(())
}
