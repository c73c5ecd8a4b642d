//! The pattern of a place where a wrong plate and the toy hide it.
//!
//! Tiles, checks and planks repeat: what is hidden looks like what is some way off in the receiver's
//! plane. The ways are those over which the surroundings of the hidden part repeat themselves best.
//!
//! Source: He and Sun 2012 (statistics of patch offsets for image completion), for offsets in a
//! plane, and with one patch around all that is hidden.

use glam::{DMat3, DVec2, DVec3, IVec2};

use super::feet::pixel_of;
use super::memory::Memory;
use super::shade::logarithm;
use super::sight::Sight;
use super::toy::covered;
use crate::picture::{Color, Level, Mask, index_in, places, square};
use crate::raster::Coverage;
use crate::receivers::{SeenReceiver, receiver_at};
use app_scene::things::Mark;

/// Distance in pixels from the toy up to which `validity` takes no receiver's colour from the frame.
const BEHIND_PX: i32 = 9;
/// Width of the surroundings in pixels of a picture of 640, and their distance from what is marked in pixels.
const AROUND_PX: f64 = 14.0;
const BESIDE_PX: i32 = 2;
/// Largest and smallest offsets, and the step of the search, in pixels of a picture of 640.
const FARTHEST_PX: DVec2 = DVec2::new(110.0, 80.0);
const NEAREST_PX: f64 = 6.0;
const STEP_PX: f64 = 2.0;
const OF_SIDE_PX: f64 = 640.0;
/// Last step of the search from the best offsets in pixels.
const FINEST_PX: f64 = 0.25;
/// Number of surrounding pixels that are compared at each offset, and in the end; the second ones
/// are then checked against as many others.
const N_COMPARED: [usize; 2] = [150, 300];
/// Part of these that must have a counterpart.
const LEAST_SEEN: f64 = 0.5;
/// Number of offsets whose surroundings are searched, and of those that are used.
const N_BEST: usize = 24;
/// Part of the deviation from a smooth place that the best offset may leave. It leaves .07 to .28 on
/// tiles, gingham and planks, .76 where planks end, and .92 on terrazzo, whose spots do not repeat.
const REPEATS: f64 = 0.5;
/// Number of coefficients of light that changes evenly, and so of the pixels that it needs.
const N_TERMS: usize = 3;

/// A place with a wrong plate.
struct Hidden<'a> {
    level: &'a Level,
    receivers: &'a [SeenReceiver],
    coverage: &'a Coverage,
    marks: &'a [Mark],
}

/// A surrounding pixel: its place in the plane, and the logarithm of its colour.
#[derive(Clone, Copy)]
struct Around {
    place_m: DVec2,
    color: Color,
}

/// An offset in the plane, and the mean squared difference of the surroundings over it.
#[derive(Clone, Copy)]
struct Offset {
    px: DVec2,
    differs: f64,
}

impl Sight<'_> {
    /// Marks of the largest level, with the place's pattern behind the toy, and the memory of this picture
    /// with both. The pattern depends on the marks and the plate alone: it is searched anew only if the
    /// marks or the view have changed.
    pub(super) fn with_pattern(&self, marks: Vec<Mark>, now: Memory) -> (Vec<Mark>, Memory) {
        if !marks.contains(&Mark::WrongPlate) {
            return (marks, now);
        }
        let known = self.memory.and_then(|before| before.completed(&now, &marks));
        let completed = known.map(<[Mark]>::to_vec);
        let completed = completed.or_else(|| self.completed(&marks));
        let completed = completed.unwrap_or_else(|| marks.clone());
        let memory = now.with_pattern(marks, completed.clone());
        (completed, memory)
    }

    fn completed(&self, marks: &[Mark]) -> Option<Vec<Mark>> {
        let level = self.pyramid.level(0);
        let hidden = Hidden {
            level,
            receivers: self.receivers,
            coverage: &covered(self, level),
            marks,
        };
        hidden.completed()
    }
}

