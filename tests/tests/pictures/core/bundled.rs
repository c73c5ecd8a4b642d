//! The bundled session at a quarter of its size, and one core for all tests, so that a device and
//! its pipelines are created once.

use std::sync::{Arc, LazyLock, Mutex, MutexGuard, PoisonError};

use app_core::Core;
use app_core::frame::FrameInput;
use app_core::scene::{Camera, Image, Intrinsics, Plate, Scene};
use app_core::session::Session;
use harness::{bundled_session, open_core};
use image::RgbaImage;
use image::imageops::{FilterType, resize};

/// Factor by which the session is larger.
pub(crate) const SHRINK: u32 = 4;

static CORE: LazyLock<Mutex<Core>> = LazyLock::new(|| Mutex::new(open_core()));

/// The core, for exclusive use by one test. State of an earlier test is dropped with that test's
/// scene.
pub(crate) fn core() -> MutexGuard<'static, Core> {
    CORE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The scene of the session.
pub(crate) fn scene() -> Scene {
    SMALL.0.clone()
}

/// Its first frame.
pub(crate) fn first_input() -> FrameInput {
    SMALL.1.clone()
}

/// Both in full size.
pub(crate) fn whole() -> (Scene, FrameInput) {
    let session = bundled_session();
    (
        session.scene().clone(),
        FrameInput::from(&session.frame(0).unwrap()),
    )
}

static SMALL: LazyLock<(Scene, FrameInput)> = LazyLock::new(|| {
    let (scene, input) = whole();
    let plates = scene.plates.iter().map(|plate| Plate {
        camera: small_camera(&plate.camera),
        image: small(&plate.image),
    });
    let plates = plates.collect();
    let size_px = [scene.width_px / SHRINK, scene.height_px / SHRINK];
    let small_scene = scene.with_size_px(size_px).with_plates(plates);
    let camera = small_camera(&input.camera);
    let image = small(input.image.rgba());
    let small_input = input.with_camera(camera).with_image(image);
    (small_scene, small_input)
});

fn small_camera(camera: &Camera) -> Camera {
    let (whole, scale) = (camera.intrinsics, f64::from(SHRINK).recip());
    Camera {
        intrinsics: Intrinsics {
            fx_px: scale * whole.fx_px,
            fy_px: scale * whole.fy_px,
            cx_px: scale * whole.cx_px,
            cy_px: scale * whole.cy_px,
        },
        ..*camera
    }
}

fn small(whole: &Image) -> Arc<Image> {
    let pixels = RgbaImage::from_raw(whole.width_px, whole.height_px, whole.rgba8.clone()).unwrap();
    let [width_px, height_px] = [whole.width_px / SHRINK, whole.height_px / SHRINK];
    Arc::new(Image {
        width_px,
        height_px,
        rgba8: resize(&pixels, width_px, height_px, FilterType::Triangle).into_raw(),
    })
}

pub(crate) fn picture_of(core: &mut Core, input: &FrameInput) -> Vec<u8> {
    core.frame(input).unwrap();
    core.read_picture().unwrap().rgba8
}
