//! Alpha of a material: its factor, its interpolated texture, and the colours of vertices.

#![expect(
    clippy::cast_possible_truncation,
    reason = "texels are counted in 64 bits and brought into the picture before they are looked up"
)]

use std::collections::HashMap;
use std::rc::Rc;

use glam::{DVec2, Vec2};

use crate::toy::material::{Material, Wrap};
use crate::toy::texture::Texture;

/// The inputs of a vertex: texture coordinates, and the alpha of its colour.
#[derive(Clone, Copy)]
pub(super) struct Corner {
    pub(super) uv: Vec2,
    pub(super) alpha: f32,
}

pub(super) struct Field<'a> {
    picture: Option<Picture<'a>>,
    factor: f32,
    cutoff: f32,
}

struct Picture<'a> {
    texture: &'a Texture,
    wraps: [Wrap; 2],
    /// Smallest and largest alpha of 1, 2 x 2, 4 x 4, … texels.
    levels: Rc<[Level]>,
}

/// Textures, and their levels, each computed on demand once.
pub(super) struct Pyramids<'a> {
    textures: &'a [Texture],
    known: HashMap<usize, Rc<[Level]>>,
}

impl<'a> Pyramids<'a> {
    pub(super) fn new(textures: &'a [Texture]) -> Self {
        Self {
            textures,
            known: HashMap::new(),
        }
    }

    fn of(&mut self, index: usize) -> (&'a Texture, Rc<[Level]>) {
        let texture = &self.textures[index];
        let levels = self.known.entry(index).or_insert_with(|| levels(texture).into());
        (texture, Rc::clone(levels))
    }
}

struct Level {
    width: usize,
    ranges: Vec<[u8; 2]>,
}

impl<'a> Field<'a> {
    pub(super) fn new(material: &Material, pyramids: &mut Pyramids<'a>, cutoff: f32) -> Self {
        let picture = material.base_color_texture.map(|used| {
            let (texture, levels) = pyramids.of(used.texture);
            Picture {
                texture,
                wraps: [used.wrap_u, used.wrap_v],
                levels,
            }
        });
        let [.., factor] = material.base_color_linear;
        Self {
            picture,
            factor,
            cutoff,
        }
    }

    /// Alpha minus the cutoff: not negative means opaque.
    pub(super) fn margin(&self, corner: Corner) -> f32 {
        let picture = self
            .picture
            .as_ref()
            .map_or(1.0, |picture| picture.alpha(corner.uv));
        self.factor * picture * corner.alpha - self.cutoff
    }

    /// A step of texture coordinates in texels; zero without a texture, where alpha is linear over a triangle.
    pub(super) fn texels(&self, step: Vec2) -> Vec2 {
        self.picture
            .as_ref()
            .map_or(Vec2::ZERO, |picture| step * picture.size().as_vec2())
    }

    /// Whether a triangle may be cut.
    pub(super) fn may_cut(&self, corners: [Corner; 3]) -> bool {
        let margins = corners.map(|corner| self.margin(corner));
        let is_in = |margin: &f32| *margin >= 0.0;
        let differ = margins.iter().any(is_in) != margins.iter().all(is_in);
        let Some(picture) = &self.picture else {
            return differ;
        };
        differ || {
            let [lowest, highest] = self.bounds(picture.range(corners.map(|corner| corner.uv)), corners);
            lowest < self.cutoff && highest >= self.cutoff
        }
    }

    /// Whether any part of a triangle is transparent, even slightly.
    pub(super) fn is_clear(&self, corners: [Corner; 3]) -> bool {
        /// The largest alpha below 1 in 8 bits, with a margin.
        const OPAQUE: f32 = 1.0 - 0.5 / 255.0;
        let range = self
            .picture
            .as_ref()
            .map_or([1.0; 2], |picture| picture.range(corners.map(|corner| corner.uv)));
        self.bounds(range, corners)[0] < OPAQUE
    }

    /// Bounds on alpha over a triangle whose texture has this range.
    fn bounds(&self, [least, most]: [f32; 2], corners: [Corner; 3]) -> [f32; 2] {
        let alphas = corners.map(|corner| corner.alpha);
        [
            self.factor * least * alphas.into_iter().fold(f32::INFINITY, f32::min),
            self.factor * most * alphas.into_iter().fold(0.0, f32::max),
        ]
    }
}