impl Hidden<'_> {
    /// The marks with the pattern in place of a wrong plate behind the toy, or with an even colour if the place has none;
    /// `None` if nothing is hidden, or too little is seen around it.
    fn completed(&self) -> Option<Vec<Mark>> {
        let size_px = self.level.frame.size_px;
        let mut hidden = Mask::new(size_px);
        for at in places(size_px) {
            if self.mark(at) == Some(Mark::WrongPlate) && self.coverage.is_near(at, BEHIND_PX) {
                hidden.mark(at);
            }
        }
        let of_hidden: Vec<IVec2> = places(size_px)
            .filter(|at| hidden.has(*at) && self.place_m(at.as_dvec2() + 0.5).is_some())
            .collect();
        if of_hidden.is_empty() {
            return None;
        }
        let middle_px =
            of_hidden.iter().map(|at| at.as_dvec2() + 0.5).sum::<DVec2>() / of_hidden.len() as f64;
        let around = self.around(&hidden);
        let [searched, checked] = [0, 1].map(|first| spread(&around, first));
        let offsets = self.offsets(middle_px, &searched).unwrap_or_default();
        let colors: Vec<(DVec2, Color)> = checked.iter().map(|one| (one.place_m, one.color)).collect();
        let smooth = even_light(&colors)?.differs;
        let left = offsets.first().and_then(|best| {
            let pairs = self.pairs(&checked, self.offset_m(middle_px, best.px)?);
            Some(
                even_light(&pairs)
                    .filter(|_| are_enough(&pairs, &checked))?
                    .differs,
            )
        });
        if left.is_none_or(|left| left >= REPEATS * REPEATS * smooth) {
            return Some(self.evenly_filled(&of_hidden, &[searched, checked].concat()));
        }
        let mut marks = self.marks.to_vec();
        let mut open = of_hidden;
        for offset in offsets {
            let Some(offset_m) = self.offset_m(middle_px, offset.px) else {
                continue;
            };
            let Some(light) = even_light(&self.pairs(&around, offset_m)) else {
                continue;
            };
            open.retain(|at| match self.light_at(*at, offset_m, &light) {
                Some(mark) => {
                    if let Some(index) = index_in(size_px, *at) {
                        marks[index] = mark;
                    }
                    false
                }
                None => true,
            });
        }
        Some(marks)
    }

    /// The marks with the surroundings' mean colour, in light that changes evenly, in place of a wrong plate behind the
    /// toy. Cells of the picture are smooth as well, but one at a red stone colours all that is hidden: with them the
    /// error of the shadow of a husky on terrazzo is 10.06, and now 9.03; that of a heron on planks 3.17, and now 2.50.
    fn evenly_filled(&self, hidden: &[IVec2], around: &[Around]) -> Vec<Mark> {
        let mut marks = self.marks.to_vec();
        let colors: Vec<(DVec2, Color)> = around.iter().map(|one| (one.place_m, one.color)).collect();
        let Some(light) = even_light(&colors) else {
            return marks;
        };
        for at in hidden {
            let mark = self.mark_of(*at, |place_m| Some(light.at(place_m)));
            if let (Some(mark), Some(index)) = (mark, index_in(self.level.frame.size_px, *at)) {
                marks[index] = mark;
            }
        }
        marks
    }

    /// The mark of a hidden pixel whose colour has some logarithm at its place.
    fn mark_of(&self, at: IVec2, color: impl Fn(DVec2) -> Option<Color>) -> Option<Mark> {
        let color = color(self.place_m(at.as_dvec2() + 0.5)?)?;
        let plate = self.level.plate.as_ref()?.get(at)?;
        Mark::completed_plate([0, 1, 2].map(|channel| color[channel].exp() / plate[channel]))
    }

    fn mark(&self, at: IVec2) -> Option<Mark> {
        Some(self.marks[index_in(self.level.frame.size_px, at)?])
    }

    /// Pixels of this picture per pixel of one whose longer side has 640.
    fn scale(&self) -> f64 {
        f64::from(self.level.frame.size_px.max_element()) / OF_SIDE_PX
    }

    /// The place in the first receiver's plane that a pixel shows; `None` if it shows another one.
    fn place_m(&self, px: DVec2) -> Option<DVec2> {
        let at = px.floor().as_ivec2();
        let (on, _) = receiver_at(self.receivers, &self.level.intrinsics, at)?;
        let plane_from_camera = self.receivers[on].plane_from_camera;
        let eye = plane_from_camera.w_axis.truncate();
        let ray = plane_from_camera.transform_vector3(self.level.intrinsics.ray(px));
        let point = eye - eye.y / ray.y * ray;
        (on == 0).then_some(DVec2::new(point.x, point.z))
    }

    fn offset_m(&self, middle_px: DVec2, offset_px: DVec2) -> Option<DVec2> {
        Some(self.place_m(middle_px + offset_px)? - self.place_m(middle_px)?)
    }

    /// The logarithm of the plate's colour at a place in the plane, if it shows the receiver.
    fn color_at(&self, place_m: DVec2) -> Option<Color> {
        let point = DVec3::new(place_m.x, 0.0, place_m.y);
        let px = pixel_of(point, self.receivers.first()?, self.level)?;
        let at = px.floor().as_ivec2();
        let is_clear = square(at, 1).all(|at| self.mark(at) == Some(Mark::None));
        self.place_m(px).filter(|_| is_clear)?;
        let color = logarithm(self.level.plate.as_ref()?.sample(px)?);
        (!color[0].is_nan()).then_some(color)
    }

    /// The surroundings of what is hidden.
    fn around(&self, hidden: &Mask) -> Vec<Around> {
        let size_px = self.level.frame.size_px;
        #[allow(clippy::cast_possible_truncation, reason = "some pixels")]
        let near = hidden.grown((AROUND_PX * self.scale()).ceil() as i32);
        let is_clear =
            |at: &IVec2| near.has(*at) && square(*at, BESIDE_PX).all(|at| self.mark(at) == Some(Mark::None));
        let of = |at: IVec2| {
            let place_m = self.place_m(at.as_dvec2() + 0.5)?;
            let color = logarithm(self.level.plate.as_ref()?.get(at)?);
            (!color[0].is_nan()).then_some(Around { place_m, color })
        };
        places(size_px).filter(is_clear).filter_map(of).collect()
    }

    /// The colours of surrounding pixels over those at an offset, and their places.
    fn pairs(&self, around: &[Around], offset_m: DVec2) -> Vec<(DVec2, Color)> {
        let pairs = around.iter().filter_map(|one| {
            let other = self.color_at(one.place_m + offset_m)?;
            Some((
                one.place_m,
                [0, 1, 2].map(|channel| one.color[channel] - other[channel]),
            ))
        });
        pairs.collect()
    }

    /// How much the surroundings differ over an offset; `None` if too few have a counterpart.
    fn differs(&self, around: &[Around], middle_px: DVec2, px: DVec2) -> Option<Offset> {
        if px.abs().max_element() < NEAREST_PX * self.scale() {
            return None;
        }
        let pairs = self.pairs(around, self.offset_m(middle_px, px)?);
        let differs = variance(&pairs).filter(|_| are_enough(&pairs, around))?;
        Some(Offset { px, differs })
    }

    /// The best offsets, from the best one.
    fn offsets(&self, middle_px: DVec2, around: &[Around]) -> Option<Vec<Offset>> {
        let scale = self.scale();
        let few: Vec<Around> = around
            .iter()
            .copied()
            .step_by(N_COMPARED[1] / N_COMPARED[0])
            .collect();
        let reach = (FARTHEST_PX / STEP_PX).floor().as_ivec2();
        let grid = places(2 * reach + 1).map(|at| STEP_PX * scale * (at - reach).as_dvec2());
        let mut rough: Vec<Offset> = grid.filter_map(|px| self.differs(&few, middle_px, px)).collect();
        rough.sort_by(|a, b| a.differs.total_cmp(&b.differs));
        let mut best: Vec<Offset> = Vec::new();
        for offset in rough.into_iter().take(N_BEST) {
            let Some(mut offset) = self.differs(around, middle_px, offset.px) else {
                continue;
            };
            let mut step_px = 0.5 * STEP_PX * scale;
            while step_px >= FINEST_PX {
                let steps = [DVec2::X, DVec2::NEG_X, DVec2::Y, DVec2::NEG_Y];
                let nearby = steps.map(|step| self.differs(around, middle_px, offset.px + step_px * step));
                let nearest = nearby
                    .into_iter()
                    .flatten()
                    .min_by(|a, b| a.differs.total_cmp(&b.differs));
                match nearest.filter(|nearest| nearest.differs < offset.differs) {
                    Some(nearest) => offset = nearest,
                    None => step_px *= 0.5,
                }
            }
            let is_new = |known: &Offset| known.px.distance(offset.px) > STEP_PX * scale;
            if best.iter().all(is_new) {
                best.push(offset);
            }
        }
        best.sort_by(|a, b| a.differs.total_cmp(&b.differs));
        Some(best).filter(|best| !best.is_empty())
    }

    /// The mark of a hidden pixel that looks like the place at an offset in some light.
    fn light_at(&self, at: IVec2, offset_m: DVec2, light: &Light) -> Option<Mark> {
        self.mark_of(at, |place_m| {
            let [color, lighter] = [self.color_at(place_m + offset_m)?, light.at(place_m)];
            Some([0, 1, 2].map(|channel| color[channel] + lighter[channel]))
        })
    }
}

