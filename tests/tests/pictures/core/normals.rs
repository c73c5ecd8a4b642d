//! A toy with broken or inverted normals looks like the one with correct normals, and a warning
//! reports the error.

use std::sync::Arc;

use app_core::preset::Preset;
use app_core::session::GroundTruth;
use app_core::toy::{Toy, ToyWarning};
use harness::bundled_session;

use crate::core::bundled::{SHRINK, core, first_input, picture_of, scene};
use crate::core::file::File;

/// Largest difference from the picture with correct normals inside the toy, in codes.
const MAX_RMSE: f64 = 1.0;

fn inverted(normal: [f32; 3]) -> [f32; 3] {
    normal.map(|coordinate| -coordinate)
}

pub(crate) fn picture(toy: Toy, preset: Preset) -> Vec<u8> {
    let mut core = core();
    let scene = scene().with_toy(Arc::new(toy));
    core.set_scene(scene, preset).unwrap();
    picture_of(&mut core, &first_input())
}

/// Whether each pixel lies in the shown toy.
pub(crate) fn is_toy() -> Vec<bool> {
    let session = bundled_session();
    let mask = session.truth(0).unwrap().unwrap().mask;
    let step = SHRINK as usize;
    let rows = mask.rgba8.chunks_exact(4 * mask.width_px as usize).step_by(step);
    let row = |row: &[u8]| -> Vec<bool> { row.chunks_exact(4).step_by(step).map(|p| p[0] > 0).collect() };
    rows.flat_map(row).collect()
}

/// Root of the mean squared difference inside the toy, in codes.
fn rmse(actual: &[u8], expected: &[u8]) -> f64 {
    let is_toy = is_toy();
    rmse_where(actual, expected, |pixel| is_toy[pixel])
}

/// The same over some of the pixels.
pub(crate) fn rmse_where(actual: &[u8], expected: &[u8], is_counted: impl Fn(usize) -> bool) -> f64 {
    let pixels = actual.chunks_exact(4).zip(expected.chunks_exact(4)).enumerate();
    let (mut sum, mut n) = (0.0, 0.0);
    for (_, (a, b)) in pixels.filter(|(pixel, _)| is_counted(*pixel)) {
        for channel in 0..3 {
            sum += (f64::from(a[channel]) - f64::from(b[channel])).powi(2);
            n += 1.0;
        }
    }
    (sum / n).sqrt()
}

#[test]
fn broken_normals_look_as_good_ones_do() {
    let zero = |_| [0.0; 3];
    let all = usize::MAX;
    #[rustfmt::skip] // One case a line.
    let cases = [
        ("zero", File::open().change_normals(all, zero), "no length"),
        ("zero in one part", File::open().change_normals(1, zero), "no length"),
        ("inverted", File::open().change_normals(all, inverted), "pointed into"),
        ("inverted in one part", File::open().change_normals(1, inverted), "pointed into"),
        ("inside out", File::open().change_normals(all, inverted).turn_faces(), "faced inwards"),
        ("faces turned around", File::open().turn_faces(), "faced inwards"),
    ];
    for preset in [Preset::Balanced, Preset::Best] {
        let good = picture(File::open().toy(), preset);
        // Control: wrong normals that cannot be detected; the comparison must show them.
        let up = picture(
            File::open().change_normals(all, |_| [0.0, 1.0, 0.0]).toy(),
            preset,
        );
        let planted = rmse(&up, &good);
        assert!(planted > MAX_RMSE, "{planted}");
        for (name, file, word) in &cases {
            let toy = file.toy();
            let warnings: Vec<String> = toy.warnings().iter().map(ToyWarning::to_string).collect();
            let found = rmse(&picture(toy, preset), &good);
            println!("{name}, {preset:?}: {found:.3}, planted {planted:.3}, {warnings:?}");
            assert!(found <= MAX_RMSE, "{name}, {preset:?}: {found} codes");
            assert!(
                warnings.iter().any(|warning| warning.contains(word)),
                "{name}: {warnings:?}"
            );
        }
    }
    assert!(File::open().toy().warnings().is_empty());
}
