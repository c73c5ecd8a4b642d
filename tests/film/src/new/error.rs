//! Reasons why photographs make no session.

use std::path::PathBuf;

use thiserror::Error;

use super::Side;

/// The reason why photographs make no session.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum NewError {
    /// The angle of view is unknown.
    #[error(
        "{}: its EXIF states no focal length: give --focal-35mm MM (the main camera of most phones has 24 to 28)",
        path.display()
    )]
    NoFocalLength {
        /// The photograph.
        path: PathBuf,
    },
    /// A plate of another size.
    #[error(
        "{}: {} x {} px, but the photograph of the toy has {} x {}: take all with the same camera, turned the same way",
        path.display(), size_px[0], size_px[1], expected_px[0], expected_px[1]
    )]
    Size {
        /// The plate.
        path: PathBuf,
        /// Its size.
        size_px: [u32; 2],
        /// Size of the photograph of the toy.
        expected_px: [u32; 2],
    },
    /// The model's unit seems to be no metre.
    #[error(
        "the model is {own:.4} units high, which can hardly be metres: give the toy's --height, such as 12cm"
    )]
    NoHeight {
        /// Its height.
        own: f64,
    },
    /// The model has no height.
    #[error("the model has no height along the axis that points up: give another --up")]
    Flat,
    /// No pose fits the outline.
    #[error("the toy is not found: {reached}. {advice}")]
    NotFound {
        /// The best fit of the search.
        reached: String,
        /// Advice.
        advice: String,
    },
    /// Several poses fit.
    #[error(
        "the toy fits in several ways, and neither outline nor colours say in which: {}",
        advice(sides)
    )]
    Ambiguous {
        /// The visible sides in these poses, each once.
        sides: Vec<Side>,
    },
}

fn advice(sides: &[Side]) -> String {
    let names: Vec<String> = sides.iter().map(Side::to_string).collect();
    match &names[..] {
        [] | [_] => "photograph it from another side".to_owned(),
        _ => format!("give --view {}", names.join("|")),
    }
}
