//! The camera sinks to the table's height and below it.

use glam::DVec3;

use super::{evenly, findings, photographed};
use crate::photographer::World;
use crate::photographer::world::{camera, toward};
use crate::stability::exact::small;
use crate::stability::lab::{Lab, Label};
use crate::stability::row::Findings;

const TARGET: DVec3 = DVec3::new(0.02, 0.04, 0.01);

/// Above the table the toy is shown moved; from below it the frame passes through. The world is
/// photographed for each step.
pub(super) fn edge_on(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    let worlds = evenly(40, 20.0, -9.25).map(|elevation_deg| {
        let world = small();
        let direction = toward(elevation_deg, 10.0);
        // On a circle around the point of the table below the target, so that 0 degrees is edge-on.
        let eye = DVec3::new(TARGET.x, 0.0, TARGET.z) + 0.44 * direction;
        let camera = camera(world.size_px, eye, TARGET);
        (elevation_deg, World { camera, ..world })
    });
    let moments = photographed(lab, worlds)?;
    findings(label, "camera's elevation, degrees", moments, None)
}
