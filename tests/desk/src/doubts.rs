//! Values that can be read, but contradict one another or the pictures: lengths in millimetres, a
//! bulb around the toy, a wrong exposure, frames without the plates' colours. They are reported,
//! and nothing is changed.

use app_core::scene::{Camera, Image, Light, Plate, Scene};
use app_core::session::SessionFrame;
use app_scene::geometry::color::linear_of_codes;
use app_scene::words::Number;
use glam::{DMat4, DVec3};

/// Plausible distances of a camera from the toy, in metres.
const CAMERA_M: [f64; 2] = [0.03, 30.0];
/// Other units than the metre, and their length in metres.
const UNITS: [(&str, f64); 2] = [("millimetres", 0.001), ("centimetres", 0.01)];
/// Usual distance of a camera, in sizes of the toy.
const USUAL_SIZES: f64 = 5.0;
/// Number of sampled pixels along a row and along a column.
const N_SAMPLES: u32 = 64;
/// Codes that measure a pixel's light: neither noise nor clipped.
const TELLING: std::ops::RangeInclusive<u8> = 12..=245;
/// Allowed factor between measured light and a stated exposure: for the same place, and for a place
/// seen from elsewhere.
const SAME_PLACE: f64 = 1.5;
const OTHER_PLACE: f64 = 3.0;
/// Largest move of a camera that still sees the same place, as a fraction of its distance, and
/// largest turn, as a cosine.
const MOVED: f64 = 0.02;
const TURNED: f64 = 0.9998;
/// Differences between channels, in codes: the largest of a grey picture, and the mean of one with
/// colours.
const GREY: u8 = 2;
const COLOURED: f64 = 6.0;

/// Doubts about the session as a whole.
pub(crate) fn of_scene(scene: &Scene) -> Vec<String> {
    let Some([centre, _]) = centre_and_diagonal(scene, &scene.world_from_object) else {
        return Vec::new();
    };
    let around = |(index, light): (usize, &Light)| match light {
        Light::Sphere {
            position_in_world,
            radius_m,
        } if position_in_world.distance(centre) <= *radius_m => Some(format!(
            "lights[{index}].radius: the bulb's radius is {} m, but its middle is only {} m from the toy, which would be inside it: both are in metres, and a radius is half the bulb's width",
            Number(*radius_m),
            Number(position_in_world.distance(centre))
        )),
        _ => None,
    };
    scene.lights.iter().enumerate().filter_map(around).collect()
}

/// Doubts about one frame.
pub(crate) fn of_frame(scene: &Scene, index: usize, frame: &SessionFrame) -> Vec<String> {
    let about = [
        distance(scene, frame).map(|what| ("world_from_camera", what)),
        exposure(scene, frame).map(|what| ("exposure", what)),
        colours(scene, frame).map(|what| ("image", what)),
    ];
    let about = about.into_iter().flatten();
    about
        .map(|(key, what)| format!("frames[{index}].{key}: {what}"))
        .collect()
}

/// A camera much too far away or too close, and the unit that would make its lengths right.
fn distance(scene: &Scene, frame: &SessionFrame) -> Option<String> {
    let [centre, diagonal] = centre_and_diagonal(scene, &frame.world_from_object)?;
    let diagonal_m = diagonal.length();
    let camera_m = frame.camera.world_from_camera.w_axis.truncate().distance(centre);
    if (CAMERA_M[0]..=CAMERA_M[1]).contains(&camera_m) {
        return None;
    }
    let far = |factor: f64| (factor * camera_m / (USUAL_SIZES * diagonal_m)).ln().abs();
    let unit = UNITS
        .into_iter()
        .filter(|(_, factor)| (CAMERA_M[0]..=CAMERA_M[1]).contains(&(factor * camera_m)))
        .min_by(|a, b| far(a.1).total_cmp(&far(b.1)));
    let way_out = unit.map_or(String::new(), |(name, factor)| {
        format!(": if it is given in {name}, multiply its last column by {factor}, and in plates as well")
    });
    Some(format!(
        "the camera is {} m from the toy, which is {} m from corner to corner, and lengths are in metres{way_out}",
        Number(camera_m),
        Number(diagonal_m)
    ))
}

