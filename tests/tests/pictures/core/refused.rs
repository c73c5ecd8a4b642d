//! Wrong inputs from a shell: they are refused by name, and no estimate is lost.

use app_core::CoreError;
use app_core::camera_frame::CameraImage;
use app_core::frame::{FrameInput, PassGroup};
use app_core::preset::Preset;
use app_core::scene::{Image, Light, Pose};
use app_core::things::{Mark, Things};
use glam::{DMat4, DVec3, UVec2};
use measure::planar::{BT601_FULL, planar};

use crate::core::bundled::{core, first_input, picture_of, scene};

#[test]
fn pictures_that_do_not_fit_are_refused() {
    let mut core = core();
    let input = first_input();
    assert!(matches!(
        harness::open_core().frame(&input),
        Err(CoreError::NoScene)
    ));

    let wide = scene().with_size_px([9000, 100]).with_plates(Vec::new());
    let refused = core.set_scene(wide, Preset::Balanced);
    assert!(matches!(
        refused,
        Err(CoreError::SizeOutOfRange {
            size_px: [9000, 100],
            ..
        })
    ));

    let large = scene().with_size_px([8000, 2000]).with_plates(Vec::new());
    let refused = core.set_scene(large, Preset::Balanced).unwrap_err().to_string();
    assert!(
        refused.starts_with("width_px, height_px: 8000 x 2000 px are more than the 12582912"),
        "{refused}"
    );

    core.set_scene(scene(), Preset::Balanced).unwrap();
    let mut cut = input.image.rgba().as_ref().clone();
    cut.rgba8.pop();
    let refused = core.frame(&input.clone().with_image(cut));
    assert!(matches!(
        refused,
        Err(CoreError::SizeDiffers {
            what: "camera frame",
            ..
        })
    ));
    assert!(core.frame(&input).unwrap().region.is_some());
}

/// Wrong values from a tracker or an app are refused by name, without the loss of any estimate.
#[test]
fn values_that_cannot_be_are_refused_by_name() {
    let mut core = core();
    let scene = scene();
    let good = first_input();
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
    assert!(
        report.ran.iter().all(|run| run.path == PassGroup::Frame),
        "{report:?}"
    );
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
    let mut core = core();
    let input = first_input();
    core.set_scene(scene(), Preset::Balanced).unwrap();
    let expected = picture_of(&mut core, &input);

    core.set_scene(scene(), Preset::Balanced).unwrap();
    let shown_pose = Pose::Clip {
        clip: input.shown_pose.clip().unwrap(),
        time_secs: f64::NAN,
    };
    assert!(matches!(
        core.frame(&input.clone().with_shown_pose(shown_pose)),
        Err(CoreError::Toy(_))
    ));
    assert!(picture_of(&mut core, &input) == expected);
}

/// The camera picture of a refused frame is shown as it is, without the region of the frame before.
#[test]
fn a_refused_frame_shows_its_camera_picture() {
    let mut core = core();
    let input = first_input();
    core.set_scene(scene(), Preset::Balanced).unwrap();
    assert!(picture_of(&mut core, &input) != input.image.rgba().rgba8);
    let mut other = input.image.rgba().as_ref().clone();
    other.rgba8.chunks_exact_mut(4).for_each(|pixel| pixel[0] /= 2);
    let shown_pose = Pose::Clip {
        clip: input.shown_pose.clip().unwrap(),
        time_secs: f64::NAN,
    };
    let refused = input.with_image(other.clone()).with_shown_pose(shown_pose);
    assert!(matches!(core.frame(&refused), Err(CoreError::Toy(_))));
    assert!(core.read_picture().unwrap().rgba8 == other.rgba8);
}

/// Work that the device refuses does not darken the screen until the next frame: the camera picture
/// that it was about is there.
#[test]
fn work_that_the_device_refuses_shows_its_camera_picture() {
    let mut core = core();
    let input = first_input();
    let as_planes = |image: &Image| CameraImage::from(planar(image, BT601_FULL).unwrap());
    let image = input.image.rgba();
    let mut other = image.as_ref().clone();
    other.rgba8.chunks_exact_mut(4).for_each(|pixel| pixel[0] /= 2);
    let physical_pose = scene().physical_pose;
    core.set_scene(scene(), Preset::Balanced).unwrap();
    let later = input.clone().with_image(as_planes(&other));
    let expected = picture_of(&mut core, &later.clone().with_shown_pose(physical_pose));

    core.set_scene(scene(), Preset::Balanced).unwrap();
    picture_of(&mut core, &input.clone().with_image(as_planes(image)));
    // Wider than any texture.
    let marks = vec![Mark::Thing; 9000];
    let things = Things::new(UVec2::new(9000, 1), marks, input.camera).unwrap();
    let refused = core.frame(&later.clone().with_things(Some(things)));
    assert!(matches!(refused, Err(CoreError::Gpu(_))), "{refused:?}");
    assert!(core.read_picture().unwrap().rgba8 == expected);
    assert!(
        picture_of(&mut core, &later) != expected,
        "the next frame is made"
    );
}
