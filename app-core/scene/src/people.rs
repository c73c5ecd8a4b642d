//! Masks of the people in camera pictures.

use std::sync::Arc;

use glam::{DVec2, DVec3, IVec2, UVec2};

use crate::disjoint::DisjointSets;
use crate::scene::Camera;
use crate::things::{Mark, Things};

/// Code from which on a pixel shows a person.
const PERSON: u8 = 128;
/// Share of the toy's inner pixels that a person before it must cover: masks of a person behind it
/// reach over its outline alone.
const LEAST_COVERED: f64 = 0.02;
/// Largest number of marks along a pixel of the mask: outlines are smoother than its pixels.
const MOST_FINER: u32 = 2;

/// The pixels of a camera's picture that show people, in a picture of its own resolution that shows
/// what the camera's picture shows.
#[derive(Clone, Debug)]
pub struct People {
    size_px: UVec2,
    /// 255 on a person, 0 elsewhere.
    codes: Arc<[u8]>,
}

impl People {
    /// A mask, rows from the top, 255 on a person and 0 elsewhere; `None` if its number of pixels is
    /// wrong, or 0.
    #[must_use]
    pub fn new(size_px: UVec2, codes: impl Into<Arc<[u8]>>) -> Option<Self> {
        let codes = codes.into();
        let n_pixels = u64::from(size_px.x) * u64::from(size_px.y);
        (codes.len() as u64 == n_pixels && n_pixels > 0).then_some(Self { size_px, codes })
    }

    /// Width and height in pixels.
    #[must_use]
    pub fn size_px(&self) -> UVec2 {
        self.size_px
    }

    /// The code of each pixel, rows from the top.
    #[must_use]
    pub fn codes(&self) -> &[u8] {
        &self.codes
    }

    /// Whether it shows anybody.
    #[must_use]
    pub fn has_any(&self) -> bool {
        self.codes.iter().any(|code| *code >= PERSON)
    }

    /// Whether both share their memory.
    #[must_use]
    pub fn is(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.codes, &other.codes)
    }

    /// Whether a place shows a person: `place` is in parts of the picture, from (0, 0) at its top
    /// left to (1, 1). Between the centres of pixels the codes are interpolated.
    #[must_use]
    pub fn is_person(&self, place: DVec2) -> bool {
        let last = self.size_px.as_ivec2() - 1;
        let at = place * self.size_px.as_dvec2() - 0.5;
        let corner = at.floor();
        let [right, down] = (at - corner).to_array();
        #[allow(clippy::cast_possible_truncation, reason = "clamped to the mask")]
        let code = |x: i32, y: i32| {
            let at = (corner.as_ivec2() + IVec2::new(x, y))
                .clamp(IVec2::ZERO, last)
                .as_uvec2();
            f64::from(self.codes[(at.y * self.size_px.x + at.x) as usize])
        };
        let rows = [0, 1].map(|y| (1.0 - right) * code(0, y) + right * code(1, y));
        (1.0 - down) * rows[0] + down * rows[1] >= f64::from(PERSON)
    }
}

/// Triangles of a toy in the world.
pub struct ToyInWorld<'a> {
    /// Its corners.
    pub positions: &'a [DVec3],
    /// Three indices of corners for each triangle.
    pub indices: &'a [u32],
}

impl People {
    /// Marks of the people in a picture of a size, in a finer picture than the mask, whose camera
    /// sees the toy at its place. A person that covers a part of the toy is before it, and so is
    /// everything that is connected with that part; others are beside it. `None` without anybody.
    #[must_use]
    pub fn things(&self, camera: &Camera, picture_px: UVec2, toy: &ToyInWorld<'_>) -> Option<Things> {
        if !self.has_any() || picture_px.min_element() == 0 {
            return None;
        }
        let (groups, are_before) = self.before(&self.inner(camera, picture_px, toy));
        let finer = (picture_px / self.size_px).min_element().clamp(1, MOST_FINER);
        let size_px = finer * self.size_px;
        let mark = |at: UVec2| {
            let place = (at.as_dvec2() + 0.5) / size_px.as_dvec2();
            if !self.is_person(place) {
                return Mark::None;
            }
            let of_mask = (at / finer).as_ivec2();
            // Between two pixels, one of which is a person's.
            let near = [
                [0, 0],
                [1, 0],
                [0, 1],
                [-1, 0],
                [0, -1],
                [1, 1],
                [-1, 1],
                [1, -1],
                [-1, -1],
            ];
            let group = near.into_iter().find_map(|[x, y]| {
                let index = self.index(of_mask + IVec2::new(x, y))?;
                (self.codes[index] >= PERSON).then(|| groups[index])
            });
            match group {
                Some(group) if are_before[group] => Mark::BeforeToy,
                _ => Mark::Thing,
            }
        };
        let pixels = (0..size_px.y).flat_map(|y| (0..size_px.x).map(move |x| UVec2::new(x, y)));
        let scale = f64::from(size_px.x) / f64::from(picture_px.x);
        let camera = Camera {
            intrinsics: camera.intrinsics.scaled(scale),
            ..*camera
        };
        Things::new(size_px, pixels.map(mark).collect::<Vec<_>>(), camera)
    }

