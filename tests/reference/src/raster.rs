//! Values over a rectangle of pixels.

use std::ops::{Add, Mul};

use glam::{DVec2, UVec2};

/// Values over a rectangle, rows from the top; the centre of the first lies at (0.5, 0.5).
#[derive(Clone, Debug, PartialEq)]
pub struct Raster<T> {
    size: UVec2,
    texels: Vec<T>,
}

/// All texels of a rectangle, row by row.
pub fn texels_of(size: UVec2) -> impl Iterator<Item = UVec2> {
    (0..size.y).flat_map(move |y| (0..size.x).map(move |x| UVec2::new(x, y)))
}

impl<T: Copy> Raster<T> {
    /// Computes `value` for each texel.
    pub fn from_fn(size: UVec2, mut value: impl FnMut(UVec2) -> T) -> Self {
        Self {
            size,
            texels: texels_of(size).map(&mut value).collect(),
        }
    }

    /// Maps each texel.
    #[must_use]
    pub fn map<U>(&self, value: impl FnMut(T) -> U) -> Raster<U> {
        Raster {
            size: self.size,
            texels: self.texels.iter().copied().map(value).collect(),
        }
    }

    /// Columns and rows.
    #[must_use]
    pub fn size(&self) -> UVec2 {
        self.size
    }

    /// All texels, row by row.
    #[must_use]
    pub fn texels(&self) -> &[T] {
        &self.texels
    }

    /// The texel at (column, row).
    ///
    /// # Panics
    /// Outside the rectangle.
    #[must_use]
    pub fn at(&self, texel: UVec2) -> T {
        assert!(texel.cmplt(self.size).all(), "no texel {texel} in {}", self.size);
        self.texels[(texel.y * self.size.x + texel.x) as usize]
    }
}

impl<T: Copy + Add<Output = T> + Mul<f64, Output = T>> Raster<T> {
    /// Bilinear interpolation between the four nearest centres, with repeated border texels.
    #[must_use]
    pub fn bilinear(&self, at: DVec2) -> T {
        let last = self.size.as_dvec2() - 1.0;
        let from_centre = at - 0.5;
        let low = from_centre.floor();
        let part = from_centre - low;
        let texel = |dx: f64, dy: f64| {
            let texel = (low + DVec2::new(dx, dy)).clamp(DVec2::ZERO, last);
            self.at(texel.as_uvec2())
        };
        let row = |dy: f64| texel(0.0, dy) * (1.0 - part.x) + texel(1.0, dy) * part.x;
        row(0.0) * (1.0 - part.y) + row(1.0) * part.y
    }
}
