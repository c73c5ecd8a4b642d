//! The place itself, from `capture.json`: camera, receivers, lights, plates, probe.

use std::collections::HashMap;
use std::sync::Arc;

use glam::DVec2;

use super::PictureStore;
use super::field::{at, in_index};
use super::record::{
    BackgroundRecord, IntrinsicsRecord, LightKind, LightRecord, ProbeRecord, ReceiverRecord, SurfaceRecord,
};
use crate::scene::{FresnelLens, Image, Intrinsics, Light, Plate, Receiver, Surface};
use crate::session::check;
use crate::session::error::{FieldError, SessionError};

/// Pixels of all plates together, which stay in memory: 1 GiB.
const MAX_PLATE_PIXELS: u64 = 1 << 28;

pub(super) fn intrinsics(record: &IntrinsicsRecord) -> Result<Intrinsics, SessionError> {
    Ok(Intrinsics {
        fx_px: at("intrinsics.fx", check::number(record.fx, &check::FOCAL_PX))?,
        fy_px: at("intrinsics.fy", check::number(record.fy, &check::FOCAL_PX))?,
        cx_px: at("intrinsics.cx", check::number(record.cx, &check::POSITION_PX))?,
        cy_px: at("intrinsics.cy", check::number(record.cy, &check::POSITION_PX))?,
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
            position_in_world: vector("position", record.position, check::point)?,
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

/// Reads the plates. Those with the same file share its picture.
pub(super) fn plates(store: &PictureStore, records: &[BackgroundRecord]) -> Result<Vec<Plate>, SessionError> {
    let mut pictures: HashMap<&str, Arc<Image>> = HashMap::new();
    let mut plates = Vec::new();
    for (i, record) in records.iter().enumerate() {
        let field = format!("backgrounds[{i}]");
        let world_from_camera = at(
            &format!("{field}.world_from_camera"),
            check::rigid(record.world_from_camera),
        )?;
        let image = match pictures.get(record.image.as_str()) {
            Some(image) => Arc::clone(image),
            None => {
                let n_pixels = store.size.n_pixels() * (pictures.len() as u64 + 1);
                if n_pixels > MAX_PLATE_PIXELS {
                    let error = FieldError::TooManyPixels {
                        max_pixels: MAX_PLATE_PIXELS,
                    };
                    return Err(in_index("backgrounds", error));
                }
                let image = Arc::new(store.photo(&record.image, &format!("{field}.image"))?);
                pictures.insert(&record.image, Arc::clone(&image));
                image
            }
        };
        plates.push(Plate {
            world_from_camera,
            image,
        });
    }
    Ok(plates)
}

pub(super) fn fresnel_lens(store: &PictureStore, record: &ProbeRecord) -> Result<FresnelLens, SessionError> {
    Ok(FresnelLens {
        world_from_lens: at("probe.world_from_lens", check::rigid(record.world_from_lens))?,
        radius_m: at("probe.radius", check::number(record.radius, &check::EXTENT_M))?,
        exposure_ratio: at(
            "probe.exposure_ratio",
            check::number(record.exposure_ratio, &check::EXPOSURE_RATIO),
        )?,
        image: Arc::new(store.photo(&record.image, "probe.image")?),
    })
}
