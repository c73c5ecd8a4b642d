//! Variations that must not change a byte of the picture.

use std::sync::OnceLock;

use app_core::scene::Pose;
use app_core::toy::ToyError;
use glam::{DMat4, DQuat, DVec2, DVec3};

use super::case::{Case, Scope};
use super::lab::{Lab, Label};
use super::row::{Bound, Findings};
use crate::photographer::{Ground, Paint, Photos, STILL_CLIP, Shot, ToyFile, World};

const EQUAL: Bound = Bound {
    limit: 0.0,
    unit: "bytes",
    meaning: "bytes of the picture that differ",
};
const GROUP: &str = "exact";

/// The group's cases.
pub(super) const CASES: &[Case] = &[
    Case::new(GROUP, "run-again", Scope::Quick, run_again),
    Case::new(GROUP, "rigid-motion", Scope::Quick, rigid_motion),
    Case::new(GROUP, "still-clip", Scope::Quick, still_clip),
    Case::new(GROUP, "receiver-order", Scope::Quick, receiver_order),
    Case::new(GROUP, "unused-parts", Scope::Quick, unused_parts),
    Case::new(GROUP, "weight-scale", Scope::Quick, weight_scale),
];

/// A small picture of boxes on a table of slow waves.
pub(super) fn small() -> World {
    let mut world = World::boxes().resized([160, 90]);
    world.grounds[0].paint = Paint::Waves {
        color: DVec3::new(0.42, 0.37, 0.31),
        amount: 0.3,
        wave_m: 0.11,
    };
    world
}

/// Pictures of [`small`], which are taken once.
pub(super) fn small_photos() -> &'static Photos {
    static PHOTOS: OnceLock<Photos> = OnceLock::new();
    PHOTOS.get_or_init(|| Photos::of(&small()))
}

/// Rows of variations of a shot, all of which must have its picture to the last byte.
fn equal(
    lab: &mut Lab,
    label: Label,
    shot: &Shot,
    others: impl IntoIterator<Item = (String, Shot)>,
) -> anyhow::Result<Findings> {
    lab.compare(label, (EQUAL, |gap| gap.n_bytes), shot, others)
}

fn run_again(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    let shot = Shot::described(&small(), small_photos(), &ToyFile::default())?;
    let again = (1..=2).map(|run| (format!("run {run}"), shot.clone()));
    equal(lab, label, &shot, again)
}

fn rigid_motion(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    let world = small();
    let photos = small_photos();
    let told = |world: &World| Shot::described(world, photos, &ToyFile::default());
    let direction = DVec3::new(0.8, 0.0, -0.6);
    let motions = [
        ("1 m", DMat4::from_translation(direction)),
        ("100 m", DMat4::from_translation(100.0 * direction)),
        ("1 km", DMat4::from_translation(1e3 * direction)),
        ("10 km", DMat4::from_translation(1e4 * direction)),
        ("turned by 40 deg", DMat4::from_rotation_y(40f64.to_radians())),
        (
            "turned about a slanted axis, at 10 km",
            DMat4::from_rotation_translation(
                DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 1.1),
                1e4 * DVec3::new(0.6, 0.3, 0.741_619_848_709_566_3),
            ),
        ),
    ];
    let moved = motions
        .into_iter()
        .map(|(name, motion)| Ok((name.to_owned(), told(&world.clone().moved(&motion))?)));
    let moved: Vec<_> = moved.collect::<Result<_, ToyError>>()?;
    equal(lab, label, &told(&world)?, moved)
}

fn still_clip(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    let world = small();
    let file = ToyFile {
        has_still_clip: true,
        ..ToyFile::default()
    };
    let shot = Shot::described(&world, small_photos(), &file)?;
    let clip = shot.scene.toy.find_clip(STILL_CLIP)?;
    let others = [0.0, 1e-9, 0.37, 3.3, 9.99, 10.0].map(|time_secs| {
        let mut other = shot.clone();
        other.scene.physical_pose = Pose::Clip { clip, time_secs };
        (format!("at {time_secs} s"), other)
    });
    equal(lab, label, &shot, others)
}

/// A wall behind the toy.
pub(super) fn walled(mut world: World) -> World {
    world.grounds.push(Ground {
        world_from_plane: DMat4::from_rotation_translation(
            DQuat::from_rotation_x(std::f64::consts::FRAC_PI_2),
            DVec3::new(0.0, 0.2, -0.09),
        ),
        half_extent_m: DVec2::new(0.4, 0.2),
        paint: Paint::Even(DVec3::new(0.3, 0.38, 0.42)),
    });
    world
}

fn receiver_order(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    let shot = Shot::of(&walled(small()))?;
    let mut other = shot.clone();
    other.scene.receivers.reverse();
    equal(lab, label, &shot, [("wall before table".to_owned(), other)])
}

fn told_as(
    lab: &mut Lab,
    label: Label,
    base: &ToyFile,
    files: &[(&str, ToyFile)],
) -> anyhow::Result<Findings> {
    let world = small();
    let photos = small_photos();
    let others = files
        .iter()
        .map(|(name, file)| Ok(((*name).to_owned(), Shot::described(&world, photos, file)?)));
    let others: Vec<_> = others.collect::<Result<_, ToyError>>()?;
    equal(lab, label, &Shot::described(&world, photos, base)?, others)
}

fn unused_parts(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    let base = ToyFile::default();
    let with = ToyFile {
        has_unused: true,
        ..base
    };
    told_as(lab, label, &base, &[("a node, a mesh and a material", with)])
}

fn weight_scale(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    let of = |sum: f32| ToyFile {
        skin_weight: Some(sum),
        ..ToyFile::default()
    };
    let files = [
        ("sum 0.5", of(0.5)),
        ("sum 2", of(2.0)),
        ("sum 3", of(3.0)),
        ("sum 16", of(16.0)),
    ];
    told_as(lab, label, &of(1.0), &files)
}
