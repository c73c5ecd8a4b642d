//! A plate without its wrong part, for a second look at the toy.
//!
//! What the plate shows there misleads about the toy's outline, but the frame does not: beside the toy it
//! shows the place itself, and behind the toy the place around it continues. Without any plate there, too
//! little of a toy that overlaps with what the plate shows would be left.

use glam::IVec2;

use super::exposure::gains_at;
use super::interpolate::interpolate;
use super::shade::logarithm;
use crate::picture::{Color, Level, Mask, Picture, UNKNOWN, places};
use crate::raster::Coverage;
use app_scene::things::Mark;

/// Distance in pixels from the toy's given place within which the frame may show the toy.
const OF_TOY_PX: i32 = 4;

/// The level with the frame, at the plate's exposure, in place of wrong parts of the plate, and a smooth
/// estimate where the toy may be. The marks are those of the level's pixels.
pub(crate) fn with_mended_plate(level: &Level, coverage: &Coverage, marks: &[Mark]) -> Level {
    let size_px = level.frame.size_px;
    let Some(plate) = &level.plate else {
        return level.clone();
    };
    let mut wrong = Mask::new(size_px);
    for (at, mark) in places(size_px).zip(marks) {
        if is_of_wrong_plate(*mark) {
            wrong.mark(at);
        }
    }
    let is_of_toy = |at: IVec2| coverage.is_near(at, OF_TOY_PX);
    let seen = |at: &IVec2| !wrong.has(*at) && !is_of_toy(*at);
    let gains = gains_at(places(size_px).filter(seen), [&level.frame, plate]).unwrap_or([1.0; 3]);
    let known = |at: IVec2| match wrong.has(at) {
        true if is_of_toy(at) => None,
        true => {
            let color = level.frame.get(at)?;
            Some([0, 1, 2].map(|channel| color[channel] / gains[channel]))
        }
        false => plate.get(at),
    };
    let mut colors: Vec<Color> = places(size_px)
        .map(|at| known(at).map_or(UNKNOWN, logarithm))
        .collect();
    let hidden: Vec<IVec2> = places(size_px)
        .filter(|at| wrong.has(*at) && is_of_toy(*at))
        .collect();
    let unmeasured = vec![UNKNOWN; colors.len()];
    interpolate(&mut colors, (&unmeasured, size_px), &hidden);
    let mended = places(size_px)
        .zip(colors)
        .map(|(at, color)| match wrong.has(at) {
            true => color.map(f32::exp),
            false => plate.get(at).unwrap_or(UNKNOWN),
        });
    Level {
        plate: Some(Picture::of(size_px, mended.collect())),
        ..level.clone()
    }
}

/// Whether the plate does not show the place at a mark.
pub(crate) fn is_of_wrong_plate(mark: Mark) -> bool {
    matches!(mark, Mark::WrongPlate | Mark::CompletedPlate { .. })
}
