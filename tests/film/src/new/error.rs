//! Why photographs do not make a session.

use std::path::PathBuf;

use thiserror::Error;

use super::Side;

/// Photographs that make no session.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum NewError {
    /// Nothing says how wide the lens sees.
    #[error(
        "{}: its EXIF states no focal length: say --focal-35mm MM (the main camera of most phones has 24 to 28)",
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
        /// That of the photograph.
        expected_px: [u32; 2],
    },
    /// The model's unit is no metre.
    #[error(
        "the model is {own:.4} units high, which are hardly metres: say the toy's --height, such as 12cm"
    )]
    NoHeight {
        /// Its height.
        own: f64,
    },
    /// The model has no height.
    #[error("the model has no height along the axis that points up: say another --up")]
    Flat,
    /// No pose meets the outline.
    #[error("the toy is not found: {reached}. {advice}")]
    NotFound {
        /// How near the search came.
        reached: String,
        /// What may help.
        advice: String,
    },
    /// Several do.
    #[error(
        "the toy fits in several ways, and neither outline nor colours say in which: {}",
        advice(sides)
    )]
    Ambiguous {
        /// What is seen of it in these, each once.
        sides: Vec<Side>,
    },
}

fn advice(sides: &[Side]) -> String {
    let names: Vec<String> = sides.iter().map(Side::to_string).collect();
    match &names[..] {
        [] | [_] => "photograph it from another side".to_owned(),
        _ => format!("say --view {}", names.join("|")),
    }
}
