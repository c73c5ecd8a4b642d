//! Golden pictures: the presets' pictures of the bundled session, kept in the repository for
//! comparison.
//!
//! A test only reads them. The program `bless` writes them and never ends in success, so that no
//! picture becomes a golden without someone having looked at it.

use std::path::{Path, PathBuf};

use app_core::core::{Core, CoreError};
use app_core::frame::FrameInput;
use app_core::preset::Preset;
use app_core::scene::Image;
use app_core::session::{Capture, GroundTruth, Session, SessionError};
use image::ImageReader;
use thiserror::Error;

use crate::compare::{Check, CompareError, Difference, Pair};
use desk::files::{BUNDLED_SESSION, Folder, FolderError};
use desk::metrics::{Scores, SizeError, score};
use desk::output::{WriteError, make_folder, write_png};

/// The command that makes goldens.
pub const BLESS_COMMAND: &str = "cargo xtask bless";
/// Part of the name of the goldens' adapter.
pub const SOFTWARE_ADAPTER: &str = "llvmpipe";
/// Frame of the bundled session whose shadow has moved far, over wood grain and over the real one.
const FRAME: usize = 2;
/// Part of that frame with toy, real shadow and moved shadow.
const CROP: Crop = Crop {
    origin_px: [168, 16],
    size_px: [344, 288],
};
/// Difference, in codes, that is full red in a picture of differences.
const FULL_RED_CODES: f64 = 16.0;

/// Conditions on the goldens' own adapter, a software renderer.
///
/// Its picture does not vary between runs. Another processor contracts and rounds differently:
/// restricted to SSE 4.1 (`GALLIUM_OVERRIDE_CPU_CAPS=sse4.1`) instead of AVX2, 0.046 % of the
/// pixels change, 0.019 % by more than two codes, the worst, a sample on the other side of an edge,
/// by 25.
pub const ON_SOFTWARE: &[Check] = &[
    Check::Outliers {
        tolerance: 2.0,
        max_share: 1e-3,
    },
    Check::MaxAbs(64.0),
];
/// Conditions on any other adapter, whose rasteriser may sample edges at other places and whose
/// filters have 8 bit of fraction.
///
/// Estimated, not yet measured: the edges of toy and shadow are about 2 % of the picture.
pub const ON_HARDWARE: &[Check] = &[
    Check::Outliers {
        tolerance: 3.0,
        max_share: 0.02,
    },
    Check::MaxAbs(160.0),
];

