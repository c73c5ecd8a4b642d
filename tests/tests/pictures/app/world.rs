//! A small world for the app: a table with a grid on it, and a toy of boxes.

use std::sync::{Arc, OnceLock};

use app_core::alignment::NoLight;
use app_core::alignment::{Alignment, PoseAlignment, PoseDeviation};
use app_core::app::{App, GraphicsState, Permission, Recorded, ShellCommand, ShellEvent, UserAction};
use app_core::camera_frame::{CameraFrame, Display, FoundPlane, Stamp, Tracking};
use app_core::frame::FrameInput;
use app_core::interface::{Insets, Screen};
use app_core::recording::RecordingJob;
use app_core::scene::{Image, Intrinsics};
use app_core::toy::Toy;
use glam::{DMat4, DVec2, DVec3};
use measure::photographer::{ToyFile, World, toy_glb};

pub(crate) const SIZE_PX: [u32; 2] = [64, 48];

/// The toy, read once.
pub(crate) fn toy() -> Arc<Toy> {
    static TOY: OnceLock<Arc<Toy>> = OnceLock::new();
    let read = || Arc::new(Toy::from_glb("toy.glb", &toy_file()).unwrap());
    Arc::clone(TOY.get_or_init(read))
}

pub(crate) fn toy_file() -> Vec<u8> {
    toy_glb(&World::boxes(), &ToyFile::default())
}

pub(crate) fn app() -> App {
    App::new(toy())
}

/// An uncovered screen, with one pixel per point.
pub(crate) const fn screen(width_px: u32, height_px: u32) -> Screen {
    Screen {
        size_px: [width_px, height_px],
        pixels_per_point: 1.0,
        insets: Insets {
            left_px: 0.0,
            top_px: 0.0,
            right_px: 0.0,
            bottom_px: 0.0,
        },
        text_scale: 1.0,
    }
}

/// The events until a camera searches for a table.
pub(crate) fn opening() -> [ShellEvent; 4] {
    [
        ShellEvent::Foreground(true),
        ShellEvent::Graphics(GraphicsState::Ready),
        ShellEvent::Permission(Permission::Granted),
        ShellEvent::User(UserAction::Begin),
    ]
}

/// The commands of an app that begins with [`opening`].
pub(crate) fn begun(app: &mut App) -> Vec<ShellCommand> {
    opening().into_iter().flat_map(|event| app.event(event)).collect()
}

/// An app whose ghost stands on the table, without a plate.
pub(crate) fn at_ghost() -> App {
    let mut app = app();
    let placing = [
        ShellEvent::Frame(Box::new(frame(1, 0, 0, Tracking::Normal))),
        ShellEvent::User(UserAction::Tap(DVec2::new(32.0, 24.0))),
        ShellEvent::User(UserAction::SkipPlate),
        ShellEvent::Frame(Box::new(frame(2, 33_000_000, 0, Tracking::Normal))),
    ];
    for event in opening().into_iter().chain(placing) {
        let _ = app.event(event);
    }
    app
}

/// A frame of a camera half a metre above the table, looking down at it.
pub(crate) fn frame(id: u64, time_ns: i64, world_epoch: u32, tracking: Tracking) -> CameraFrame {
    let eye = DVec3::new(0.0, 0.4, 0.3);
    let back = eye.normalize();
    let right = DVec3::Y.cross(back).normalize();
    let [x, y, z, w] =
        [(right, 0.0), (back.cross(right), 0.0), (back, 0.0), (eye, 1.0)].map(|(axis, w)| axis.extend(w));
    let world_from_camera = DMat4::from_cols(x, y, z, w);
    let [width_px, height_px] = SIZE_PX;
    let checks = (0..width_px * height_px).flat_map(|i| {
        let code = if (i % width_px / 4 + i / width_px / 4) % 2 == 0 {
            90
        } else {
            170
        };
        [code, code, code, 255]
    });
    let image = Image {
        width_px,
        height_px,
        rgba8: checks.collect(),
    };
    CameraFrame {
        stamp: Stamp {
            id,
            time_ns,
            world_epoch,
        },
        age_ms: None,
        image: image.into(),
        intrinsics: Intrinsics {
            fx_px: 60.0,
            fy_px: 60.0,
            cx_px: 32.0,
            cy_px: 24.0,
        },
        exposure: None,
        tracking,
        world_from_camera: (tracking == Tracking::Normal).then_some(world_from_camera),
        planes: Arc::new([FoundPlane {
            id: 7,
            world_from_plane: DMat4::IDENTITY,
            half_extent_m: DVec2::splat(0.5),
        }]),
        anchors: Arc::new([]),
        world_from_card: (tracking == Tracking::Normal).then_some(DMat4::IDENTITY),
        light_estimate: None,
        people: None,
        depth: None,
        display: Display::default(),
    }
}

/// A recording that failed for lack of space.
pub(crate) fn full(job: RecordingJob) -> Recorded {
    Recorded {
        file: "full.mcap".to_owned(),
        outcome: job.without_file(&std::io::ErrorKind::StorageFull.into()),
    }
}

/// The alignment of a correct input, with this distance between the toy's outline and the
/// picture's.
pub(crate) fn alignment(input: &FrameInput, outline_px: Option<f64>) -> Alignment {
    let pose = outline_px.map(|outline_px| PoseAlignment {
        is_applied: false,
        is_held: false,
        moved_m: 0.0,
        turned_rad: 0.0,
        given_outline_px: outline_px,
        outline_px,
        deviation: PoseDeviation {
            lateral_m: 1e-5,
            depth_m: 1e-4,
            rotation_rad: 1e-3,
        },
        size_ratio: 1.0,
        model_px: 0.0,
        is_of_model: true,
        texture_correlation: None,
        spread_px: 0.0,
        stand: None,
    });
    let mut alignment = Alignment::new(input);
    alignment.report.pose = pose;
    alignment.report.no_light = Some(NoLight::PoseUnknown);
    alignment
}
