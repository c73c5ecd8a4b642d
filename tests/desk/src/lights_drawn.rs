//! Pictures of the estimated lights, beside a report.

use app_core::alignment::LightSearch;
use app_core::frame::FrameInput;
use app_core::preset::Preset;
use app_core::scene::Image;

use crate::false_color::LIGHTS;
use crate::gizmo;
use crate::gizmo::Gizmo;
use crate::lens::through_lens;
use crate::page::pictures::Pictures;
use crate::replay::{ReplayError, Shot};
use crate::report::MapEntry;

/// Name of the picture of the search directions.
pub(crate) const HEMISPHERE: &str = "hemisphere";

/// Draws the lights of an aligned frame over its photograph, and, if lights were found without a
/// list, the score of each direction.
pub(crate) fn write_lights(
    pictures: &mut Pictures,
    shot: &Shot<'_>,
    preset: Preset,
) -> Result<Vec<MapEntry>, ReplayError> {
    let Shot {
        session,
        alignments,
        index,
        ..
    } = *shot;
    let Some(aligned) = alignments.of(index) else {
        return Ok(Vec::new());
    };
    let scene = session.scene();
    let recorded = FrameInput::from(&shot.frame);
    let input = shot.input(preset);
    let given = Gizmo::listed(scene, &recorded);
    let found = Gizmo::aligned(scene, &input, &aligned.alignment.report);
    let mut picture = Image::clone(&shot.frame.image);
    gizmo::rays(&mut picture, (scene, &recorded), &given, gizmo::GIVEN);
    gizmo::rays(&mut picture, (scene, &input), &found, gizmo::FOUND);
    let picture = through_lens(session, index, picture)?;
    let mut entries = vec![MapEntry {
        name: LIGHTS.name,
        file: pictures.write(LIGHTS.name, index, picture.into())?,
    }];
    let discovered = &aligned.alignment.report.discovered;
    let before = index.checked_sub(1).and_then(|before| alignments.of(before));
    let is_known = before.is_some_and(|before| before.alignment.report.discovered == *discovered);
    if discovered.is_empty() || is_known {
        return Ok(entries);
    }
    let failed = |reason| ReplayError::Align {
        index,
        reason: Box::new(reason),
    };
    if let Some(search) = LightSearch::of(&alignments.scene(scene), &input).map_err(failed)? {
        let listed = given.iter().map(|light| (*light, gizmo::GIVEN));
        let found = found.iter().map(|light| (*light, gizmo::FOUND));
        let lights: Vec<_> = listed.chain(found).collect();
        let picture = gizmo::hemisphere(&search, &input.camera, &lights);
        entries.push(MapEntry {
            name: HEMISPHERE,
            file: pictures.write(HEMISPHERE, index, picture.into())?,
        });
    }
    Ok(entries)
}