    /// The group of connected pixels of each pixel of a person, and for each group whether it
    /// covers the inside of the toy.
    fn before(&self, inner: &[bool]) -> (Vec<usize>, Vec<bool>) {
        let n_pixels = self.codes.len();
        let mut sets = DisjointSets::new(n_pixels);
        let is_person = |index: usize| self.codes[index] >= PERSON;
        let width = self.size_px.x as usize;
        for index in (0..n_pixels).filter(|index| is_person(*index)) {
            let left = (index % width > 0).then(|| index - 1);
            let above = index.checked_sub(width);
            let touching = left.into_iter().chain(above).filter(|other| is_person(*other));
            touching.for_each(|other| sets.join(index, other));
        }
        let groups: Vec<usize> = (0..n_pixels).map(|index| sets.first(index)).collect();
        let mut n_covered = vec![0_u32; n_pixels];
        for index in (0..n_pixels).filter(|index| inner[*index] && is_person(*index)) {
            n_covered[groups[index]] += 1;
        }
        let least = LEAST_COVERED * inner.iter().filter(|is_inner| **is_inner).count() as f64;
        let are_before = n_covered.into_iter().map(|n| n > 0 && f64::from(n) >= least);
        (groups, are_before.collect())
    }

    /// Pixels of the mask that show the toy, as all pixels around them do.
    fn inner(&self, camera: &Camera, picture_px: UVec2, toy: &ToyInWorld<'_>) -> Vec<bool> {
        let scale = self.size_px.as_dvec2() / picture_px.as_dvec2();
        let camera_from_world = camera.world_from_camera.inverse();
        let corner = |point: &DVec3| {
            let at = camera
                .intrinsics
                .pixel_of(camera_from_world.transform_point3(*point))?;
            Some(scale * at)
        };
        let corners: Vec<Option<DVec2>> = toy.positions.iter().map(corner).collect();
        let mut shown = vec![false; self.codes.len()];
        for triangle in toy.indices.chunks_exact(3) {
            let corner = |index: u32| corners.get(index as usize).copied().flatten();
            if let [Some(a), Some(b), Some(c)] = [0, 1, 2].map(|of| corner(triangle[of])) {
                self.fill([a, b, c], &mut shown);
            }
        }
        let is_shown = |at: IVec2| self.index(at).is_some_and(|index| shown[index]);
        let around = |at: IVec2| (-1..=1).flat_map(move |y| (-1..=1).map(move |x| at + IVec2::new(x, y)));
        let [width, height] = self.size_px.as_ivec2().to_array();
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| IVec2::new(x, y)));
        pixels.map(|at| around(at).all(is_shown)).collect()
    }

    /// Marks the pixels whose centres are in a triangle.
    fn fill(&self, [a, b, c]: [DVec2; 3], shown: &mut [bool]) {
        let last = self.size_px.as_dvec2() - 1.0;
        let low = (a.min(b).min(c) - 0.5).ceil().clamp(DVec2::ZERO, last + 1.0);
        let high = (a.max(b).max(c) - 0.5).floor().clamp(-DVec2::ONE, last);
        #[allow(clippy::cast_possible_truncation, reason = "clamped to the mask")]
        let [low, high] = [low, high].map(|at| at.as_ivec2());
        for y in low.y..=high.y {
            for x in low.x..=high.x {
                let at = IVec2::new(x, y);
                let centre = at.as_dvec2() + 0.5;
                let sides = [[a, b], [b, c], [c, a]].map(|[from, to]| (to - from).perp_dot(centre - from));
                let is_inside =
                    sides.iter().all(|side| *side >= 0.0) || sides.iter().all(|side| *side <= 0.0);
                if let Some(index) = self.index(at).filter(|_| is_inside) {
                    shown[index] = true;
                }
            }
        }
    }

    fn index(&self, at: IVec2) -> Option<usize> {
        let size_px = self.size_px.as_ivec2();
        let is_in = at.cmpge(IVec2::ZERO).all() && at.cmplt(size_px).all();
        is_in.then(|| (at.y * size_px.x + at.x) as usize)
    }
}
