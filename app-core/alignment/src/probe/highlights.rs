//! Bright regions of a probe's picture.

use glam::{DVec2, IVec2, UVec2};

use super::error::ProbeError;
use super::surface::Surface;
use crate::median::median;
use app_scene::disjoint::DisjointSets;
use app_scene::geometry::color::linear_of_codes;
use app_scene::scene::Image;

/// Fraction of white above which all channels of a bright pixel are. Source: Casas et al. 2019,
/// equation 2 and the text below.
const BRIGHT: f64 = 0.9;
/// Width of the halo of light that a lens spreads around a bright region, in pixels.
const HALO_PX: i32 = 3;
/// Width of the background around the halo.
const AROUND_PX: i32 = 5;
/// Number of the probe's pixels that a search needs.
const LEAST_PIXELS: usize = 100;

/// A bright region.
#[derive(Clone, Debug)]
pub(super) struct Highlight {
    /// Its bright pixels, in the order of rows.
    pub(super) bright: Vec<UVec2>,
    /// The bright pixels and the halo, with linear light minus the background's: white is 1.
    pub(super) weighted: Vec<(UVec2, f64)>,
    /// Whether it touches pixels outside of the probe.
    pub(super) is_at_rim: bool,
}

/// Centre of a pixel.
pub(super) fn middle_px(pixel: UVec2) -> DVec2 {
    pixel.as_dvec2() + 0.5
}

/// Finds the bright regions, in the order of their first rows.
pub(super) fn find(image: &Image, surface: &Surface<'_>) -> Result<Vec<Highlight>, ProbeError> {
    let window = Window::around(image, surface).ok_or(ProbeError::OutOfView)?;
    let shown: Vec<bool> = window.pixels().map(|at| surface.is_at(middle_px(at))).collect();
    match shown.iter().filter(|shown| **shown).count() {
        0 => return Err(ProbeError::OutOfView),
        n_pixels if n_pixels < LEAST_PIXELS => return Err(ProbeError::TooSmall { n_pixels }),
        _ => {}
    }
    let is_bright = |at: UVec2| {
        let codes = rgb(image, at);
        codes.iter().all(|code| f64::from(*code) > BRIGHT * 255.0)
    };
    let bright: Vec<bool> = window
        .pixels()
        .zip(&shown)
        .map(|(at, shown)| *shown && is_bright(at))
        .collect();
    let linear = linear_of_codes();
    let light = |at: UVec2| {
        let sum: f64 = rgb(image, at)
            .iter()
            .map(|code| f64::from(linear[usize::from(*code)]))
            .sum();
        sum / 3.0
    };
    let mut owners = window.regions(&bright);
    let n_regions = owners.iter().flatten().max().map_or(0, |last| last + 1);
    let mut rings = vec![vec![Vec::new(); n_regions]; 3];
    window.collect(&owners, &mut rings[0]);
    for (ring, until_px) in [(1, HALO_PX), (2, AROUND_PX)] {
        let from_px = if ring == 1 { 0 } else { HALO_PX };
        for _ in from_px..until_px {
            let grown = window.grown(&owners, &shown);
            for (index, (before, after)) in owners.iter().zip(&grown).enumerate() {
                if let (None, Some(region)) = (before, after) {
                    rings[ring][*region].push(window.pixel(index));
                }
            }
            owners = grown;
        }
    }
    let highlights = (0..n_regions).map(|region| {
        let [bright, halo, around] = [0, 1, 2].map(|ring| &rings[ring][region]);
        let background = median(around.iter().map(|at| light(*at)), f64::total_cmp).unwrap_or(0.0);
        let weighted = bright
            .iter()
            .chain(halo)
            .map(|at| (*at, (light(*at) - background).max(0.0)));
        Highlight {
            bright: bright.clone(),
            weighted: weighted.collect(),
            is_at_rim: bright.iter().any(|at| window.is_at_rim(*at, &shown)),
        }
    });
    Ok(highlights.collect())
}

fn rgb(image: &Image, at: UVec2) -> [u8; 3] {
    let first = 4 * (at.y as usize * image.width_px as usize + at.x as usize);
    match image.rgba8.get(first..first + 3) {
        Some(&[r, g, b]) => [r, g, b],
        _ => [0; 3],
    }
}

