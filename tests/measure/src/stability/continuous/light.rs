//! Lights that move around, nearer and farther, and grow.

use glam::DVec3;

use super::{Moment, evenly, findings, moment, photographed};
use crate::photographer::world::toward;
use crate::photographer::{Lamp, Photos, Shot, ToyFile, World};
use crate::stability::exact::small;
use crate::stability::lab::{Lab, Label};
use crate::stability::row::{Bound, Findings};

const TWO_CODES: Bound = Bound {
    limit: 2.0,
    unit: "codes",
    meaning: "largest difference of a colour in a step of 0.2 mm",
};
/// Centre of the toy, from which a light's distance is measured.
const MIDDLE: DVec3 = DVec3::new(0.0, 0.05, 0.0);
/// Radius of a sphere around the toy in all its poses.
const REACH_M: f64 = 0.11;
const AZIMUTH_DEG: f64 = 35.0;

fn lit(lamp: Lamp) -> World {
    small().lit_by(vec![lamp])
}

/// A directional light from overhead to below the table; the world is photographed for each step.
pub(super) fn elevation(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    let worlds = evenly(40, 90.0, -7.5).map(|elevation_deg| {
        let sun = Lamp::sun(toward(elevation_deg, AZIMUTH_DEG), 0.01, 0.75);
        (elevation_deg, lit(sun))
    });
    let moments = photographed(lab, worlds)?;
    findings(label, "elevation, degrees", moments, None)
}

/// A bulb of one angle and brightness, 5 cm to 1,000 km from the toy; the world is photographed for each step.
pub(super) fn distance(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    let worlds = evenly(32, 0.05f64.log10(), 6.0).map(|power| {
        let distance_m = REACH_M + 10f64.powf(power);
        let position = MIDDLE + distance_m * toward(50.0, AZIMUTH_DEG);
        let bulb = Lamp::bulb(position, 0.02 * distance_m, 0.75 * distance_m * distance_m);
        (power, lit(bulb))
    });
    let moments = photographed(lab, worlds)?;
    findings(
        label,
        "decimal logarithm of the distance in metres",
        moments,
        None,
    )
}

fn bulb_at_a_metre(radius_m: f64) -> Lamp {
    Lamp::bulb(toward(50.0, AZIMUTH_DEG), radius_m, 0.75)
}

/// From a point light on, in steps of 0.2 mm; the world is photographed for each step.
pub(super) fn small_radius(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    let from_a_point =
        evenly(16, 3.0, 0.0).map(|radius_mm| (radius_mm, lit(bulb_at_a_metre(1e-3 * radius_mm))));
    let worlds = lab.some_of(from_a_point, 3);
    let moments = photographed(lab, worlds)?;
    findings(label, "radius, mm", moments, Some(TWO_CODES))
}

/// Up to an angular radius of 30 degrees; the world is photographed for each step.
pub(super) fn large_radius(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    let worlds = evenly(31, 0.0, 30.0).map(|half_deg| {
        let sine = half_deg.to_radians().sin();
        (half_deg, lit(bulb_at_a_metre(sine)))
    });
    let moments = photographed(lab, worlds)?;
    findings(label, "half angle, degrees", moments, None)
}

/// The photographs have a bulb of 1 mm; the listed radius grows from 0.
pub(super) fn told_radius(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    let world = lit(bulb_at_a_metre(1e-3));
    let photos = Photos::of(&world);
    let mut moments: Vec<Moment> = Vec::new();
    for radius_mm in evenly(16, 0.0, 3.0) {
        let told = lit(bulb_at_a_metre(1e-3 * radius_mm));
        let shot = Shot::described(&told, &photos, &ToyFile::default())?;
        moments.push(Moment {
            truth: None,
            ..moment(lab, radius_mm, &shot)?
        });
    }
    findings(label, "radius told, mm", moments, Some(TWO_CODES))
}
