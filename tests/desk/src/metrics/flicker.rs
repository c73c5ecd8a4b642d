//! Flicker: changes from one picture to the next that differ from the truth's changes.

use app_core::scene::Image;
use app_core::session::Truth;
use serde::Serialize;

use super::{N_REGIONS, Regions, SizeError};

/// Root of the mean squared (picture' - picture) - (truth' - truth), ' being the next frame, in
/// 8-bit sRGB units over the three colours and over pixels that belong to the region in both
/// frames; 0 if there are none.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Flicker {
    /// Pixels of a former or present shadow outside of the toy.
    pub shadow: f64,
    /// Pixels inside the moved toy.
    pub toy: f64,
    /// The rim of the moved toy.
    pub edge: f64,
    /// The whole picture.
    pub frame: f64,
}

/// Difference of a picture from its truth, pixel by pixel.
#[derive(Clone, Debug)]
pub struct Errors {
    regions: Regions,
    /// Picture minus truth of red, green and blue, rows from the top.
    rgb: Vec<[i16; 3]>,
}

impl Errors {
    /// The errors of a picture. Alpha is ignored.
    ///
    /// # Errors
    /// When the size of picture or truth differs from the mask's.
    pub fn new(picture: &Image, truth: &Truth) -> Result<Self, SizeError> {
        let regions = Regions::from_mask(&truth.mask);
        regions.check_size("picture", picture)?;
        regions.check_size("truth", &truth.image)?;
        let [picture, truth] = [picture, &truth.image].map(|image| image.rgba8.as_chunks::<4>().0);
        let difference = |(picture, truth): (&[u8; 4], &[u8; 4])| {
            [0, 1, 2].map(|channel| i16::from(picture[channel]) - i16::from(truth[channel]))
        };
        let rgb = picture.iter().zip(truth).map(difference).collect();
        Ok(Self { regions, rgb })
    }

    /// The flicker from the frame before to this one.
    ///
    /// # Errors
    /// When their sizes differ.
    pub fn flicker_from(&self, before: &Self) -> Result<Flicker, SizeError> {
        let [own, other] = [&self.regions, &before.regions];
        if [own.width_px, own.height_px] != [other.width_px, other.height_px] {
            return Err(SizeError {
                name: "picture before",
                width_px: other.width_px,
                height_px: other.height_px,
                mask_width_px: own.width_px,
                mask_height_px: own.height_px,
            });
        }
        let mut sums = [(0_u32, 0.0); N_REGIONS];
        let members = own.members.iter().zip(&other.members);
        for ((rgb, before), (own, other)) in self.rgb.iter().zip(&before.rgb).zip(members) {
            let squared = [0, 1, 2].map(|channel| f64::from(rgb[channel] - before[channel]).powi(2));
            let mean = squared.iter().sum::<f64>() / 3.0;
            for (region, (n_pixels, sum)) in sums.iter_mut().enumerate() {
                if own & other & (1 << region) != 0 {
                    *n_pixels += 1;
                    *sum += mean;
                }
            }
        }
        let [shadow, toy, edge, frame] =
            sums.map(|(n_pixels, sum)| (sum / f64::from(n_pixels.max(1))).sqrt());
        Ok(Flicker {
            shadow,
            toy,
            edge,
            frame,
        })
    }
}

/// The flicker of successive frames, whose pictures arrive one by one.
#[derive(Debug, Default)]
pub struct Follower {
    before: Option<(usize, Errors)>,
}

impl Follower {
    /// Takes the picture of frame `index`; returns its flicker if the previous call had the frame
    /// before.
    ///
    /// # Errors
    /// When the size of picture or truth differs from the mask's, or from the frame before.
    pub fn next(
        &mut self,
        index: usize,
        picture: &Image,
        truth: &Truth,
    ) -> Result<Option<Flicker>, SizeError> {
        let errors = Errors::new(picture, truth)?;
        let flicker = match &self.before {
            Some((before, of_before)) if before + 1 == index => Some(errors.flicker_from(of_before)?),
            _ => None,
        };
        self.before = Some((index, errors));
        Ok(flicker)
    }
}

/// The mean, region by region; `None` of an empty list.
#[must_use]
pub fn mean_flicker(all: &[Flicker]) -> Option<Flicker> {
    let n = all.len() as f64;
    let mean = |region: fn(&Flicker) -> f64| all.iter().map(region).sum::<f64>() / n;
    (!all.is_empty()).then(|| Flicker {
        shadow: mean(|flicker| flicker.shadow),
        toy: mean(|flicker| flicker.toy),
        edge: mean(|flicker| flicker.edge),
        frame: mean(|flicker| flicker.frame),
    })
}
