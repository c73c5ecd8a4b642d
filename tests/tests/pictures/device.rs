//! The work that a device gets for a frame, by the device's own trace rather than by the core's
//! report: the passes are those of the report, and no object is created if only pose, picture or
//! view are new.

use std::collections::BTreeMap;
use std::thread;

use app_core::Core;
use app_core::camera_frame::CameraImage;
use app_core::frame::{FrameInput, FrameReport};
use app_core::preset::Preset;
use app_core::scene::{Camera, Image, Pose};
use app_core::self_test;
use app_core::session::Session;
use app_core::wgpu;
use app_pipeline::core::inspect::Inspect;
use app_pipeline::plan::Change;
use glam::{DMat4, DVec3};
use harness::bundled_session;
use measure::planar::{BT601_FULL, planar};

use crate::trace::Traced;

/// Runs a pass and creates a buffer, neither of which is in a report.
fn plant(traced: &Traced) {
    let _ = traced.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: 4,
        usage: wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = traced
        .device
        .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
        label: Some("planted"),
        timestamp_writes: None,
    });
    traced.queue.submit([encoder.finish()]);
}

/// Number of objects that the core reports as created.
fn n_counted(core: &Core) -> u64 {
    core.n_created().iter().map(|(_, n)| n).sum()
}

/// The passes of a report in the form of a trace.
fn reported(report: &FrameReport) -> BTreeMap<&str, u32> {
    let mut passes = BTreeMap::new();
    for run in &report.ran {
        *passes.entry(run.pass).or_default() += run.n_runs;
    }
    passes
}

/// A picture as a phone delivers it.
fn as_planes(image: &Image) -> CameraImage {
    planar(image, BT601_FULL).unwrap().into()
}

fn later(input: &FrameInput) -> FrameInput {
    let Pose::Clip { clip, time_secs } = input.shown_pose else {
        panic!("the session shows a clip");
    };
    input.clone().with_shown_pose(Pose::Clip {
        clip,
        time_secs: time_secs + 0.1,
    })
}

fn photographed_again(input: &FrameInput) -> FrameInput {
    input.clone().with_image(as_planes(input.image.rgba()))
}

fn from_nearby(input: &FrameInput) -> FrameInput {
    input.clone().with_camera(Camera {
        world_from_camera: input.camera.world_from_camera
            * DMat4::from_translation(DVec3::new(0.0, 0.0, -0.02)),
        ..input.camera
    })
}

fn from_beside(input: &FrameInput) -> FrameInput {
    input.clone().with_camera(Camera {
        world_from_camera: DMat4::from_translation(DVec3::new(0.002, 0.0, 0.001))
            * input.camera.world_from_camera,
        ..input.camera
    })
}

/// The frames that each change a single thing, and that change.
fn steady_frames(first: &FrameInput) -> [(Change, FrameInput); 4] {
    let pose = later(first);
    let picture = photographed_again(&later(&pose));
    // The region grows when the camera comes nearer, and then keeps its size for a while.
    let growing = from_nearby(&picture);
    let view = from_beside(&growing);
    [
        (Change::Pose, pose),
        (Change::Picture, picture),
        (Change::Scene, growing),
        (Change::View, view),
    ]
}

#[test]
fn a_steady_frame_makes_nothing_and_is_what_its_report_says() {
    let session = bundled_session();
    let mut first = FrameInput::from(&session.frame(0).unwrap());
    first.image = as_planes(first.image.rgba());
    let mut traced = Traced::new("steady");
    // The other presets run a part of the passes of these.
    for preset in [Preset::Paper, Preset::Best] {
        traced.core.set_scene(session.scene().clone(), preset).unwrap();
        let (report, given) = traced.frame(&first);
        assert_eq!(given.runs(), reported(&report), "{preset}");
        let compiled = ["Pipeline", "Shader"].map(|what| given.n_created(what));
        assert_eq!(compiled, [0, 0], "{preset}: the first frame compiles");
        for (change, input) in steady_frames(&first) {
            let before = n_counted(&traced.core);
            let (report, given) = traced.frame(&input);
            let what = format!("{preset}, {change:?}");
            assert_eq!(given.runs(), reported(&report), "{what}");
            assert_eq!(
                given.n_created(""),
                n_counted(&traced.core) - before,
                "{what}: objects past the count"
            );
            if change < Change::Scene {
                assert_eq!(given.created, BTreeMap::new(), "{what}");
            }
        }
    }
}

#[test]
fn a_warm_up_on_another_thread_leaves_nothing_to_compile() {
    let session = bundled_session();
    let mut traced = Traced::new("warm");
    let warm_up = traced.core.warm_up(Preset::Balanced);
    let n_passes = warm_up.len();
    let compiled = thread::spawn(move || warm_up.collect::<Result<Vec<_>, _>>());
    let compiled = compiled.join().unwrap().unwrap();
    assert_eq!(compiled.len(), n_passes);
    assert!(traced.given().n_created("Pipeline") >= n_passes as u64);
    self_test::run(&mut traced.core, Preset::Balanced).unwrap();
    assert_eq!(traced.given().n_created("Pipeline"), 0, "the self-test compiles");
    traced
        .core
        .set_scene(session.scene().clone(), Preset::Balanced)
        .unwrap();
    let mut first = FrameInput::from(&session.frame(0).unwrap());
    let pixels = first.image.rgba().clone();
    // A phone delivers planes: the pipelines for pixels are compiled when the first ones come.
    first.image = as_planes(&pixels);
    traced.core.frame(&first).unwrap();
    assert_eq!(traced.given().n_created("Pipeline"), 0);
    first.image = CameraImage::Rgba(pixels);
    traced.core.frame(&first).unwrap();
    assert!(traced.given().n_created("Pipeline") > 0);
}

/// Work that the core neither counts nor reports is detected.
#[test]
fn a_planted_pass_and_a_planted_buffer_are_found() {
    let session = bundled_session();
    let mut traced = Traced::new("planted");
    traced
        .core
        .set_scene(session.scene().clone(), Preset::Balanced)
        .unwrap();
    let first = FrameInput::from(&session.frame(0).unwrap());
    traced.frame(&first);
    let report = traced.core.frame(&first).unwrap();
    plant(&traced);
    let given = traced.given();
    let mut expected = reported(&report);
    expected.insert("planted", 1);
    assert_eq!(given.runs(), expected);
    assert_eq!(given.n_created(""), 1);
}
