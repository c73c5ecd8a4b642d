//! Estimates the extent of a thing's plane: the smallest rectangle around its visible part, with its
//! sides on edges of the plate.

use glam::{DMat4, DVec2, DVec3, Vec3Swizzles};

use super::edges::{Side, clearer_m, contrast, moved_m};
use super::groups::groups;
use super::grown::Grown;
use super::seeds::Colored;
use crate::measured_points::MeasuredPoints;
use crate::median::part_of;
use crate::picture::{Level, index_in, places};
use crate::receivers::SeenReceiver;

/// Smallest cosine between a level plane and the receiver.
pub(super) const LEVEL: f64 = 0.9998;
/// Number of trial angles of the rectangle over a quarter turn, and of finer ones on either side of
/// the best. On steps of 2 degrees alone, the ends of a book's sides were 1.5 mm off.
const N_TURNS: i32 = 45;
const N_FINER: i32 = 20;
/// Share of the points that may lie beyond each side.
const BEYOND: f64 = 0.005;
/// Least part of the rectangle's pixels that show the thing.
const FILLED: f64 = 0.6;
/// Least pixels for a rectangle.
const LEAST_PIXELS: usize = 100;
/// If the lowest side of a tilted plane is at most this part as high as the highest one, the plane
/// continues down to the receiver.
const LOW: f64 = 0.4;
/// Largest move of a side inward, over its distance from the middle.
const MOST_INWARD: f64 = 0.8;

/// Distance in metres from which on an edge above a face is taken for a line of a pattern. It is 4 mm at
/// a uniform book whose side was taken for its top, and 16 mm or more at checked books.
const PATTERN_M: f64 = 0.006;

/// Largest deviation in metres of points that bound the rectangle themselves; the largest distance
/// of one from the plane in deviations, of which the least is in metres, too.
/// Points of 1 mm bound a ramp of 35 mm as exact ones do; a LiDAR's, of 5 mm, reach down to the
/// table below a book.
const EXACT_M: f64 = 2e-3;
const MOST_OFF: f64 = 2.5;
const LEAST_OFF_M: f64 = 5e-4;
/// Least part of connected points that shows the thing; another surface of its height shows none.
const OF_THING: f64 = 0.3;

/// A thing in a level, on a receiver.
#[derive(Clone, Copy)]
pub(super) struct Outline<'a> {
    pub(super) level: &'a Level,
    pub(super) table: &'a SeenReceiver,
    pub(super) grown: &'a Grown,
    pub(super) thing: usize,
    pub(super) colored: Colored,
    /// Measured points of the view, if a search is about their plane, and whether exact ones also
    /// bound the rectangle.
    pub(super) points: Option<&'a MeasuredPoints>,
    pub(super) is_bounded_by_points: bool,
}

/// A rectangle on a plane.
pub(super) struct Extent {
    pub(super) middle: DVec2,
    pub(super) turn_rad: f64,
    pub(super) half_m: DVec2,
}

