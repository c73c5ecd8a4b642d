//! The scene, from `capture.json`: camera, receivers, lights, plates.

use std::sync::Arc;

use glam::DVec2;

use super::PictureStore;
use super::field::{LENS, at, in_index};
use super::record::{
    BackgroundRecord, IntrinsicsRecord, LensRecord, LightKind, LightRecord, ReceiverRecord, SurfaceRecord,
};
use crate::SessionWarning;
use crate::error::SessionError;
use app_scene::lens::{COEFFICIENT, Distortion, Lens};
use app_scene::scene::check;
use app_scene::scene::{
    Camera, FieldError, Image, Intrinsics, Light, MAX_SCENE_PLATES, Plate, Receiver, Surface,
};

/// Limit for the pixels of all plates together, which stay in memory: 1 GiB.
const MAX_PLATE_PIXELS: u64 = 1 << 28;

pub(super) fn intrinsics(field: &str, record: &IntrinsicsRecord) -> Result<Intrinsics, SessionError> {
    let number = |name: &str, value, range| at(&format!("{field}.{name}"), check::number(value, range));
    Ok(Intrinsics {
        fx_px: number("fx", record.fx, &check::FOCAL_PX)?,
        fy_px: number("fy", record.fy, &check::FOCAL_PX)?,
        cx_px: number("cx", record.cx, &check::POSITION_PX)?,
        cy_px: number("cy", record.cy, &check::POSITION_PX)?,
    })
}

pub(super) fn distortion(record: &LensRecord) -> Result<Distortion, SessionError> {
    let coefficient = |name: &str, value| at(&format!("{LENS}.{name}"), check::number(value, &COEFFICIENT));
    Ok(Distortion {
        k1: coefficient("k1", record.k1)?,
        k2: coefficient("k2", record.k2.unwrap_or(0.0))?,
    })
}

/// A camera with its own intrinsics, or the session's.
pub(super) fn camera(
    field: &str,
    world_from_camera: [f64; 16],
    (own, of_session): (Option<&IntrinsicsRecord>, &Intrinsics),
) -> Result<Camera, SessionError> {
    let own = own.map(|own| intrinsics(&format!("{field}.intrinsics"), own));
    Ok(Camera {
        intrinsics: own.transpose()?.unwrap_or(*of_session),
        world_from_camera: at(
            &format!("{field}.world_from_camera"),
            check::rigid(world_from_camera),
        )?,
    })
}

pub(super) fn receiver(field: &str, record: &ReceiverRecord) -> Result<Receiver, SessionError> {
    let half_extent = |i: usize| {
        at(
            &format!("{field}.half_extent[{i}]"),
            check::number(record.half_extent[i], &check::EXTENT_M),
        )
    };
    Ok(Receiver {
        name: record.name.clone(),
        world_from_plane: at(
            &format!("{field}.world_from_plane"),
            check::rigid(record.world_from_plane),
        )?,
        half_extent_m: DVec2::new(half_extent(0)?, half_extent(1)?),
        surface: match record.surface {
            SurfaceRecord::Uniform => Surface::Uniform,
            SurfaceRecord::Textured => Surface::Textured,
        },
    })
}

pub(super) fn light(field: &str, record: &LightRecord) -> Result<Light, SessionError> {
    let number = |name: &str, value: Option<f64>, range| {
        let value = value.ok_or(FieldError::Missing);
        at(
            &format!("{field}.{name}"),
            value.and_then(|value| check::number(value, range)),
        )
    };
    let vector = |name: &str, value: Option<[f64; 3]>, convert: fn([f64; 3]) -> _| {
        at(
            &format!("{field}.{name}"),
            value.ok_or(FieldError::Missing).and_then(convert),
        )
    };
    Ok(match record.kind {
        LightKind::Sphere => Light::Sphere {
            position_in_world: vector("position", record.position, check::light_position)?,
            radius_m: number("radius", record.radius, &check::RADIUS_M)?,
        },
        LightKind::Directional => {
            let degrees = number(
                "angular_radius_deg",
                record.angular_radius_deg,
                &check::ANGULAR_RADIUS_DEG,
            )?;
            Light::Directional {
                direction_to_light_in_world: vector(
                    "direction_to_light",
                    record.direction_to_light,
                    check::direction,
                )?,
                angular_radius_rad: degrees.to_radians(),
            }
        }
    })
}

/// Reads the plates. Those with the same file share its picture and one warning.
pub(super) fn plates(
    store: &PictureStore,
    intrinsics: &Intrinsics,
    records: &[BackgroundRecord],
    warnings: &mut Vec<SessionWarning>,
) -> Result<Vec<Plate>, SessionError> {
    at("backgrounds", check::at_most(records.len(), MAX_SCENE_PLATES))?;
    let mut pictures: Vec<(&str, Option<Lens>, Arc<Image>)> = Vec::new();
    let mut plates = Vec::new();
    for (i, record) in records.iter().enumerate() {
        let field = format!("backgrounds[{i}]");
        let camera = camera(
            &field,
            record.world_from_camera,
            (record.intrinsics.as_ref(), intrinsics),
        )?;
        let lens = store.lens(&camera.intrinsics)?;
        let mut known = pictures.iter();
        let image = match known.find(|known| (known.0, known.1) == (&record.image[..], lens)) {
            Some((.., image)) => Arc::clone(image),
            None => {
                let n_pixels = store.size.n_pixels() * (pictures.len() as u64 + 1);
                if n_pixels > MAX_PLATE_PIXELS {
                    let error = FieldError::TooManyPixels {
                        max_pixels: MAX_PLATE_PIXELS,
                    };
                    return Err(in_index("backgrounds", error));
                }
                let field = format!("{field}.image");
                let photo = store.photo(&record.image, &field, &camera.intrinsics)?;
                warnings.extend(photo.warning(&record.image, &field));
                pictures.push((&record.image, lens, Arc::clone(&photo.image)));
                photo.image
            }
        };
        plates.push(Plate { camera, image });
    }
    Ok(plates)
}
