//! The toy sinks into the table and is lifted.

use glam::{DMat4, DVec3};

use super::{evenly, findings, photographed};
use crate::photographer::World;
use crate::stability::exact::small;
use crate::stability::lab::{Lab, Label};
use crate::stability::row::Findings;

/// Moves through contact, which is at 0; the world is photographed again for each step.
pub(super) fn height(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    let worlds = evenly(41, -20.0, 20.0).map(|height_mm| {
        let world_from_object = DMat4::from_translation(DVec3::new(0.0, 1e-3 * height_mm, 0.0));
        let world = World {
            world_from_object,
            ..small()
        };
        (height_mm, world)
    });
    let moments = photographed(lab, worlds)?;
    findings(label, "height over the table, mm", moments, None)
}
