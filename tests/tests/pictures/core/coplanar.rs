//! A part of the toy that lies in its receiver's plane hides none of the receiver.

use app_core::preset::Preset;
use glam::{DVec3, DVec4};

use crate::core::bundled::{first_input, scene};
use crate::core::file::File;
use crate::core::normals::{is_toy, picture, rmse_where};

/// Half the side of the square, in metres.
const HALF_M: f32 = 0.05;
/// Largest difference from the picture without it, on the table beside it, in codes.
const MAX_RMSE: f64 = 1.0;

/// Whether each pixel shows the table, or something in front of it, farther from the square than a
/// pixel's footprint.
fn is_beside() -> Vec<bool> {
    const MARGIN_M: f64 = 0.005;
    let (scene, input) = (scene(), first_input());
    let object_from_camera = scene.world_from_object.inverse() * input.camera.world_from_camera;
    let intrinsics = input.camera.intrinsics;
    let eye = object_from_camera.w_axis.truncate();
    let ray = |x: u32, y: u32| {
        let right = (f64::from(x) + 0.5 - intrinsics.cx_px) / intrinsics.fx_px;
        let up = (intrinsics.cy_px - f64::from(y) - 0.5) / intrinsics.fy_px;
        (object_from_camera * DVec4::new(right, up, -1.0, 0.0)).truncate()
    };
    let is_beside = |direction: DVec3| {
        let at = eye - direction * (eye.y / direction.y);
        at.x.abs().max(at.z.abs()) > f64::from(HALF_M) + MARGIN_M
    };
    let rows = (0..scene.height_px).flat_map(|y| (0..scene.width_px).map(move |x| (x, y)));
    rows.map(|(x, y)| is_beside(ray(x, y))).collect()
}

#[test]
fn a_square_in_the_plane_of_the_table_changes_nothing_beside_it() {
    // The toy's own estimates use the square's pixels, which are the table's: a real toy has no
    // such part.
    let is_table: Vec<bool> = is_beside()
        .iter()
        .zip(is_toy())
        .map(|(beside, toy)| *beside && !toy)
        .collect();
    for preset in [Preset::Balanced, Preset::Best] {
        let without = picture(File::open().toy(), preset);
        let square = |height_m| {
            picture(
                File::open().add_square([0.0, height_m, 0.0], HALF_M).toy(),
                preset,
            )
        };
        let found = rmse_where(&square(0.0), &without, |pixel| is_table[pixel]);
        // Control: above the table it hides and shades, and the comparison must detect that.
        let planted = rmse_where(&square(0.05), &without, |pixel| is_table[pixel]);
        println!("{preset:?}: {found:.3}, planted {planted:.3}");
        assert!(planted > MAX_RMSE, "{planted}");
        assert!(found <= MAX_RMSE, "{preset:?}: {found} codes");
    }
}
