//! The placement of a picture on a screen: rotated by quarter turns, with its aspect ratio kept.

use glam::{DAffine2, DMat2, DVec2, Vec2Swizzles};

/// The handling of different aspect ratios of picture and screen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Fit {
    /// The picture fills the screen and is cropped equally on both sides, as in phones' camera
    /// apps.
    #[default]
    Fill,
    /// The whole picture is shown, black beside it.
    Whole,
}

/// The presentation of a camera's picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Display {
    /// Clockwise quarter turns of the picture: a sensor is fixed in the phone.
    pub quarter_turns: u8,
    /// Cropped or whole.
    pub fit: Fit,
}

impl Display {
    /// Map from pixels of the screen to those of the picture; both have their origin at the top left, and a first pixel's
    /// centre at (.5, .5). Neither size may be 0.
    #[must_use]
    pub fn image_from_screen(self, image_px: [u32; 2], screen_px: [u32; 2]) -> DAffine2 {
        let [image_px, screen_px] = [image_px, screen_px].map(|size_px| DVec2::from(size_px.map(f64::from)));
        let turned_px = if self.quarter_turns % 2 == 1 {
            image_px.yx()
        } else {
            image_px
        };
        let scales = turned_px / screen_px;
        let scale = match self.fit {
            Fit::Fill => scales.min_element(),
            Fit::Whole => scales.max_element(),
        };
        let turn = match self.quarter_turns % 4 {
            0 => DMat2::IDENTITY,
            1 => DMat2::from_cols(DVec2::NEG_Y, DVec2::X),
            2 => -DMat2::IDENTITY,
            _ => DMat2::from_cols(DVec2::Y, DVec2::NEG_X),
        };
        let matrix = turn * scale;
        DAffine2::from_mat2_translation(matrix, 0.5 * image_px - matrix * (0.5 * screen_px))
    }
}
