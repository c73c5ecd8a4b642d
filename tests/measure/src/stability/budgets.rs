//! The cost of large scenes: processor seconds, memory.

use app_core::scene::Plate;
use glam::{DQuat, DVec3};

use super::case::{Case, Scope};
use super::exact::{small, small_photos};
use super::lab::{Lab, Label};
use super::row::{Bound, Findings};
use crate::photographer::world::{camera, toward};
use crate::photographer::{Key, Part, Photos, Shape, Shot, Stance, ToyFile, World};
use crate::process::{cpu_secs, held_mib, peak_mib, reset_peak};

/// For scene and first frame together, on a software renderer.
const CPU_SECS: Bound = Bound {
    limit: 60.0,
    unit: "s",
    meaning: "seconds on processors for scene and first frame",
};
/// Largest additional memory of a scene.
const PEAK_MIB: Bound = Bound {
    limit: 1024.0,
    unit: "MiB",
    meaning: "most memory held on top of before",
};
const GROUP: &str = "budgets";

/// The group's cases.
pub(super) const CASES: &[Case] = &[
    Case::new(GROUP, "plates", Scope::Whole, plates),
    Case::new(GROUP, "materials", Scope::Whole, materials),
    Case::new(GROUP, "large-triangles", Scope::Whole, large_triangles),
    Case::new(GROUP, "large-pictures", Scope::Whole, large_pictures),
];

fn cost(lab: &mut Lab, label: Label, parameter: String, shot: &Shot) -> anyhow::Result<Findings> {
    let planted = if lab.is_planted() { 1e6 } else { 0.0 };
    let (before_mib, before_secs) = (held_mib()?, cpu_secs()?);
    reset_peak()?;
    if let Err(error) = lab.picture(shot) {
        return Ok(vec![label.refused(parameter, CPU_SECS, error)?].into());
    }
    // A frame that passes through costs nothing.
    let planted = if lab.is_retargeted() { planted } else { f64::NAN };
    let rows = vec![
        label.row(parameter.clone(), CPU_SECS, cpu_secs()? - before_secs + planted),
        label.row(parameter, PEAK_MIB, peak_mib()? - before_mib + planted),
    ];
    Ok(rows.into())
}

fn join(findings: impl IntoIterator<Item = anyhow::Result<Findings>>) -> anyhow::Result<Findings> {
    let mut all = Findings::default();
    for found in findings {
        all.rows.extend(found?.rows);
    }
    Ok(all)
}

/// Plates from places around the frame's camera.
fn plates(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    let world = World::boxes();
    let photos = Photos::of(&world);
    let target = DVec3::new(0.02, 0.04, 0.01);
    join([1u16, 50, 300].map(|n_plates| {
        let mut shot = Shot::described(&world, &photos, &ToyFile::default())?;
        shot.scene.plates = (0..n_plates)
            .map(|plate| {
                let turn = 360.0 * f64::from(plate) / f64::from(n_plates);
                let eye = target + 0.44 * toward(30.0, 10.0 + turn);
                Plate {
                    camera: camera(world.size_px, eye, target),
                    // A plain table looks the same from everywhere, and each plate has its own
                    // copy.
                    image: std::sync::Arc::new((*photos.plate).clone()),
                }
            })
            .collect();
        cost(lab, label, format!("{n_plates} plates"), &shot)
    }))
}

/// A heap of boxes around the centre, each with its own material.
fn heap(n_parts: u16, half_m: f64) -> World {
    let mut world = small();
    world.parts = (0..n_parts)
        .map(|part| {
            let turn = 2.4 * f64::from(part);
            let share = (f64::from(part) + 0.5) / f64::from(n_parts);
            let place = DVec3::new(
                0.05 * share.sqrt() * turn.cos(),
                half_m + 0.08 * share,
                0.05 * share.sqrt() * turn.sin(),
            );
            let rest = Stance::at(place).turned(DQuat::from_rotation_y(turn));
            let end = Stance {
                place_m: place + DVec3::new(0.02, 0.0, 0.01),
                ..rest
            };
            Part {
                shape: Shape::cuboid(DVec3::splat(half_m)),
                color: DVec3::new(0.3 + 0.4 * share, 0.5, 0.6 - 0.4 * share),
                rest,
                keys: [(0.0, rest), (1.0, end)]
                    .map(|(time_secs, stance)| Key { time_secs, stance })
                    .to_vec(),
            }
        })
        .collect();
    world
}

/// The photographs show other boxes: only the cost matters.
fn materials(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    let photos = small_photos();
    join([1u16, 100, 1000].map(|n_parts| {
        let world = heap(n_parts, 0.004);
        let shot = Shot::described(&world, photos, &ToyFile::default())?;
        cost(lab, label, format!("{n_parts} materials"), &shot)
    }))
}

/// Triangles that each fill much of the picture, one behind the other.
fn large_triangles(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    let photos = small_photos();
    join([10u16, 100, 1000].map(|n_parts| {
        let world = heap(n_parts, 0.06);
        let shot = Shot::described(&world, photos, &ToyFile::default())?;
        cost(lab, label, format!("{} large triangles", 12 * n_parts), &shot)
    }))
}

/// Pictures enlarged from a small one: only the cost matters.
fn large_pictures(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    join([[640u32, 360], [1280, 720], [1920, 1080]].map(|size_px| {
        let mut world = World::boxes().resized(size_px);
        world.quality.n_across = 1;
        world.quality.n_light_rays = 16;
        world.quality.n_sky_rays = 8;
        cost(
            lab,
            label,
            format!("{} x {} px", size_px[0], size_px[1]),
            &Shot::of(&world)?,
        )
    }))
}