impl Picture<'_> {
    fn size(&self) -> DVec2 {
        DVec2::new(self.texture.width_px.into(), self.texture.height_px.into())
    }

    /// Bilinear alpha.
    fn alpha(&self, uv: Vec2) -> f32 {
        let at = uv.as_dvec2() * self.size() - 0.5;
        let (first, part) = (at.floor(), (at - at.floor()).as_vec2());
        let texel = |right: f64, down: f64| {
            let [x, y] = self.wrapped(first + DVec2::new(right, down));
            let texel = self.levels[0].ranges[y * self.levels[0].width + x];
            f32::from(texel[0]) / 255.0
        };
        let upper = texel(0.0, 0.0) * (1.0 - part.x) + texel(1.0, 0.0) * part.x;
        let lower = texel(0.0, 1.0) * (1.0 - part.x) + texel(1.0, 1.0) * part.x;
        upper * (1.0 - part.y) + lower * part.y
    }

    /// The column and row of a texel, integers outside of the picture included.
    fn wrapped(&self, texel: DVec2) -> [usize; 2] {
        let [u, v] = self.wraps;
        let size = self.size();
        [wrapped(texel.x, size.x, u), wrapped(texel.y, size.y, v)]
    }

    /// Smallest and largest alpha around a triangle; at least those inside.
    fn range(&self, uvs: [Vec2; 3]) -> [f32; 2] {
        /// Cells of a level along each side of the box around it.
        const CELLS: f64 = 6.0;
        let places = uvs.map(|uv| uv.as_dvec2() * self.size() - 0.5);
        let from = places.iter().copied().fold(DVec2::INFINITY, DVec2::min).floor();
        let to = places
            .iter()
            .copied()
            .fold(DVec2::NEG_INFINITY, DVec2::max)
            .floor()
            + 1.0;
        let span = (to - from).max_element() + 1.0;
        let mut level = 0;
        while span / f64::from(1_u32 << level) > CELLS && level + 1 < self.levels.len() {
            level += 1;
        }
        let whole = &self.levels[self.levels.len() - 1].ranges;
        if level + 1 == self.levels.len() && whole.len() == 1 {
            return whole[0].map(|alpha| f32::from(alpha) / 255.0);
        }
        let [mut least, mut most] = [u8::MAX, 0];
        let (step, cells) = (f64::from(1_u32 << level), &self.levels[level]);
        let is_fine = level == 0;
        for y in steps(from.y, to.y, step) {
            for x in steps(from.x, to.x, step) {
                // Single texels count only if they touch the triangle.
                if is_fine && !is_near(DVec2::new(x, y), &places) {
                    continue;
                }
                let [column, row] = self.wrapped(DVec2::new(x, y));
                let range = cells.ranges[(row >> level) * cells.width + (column >> level)];
                least = least.min(range[0]);
                most = most.max(range[1]);
            }
        }
        [least, most].map(|alpha| f32::from(alpha) / 255.0)
    }
}

/// One texel in each cell of `step` texels between two, cells at the border being smaller.
fn steps(from: f64, to: f64, step: f64) -> impl Iterator<Item = f64> {
    /// Far above the size of triangles' boxes at their levels.
    const MOST: usize = 4096;
    let half = (step / 2.0).floor().max(1.0);
    let inner = (0..MOST).map(move |i| from + half * i as f64);
    inner.take_while(move |at| *at < to).chain([to])
}

/// Whether a texel's centre is within a texel of a triangle.
fn is_near(texel: DVec2, [a, b, c]: &[DVec2; 3]) -> bool {
    let area = (b - a).perp_dot(c - a);
    let sides = [(a, b), (b, c), (c, a)];
    sides.into_iter().all(|(from, to)| {
        let side = to - from;
        let outside = -side.perp_dot(texel - from) * area.signum();
        outside <= side.length() || side.length() == 0.0
    })
}

fn wrapped(texel: f64, size: f64, wrap: Wrap) -> usize {
    let inside = match wrap {
        Wrap::ClampToEdge => texel.clamp(0.0, size - 1.0),
        Wrap::Repeat => texel.rem_euclid(size),
        Wrap::MirroredRepeat => {
            let twice = texel.rem_euclid(2.0 * size);
            twice.min(2.0 * size - 1.0 - twice)
        }
    };
    index(inside.clamp(0.0, size - 1.0))
}

#[expect(clippy::cast_sign_loss, reason = "it is not negative")]
fn index(inside: f64) -> usize {
    inside as usize
}

fn levels(texture: &Texture) -> Vec<Level> {
    let alphas = texture.rgba8_srgb.as_chunks::<4>().0;
    let mut levels = vec![Level {
        width: texture.width_px as usize,
        ranges: alphas.iter().map(|[.., alpha]| [*alpha; 2]).collect(),
    }];
    while let Some(fine) = levels.last().filter(|level| level.ranges.len() > 1) {
        let height = fine.ranges.len() / fine.width;
        let (width, rows) = (fine.width.div_ceil(2), height.div_ceil(2));
        let mut ranges = vec![[u8::MAX, 0]; width * rows];
        for (i, [least, most]) in fine.ranges.iter().enumerate() {
            let range = &mut ranges[i / fine.width / 2 * width + i % fine.width / 2];
            *range = [range[0].min(*least), range[1].max(*most)];
        }
        levels.push(Level { width, ranges });
    }
    levels
}
