//! Variations that may change the picture by rounding alone, or its errors slightly.

use app_core::scene::Plate;
use app_core::session::Truth;
use app_core::toy::ToyError;
use glam::{DMat4, DVec3};

use super::case::{Case, Scope};
use super::exact::{small, small_photos, walled};
use super::lab::{Lab, Label};
use super::row::{Bound, Findings, Row};
use crate::photographer::world::{camera, toward};
use crate::photographer::{Films, Lamp, Photos, Sensor, Shot, ToyFile, World, flipped};
use desk::metrics::score;

const ONE_CODE: Bound = Bound {
    limit: 1.0,
    unit: "codes",
    meaning: "largest difference of a colour",
};
const SAME_ERROR: Bound = Bound {
    limit: 1.0,
    unit: "codes",
    meaning: "change of the toy's RMSE against the truth",
};
const SAME_SHADOW_ERROR: Bound = Bound {
    limit: 1.0,
    unit: "codes",
    meaning: "change of the shadow's RMSE against the truth",
};
const FAR_IS_DIRECTIONAL: Bound = Bound {
    limit: 0.1,
    unit: "codes",
    meaning: "toy's RMSE, less that with a directional light",
};
/// Exponent of most of the sRGB curve. Source: IEC 61966-2-1.
const SRGB_POWER: f64 = 2.4;
const GROUP: &str = "bounded";

/// The group's cases.
pub(super) const CASES: &[Case] = &[
    Case::new(GROUP, "uniform-scale", Scope::Quick, uniform_scale),
    Case::new(GROUP, "receiver-origin", Scope::Quick, receiver_origin),
    Case::new(GROUP, "triangles-permuted", Scope::Quick, triangles_permuted),
    Case::new(GROUP, "lights-permuted", Scope::Quick, lights_permuted),
    Case::new(GROUP, "plates-permuted", Scope::Whole, plates_permuted),
    Case::new(GROUP, "mirrored", Scope::Whole, mirrored),
    Case::new(GROUP, "exposure", Scope::Quick, exposure),
    Case::new(GROUP, "light-twice", Scope::Quick, light_twice),
    Case::new(GROUP, "far-sphere", Scope::Quick, far_sphere),
];

/// Rows of shots that must have the first one's picture, within a code.
fn within_a_code(
    lab: &mut Lab,
    label: Label,
    shot: &Shot,
    others: impl IntoIterator<Item = (String, Shot)>,
) -> anyhow::Result<Findings> {
    lab.compare(label, (ONE_CODE, |gap| gap.max), shot, others)
}

fn uniform_scale(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    let world = small();
    let photos = small_photos();
    let told = |world: &World| Shot::described(world, photos, &ToyFile::default());
    let scales = [1e-3, 1e-2, 0.1, 0.5, 2.0, 10.0, 100.0, 1e3];
    let scaled = scales.map(|factor| Ok((format!("x {factor}"), told(&world.clone().scaled(factor))?)));
    let scaled = scaled.into_iter().collect::<Result<Vec<_>, ToyError>>()?;
    within_a_code(lab, label, &told(&world)?, scaled)
}

/// The receiver's rectangle is 6 km long, so that its border is far away.
fn receiver_origin(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    let mut world = small();
    world.grounds[0].half_extent_m *= 2e3;
    let shot = Shot::of(&world)?;
    let others = [1.0, 10.0, 100.0, 1e3].map(|metres: f64| {
        let mut other = shot.clone();
        let along = DVec3::new(0.6, 0.0, 0.8) * metres;
        other.scene.receivers[0].world_from_plane = DMat4::from_translation(along);
        (format!("moved by {metres} m"), other)
    });
    within_a_code(lab, label, &shot, others)
}