/// The rectangle of a picture that can show a probe.
#[derive(Clone, Copy, Debug)]
struct Window {
    first: UVec2,
    size: UVec2,
}

impl Window {
    /// `None` if the probe is outside of the picture.
    fn around(image: &Image, surface: &Surface<'_>) -> Option<Self> {
        let all = UVec2::new(image.width_px, image.height_px);
        let (mut min, mut max) = (DVec2::ZERO, all.as_dvec2());
        if let Some(corners) = surface.corners_px() {
            let [least, most] = [
                corners.into_iter().fold(DVec2::INFINITY, DVec2::min),
                corners.into_iter().fold(DVec2::NEG_INFINITY, DVec2::max),
            ];
            min = min.max(least.floor());
            max = max.min(most.ceil());
        }
        (min.cmplt(max).all()).then(|| Self {
            first: min.as_uvec2(),
            size: max.as_uvec2() - min.as_uvec2(),
        })
    }

    fn n_pixels(&self) -> usize {
        self.size.x as usize * self.size.y as usize
    }

    fn pixels(&self) -> impl Iterator<Item = UVec2> {
        let window = *self;
        (0..self.n_pixels()).map(move |index| window.pixel(index))
    }

    fn pixel(&self, index: usize) -> UVec2 {
        let width = self.size.x.max(1) as usize;
        #[allow(clippy::cast_possible_truncation, reason = "less than a picture's sides")]
        let at = UVec2::new((index % width) as u32, (index / width) as u32);
        self.first + at
    }

    /// Index of a neighbour within the window.
    fn neighbour(&self, index: usize, step: IVec2) -> Option<usize> {
        let at = (self.pixel(index) - self.first).as_ivec2() + step;
        let is_in = at.cmpge(IVec2::ZERO).all() && at.cmplt(self.size.as_ivec2()).all();
        let at = at.as_uvec2();
        is_in.then(|| at.y as usize * self.size.x as usize + at.x as usize)
    }

    /// Region of each bright pixel: pixels that touch by a side or a corner belong to one region.
    fn regions(&self, bright: &[bool]) -> Vec<Option<usize>> {
        let mut sets = DisjointSets::new(self.n_pixels());
        for (index, _) in bright.iter().enumerate().filter(|(_, bright)| **bright) {
            for step in [IVec2::X, IVec2::Y, IVec2::ONE, IVec2::new(-1, 1)] {
                if let Some(other) = self.neighbour(index, step).filter(|other| bright[*other]) {
                    sets.join(index, other);
                }
            }
        }
        // The first pixel of a region is its name.
        let mut regions = vec![None; self.n_pixels()];
        let mut n_regions = 0;
        for (index, _) in bright.iter().enumerate().filter(|(_, bright)| **bright) {
            let first = sets.first(index);
            if first == index {
                regions[index] = Some(n_regions);
                n_regions += 1;
            } else {
                regions[index] = regions[first];
            }
        }
        regions
    }

    /// Regions with the adjacent pixels of the probe that are in none; of several regions the first
    /// one gets a pixel.
    fn grown(&self, owners: &[Option<usize>], shown: &[bool]) -> Vec<Option<usize>> {
        let around = |index: usize| {
            let steps = (-1..=1).flat_map(|y| (-1..=1).map(move |x| IVec2::new(x, y)));
            steps
                .filter_map(|step| owners[self.neighbour(index, step)?])
                .min()
        };
        let grown = owners.iter().zip(shown).enumerate();
        grown
            .map(|(index, (owner, shown))| match owner {
                None if *shown => around(index),
                owner => *owner,
            })
            .collect()
    }

    fn collect(&self, owners: &[Option<usize>], regions: &mut [Vec<UVec2>]) {
        for (index, owner) in owners.iter().enumerate() {
            if let Some(region) = owner {
                regions[*region].push(self.pixel(index));
            }
        }
    }

    /// Whether a pixel touches one outside of the probe, or the window's border.
    fn is_at_rim(&self, at: UVec2, shown: &[bool]) -> bool {
        let at = at - self.first;
        let index = at.y as usize * self.size.x as usize + at.x as usize;
        [IVec2::X, IVec2::NEG_X, IVec2::Y, IVec2::NEG_Y]
            .into_iter()
            .any(|step| self.neighbour(index, step).is_none_or(|other| !shown[other]))
    }
}