/// As many of the surroundings as are compared, from all sides; two that begin at 0 and 1 have none in common.
fn spread(around: &[Around], first: usize) -> Vec<Around> {
    let step = (around.len() / (2 * N_COMPARED[1])).max(1);
    around
        .iter()
        .copied()
        .skip(first * step)
        .step_by(2 * step)
        .collect()
}

/// Whether enough of the surroundings have a counterpart.
fn are_enough(pairs: &[(DVec2, Color)], around: &[Around]) -> bool {
    pairs.len() as f64 >= LEAST_SEEN * around.len() as f64
}

/// Mean squared difference of colours from their mean.
fn variance(pairs: &[(DVec2, Color)]) -> Option<f64> {
    let n = pairs.len() as f64;
    let mut sum = 0.0;
    for channel in 0..3 {
        let values = pairs.iter().map(|(_, color)| f64::from(color[channel]));
        let mean = values.clone().sum::<f64>() / n;
        sum += values.map(|value| (value - mean).powi(2)).sum::<f64>() / n;
    }
    (n > 0.0).then_some(sum)
}

/// Logarithm of light that changes evenly along the plane.
struct Light {
    /// Coefficients of 1 and of both directions from the origin, for each channel.
    channels: [DVec3; 3],
    origin_m: DVec2,
    /// What it leaves, as a mean square.
    differs: f64,
}

