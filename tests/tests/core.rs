//! What a shell may do to the core: pictures that do not fit, poses without a clip, frames that pass through in between.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::sync::Arc;

use app_core::frame::{FrameInput, Path};
use app_core::gpu::AdapterChoice;
use app_core::preset::Preset;
use app_core::scene::{Image, Light, Pose, Scene};
use app_core::session::{Capture, Session};
use app_core::wgpu::{Instance, InstanceDescriptor};
use app_core::{Core, CoreError};
use glam::{DMat4, DVec3};
use harness::files::Folder;

const BUNDLED: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/sessions/llama");

fn core() -> Core {
    let instance = Instance::new(InstanceDescriptor::new_without_display_handle());
    pollster::block_on(Core::headless(&instance, &AdapterChoice::Fastest)).unwrap()
}

fn session() -> Capture {
    Capture::open(Folder::open(BUNDLED).unwrap()).unwrap()
}

fn picture_of(core: &mut Core, input: &FrameInput) -> Vec<u8> {
    core.frame(input).unwrap();
    core.read_picture().unwrap().rgba8
}

#[test]
fn pictures_that_do_not_fit_are_refused() {
    let (session, mut core) = (session(), core());
    let input = FrameInput::from(&session.frame(0).unwrap());
    assert!(matches!(core.frame(&input), Err(CoreError::NoScene)));

    let wide = Scene {
        width_px: 9000,
        height_px: 100,
        plates: Vec::new(),
        ..session.scene().clone()
    };
    let refused = core.set_scene(wide, Preset::Balanced);
    assert!(matches!(
        refused,
        Err(CoreError::SizeOutOfRange {
            size_px: [9000, 100],
            ..
        })
    ));

    core.set_scene(session.scene().clone(), Preset::Balanced).unwrap();
    let mut cut = input.image.as_ref().clone();
    cut.rgba8.pop();
    let refused = core.frame(&FrameInput {
        image: Arc::new(cut),
        ..input.clone()
    });
    assert!(matches!(
        refused,
        Err(CoreError::SizeDiffers {
            what: "camera frame",
            ..
        })
    ));
    assert!(core.frame(&input).unwrap().region.is_some());
}

/// What a tracker or an app may hand over by mistake is refused by name, and costs nothing that was learned.
#[test]
fn values_that_cannot_be_are_refused_by_name() {
    let (session, mut core) = (session(), core());
    let scene = session.scene().clone();
    let good = FrameInput::from(&session.frame(0).unwrap());
    let spoiled = |field: &str, spoil: &dyn Fn(&mut FrameInput)| {
        let mut input = good.clone();
        spoil(&mut input);
        (field.to_owned(), input)
    };
    let dark = Light::Sphere {
        position_in_world: DVec3::ONE,
        radius_m: -1.0,
    };
    let cases = [
        spoiled("camera.world_from_camera", &|input| {
            input.camera.world_from_camera.w_axis.x = f64::NAN;
        }),
        spoiled("camera.world_from_camera", &|input| {
            input.camera.world_from_camera *= DMat4::from_scale(DVec3::splat(2.0));
        }),
        spoiled("camera.intrinsics.fx_px", &|input| {
            input.camera.intrinsics.fx_px = 0.0
        }),
        spoiled("world_from_object", &|input| {
            input.world_from_object = DMat4::ZERO
        }),
        spoiled("exposure", &|input| input.exposure = f64::INFINITY),
        spoiled("lights[0].radius_m", &|input| input.lights = Some([dark].into())),
    ];
    core.set_scene(scene.clone(), Preset::Balanced).unwrap();
    let expected = picture_of(&mut core, &good);
    for (field, input) in cases {
        let refused = core.frame(&input).unwrap_err().to_string();
        assert!(refused.starts_with(&format!("{field}: ")), "{field}: {refused}");
    }
    let report = core.frame(&good).unwrap();
    assert!(report.ran.iter().all(|run| run.path == Path::Frame), "{report:?}");
    assert!(core.read_picture().unwrap().rgba8 == expected);

    let mut tilted = scene;
    tilted.receivers[0].world_from_plane.x_axis.y = 0.5;
    let refused = core.set_scene(tilted, Preset::Balanced).unwrap_err().to_string();
    assert!(
        refused.starts_with("receivers[0].world_from_plane: "),
        "{refused}"
    );
    assert!(core.frame(&good).is_ok(), "the scene before is gone");
}

#[test]
fn a_failed_pose_leaves_nothing_half_learned() {
    let (session, mut core) = (session(), core());
    let input = FrameInput::from(&session.frame(0).unwrap());
    core.set_scene(session.scene().clone(), Preset::Balanced).unwrap();
    let expected = picture_of(&mut core, &input);

    core.set_scene(session.scene().clone(), Preset::Balanced).unwrap();
    let shown_pose = Pose::Clip {
        clip: input.shown_pose.clip().unwrap(),
        time_secs: f64::NAN,
    };
    assert!(matches!(
        core.frame(&FrameInput {
            shown_pose,
            ..input.clone()
        }),
        Err(CoreError::Toy(_))
    ));
    assert!(picture_of(&mut core, &input) == expected);
}

#[test]
fn the_pose_as_authored_is_a_pose_like_any_other() {
    let (session, mut core) = (session(), core());
    let input = FrameInput::from(&session.frame(0).unwrap());
    let posed = Scene {
        physical_pose: input.shown_pose.clone(),
        ..session.scene().clone()
    };
    core.set_scene(posed, Preset::Balanced).unwrap();
    assert!(core.frame(&input).unwrap().region.is_none());
    assert!(
        core.frame(&FrameInput {
            shown_pose: Pose::Authored,
            ..input
        })
        .unwrap()
        .region
        .is_some()
    );
}

#[test]
fn the_toys_colours_are_those_of_the_latest_picture() {
    let (session, mut core) = (session(), core());
    let first = FrameInput::from(&session.frame(0).unwrap());
    let dimmed: Vec<u8> = first
        .image
        .rgba8
        .chunks_exact(4)
        .flat_map(|p| [p[0] / 2, p[1] / 2, p[2] / 2, 255])
        .collect();
    let image = Arc::new(Image {
        rgba8: dimmed,
        ..first.image.as_ref().clone()
    });
    let second = FrameInput {
        image,
        ..first.clone()
    };
    let at_rest = FrameInput {
        shown_pose: session.scene().physical_pose.clone(),
        ..second.clone()
    };

    core.set_scene(session.scene().clone(), Preset::Balanced).unwrap();
    core.frame(&first).unwrap();
    let expected = picture_of(&mut core, &second);

    core.set_scene(session.scene().clone(), Preset::Balanced).unwrap();
    core.frame(&first).unwrap();
    core.frame(&at_rest).unwrap();
    assert!(picture_of(&mut core, &second) == expected);
}
