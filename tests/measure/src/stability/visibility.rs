//! Visibility of a light past the real toy: the core's map compared with exact rays, and the
//! rounding error of 32 bits.

use app_pipeline::geometry::rect::PixelRect;
use app_pipeline::readback::FloatMap;
use glam::{DMat4, DVec2, DVec3};

use super::case::{Case, Scope};
use super::exact::{small, small_photos};
use super::lab::{Lab, Label};
use super::row::{Bound, Findings};
use crate::photographer::world::toward;
use crate::photographer::{Lamp, Place, Shot, Shown, ToyFile, World};
use reference::occlusion::{Occluder, sample_position};
use reference::real::Real;
use reference::visibility::exact_visibility;

/// Mean error over a grid of pixels, of 255: one light point of 64 in every second pixel.
const MEAN_ERROR: Bound = Bound {
    limit: 2.0,
    unit: "1/255",
    meaning: "mean error of the real shadow's visibility",
};
/// Number of compared pixels along each side of the region.
const N_ACROSS: u32 = 24;
/// Number of ray origins in a pixel.
const N_POSITIONS: usize = 16;
/// Number of rays from each of them.
const N_RAYS: usize = 64;
const GROUP: &str = "visibility";

/// The group's cases.
pub(super) const CASES: &[Case] = &[
    Case::new(GROUP, "visibility-bulb", Scope::Quick, bulb),
    Case::new(GROUP, "visibility-elevation", Scope::Whole, elevation),
    Case::new(GROUP, "visibility-distance", Scope::Whole, distance),
    Case::new(GROUP, "visibility-radius", Scope::Whole, radius),
    Case::new(GROUP, "visibility-scale", Scope::Whole, scale),
];

fn bulb(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    compare(lab, label, [("bulb at 1 m".to_owned(), small())])
}

fn elevation(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    let worlds = [85.0, 60.0, 40.0, 20.0, 10.0, 5.0].map(|elevation_deg| {
        let sun = Lamp::sun(toward(elevation_deg, 200.0), 0.01, 0.75);
        (format!("{elevation_deg} deg"), small().lit_by(vec![sun]))
    });
    compare(lab, label, worlds)
}

fn distance(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    let worlds = [0.2, 0.5, 1.0, 10.0, 1e2, 1e3, 1e4, 1e5, 1e6].map(|metres: f64| {
        let bulb = Lamp::bulb(metres * toward(50.0, 200.0), 0.02 * metres, metres * metres);
        (format!("{metres} m"), small().lit_by(vec![bulb]))
    });
    compare(lab, label, worlds)
}

fn radius(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    let worlds = [0.0, 1e-3, 0.01, 0.05, 0.2, 0.5].map(|radius_m: f64| {
        let bulb = Lamp::bulb(toward(50.0, 200.0), radius_m, 0.75);
        (format!("{radius_m} m at 1 m"), small().lit_by(vec![bulb]))
    });
    compare(lab, label, worlds)
}

fn scale(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    let worlds = [1e-3, 0.1, 10.0, 1e3].map(|factor| (format!("x {factor}"), small().scaled(factor)));
    compare(lab, label, worlds)
}

fn compare(
    lab: &mut Lab,
    label: Label,
    worlds: impl IntoIterator<Item = (String, World)>,
) -> anyhow::Result<Findings> {
    // The content of the pictures does not affect visibility.
    let photos = small_photos();
    let mut rows = Vec::new();
    for (parameter, world) in worlds {
        let shot = Shot::described(&world, photos, &ToyFile::default())?;
        let (region, map) = match lab.visibility(&shot) {
            Ok(Some(found)) => found,
            Ok(None) => {
                let mut row = label.row(parameter, MEAN_ERROR, f64::NAN);
                row.note = "the frame passes through".to_owned();
                rows.push(row);
                continue;
            }
            Err(error) => {
                rows.push(label.refused(parameter, MEAN_ERROR, error)?);
                continue;
            }
        };
        let points = pixels(&world, &region, &map);
        let of_core: Vec<f64> = points.iter().map(|point| point.of_core).collect();
        let wide = exact::<f64>(&world, &points);
        let narrow = exact::<f32>(&world, &points);
        let photographed = photographed(&world, &points);
        let mut row = label.row(parameter, MEAN_ERROR, mean_error(&of_core, &wide));
        row.cpu_f32 = Some(mean_error(&narrow, &wide));
        row.cpu_f64 = Some(mean_error(&photographed, &wide));
        row.note = format!(
            "{} pixels; CPU columns: 32 bits, and the photographer's rays",
            wide.len()
        );
        rows.push(row);
    }
    Ok(rows.into())
}

