//! The light probe, from `capture.json`.

use std::sync::Arc;

use glam::DMat4;

use super::PictureStore;
use super::field::{at, each, in_index};
use super::place::camera;
use super::record::{FacetRecord, ProbeKind, ProbePictureRecord, ProbeRecord};
use crate::SessionWarning;
use crate::error::SessionError;
use app_scene::scene::check;
use app_scene::scene::{
    Camera, Facet, FacetSlope, FieldError, Image, Intrinsics, MAX_FACETS, MAX_FURTHER_PICTURES, Probe,
    ProbePicture, ProbeShape,
};

/// Limit for the pixels of all pictures of a probe together, which stay in memory: 256 MiB.
const MAX_PROBE_PIXELS: u64 = 1 << 26;

/// Reads the probe with its pictures; `first` is the first frame's camera.
pub(super) fn probe(
    store: &PictureStore,
    record: &ProbeRecord,
    (intrinsics, first): (&Intrinsics, &Camera),
    warnings: &mut Vec<SessionWarning>,
) -> Result<Probe, SessionError> {
    let shape = shape(record)?;
    let world_from_probe = at("probe.world_from_lens", check::rigid(record.world_from_lens))?;
    let exposure_ratio = at(
        "probe.exposure_ratio",
        check::number(record.exposure_ratio, &check::EXPOSURE_RATIO),
    )?;
    let world_from_camera = record
        .world_from_camera
        .unwrap_or_else(|| first.world_from_camera.to_cols_array());
    let own = (record.intrinsics.as_ref(), &first.intrinsics);
    at(
        "probe.pictures",
        check::at_most(record.pictures.len(), MAX_FURTHER_PICTURES),
    )?;
    let n_pixels = store.size.n_pixels() * (record.pictures.len() as u64 + 1);
    if n_pixels > MAX_PROBE_PIXELS {
        let error = FieldError::TooManyPixels {
            max_pixels: MAX_PROBE_PIXELS,
        };
        return Err(in_index("probe.pictures", error));
    }
    let main_camera = camera("probe", world_from_camera, own)?;
    let main = ProbePicture {
        camera: main_camera,
        image: photo(store, (&record.image, "probe.image"), &main_camera, warnings)?,
        world_from_probe,
        exposure_ratio,
    };
    let further = each("probe.pictures", &record.pictures, |field, record| {
        let usual = (&world_from_probe, exposure_ratio);
        picture(store, (field, record), (intrinsics, usual), warnings)
    })?;
    Ok(Probe {
        shape,
        pictures: [vec![main], further].concat(),
    })
}

fn shape(record: &ProbeRecord) -> Result<ProbeShape, SessionError> {
    let length = |name: &str, value| at(&format!("probe.{name}"), check::number(value, &check::EXTENT_M));
    let radius_m = length("radius", record.radius)?;
    let focal_m = record
        .focal_length
        .map(|focal_m| length("focal_length", focal_m))
        .transpose()?;
    at("probe.facets", check::at_most(record.facets.len(), MAX_FACETS))?;
    let facets = each("probe.facets", &record.facets, facet)?;
    for (index, pair) in facets.windows(2).enumerate() {
        if pair[1].at <= pair[0].at {
            return Err(in_index(
                &format!("probe.facets[{}].at", index + 1),
                FieldError::Unordered,
            ));
        }
    }
    Ok(match record.kind {
        ProbeKind::MirrorBall => ProbeShape::MirrorBall { radius_m },
        ProbeKind::FresnelLens => ProbeShape::FresnelLens {
            radius_m,
            slope: match focal_m {
                _ if !facets.is_empty() => FacetSlope::Table(facets),
                Some(focal_m) => FacetSlope::Focal { focal_m },
                None => FacetSlope::Hemisphere,
            },
        },
    })
}

fn facet(field: &str, record: &FacetRecord) -> Result<Facet, SessionError> {
    let number = |name: &str, value, range| at(&format!("{field}.{name}"), check::number(value, range));
    Ok(Facet {
        at: number("at", record.at, &check::OF_RADIUS)?,
        slope_rad: number("slope_deg", record.slope_deg, &check::SLOPE_DEG)?.to_radians(),
    })
}

fn picture(
    store: &PictureStore,
    (field, record): (&str, &ProbePictureRecord),
    (intrinsics, (world_from_probe, exposure_ratio)): (&Intrinsics, (&DMat4, f64)),
    warnings: &mut Vec<SessionWarning>,
) -> Result<ProbePicture, SessionError> {
    let camera = camera(
        field,
        record.world_from_camera,
        (record.intrinsics.as_ref(), intrinsics),
    )?;
    Ok(ProbePicture {
        camera,
        world_from_probe: match record.world_from_lens {
            Some(matrix) => at(&format!("{field}.world_from_lens"), check::rigid(matrix))?,
            None => *world_from_probe,
        },
        exposure_ratio: match record.exposure_ratio {
            Some(ratio) => at(
                &format!("{field}.exposure_ratio"),
                check::number(ratio, &check::EXPOSURE_RATIO),
            )?,
            None => exposure_ratio,
        },
        image: photo(
            store,
            (&record.image, &format!("{field}.image")),
            &camera,
            warnings,
        )?,
    })
}

fn photo(
    store: &PictureStore,
    (file, field): (&str, &str),
    camera: &Camera,
    warnings: &mut Vec<SessionWarning>,
) -> Result<Arc<Image>, SessionError> {
    let photo = store.photo(file, field, &camera.intrinsics)?;
    warnings.extend(photo.warning(file, field));
    Ok(photo.image)
}