fn triangles_permuted(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    let world = small();
    let photos = small_photos();
    let told = |order| {
        let file = ToyFile {
            order,
            ..ToyFile::default()
        };
        Shot::described(&world, photos, &file)
    };
    let others = [1, 2, 3].map(|seed| Ok((format!("seed {seed}"), told(Some(seed))?)));
    let others = others.into_iter().collect::<Result<Vec<_>, ToyError>>()?;
    within_a_code(lab, label, &told(None)?, others)
}

/// Three lights of different sizes and colours.
fn three_lights() -> World {
    let mut lamps = vec![
        Lamp::bulb(toward(50.0, 30.0), 0.02, 0.4),
        Lamp::bulb(0.8 * toward(40.0, 120.0), 0.01, 0.2),
        Lamp::sun(toward(65.0, 250.0), 0.02, 0.25),
    ];
    lamps[1].color *= DVec3::new(1.0, 0.8, 0.6);
    small().lit_by(lamps)
}

fn lights_permuted(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    let shot = Shot::of(&three_lights())?;
    let others = [[1, 0, 2], [0, 2, 1], [2, 1, 0], [1, 2, 0]].map(|order| {
        let mut other = shot.clone();
        other.scene.lights = order.map(|light| shot.scene.lights[light]).to_vec();
        (format!("order {order:?}"), other)
    });
    within_a_code(lab, label, &shot, others)
}

/// Plates from the frame's camera and from two beside it.
fn plates_permuted(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    let world = small();
    let mut shot = Shot::of(&world)?;
    for eye in [DVec3::new(0.11, 0.26, 0.33), DVec3::new(0.0, 0.22, 0.38)] {
        let beside = World {
            camera: camera(world.size_px, eye, DVec3::new(0.02, 0.04, 0.01)),
            ..world.clone()
        };
        shot.scene.plates.push(Plate {
            camera: beside.camera,
            image: Photos::of(&beside).plate,
        });
    }
    // The frame's own camera has no plate: each part of the picture comes from the others.
    shot.scene.plates.remove(0);
    let eye = DVec3::new(0.05, 0.29, 0.35);
    let third = World {
        camera: camera(world.size_px, eye, DVec3::new(0.02, 0.04, 0.01)),
        ..world
    };
    shot.scene.plates.push(Plate {
        camera: third.camera,
        image: Photos::of(&third).plate,
    });
    let others = [[1, 0, 2], [0, 2, 1], [2, 1, 0], [1, 2, 0]].map(|order| {
        let mut other = shot.clone();
        other.scene.plates = order.map(|plate| shot.scene.plates[plate].clone()).to_vec();
        (format!("order {order:?}"), other)
    });
    within_a_code(lab, label, &shot, others)
}

/// By errors against the truth: the sample positions in a pixel are not symmetric.
fn mirrored(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    let mut findings = Findings::default();
    for (name, world) in lab.some_of([("table and wall", walled(small())), ("table", small())], 1) {
        let photos = Photos::of(&world);
        let mirror = Photos {
            plate: flipped(&photos.plate).into(),
            frame: flipped(&photos.frame).into(),
            truth: Truth {
                image: flipped(&photos.truth.image),
                mask: flipped(&photos.truth.mask),
            },
        };
        let shot = Shot::described(&world, &photos, &ToyFile::default())?;
        let other = Shot::described(&world.mirrored(), &mirror, &ToyFile::default())?;
        let rows = same_errors(lab, label, &shot, [(name.to_owned(), other, 1.0)])?.rows;
        findings.rows.extend(rows);
    }
    Ok(findings)
}