/// A pixel that shows the table.
struct Pixel {
    of_core: f64,
    /// Its points of the table, (x, z).
    in_plane: Vec<DVec2>,
}

fn pixels(world: &World, region: &PixelRect, map: &FloatMap) -> Vec<Pixel> {
    let size = region.size_px;
    let grid = (0..N_ACROSS).flat_map(|y| (0..N_ACROSS).map(move |x| (x, y)));
    let pixel = |(x, y): (u32, u32)| {
        let (x, y) = (x * size.x / N_ACROSS, y * size.y / N_ACROSS);
        let corner = region.origin_px.as_dvec2() + DVec2::new(f64::from(x), f64::from(y));
        let seen = (0..N_POSITIONS).map(|i| table_point(world, corner + sample_position(i, N_POSITIONS)));
        let texel = map.texels.get((y * map.width + x) as usize)?;
        Some(Pixel {
            of_core: f64::from(texel[0]),
            in_plane: seen.collect::<Option<Vec<_>>>()?,
        })
    };
    grid.filter_map(pixel).collect()
}

fn table_point(world: &World, image_px: DVec2) -> Option<DVec2> {
    let k = &world.camera.intrinsics;
    let in_camera = DVec3::new(
        (image_px.x - k.cx_px) / k.fx_px,
        (k.cy_px - image_px.y) / k.fy_px,
        -1.0,
    );
    let table = &world.grounds[0];
    let plane_from_camera = table.world_from_plane.inverse() * world.camera.world_from_camera;
    let origin = plane_from_camera.w_axis.truncate();
    let direction = plane_from_camera.transform_vector3(in_camera);
    let distance = -origin.y / direction.y;
    let at = origin + distance * direction;
    let in_plane = DVec2::new(at.x, at.z);
    let is_on_it = distance > 0.0 && in_plane.abs().cmple(table.half_extent_m).all();
    is_on_it.then_some(in_plane)
}

fn exact<R: Real>(world: &World, pixels: &[Pixel]) -> Vec<f64> {
    let in_plane = world.clone().moved(&world.grounds[0].world_from_plane.inverse());
    let occluder = occluder::<R>(&in_plane);
    let light = in_plane.lamps[0].light;
    let at = |point: &DVec2| exact_visibility(&occluder, *point, &light, N_RAYS);
    pixels
        .iter()
        .map(|pixel| mean(pixel.in_plane.iter().map(at)))
        .collect()
}

fn photographed(world: &World, pixels: &[Pixel]) -> Vec<f64> {
    let place = Place::new(world, Shown::Rest);
    let at = |point: &DVec2| place.visibility_on(0, *point, 0);
    pixels
        .iter()
        .map(|pixel| mean(pixel.in_plane.iter().map(at)))
        .collect()
}

/// The toy in its physical pose.
fn occluder<R: Real>(world: &World) -> Occluder<R> {
    let (mut positions, mut indices) = (Vec::new(), Vec::new());
    for part in &world.parts {
        let world_from_part: DMat4 = world.world_from_object * part.rest.object_from_part();
        let mesh = part.shape.mesh();
        #[allow(clippy::cast_possible_truncation, reason = "a toy here has few corners")]
        let first = positions.len() as u32;
        positions.extend(
            mesh.positions
                .iter()
                .map(|at| world_from_part.transform_point3(*at)),
        );
        indices.extend(mesh.indices.iter().map(|index| first + index));
    }
    Occluder::new(&positions, &indices)
}

fn mean_error(a: &[f64], b: &[f64]) -> f64 {
    255.0 * mean(a.iter().zip(b).map(|(a, b)| (a - b).abs()))
}

/// NaN for an empty list.
fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let n = values.len() as f64;
    values.sum::<f64>() / n
}
