//! The growth of a frame's cost, by the ledger: with the picture around the region, with the
//! region, with lights, with triangles.

use app_core::Core;
use app_core::core::CoreError;
use app_core::frame::FrameInput;
use app_core::preset::Preset;
use app_core::scene::{Camera, Intrinsics, Scene};

use crate::ball::{SCREEN_PX, ball, phone, scene_of};
use crate::bench::FrameKind;
use crate::count::{Counted, count};
use crate::stability::Sweep;

/// The pass that shows a picture, whose cost depends on the screen.
const SCREEN: &str = "screen";
const PRESET: Preset = Preset::Balanced;
/// Divisions around and along a ball of 10,000 triangles.
const FINE: [u32; 2] = [100, 51];
/// Pixels of a region, in millions.
const MEGAPIXEL: f64 = 1e6;

/// A camera with the same angle per pixel, in a picture of another size.
fn widened([width_px, height_px]: [u32; 2]) -> (Camera, [u32; 2]) {
    let camera = phone();
    let intrinsics = Intrinsics {
        cx_px: 0.5 * f64::from(width_px),
        cy_px: 0.5 * f64::from(height_px),
        ..camera.intrinsics
    };
    (Camera { intrinsics, ..camera }, [width_px, height_px])
}

/// A camera in which everything is smaller by the given ratio.
fn zoomed(ratio: f64) -> (Camera, [u32; 2]) {
    let camera = phone();
    let intrinsics = Intrinsics {
        fx_px: ratio * camera.intrinsics.fx_px,
        fy_px: ratio * camera.intrinsics.fy_px,
        ..camera.intrinsics
    };
    (Camera { intrinsics, ..camera }, SCREEN_PX)
}

/// Memory traffic in mebibytes without the pass that shows the picture.
#[must_use]
pub fn moved_mib(counted: &Counted) -> f64 {
    let passes = counted.ledger.entries().iter();
    let bytes: u64 = passes
        .filter(|run| run.pass != SCREEN)
        .map(|run| run.work.bytes_moved())
        .sum();
    let bytes = bytes as f64;
    bytes / 1048576.0
}

/// Triangles in thousands.
fn kilotriangles(counted: &Counted) -> f64 {
    let triangles = counted.ledger.total().triangles() as f64;
    triangles / 1e3
}

/// A parameter's value, and its scene.
type Setup = (f64, (Scene, FrameInput));

/// A line for each kind of frame.
fn sweep(
    name: &str,
    (along, measure): (&'static str, &'static str),
    cost: fn(&Counted) -> f64,
    setups: &[Setup],
) -> Result<Sweep, CoreError> {
    let mut lines: Vec<(&'static str, Vec<[f64; 2]>)> = Vec::new();
    for (at, (scene, input)) in setups {
        for counted in count(scene, (PRESET, &[]), input)? {
            let point = [*at, cost(&counted)];
            let line = line_of(counted.kind);
            match lines.iter_mut().find(|(known, _)| *known == line) {
                Some((_, points)) => points.push(point),
                None => lines.push((line, vec![point])),
            }
        }
    }
    Ok(Sweep {
        name: format!("ledger-by-{name}"),
        along,
        measure,
        lines,
    })
}

fn line_of(kind: FrameKind) -> &'static str {
    match kind {
        FrameKind::Pose => "new pose",
        FrameKind::Picture => "new picture",
        FrameKind::View => "new view",
    }
}

/// Pixels of a scene's work region, in millions.
fn region_megapixels((scene, input): &(Scene, FrameInput)) -> Result<f64, CoreError> {
    let mut core = Core::counting();
    core.set_scene(scene.clone(), PRESET)?;
    let region = core.frame(input)?.region;
    let n_px = region.map_or(0, |region| region.size_px.element_product());
    Ok(f64::from(n_px) / MEGAPIXEL)
}

const MOVED: &str = "MiB moved, without showing the picture";

/// By the picture's width, with the same region.
///
/// # Errors
/// When the core refuses the scene.
pub fn by_picture() -> Result<Sweep, CoreError> {
    let setups: Vec<Setup> = [[2000, 1400], [2436, 1400], [3200, 1600], [4000, 1800]]
        .map(|size_px: [u32; 2]| {
            let scene = scene_of(ball(FINE[0], FINE[1]), 1, widened(size_px));
            (f64::from(size_px[0]), scene)
        })
        .into();
    sweep(
        "picture",
        ("width of the picture, px; the region is the same", MOVED),
        moved_mib,
        &setups,
    )
}

/// By the pixels of the region.
///
/// # Errors
/// As above.
pub fn by_area() -> Result<Sweep, CoreError> {
    let scenes = [0.4, 0.6, 0.8, 1.0, 1.1].map(|ratio| scene_of(ball(FINE[0], FINE[1]), 1, zoomed(ratio)));
    let setups: Result<Vec<Setup>, CoreError> = scenes
        .into_iter()
        .map(|scene| Ok((region_megapixels(&scene)?, scene)))
        .collect();
    sweep("area", ("region, megapixels", MOVED), moved_mib, &setups?)
}

/// By the number of lights.
///
/// # Errors
/// As above.
pub fn by_lights() -> Result<Sweep, CoreError> {
    let scene = |n: u32| {
        (
            f64::from(n),
            scene_of(ball(FINE[0], FINE[1]), n, (phone(), SCREEN_PX)),
        )
    };
    let setups = [1, 2, 3, 4].map(scene);
    sweep(
        "lights",
        ("lights", "thousands of triangles drawn"),
        kilotriangles,
        &setups,
    )
}

/// By the triangles of the toy.
///
/// # Errors
/// As above.
pub fn by_triangles() -> Result<Sweep, CoreError> {
    let setups = [(40, 21), (60, 31), (80, 41), (100, 51), (140, 73)].map(|(around, along)| {
        let n_triangles = f64::from(2 * around * (along - 1));
        (
            n_triangles / 1e3,
            scene_of(ball(around, along), 1, (phone(), SCREEN_PX)),
        )
    });
    let axes = (
        "thousands of triangles of the toy",
        "thousands of triangles drawn",
    );
    sweep("triangles", axes, kilotriangles, &setups)
}