/// A stated exposure that the picture's brightness contradicts.
fn exposure(scene: &Scene, frame: &SessionFrame) -> Option<String> {
    if frame.exposure == 1.0 {
        return None;
    }
    let distance_m = frame
        .camera
        .world_from_camera
        .w_axis
        .distance(scene.world_from_object.w_axis);
    let is_same = |plate: &&Plate| is_same_place(&plate.camera, &frame.camera, distance_m);
    let plate = scene.plates.iter().find(is_same);
    let (ratio, allowed) = match plate {
        Some(plate) => (ratio_of_pixels(&frame.image, &plate.image)?, SAME_PLACE),
        None => {
            let plate = scene.plates.first()?;
            (mean_light(&frame.image)? / mean_light(&plate.image)?, OTHER_PLACE)
        }
    };
    let contradiction = ratio / frame.exposure;
    let is_contradicted = contradiction.ln().abs() > allowed.ln();
    is_contradicted.then(|| {
        format!(
            "an exposure of {} is stated, but the picture is {} times as bright as the plate: leave exposure out, or state that of this picture over the plate's",
            Number(frame.exposure),
            Number((100.0 * ratio).round() / 100.0)
        )
    })
}

fn is_same_place(a: &Camera, b: &Camera, distance_m: f64) -> bool {
    let moved_m = a.world_from_camera.w_axis.distance(b.world_from_camera.w_axis);
    let turned = a.world_from_camera.z_axis.dot(b.world_from_camera.z_axis);
    a.intrinsics == b.intrinsics && moved_m <= MOVED * distance_m && turned >= TURNED
}

/// A grey frame of a place whose plate has colours.
fn colours(scene: &Scene, frame: &SessionFrame) -> Option<String> {
    let spread = |image: &Image| samples(image).map(spread_of).collect::<Vec<_>>();
    if spread(&frame.image).into_iter().any(|spread| spread > GREY) {
        return None;
    }
    let has_colours = |plate: &Plate| {
        let spreads = spread(&plate.image);
        let sum: f64 = spreads.iter().map(|spread| f64::from(*spread)).sum();
        sum > COLOURED * spreads.len() as f64
    };
    scene.plates.iter().any(has_colours).then(|| {
        "the picture is grey, but a plate has colours: give both from the same camera, with the same processing"
            .to_owned()
    })
}

fn spread_of([r, g, b]: [u8; 3]) -> u8 {
    r.max(g).max(b) - r.min(g).min(b)
}

/// Sample pixels all over a picture.
fn samples(image: &Image) -> impl Iterator<Item = [u8; 3]> {
    let [width, height] = [image.width_px, image.height_px];
    let along = |n: u32| (0..n).step_by((n / N_SAMPLES).max(1) as usize);
    let places = along(height).flat_map(move |y| along(width).map(move |x| (y * width + x) as usize));
    places.filter_map(|at| image.rgba8.get(4 * at..4 * at + 3)?.try_into().ok())
}

/// Median ratio of the pixels' green to that of another picture.
fn ratio_of_pixels(image: &Image, other: &Image) -> Option<f64> {
    let linear = linear_of_codes();
    let both = samples(image).zip(samples(other));
    let telling = both.filter(|(a, b)| TELLING.contains(&a[1]) && TELLING.contains(&b[1]));
    let light = |code: u8| f64::from(linear[usize::from(code)]);
    let mut ratios: Vec<f64> = telling.map(|(a, b)| light(a[1]) / light(b[1])).collect();
    ratios.sort_by(f64::total_cmp);
    ratios.get(ratios.len() / 2).copied()
}

/// Mean green of a picture in linear light; `None` for a black one.
fn mean_light(image: &Image) -> Option<f64> {
    let linear = linear_of_codes();
    let light: Vec<f64> = samples(image)
        .map(|[_, g, _]| linear[usize::from(g)].into())
        .collect();
    let mean = light.iter().sum::<f64>() / light.len() as f64;
    (mean > 0.0).then_some(mean)
}

/// Centre and diagonal of the toy's box in the world.
fn centre_and_diagonal(scene: &Scene, world_from_object: &DMat4) -> Option<[DVec3; 2]> {
    let bounds = scene.toy.bounds_of_pose(&scene.physical_pose).ok()?;
    let ends = [bounds.min, bounds.max].map(|end| world_from_object.transform_point3(end.as_dvec3()));
    let [first, last] = ends;
    Some([0.5 * (first + last), last - first])
}
