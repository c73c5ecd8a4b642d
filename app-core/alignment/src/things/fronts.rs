//! Where things before the toy end: parts of the toy nearer to the camera than a side, or above a top, are in front
//! of them.
//!
//! What stands on the receiver is before the toy if its foot is, whether or not it hides a part of the resting
//! toy: an arm may be moved behind it.

use std::collections::{BTreeMap, BTreeSet};

use glam::{DVec3, IVec2, Vec3Swizzles};

use super::ends::Ends;
use super::feet::{Bodies, Feet};
use super::found::Found;
use super::sight::Sight;
use crate::median::{median, part_of};
use crate::picture::{Level, places};
use crate::receivers::SeenReceiver;
use app_scene::things::{Front, Mark};

/// Least height of a standing thing in the picture, over its width; the least part that it fills of the rectangle of
/// its upright columns, those of at least a part of its height; and the least part of it that is in these. Eighteen
/// posts and cups have 1.13 to 7.9 and .87 to .98; a stick that lies almost along the view has 3.4 and .73, a book
/// and a flat box .75 and .94, and .82 and .83.
const TALL: f64 = 1.05;
const FILLED: f64 = 0.85;
const OF_TALLEST: f64 = 0.5;
const LEAST_WITHIN: f64 = 0.5;
/// Most pixels of other things before the toy, over all of the standing one.
const SPECKS: f64 = 0.01;
/// Part of a thing's feet that are farther from the camera than its side: below others, its shadow may be taken for it.
const BEHIND_SIDE: f64 = 0.25;
/// Least height of a top, over that of its outline as if it were upright: a wide thing may be thin.
const LEAST_OF_OUTLINE: f64 = 0.5;

impl Sight<'_> {
    /// The ends of things before the toy, of which these are the bodies and the marks in the largest level.
    pub(super) fn ends(&self, level: &Level, found: &Found<'_>, (bodies, marks): (&Bodies, &[Mark])) -> Ends {
        let Some(table) = self.receivers.first() else {
            return Ends::default();
        };
        let low = self.front_of_low(level, found, (bodies.size_px, marks));
        let low = low.map(|low| Ends {
            fronts: vec![low],
            before: Vec::new(),
        });
        let ends = low.or_else(|| self.ends_of_standing((level, table), found, (bodies, marks)));
        let ends = ends.unwrap_or_default();
        let table_from_world = self.plane_from_world(table);
        let in_world = ends.fronts.iter().map(|front| front.in_space(&table_from_world));
        Ends {
            fronts: in_world.collect(),
            ..ends
        }
    }

    /// Those of the only thing that is before the toy, if it stands on the receiver, in the receiver's space.
    fn ends_of_standing(
        &self,
        (level, table): (&Level, &SeenReceiver),
        found: &Found<'_>,
        (bodies, marks): (&Bodies, &[Mark]),
    ) -> Option<Ends> {
        let feet = Feet::of(bodies, self.pyramid.level(0), table);
        let eye = table.plane_from_camera.w_axis.truncate();
        let toy = self.shape.points.iter().sum::<DVec3>() / self.shape.points.len() as f64;
        let toy = table.plane_from_camera.transform_point3(toy);
        let n_things = bodies.thing.iter().flatten().max()? + 1;
        let standing = (0..n_things).filter_map(|thing| {
            let columns = upright_columns(bodies, &feet, thing)?;
            let tops = feet.tops(thing, |column| columns.contains(&column));
            let fronts = fronts_of(&tops, eye)?;
            (fronts[0].distance_m(toy) < 0.0).then_some((thing, fronts))
        });
        let standing: Vec<_> = standing.collect();
        let [(thing, fronts)] = standing[..] else {
            return None;
        };
        let per_px = self.per_px(level);
        let is_other = |(at, mark): (IVec2, &Mark)| {
            *mark == Mark::BeforeToy && found.thing_at((at.as_dvec2() + 0.5) * per_px) != Some(thing)
        };
        let n_others = places(bodies.size_px)
            .zip(marks)
            .filter(|pixel| is_other(*pixel))
            .count();
        let of_thing = bodies.thing.iter().enumerate();
        let of_thing = of_thing.filter_map(|(index, of)| (*of == Some(thing)).then_some(index));
        let before: Vec<usize> = of_thing.collect();
        (n_others as f64 <= SPECKS * before.len() as f64).then(|| Ends {
            fronts: fronts.to_vec(),
            before,
        })
    }
}

/// The side and the top of a thing, of which these are points along its upper outline as if it were upright. It is
/// taken to be as deep as it is wide: as much higher as the far edge of its top seems to be, it is not.
fn fronts_of(tops: &[DVec3], eye: DVec3) -> Option<[Front; 2]> {
    let middle = (tops.iter().sum::<DVec3>() / tops.len() as f64).with_y(0.0);
    let towards = (eye - middle).with_y(0.0).try_normalize()?;
    let mut nearness_m: Vec<f64> = tops.iter().map(|top| towards.dot(*top)).collect();
    nearness_m.sort_unstable_by(f64::total_cmp);
    let side_m = *nearness_m.get(part_of(nearness_m.len(), BEHIND_SIDE))?;
    let aside = tops.iter().map(|top| towards.xz().perp_dot(top.xz()));
    let (least, most) = aside.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), aside| {
        (least.min(aside), most.max(aside))
    });
    let outline_m = median(tops.iter().map(|top| top.y), f64::total_cmp)?;
    let slope = (eye.y - outline_m) / (towards.dot(eye) - side_m);
    let top_m = (outline_m - slope * (most - least)).max(LEAST_OF_OUTLINE * outline_m);
    Some([
        Front::at(side_m * towards, towards)?,
        Front::at(top_m * DVec3::Y, DVec3::Y)?,
    ])
}

/// The columns across the upright direction in which a thing stands; `None` if it is not tall, its sides are not
/// upright, or the picture does not show all of it. Other columns may show its shadow.
fn upright_columns(bodies: &Bodies, feet: &Feet<'_>, thing: usize) -> Option<BTreeSet<i32>> {
    let (mut heights, mut cut) = (BTreeMap::<i32, f64>::new(), Vec::new());
    let last = bodies.size_px - 1;
    for at in places(bodies.size_px).filter(|at| bodies.of(*at) == Some(thing)) {
        let column = feet.column(at, thing)?;
        *heights.entry(column).or_default() += 1.0;
        if at.cmpeq(IVec2::ZERO).any() || at.cmpeq(last).any() {
            cut.push(column);
        }
    }
    let all: f64 = heights.values().sum();
    let tallest = heights.values().copied().fold(0.0, f64::max);
    heights.retain(|_, height| *height >= OF_TALLEST * tallest);
    let (width, shown) = (heights.len() as f64, heights.values().sum::<f64>());
    if cut.iter().any(|column| heights.contains_key(column)) {
        return None;
    }
    let is_upright =
        tallest >= TALL * width && shown >= FILLED * width * tallest && shown >= LEAST_WITHIN * all;
    (is_upright && width > 0.0).then(|| heights.into_keys().collect())
}