impl Outline<'_> {
    /// Places of the thing's upper side on a plane, in metres. For a level plane these are the places
    /// directly above the thing's footprint, which excludes its visible sides.
    fn places(&self, plane_from_camera: &DMat4, is_level: bool) -> Vec<DVec2> {
        let endless = SeenReceiver::of_size(*plane_from_camera, DVec2::INFINITY);
        let k = &self.level.intrinsics;
        let table_from_camera = self.table.plane_from_camera;
        let camera_from_table = table_from_camera.inverse();
        let is_over_thing = |point: DVec3| {
            let below = table_from_camera.transform_point3(point) * DVec3::new(1.0, 0.0, 1.0);
            let seen = k.pixel_of(camera_from_table.transform_point3(below));
            seen.is_some_and(|at| self.grown.of_pixel(at.floor().as_ivec2()) == Some(self.thing))
        };
        let pixels = places(self.level.frame.size_px);
        let pixels = pixels.filter(|at| self.grown.of_pixel(*at) == Some(self.thing));
        let points = pixels.filter_map(|at| endless.point_at(k, at));
        points
            .filter(|point| !is_level || is_over_thing(*point))
            .map(|point| plane_from_camera.transform_point3(point).xz())
            .collect()
    }

    /// Places on a plane that exact points show, around those that show the thing; `None` without
    /// such points.
    fn measured_places(&self, plane_from_camera: &DMat4) -> Option<Vec<DVec2>> {
        let is_used = |points: &&MeasuredPoints| self.is_bounded_by_points && is_exact(points);
        let points = self.points.filter(is_used)?;
        let deviation_m = points.deviation_m?;
        let most_m = MOST_OFF * deviation_m.max(LEAST_OFF_M);
        let mut is_on = vec![false; (points.size_px.x * points.size_px.y) as usize];
        let mut places = vec![DVec2::ZERO; is_on.len()];
        let mut is_of_thing = is_on.clone();
        for (point, at) in points.points.iter().zip(&points.places) {
            let Some(index) = index_in(points.size_px, *at) else {
                continue;
            };
            let place = plane_from_camera.transform_point3(*point);
            let seen = self.level.intrinsics.pixel_of(*point);
            // Closer to the receiver, planes cannot be told apart.
            let height_m = self.table.plane_from_camera.transform_point3(*point).y;
            is_on[index] = place.y.abs() < most_m && height_m > 2.0 * most_m;
            places[index] = place.xz();
            is_of_thing[index] =
                seen.is_some_and(|at| self.grown.of_pixel(at.floor().as_ivec2()) == Some(self.thing));
        }
        let groups = groups(points.size_px, |index| is_on[index]).into_iter();
        let of_thing = groups.filter(|group| {
            let n_thing = group.iter().filter(|index| is_of_thing[**index]).count();
            n_thing as f64 >= OF_THING * group.len() as f64
        });
        Some(of_thing.flatten().map(|index| places[index]).collect())
    }

    /// The part of a plane's visible pixels that shows the thing.
    fn filled(&self, plane: &SeenReceiver) -> f64 {
        let pixels = places(self.level.frame.size_px);
        let seen = pixels.filter(|at| plane.point_at(&self.level.intrinsics, *at).is_some());
        let (mut n, mut n_thing) = (0, 0);
        for at in seen {
            n += 1;
            n_thing += usize::from(self.grown.of_pixel(at) == Some(self.thing));
        }
        n_thing as f64 / f64::from(n.max(1))
    }
}

/// Whether points show where a thing ends.
pub(super) fn is_exact(points: &MeasuredPoints) -> bool {
    points
        .deviation_m
        .is_some_and(|deviation_m| deviation_m <= EXACT_M)
}

impl Extent {
    /// `None` if too little is visible, or the thing is no rectangle.
    pub(super) fn of(outline: &Outline<'_>, plane_from_camera: &DMat4, is_level: bool) -> Option<Self> {
        let is_enough = |places: &Vec<DVec2>| places.len() >= LEAST_PIXELS;
        let measured = outline.measured_places(plane_from_camera).filter(is_enough);
        let is_measured = measured.is_some();
        let shown = || Some(outline.places(plane_from_camera, is_level)).filter(is_enough);
        let places = measured.or_else(shown)?;
        let smallest = Self::smallest(&places)?;
        let foot = (!is_measured).then_some(outline.table);
        let on_edges = |extent: &Self| extent.on_edges(outline.level, plane_from_camera, foot);
        // The first round corrects the lengths that the second one looks along.
        let smallest = on_edges(&on_edges(&smallest));
        // How far a thing in the place's own colours reaches is not seen.
        let is_filled =
            outline.colored == Colored::Alike || outline.filled(&smallest.plane(plane_from_camera)) >= FILLED;
        let whole = if is_level {
            smallest
        } else {
            smallest.down_to(outline.table, plane_from_camera)
        };
        is_filled.then_some(whole)
    }

    /// The smallest rectangle around places.
    pub(super) fn smallest(places: &[DVec2]) -> Option<Self> {
        let turned = |turn_rad| {
            let extent = Self::turned(places, turn_rad);
            (extent.half_m.element_product(), extent)
        };
        Self::of_least(N_FINER, turned).map(|(_, extent)| extent)
    }