/// Rows of the change of both errors from the first shot's. Each of the other shots has the
/// brightness ratio of its frame: a code stands for more light then, by the power of sRGB.
fn same_errors(
    lab: &mut Lab,
    label: Label,
    shot: &Shot,
    others: impl IntoIterator<Item = (String, Shot, f64)>,
) -> anyhow::Result<Findings> {
    let before = score(&lab.reference(shot)?, &shot.truth)?;
    let mut rows: Vec<Row> = Vec::new();
    for (parameter, other, gain) in lab.some_of(others, 1) {
        let picture = match lab.picture(&other) {
            Ok(picture) => picture,
            Err(error) => {
                rows.push(label.refused(parameter, SAME_ERROR, error)?);
                continue;
            }
        };
        let after = score(&picture, &other.truth)?;
        let pairs = [
            (SAME_ERROR, before.toy, after.toy),
            (SAME_SHADOW_ERROR, before.shadow, after.shadow),
        ];
        for (bound, before, after) in pairs {
            let expected = before.rmse * gain.powf(1.0 / SRGB_POWER);
            let row = label.row(parameter.clone(), bound, (after.rmse - expected).abs());
            rows.push(row.noting(before.rmse, after.rmse));
        }
    }
    Ok(rows.into())
}

/// The exposure is not stated: it must be estimated from the pixels.
fn exposure(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    let world = small();
    let films = Films::of(&world);
    let taken = |plate_gain, frame_gain| {
        let sensor = Sensor {
            plate_gain,
            frame_gain,
            ..Sensor::default()
        };
        Shot::described(&world, &films.develop(&sensor), &ToyFile::default())
    };
    let warm = DVec3::new(1.15, 1.0, 0.8);
    let one = DVec3::ONE;
    let gains = [
        ("both at half", 0.5 * one, 0.5 * one),
        ("both at 1.4", 1.4 * one, 1.4 * one),
        ("both warm", warm, warm),
        ("plate at half", 0.5 * one, one),
        ("plate at 1.4", 1.4 * one, one),
        ("frame at half", one, 0.5 * one),
        ("frame at 1.4", one, 1.4 * one),
        ("frame warm", one, warm),
        ("plate warm and at half", 0.5 * warm, one),
    ];
    let others = gains
        .map(|(name, plate, frame)| Ok((name.to_owned(), taken(plate, frame)?, frame.element_sum() / 3.0)));
    let others = others.into_iter().collect::<Result<Vec<_>, ToyError>>()?;
    same_errors(lab, label, &taken(one, one)?, others)
}

fn light_twice(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    let mut findings = Findings::default();
    for (name, world) in lab.some_of([("three lights", three_lights()), ("one light", small())], 1) {
        let shot = Shot::of(&world)?;
        let mut other = shot.clone();
        other.scene.lights.push(shot.scene.lights[0]);
        let rows = same_errors(
            lab,
            label,
            &shot,
            [(format!("{name}, the first one twice"), other, 1.0)],
        )?
        .rows;
        findings.rows.extend(rows);
    }
    Ok(findings)
}

/// The photographs have a directional light; the scene lists a sphere of its angle.
fn far_sphere(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    let angular_radius_rad = 0.01;
    let direction = toward(50.0, 35.0);
    let sun = small().lit_by(vec![Lamp::sun(direction, angular_radius_rad, 0.75)]);
    let shot = Shot::of(&sun)?;
    let before = score(&lab.reference(&shot)?, &shot.truth)?;
    let mut rows = Vec::new();
    for power in lab.some_of(2..=9, 1) {
        let distance_m = 10f64.powi(power);
        let sphere = Lamp::bulb(distance_m * direction, distance_m * angular_radius_rad.sin(), 1.0);
        let mut other = shot.clone();
        other.scene.lights = vec![sphere.light];
        let parameter = format!("1e{power} m");
        let row = match lab.picture(&other) {
            Err(error) => label.refused(parameter, FAR_IS_DIRECTIONAL, error)?,
            Ok(picture) => {
                let after = score(&picture, &other.truth)?;
                let number = (after.toy.rmse - before.toy.rmse).abs();
                let row = label.row(parameter, FAR_IS_DIRECTIONAL, number);
                row.noting(before.toy.rmse, after.toy.rmse)
            }
        };
        rows.push(row);
    }
    Ok(rows.into())
}
