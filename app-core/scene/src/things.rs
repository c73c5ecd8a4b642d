//! Other things in a picture: things on the table, and things in front of the toy.

use std::sync::Arc;

use glam::UVec2;

use crate::scene::Camera;

/// The content of a pixel in place of a receiver or the toy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mark {
    /// No thing: a receiver or the toy.
    #[default]
    None,
    /// A thing: the camera's pixel stays, and the toy is drawn over it.
    Thing,
    /// A thing in front of the toy: the camera's pixel stays, the toy is drawn behind it, and no
    /// colour of the toy is taken from it.
    BeforeToy,
    /// A receiver whose plate shows something else; it is treated as not photographed there.
    WrongPlate,
}

/// Marks on the pixels of a picture.
#[derive(Clone, Debug)]
pub struct Things {
    size_px: UVec2,
    marks: Arc<[Mark]>,
    /// Number of pixels with each mark except `None`.
    counts: [usize; 3],
    /// The camera that took the picture.
    camera: Camera,
}

impl Things {
    /// Marks of a picture's pixels, rows from the top; `None` if their number is wrong.
    #[must_use]
    pub fn new(size_px: UVec2, marks: impl Into<Arc<[Mark]>>, camera: Camera) -> Option<Self> {
        let marks = marks.into();
        let n_pixels = u64::from(size_px.x) * u64::from(size_px.y);
        let count = |mark: Mark| marks.iter().filter(|other| **other == mark).count();
        let counts = [Mark::Thing, Mark::BeforeToy, Mark::WrongPlate].map(count);
        (marks.len() as u64 == n_pixels).then_some(Self {
            size_px,
            marks,
            counts,
            camera,
        })
    }

    /// Width and height of the picture in pixels.
    #[must_use]
    pub fn size_px(&self) -> UVec2 {
        self.size_px
    }

    /// The mark of each pixel, rows from the top.
    #[must_use]
    pub fn marks(&self) -> &[Mark] {
        &self.marks
    }

    /// The camera that took the picture.
    #[must_use]
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Whether both share their memory, and so mark the same picture.
    #[must_use]
    pub fn is(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.marks, &other.marks)
    }

    /// Whether both have equal contents.
    #[must_use]
    pub fn is_like(&self, other: &Self) -> bool {
        self.camera == other.camera && self.marks == other.marks
    }

    /// Whether there is any mark.
    #[must_use]
    pub fn has_any(&self) -> bool {
        self.counts != [0; 3]
    }

    /// Number of pixels with a mark.
    #[must_use]
    pub fn count(&self, mark: Mark) -> usize {
        let [thing, before_toy, wrong_plate] = self.counts;
        match mark {
            Mark::None => self.marks.len() - thing - before_toy - wrong_plate,
            Mark::Thing => thing,
            Mark::BeforeToy => before_toy,
            Mark::WrongPlate => wrong_plate,
        }
    }
}