    /// The rectangle of the least cost: among turns over a quarter, then among this many finer ones on
    /// either side of the best. A function gives cost and rectangle of each.
    pub(super) fn of_least(n_finer: i32, turned: impl Fn(f64) -> (f64, Self)) -> Option<(f64, Self)> {
        const STEP_RAD: f64 = std::f64::consts::FRAC_PI_2 / N_TURNS as f64;
        let among =
            |turns: &mut dyn Iterator<Item = f64>| turns.map(&turned).min_by(|a, b| a.0.total_cmp(&b.0));
        let about = among(&mut (0..N_TURNS).map(|i| STEP_RAD * f64::from(i)))?
            .1
            .turn_rad;
        let fine = |i: i32| about + STEP_RAD * f64::from(i) / f64::from(n_finer);
        among(&mut (-n_finer..=n_finer).map(fine))
    }

    /// The rectangle of a receiver on a plane close to its own.
    pub(super) fn of_plane(receiver: &SeenReceiver, plane_from_camera: &DMat4) -> Self {
        let from_receiver = *plane_from_camera * receiver.plane_from_camera.inverse();
        Self {
            middle: from_receiver.w_axis.truncate().xz(),
            turn_rad: from_receiver.x_axis.truncate().xz().to_angle(),
            half_m: receiver.half_extent_m(),
        }
    }

    /// The rectangle with those sides moved that the plate shows elsewhere; `None` if it shows all
    /// sides where they are.
    pub(super) fn clearer(
        &self,
        level: &Level,
        plane_from_camera: &DMat4,
        foot: Option<&SeenReceiver>,
    ) -> Option<Self> {
        let foot_from_plane = foot.map(|foot| foot.own_from_plane(plane_from_camera));
        let moved =
            |extent: &Self| extent.moved(foot_from_plane, |side| clearer_m(side, plane_from_camera, level));
        let once = moved(self);
        let is_moved = once.half_m != self.half_m || once.middle != self.middle;
        // The first round corrects the lengths that the second one looks along.
        is_moved.then(|| moved(&once))
    }

    /// The rectangle with its sides on edges of the plate, above upright faces down to a receiver.
    fn on_edges(&self, level: &Level, plane_from_camera: &DMat4, foot: Option<&SeenReceiver>) -> Self {
        let foot_from_plane = foot.map(|foot| foot.own_from_plane(plane_from_camera));
        self.moved(foot_from_plane, |side| moved_m(side, plane_from_camera, level))
    }

    /// The rectangle with its sides on edges above upright faces, and the one with each side on the nearest
    /// edge; `None` for the latter if no side moves far, to a line of a pattern.
    pub(super) fn on_near_edges(
        &self,
        level: &Level,
        plane_from_camera: &DMat4,
        foot: &SeenReceiver,
    ) -> (Self, Option<Self>) {
        let on_edges = |foot: Option<&SeenReceiver>| self.on_edges(level, plane_from_camera, foot);
        let above_face = on_edges(Some(foot));
        let longer_m = (above_face.half_m - self.half_m).abs().max_element();
        let farthest_m = above_face.middle.distance(self.middle) + longer_m;
        let nearest = (farthest_m >= PATTERN_M).then(|| on_edges(None));
        (above_face, nearest)
    }

    /// The rectangle with its sides moved outward by some metres.
    fn moved(&self, foot_from_plane: Option<DMat4>, by_m: impl Fn(&Side) -> f64) -> Self {
        let axis = DVec2::from_angle(self.turn_rad);
        let moved_m = |outward: DVec2, out_m: f64, half_m: f64| {
            let side = Side {
                middle: self.middle + out_m * outward,
                outward,
                half_m,
                foot_from_plane,
            };
            by_m(&side).max(-MOST_INWARD * out_m)
        };
        let along = |axis: DVec2, out_m: f64, half_m: f64| {
            [axis, -axis].map(|outward| moved_m(outward, out_m, half_m))
        };
        let [right_m, left_m] = along(axis, self.half_m.x, self.half_m.y);
        let [far_m, near_m] = along(axis.perp(), self.half_m.y, self.half_m.x);
        let grown = DVec2::new(right_m + left_m, far_m + near_m);
        let moved = DVec2::new(right_m - left_m, far_m - near_m);
        Self {
            middle: self.middle + 0.5 * axis.rotate(moved),
            half_m: self.half_m + 0.5 * grown,
            ..*self
        }
    }

