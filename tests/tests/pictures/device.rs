//! What a device is given for a frame, by the device's own trace rather than by what the core says of itself: the passes
//! that the report names, and no new object where only pose, picture or view are new.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::thread;

use app_core::Core;
use app_core::camera_frame::CameraImage;
use app_core::frame::{FrameInput, FrameReport};
use app_core::preset::Preset;
use app_core::scene::{Camera, Image, Pose};
use app_core::self_test;
use app_core::session::{Capture, Session};
use app_core::wgpu::{self, Instance, InstanceDescriptor};
use app_pipeline::core::inspect::Inspect;
use app_pipeline::gpu::context::phone_limits;
use app_pipeline::plan::Change;
use desk::files::{BUNDLED_SESSION, Folder};
use glam::{DMat4, DVec3};
use measure::planar::{BT601_FULL, planar};

/// A core on a device that writes down what it is given.
struct Traced {
    core: Core,
    device: wgpu::Device,
    queue: wgpu::Queue,
    trace: PathBuf,
    /// What was read of the trace.
    n_read: usize,
}

/// What a device was given.
#[derive(Debug, Default)]
struct Given {
    /// How often each pass ran, by its label.
    passes: BTreeMap<String, u32>,
    /// How often each action that makes an object.
    created: BTreeMap<String, u64>,
}

impl Given {
    /// Objects of which the action that makes them has `what` in its name.
    fn n_created(&self, what: &str) -> u64 {
        let of_kind = self.created.iter().filter(|(action, _)| action.contains(what));
        of_kind.map(|(_, n)| n).sum()
    }
}

impl Traced {
    fn new(name: &str) -> Self {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        // What an earlier run left.
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).unwrap();
        let instance = Instance::new(InstanceDescriptor::new_without_display_handle());
        let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()));
        let opened = pollster::block_on(adapter.unwrap().request_device(&wgpu::DeviceDescriptor {
            required_limits: phone_limits(),
            trace: wgpu::Trace::Directory(folder.clone()),
            ..Default::default()
        }));
        let (device, queue) = opened.unwrap();
        Self {
            core: Core::on_device(device.clone(), queue.clone()).unwrap(),
            device,
            queue,
            trace: folder.join("trace.ron"),
            n_read: 0,
        }
    }

    /// What the device was given since the last look.
    fn given(&mut self) -> Given {
        let text = fs::read_to_string(&self.trace).unwrap();
        let new = given(&text[self.n_read..]);
        self.n_read = text.len();
        new
    }

    /// Runs a pass and makes a buffer that no report tells of.
    fn plant(&self) {
        let _ = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: 4,
            usage: wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut encoder = self
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("planted"),
            timestamp_writes: None,
        });
        self.queue.submit([encoder.finish()]);
    }

    fn frame(&mut self, input: &FrameInput) -> (FrameReport, Given) {
        self.given();
        let report = self.core.frame(input).unwrap();
        (report, self.given())
    }
}

/// Reads a part of a trace: each action begins at the start of a line, each pass's label follows `pass: (`.
fn given(trace: &str) -> Given {
    let mut given = Given::default();
    let mut lines = trace.lines();
    while let Some(line) = lines.next() {
        let action = line.split('(').next().unwrap_or_default();
        if action.starts_with("Create") {
            *given.created.entry(action.to_owned()).or_default() += 1;
        }
        if line.trim() == "pass: (" {
            let label = lines.next().and_then(|line| line.split('"').nth(1)).unwrap();
            *given.passes.entry(label.to_owned()).or_default() += 1;
        }
    }
    given
}

/// Objects that the core says it made.
fn n_counted(core: &Core) -> u64 {
    core.n_created().iter().map(|(_, n)| n).sum()
}

/// The passes of a report as a trace has them.
fn reported(report: &FrameReport) -> BTreeMap<String, u32> {
    let mut passes = BTreeMap::new();
    for run in &report.ran {
        *passes.entry(run.pass.to_owned()).or_default() += run.n_runs;
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

fn session() -> Capture {
    Capture::open(Folder::open(BUNDLED_SESSION).unwrap()).unwrap()
}

/// The frames after which nothing but one thing changes, and what that is.
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
    let session = session();
    let mut first = FrameInput::from(&session.frame(0).unwrap());
    first.image = as_planes(first.image.rgba());
    let mut traced = Traced::new("steady");
    // The others run a part of what these run.
    for preset in [Preset::Paper, Preset::Best] {
        traced.core.set_scene(session.scene().clone(), preset).unwrap();
        let (report, given) = traced.frame(&first);
        assert_eq!(given.passes, reported(&report), "{preset}");
        let compiled = ["Pipeline", "Shader"].map(|what| given.n_created(what));
        assert_eq!(compiled, [0, 0], "{preset}: the first frame compiles");
        for (change, input) in steady_frames(&first) {
            let before = n_counted(&traced.core);
            let (report, given) = traced.frame(&input);
            let what = format!("{preset}, {change:?}");
            assert_eq!(given.passes, reported(&report), "{what}");
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
    let session = session();
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
    // As a phone delivers it: of pixels the pipelines are compiled when the first come.
    first.image = as_planes(&pixels);
    traced.core.frame(&first).unwrap();
    assert_eq!(traced.given().n_created("Pipeline"), 0);
    first.image = CameraImage::Rgba(pixels);
    traced.core.frame(&first).unwrap();
    assert!(traced.given().n_created("Pipeline") > 0);
}

/// What a core does past its count and its report is found.
#[test]
fn a_planted_pass_and_a_planted_buffer_are_found() {
    let session = session();
    let mut traced = Traced::new("planted");
    traced
        .core
        .set_scene(session.scene().clone(), Preset::Balanced)
        .unwrap();
    let first = FrameInput::from(&session.frame(0).unwrap());
    traced.frame(&first);
    let report = traced.core.frame(&first).unwrap();
    traced.plant();
    let given = traced.given();
    let mut expected = reported(&report);
    expected.insert("planted".to_owned(), 1);
    assert_eq!(given.passes, expected);
    assert_eq!(given.n_created(""), 1);
}