/// A picture that does not match its golden.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum GoldenError {
    /// There is no golden.
    #[error("{}: there is no golden; make it with `{BLESS_COMMAND}` and look at it", path.display())]
    Missing {
        /// Its expected path.
        path: PathBuf,
    },
    /// The golden cannot be decoded.
    #[error("{}: {reason}", path.display())]
    Unreadable {
        /// Its path.
        path: PathBuf,
        /// The decoder's error.
        reason: String,
    },
    /// The picture differs.
    #[error("{name}: {reason}; expected, actual and difference are in {}", failures.display())]
    Differs {
        /// Name of the golden.
        name: String,
        /// The difference.
        reason: CompareError,
        /// Folder with pictures to view.
        failures: PathBuf,
    },
    /// A picture cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// A picture that could not be made.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RenderError {
    /// The bundled session is missing.
    #[error(transparent)]
    Folder(#[from] FolderError),
    /// The bundled session cannot be read.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// The bundled session has lost its truth.
    #[error("the frame has no truth")]
    NoTruth,
    /// The truth has another size.
    #[error(transparent)]
    Size(#[from] SizeError),
    /// The core cannot make the picture.
    #[error(transparent)]
    Core(#[from] CoreError),
}

/// A folder of goldens, and the destination of mismatches.
#[derive(Clone, Debug)]
pub struct Goldens {
    folder: PathBuf,
    failures: PathBuf,
}

impl Goldens {
    /// Goldens in `folder`; pictures of mismatches go to `failures`, which is made if it is
    /// missing.
    #[must_use]
    pub fn in_folder(folder: &Path, failures: &Path) -> Self {
        Self {
            folder: folder.to_owned(),
            failures: failures.to_owned(),
        }
    }

    /// The project's own goldens.
    #[must_use]
    pub fn of_project() -> Self {
        let tests = Path::new(env!("CARGO_MANIFEST_DIR"));
        Self::in_folder(&tests.join("goldens"), &tests.join("../target/goldens"))
    }

    /// Path of the golden `name`, whether it exists or not.
    #[must_use]
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.join(format!("{name}.png"))
    }

    /// Compares `actual` with the golden `name`. Never writes a golden.
    ///
    /// # Errors
    /// When there is no golden, it cannot be read, or a check is not met.
    pub fn check(&self, name: &str, actual: &Image, checks: &[Check]) -> Result<Difference, GoldenError> {
        let expected = read_png(&self.path(name))?;
        let pair = Pair {
            expected: &expected,
            actual,
        };
        pair.check(checks).or_else(|reason| {
            self.show(name, &pair)?;
            Err(GoldenError::Differs {
                name: name.to_owned(),
                reason,
                failures: self.failures.clone(),
            })
        })
    }

    /// Writes `picture` as the golden `name`. For `bless` alone.
    ///
    /// # Errors
    /// When the system refuses.
    pub fn write(&self, name: &str, picture: &Image) -> Result<(), WriteError> {
        make_folder(&self.folder)?;
        write_png(&self.path(name), picture)
    }

    fn show(&self, name: &str, pair: &Pair<'_, Image>) -> Result<(), WriteError> {
        make_folder(&self.failures)?;
        let write =
            |side: &str, image: &Image| write_png(&self.failures.join(format!("{name}.{side}.png")), image);
        write("expected", pair.expected)?;
        write("actual", pair.actual)?;
        match pair.difference() {
            Ok(difference) => write("difference", &difference.picture(FULL_RED_CODES)),
            // For different sizes there is no picture of differences.
            Err(_) => Ok(()),
        }
    }
}

/// Name of a preset's golden.
#[must_use]
pub fn name_of(preset: Preset) -> String {
    format!("llama_{preset}")
}

/// A preset's picture of a frame of the bundled session.
#[derive(Debug)]
pub struct Rendered {
    /// The part of the picture in the preset's golden.
    pub golden: Image,
    /// Errors of the whole picture against the photograph of the moved toy.
    pub scores: Scores,
}

/// Makes the picture of a preset's golden.
///
/// # Errors
/// When the bundled session cannot be read, or the core fails.
pub fn render(core: &mut Core, preset: Preset) -> Result<Rendered, RenderError> {
    let folder = Folder::open(BUNDLED_SESSION)?;
    let session = Capture::open(folder)?;
    core.set_scene(session.scene().clone(), preset)?;
    core.frame(&FrameInput::from(&session.frame(FRAME)?))?;
    let picture = core.read_picture()?;
    let truth = session.truth(FRAME)?.ok_or(RenderError::NoTruth)?;
    Ok(Rendered {
        golden: CROP.of(&picture),
        scores: score(&picture, &truth)?,
    })
}

/// A rectangle of a picture.
struct Crop {
    origin_px: [usize; 2],
    size_px: [usize; 2],
}

impl Crop {
    /// The pixels of `image` within, fewer if it is smaller.
    fn of(&self, image: &Image) -> Image {
        let ([x, y], [width, height]) = (self.origin_px, self.size_px);
        let rows = image
            .rgba8
            .chunks_exact(4 * image.width_px as usize)
            .skip(y)
            .take(height);
        let rows: Vec<Vec<u8>> = rows
            .map(|row| row.iter().skip(4 * x).take(4 * width).copied().collect())
            .collect();
        let n_pixels = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
        Image {
            width_px: n_pixels(rows.first().map_or(0, |row| row.len() / 4)),
            height_px: n_pixels(rows.len()),
            rgba8: rows.concat(),
        }
    }
}

fn read_png(path: &Path) -> Result<Image, GoldenError> {
    let unreadable = |reason: String| GoldenError::Unreadable {
        path: path.to_owned(),
        reason,
    };
    if !path.exists() {
        return Err(GoldenError::Missing {
            path: path.to_owned(),
        });
    }
    let reader = ImageReader::open(path).map_err(|error| unreadable(error.to_string()))?;
    let picture = reader.decode().map_err(|error| unreadable(error.to_string()))?;
    // A golden with another layout was not written by `bless`: converting it would hide that.
    let image::DynamicImage::ImageRgba8(picture) = picture else {
        return Err(unreadable("it is not of four 8-bit channels".to_owned()));
    };
    Ok(Image {
        width_px: picture.width(),
        height_px: picture.height(),
        rgba8: picture.into_raw(),
    })
}