impl Light {
    #[allow(clippy::cast_possible_truncation, reason = "a logarithm of light")]
    fn at(&self, place_m: DVec2) -> Color {
        let terms = (place_m - self.origin_m).extend(1.0);
        self.channels.map(|channel| channel.dot(terms) as f32)
    }
}

/// The even light that explains logarithms of colours best; `None` if their places are too few.
fn even_light(pairs: &[(DVec2, Color)]) -> Option<Light> {
    if pairs.len() < N_TERMS {
        return None;
    }
    let n = pairs.len() as f64;
    let origin_m = pairs.iter().map(|(place_m, _)| *place_m).sum::<DVec2>() / n;
    let mut square = DMat3::ZERO;
    let mut sums = [DVec3::ZERO; 3];
    for (place_m, color) in pairs {
        let terms = (*place_m - origin_m).extend(1.0);
        square += DMat3::from_cols(terms.x * terms, terms.y * terms, terms.z * terms);
        for channel in 0..3 {
            sums[channel] += f64::from(color[channel]) * terms;
        }
    }
    let solved = square.inverse();
    let mut light = Light {
        channels: sums.map(|sum| solved * sum),
        origin_m,
        differs: 0.0,
    };
    for (place_m, color) in pairs {
        let expected = light.at(*place_m);
        let squares = [0, 1, 2].map(|channel| f64::from(color[channel] - expected[channel]).powi(2));
        light.differs += squares.iter().sum::<f64>() / n;
    }
    light.differs.is_finite().then_some(light)
}