    /// Mean contrast of its visible sides in the plate, in logarithms of light, with the feet of the faces
    /// below them on a receiver.
    pub(super) fn contrast(&self, level: &Level, plane_from_camera: &DMat4, foot: &SeenReceiver) -> f64 {
        let foot_from_plane = foot.own_from_plane(plane_from_camera);
        let axis = DVec2::from_angle(self.turn_rad);
        let ends = [(axis, self.half_m), (axis.perp(), self.half_m.perp().abs())];
        let sides = ends.into_iter().flat_map(|(axis, half_m)| {
            [axis, -axis].map(|outward| Side {
                middle: self.middle + half_m.x * outward,
                outward,
                half_m: half_m.y,
                foot_from_plane: Some(foot_from_plane),
            })
        });
        let contrasts: Vec<f64> = sides
            .filter_map(|side| contrast(&side, plane_from_camera, level))
            .collect();
        contrasts.iter().sum::<f64>() / contrasts.len().max(1) as f64
    }

    fn turned(places: &[DVec2], turn_rad: f64) -> Self {
        let axis = DVec2::from_angle(turn_rad);
        let ends_along = |axis: DVec2| ends(places.iter().map(|place| place.dot(axis)).collect());
        let [x, z] = [axis, axis.perp()].map(ends_along);
        let [low, high] = [0, 1].map(|end| DVec2::new(x[end], z[end]));
        Self {
            middle: axis.rotate(0.5 * (low + high)),
            turn_rad,
            half_m: 0.5 * (high - low),
        }
    }

    /// Extends the low side of a plane to the receiver, if it comes close to it.
    pub(super) fn down_to(self, table: &SeenReceiver, plane_from_camera: &DMat4) -> Self {
        let axis = DVec2::from_angle(self.turn_rad);
        let table_from_plane = table.own_from_plane(plane_from_camera);
        let height_m = |at: DVec2| table_from_plane.transform_point3(DVec3::new(at.x, 0.0, at.y)).y;
        let sides = [
            (axis, self.half_m.x),
            (-axis, self.half_m.x),
            (axis.perp(), self.half_m.y),
            (-axis.perp(), self.half_m.y),
        ];
        let heights = sides.map(|(to, half_m)| height_m(self.middle + half_m * to));
        let highest = heights.into_iter().fold(0.0, f64::max);
        let lowest = (0..4)
            .min_by(|a, b| heights[*a].total_cmp(&heights[*b]))
            .unwrap_or(0);
        let (to, half_m) = sides[lowest];
        let falls = height_m(self.middle) - heights[lowest];
        if heights[lowest] > LOW * highest || heights[lowest] <= 0.0 || falls <= 0.0 {
            return self;
        }
        let longer_m = heights[lowest] * half_m / falls;
        let along_x = lowest < 2;
        Self {
            middle: self.middle + 0.5 * longer_m * to,
            half_m: self.half_m + 0.5 * longer_m * if along_x { DVec2::X } else { DVec2::Y },
            ..self
        }
    }

    /// The plane, without bounds.
    pub(super) fn plane(&self, plane_from_camera: &DMat4) -> SeenReceiver {
        let moved = DMat4::from_rotation_y(self.turn_rad)
            * DMat4::from_translation(-DVec3::new(self.middle.x, 0.0, self.middle.y));
        SeenReceiver::of_size(moved * *plane_from_camera, self.half_m)
    }

    /// Height of its centre above a receiver, in metres.
    pub(super) fn height_m(&self, plane_from_camera: &DMat4, table: &SeenReceiver) -> f64 {
        let middle = DVec3::new(self.middle.x, 0.0, self.middle.y);
        let middle = plane_from_camera.inverse().transform_point3(middle);
        table.plane_from_camera.transform_point3(middle).y
    }
}

/// The least and the largest of some values, without outliers.
fn ends(mut values: Vec<f64>) -> [f64; 2] {
    values.sort_unstable_by(f64::total_cmp);
    let beyond = part_of(values.len(), BEYOND);
    let last = values.len().saturating_sub(1 + beyond);
    [
        values.get(beyond).copied().unwrap_or(0.0),
        values.get(last).copied().unwrap_or(0.0),
    ]
}
