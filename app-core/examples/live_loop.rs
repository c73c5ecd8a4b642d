//! A loop over frames with poses of the program's own: the llama turns its head, and each pass is
//! timed.
//!
//! `cargo run -p app-core --features fs --example live_loop`

use std::error::Error;
use std::sync::Arc;

use app_core::frame::{FrameInput, PassGroup};
use app_core::glam::DQuat;
use app_core::gpu::AdapterChoice;
use app_core::preset::Preset;
use app_core::scene::Pose;
use app_core::session::{Capture, Folder, Session};
use app_core::toy::{NodePose, Toy, ToyError};
use app_core::{Core, wgpu};

/// Rotation of the head from frame to frame, in radians.
const STEP_RAD: f64 = 0.1;
const N_FRAMES: u32 = 4;

/// The project's session: a jointed wooden llama on a table, under one bulb.
const SESSION: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/sessions/llama");

pub(crate) fn main() -> Result<(), Box<dyn Error>> {
    let session = Capture::open(Folder::open(SESSION)?)?;
    let toy = &session.scene().toy;
    let instance = wgpu::Instance::default();
    let mut core = pollster::block_on(Core::headless(&instance, &AdapterChoice::Fastest))?;
    core.set_scene(session.scene().clone(), Preset::Balanced)?;
    // Times are measured on the device, if it supports that; without this request there is no cost.
    core.time_passes(true)?;

    // A camera that stands still: one picture for all frames. A live app supplies a new one with
    // each.
    let mut input = FrameInput::from(&session.frame(0)?);
    let mut before = None;
    for frame in 0..N_FRAMES {
        input.shown_pose = head_turned(toy, STEP_RAD * f64::from(frame))?;
        let report = core.frame(&input)?;

        println!("frame {frame}: {} passes", report.ran.len());
        for time in core.read_pass_times()? {
            println!("  {:7} {:16} {:8.3} ms", time.path.name(), time.pass, time.gpu_ms);
        }
        // The first frame estimates the place: lights, surfaces, the area behind the toy. Later
        // ones only draw.
        let learns = report.ran.iter().any(|run| run.path == PassGroup::Capture);
        assert_eq!(learns, frame == 0);

        // Readback waits for the device; an app shows the picture with `Core::present` or
        // `Core::draw_on`.
        let picture = core.read_picture()?;
        assert_ne!(before.as_ref(), Some(&picture));
        before = Some(picture);
    }
    Ok(())
}

/// The pose with the head turned about its own vertical axis: nodes without an entry stay as
/// authored.
fn head_turned(toy: &Toy, angle_rad: f64) -> Result<Pose, ToyError> {
    let head = toy.find_node("head")?;
    let mut nodes = NodePose::default();
    if let Some(mut transform) = toy.authored_transform(head)? {
        transform.rotation *= DQuat::from_rotation_y(angle_rad);
        nodes.parent_from_node.push((head, transform));
    }
    Ok(Pose::Nodes(Arc::new(nodes)))
}
