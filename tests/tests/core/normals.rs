//! A toy with broken normals, or inside out, looks as the one with good normals does, and says what was wrong.

use std::fs;
use std::sync::Arc;

use app_core::preset::Preset;
use app_core::scene::Scene;
use app_core::session::{Capture, GroundTruth};
use app_core::toy::{Toy, ToyWarning};
use harness::files::{BUNDLED_SESSION, Folder};
use serde_json::Value;

use crate::bundled::{SHRINK, core, first_input, picture_of, scene};

/// Largest difference to the picture of good normals inside the toy, in codes.
const MAX_RMSE: f64 = 1.0;

/// The bundled toy's file, whose accessors are packed.
struct File {
    json: Value,
    bytes: Vec<u8>,
    /// First byte of the binary chunk's contents.
    bin: usize,
}

impl File {
    fn open() -> Self {
        let bytes = fs::read(format!("{BUNDLED_SESSION}/toy.glb")).unwrap();
        let n_json_bytes = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
        let json = serde_json::from_slice(&bytes[20..20 + n_json_bytes]).unwrap();
        Self {
            json,
            bin: 20 + n_json_bytes + 8,
            bytes,
        }
    }

    /// The primitives' accessors that `find` selects.
    fn accessors(&self, find: impl Fn(&Value) -> &Value) -> Vec<usize> {
        let primitives = self.json["meshes"][0]["primitives"].as_array().unwrap();
        let index = |primitive| usize::try_from(find(primitive).as_u64().unwrap()).unwrap();
        primitives.iter().map(index).collect()
    }

    /// The bytes of an accessor whose elements take `size` bytes.
    fn elements(&mut self, accessor: usize, size: usize) -> &mut [u8] {
        let number = |value: &Value| usize::try_from(value.as_u64().unwrap_or(0)).unwrap();
        let accessor = &self.json["accessors"][accessor];
        let view = &self.json["bufferViews"][number(&accessor["bufferView"])];
        let first = self.bin + number(&view["byteOffset"]) + number(&accessor["byteOffset"]);
        let n_bytes = size * number(&accessor["count"]);
        &mut self.bytes[first..first + n_bytes]
    }

    /// Changes each normal of the first `n` primitives.
    fn change_normals(mut self, n: usize, change: impl Fn([f32; 3]) -> [f32; 3]) -> Self {
        for accessor in self
            .accessors(|primitive| &primitive["attributes"]["NORMAL"])
            .into_iter()
            .take(n)
        {
            for bytes in self.elements(accessor, 12).as_chunks_mut::<12>().0 {
                let normal = [0, 4, 8].map(|k| f32::from_le_bytes(bytes[k..k + 4].try_into().unwrap()));
                bytes.copy_from_slice(change(normal).map(f32::to_le_bytes).as_flattened());
            }
        }
        self
    }

    /// Turns every triangle around.
    fn turn_faces(mut self) -> Self {
        for accessor in self.accessors(|primitive| &primitive["indices"]) {
            for [_, b, c] in self
                .elements(accessor, 2)
                .as_chunks_mut::<2>()
                .0
                .as_chunks_mut()
                .0
            {
                std::mem::swap(b, c);
            }
        }
        self
    }

    fn toy(&self) -> Toy {
        Toy::from_glb("toy.glb", &self.bytes).unwrap()
    }
}

fn inverted(normal: [f32; 3]) -> [f32; 3] {
    normal.map(|coordinate| -coordinate)
}

fn picture(toy: Toy, preset: Preset) -> Vec<u8> {
    let mut core = core();
    let scene = Scene {
        toy: Arc::new(toy),
        ..scene()
    };
    core.set_scene(scene, preset).unwrap();
    picture_of(&mut core, &first_input())
}

/// Whether each pixel lies in the shown toy.
fn is_toy() -> Vec<bool> {
    let session = Capture::open(Folder::open(BUNDLED_SESSION).unwrap()).unwrap();
    let mask = session.truth(0).unwrap().unwrap().mask;
    let step = SHRINK as usize;
    let rows = mask.rgba8.chunks_exact(4 * mask.width_px as usize).step_by(step);
    let row = |row: &[u8]| -> Vec<bool> { row.chunks_exact(4).step_by(step).map(|p| p[0] > 0).collect() };
    rows.flat_map(row).collect()
}

/// Root of the mean squared difference inside the toy, in codes.
fn rmse(actual: &[u8], expected: &[u8]) -> f64 {
    let pixels = actual.chunks_exact(4).zip(expected.chunks_exact(4)).zip(is_toy());
    let (mut sum, mut n) = (0.0, 0.0);
    for ((a, b), _) in pixels.filter(|(_, is_toy)| *is_toy) {
        for channel in 0..3 {
            sum += (f64::from(a[channel]) - f64::from(b[channel])).powi(2);
            n += 1.0;
        }
    }
    (sum / n as f64).sqrt()
}

#[test]
fn broken_normals_look_as_good_ones_do() {
    let zero = |_| [0.0; 3];
    let all = usize::MAX;
    let cases = [
        ("zero", File::open().change_normals(all, zero), "no length"),
        (
            "zero in one part",
            File::open().change_normals(1, zero),
            "no length",
        ),
        (
            "inverted",
            File::open().change_normals(all, inverted),
            "pointed into",
        ),
        (
            "inverted in one part",
            File::open().change_normals(1, inverted),
            "pointed into",
        ),
        (
            "inside out",
            File::open().change_normals(all, inverted).turn_faces(),
            "faced inwards",
        ),
        ("faces turned around", File::open().turn_faces(), "faced inwards"),
    ];
    for preset in [Preset::Balanced, Preset::Best] {
        let good = picture(File::open().toy(), preset);
        // Normals that are wrong and that nothing tells: the comparison must see them.
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
