//! Whether a device draws what it should: a small picture, made by a preset, against what is expected of it.
//!
//! The scene is made in code (`place`): a toy of two boxes on a chequered table, photographed by exact rays, shown turned. What is
//! expected is a colour for each block of 8 x 8 pixels, since edges may be sampled elsewhere on another device. At this size `paper`
//! finds too little of the real shadow to sample and shows none, which its picture has as well.

mod place;

use thiserror::Error;

use app_pipeline::core::{Core, CoreError};
use app_pipeline::preset::Preset;
use app_scene::scene::Image;
use app_scene::toy::ToyError;

pub use place::SIZE_PX;

/// Side of a block.
const BLOCK_PX: usize = 8;
/// Blocks in a row of the picture.
const N_COLUMNS: usize = 8;

/// Largest difference of a block's mean, in codes of 8 bits.
///
/// Between what other sampling may do and the least fault that a test plants: `balanced` shifted by a quarter of a pixel changes a
/// block by 3.8 codes and all by .6 in the mean, shifted by a whole pixel by 15 and 2.4; any other fault changes more of either.
/// Measured on one software renderer; no phone has drawn it yet.
const WORST_CODES: f64 = 8.0;
/// Largest mean difference over all blocks, in codes of 8 bits.
const MEAN_CODES: f64 = 1.0;

/// How far a picture is from what is expected, in codes of 8 bits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Difference {
    /// Of the block and the channel that differ most.
    pub worst_codes: f64,
    /// Over all blocks and channels.
    pub mean_codes: f64,
}

/// Why a device is not to be trusted with a preset.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SelfTestError {
    /// It did not draw.
    #[error(transparent)]
    Core(#[from] CoreError),
    /// The scene's toy cannot be read.
    #[error(transparent)]
    Toy(#[from] ToyError),
    /// It drew something else.
    #[error(
        "a test picture is {:.1} codes off where it is worst, {:.1} in the mean",
        .0.worst_codes,
        .0.mean_codes
    )]
    Differs(Difference),
    /// The picture has another size than the one that is expected.
    #[error("a test picture has {size_px:?} pixels")]
    Size {
        /// Its size.
        size_px: [u32; 2],
    },
}

/// Draws the picture with a preset and compares it. The core has no scene afterwards.
///
/// # Errors
/// When the device does not draw, or draws something else.
pub fn run(core: &mut Core, preset: Preset) -> Result<Difference, SelfTestError> {
    check(&render(core, preset)?, preset)
}

/// Draws the picture with a preset. The core has no scene afterwards.
///
/// # Errors
/// When the device does not draw.
pub fn render(core: &mut Core, preset: Preset) -> Result<Image, SelfTestError> {
    let drawn = draw(core, preset);
    core.forget_scene();
    drawn
}

fn draw(core: &mut Core, preset: Preset) -> Result<Image, SelfTestError> {
    let (scene, input) = place::place()?;
    core.set_scene(scene, preset)?;
    core.frame(&input)?;
    Ok(core.read_picture()?)
}

/// The photograph of which the picture is made: the toy as it stands.
///
/// # Errors
/// When the scene's toy cannot be read.
pub fn photograph() -> Result<Image, SelfTestError> {
    let (_, input) = place::place()?;
    Ok(input.image.rgba().as_ref().clone())
}

/// Compares a picture with what is expected of a preset.
///
/// # Errors
/// When it is of another size, or farther off than what other sampling of edges explains.
pub fn check(picture: &Image, preset: Preset) -> Result<Difference, SelfTestError> {
    if !picture.is_of_size(SIZE_PX) {
        return Err(SelfTestError::Size {
            size_px: [picture.width_px, picture.height_px],
        });
    }
    let expected = parsed(golden(preset));
    let actual = means(picture);
    let mut difference = Difference::default();
    if expected.len() != actual.len() {
        difference.worst_codes = f64::INFINITY;
    }
    for (actual, expected) in actual.iter().zip(&expected) {
        for (actual, expected) in actual.iter().zip(expected) {
            let codes = (actual - expected).abs();
            difference.worst_codes = difference.worst_codes.max(codes);
            let n = (3 * expected_blocks()) as f64;
            difference.mean_codes += codes / n;
        }
    }
    if difference.worst_codes <= WORST_CODES && difference.mean_codes <= MEAN_CODES {
        Ok(difference)
    } else {
        Err(SelfTestError::Differs(difference))
    }
}

/// The means of a picture's blocks, as they are kept: a row of blocks a line, a block as its red, green and blue in hexadecimal.
#[must_use]
pub fn kept(picture: &Image) -> String {
    let mut text = String::new();
    for row in means(picture).chunks(N_COLUMNS) {
        let words = row.iter().map(|mean| {
            #[allow(clippy::cast_possible_truncation, reason = "a mean of bytes")]
            let [r, g, b] = mean.map(|code| code.round() as u8);
            format!("{r:02x}{g:02x}{b:02x}")
        });
        text.push_str(&words.collect::<Vec<_>>().join(" "));
        text.push('\n');
    }
    text
}

fn golden(preset: Preset) -> &'static str {
    match preset {
        Preset::Flat => include_str!("golden/flat.txt"),
        Preset::Paper => include_str!("golden/paper.txt"),
        Preset::Fast => include_str!("golden/fast.txt"),
        Preset::Balanced => include_str!("golden/balanced.txt"),
        Preset::Best => include_str!("golden/best.txt"),
        // A preset without a picture of its own fails: none of its blocks is expected.
        _ => "",
    }
}

/// What [`kept`] wrote; what is no colour is left out, and a block is then missing.
fn parsed(text: &str) -> Vec<[f64; 3]> {
    let colors = text
        .split_whitespace()
        .filter_map(|word| u32::from_str_radix(word, 16).ok());
    colors
        .map(|color| {
            let [_, r, g, b] = color.to_be_bytes();
            [r, g, b].map(f64::from)
        })
        .collect()
}

fn expected_blocks() -> usize {
    N_COLUMNS * SIZE_PX[1] as usize / BLOCK_PX
}

/// Mean codes of the blocks, row after row. Codes, not light: dark parts are to count as much as they are seen.
fn means(picture: &Image) -> Vec<[f64; 3]> {
    let mut sums = vec![[0.0; 3]; expected_blocks()];
    let n = (BLOCK_PX * BLOCK_PX) as f64;
    let rows = picture.rgba8.chunks_exact(4 * SIZE_PX[0] as usize);
    for (y, row) in rows.enumerate() {
        for (x, pixel) in row.chunks_exact(4).enumerate() {
            let Some(sum) = sums.get_mut(y / BLOCK_PX * N_COLUMNS + x / BLOCK_PX) else {
                continue;
            };
            for (sum, code) in sum.iter_mut().zip(pixel) {
                *sum += f64::from(*code) / n;
            }
        }
    }
    sums
}
