//! Accuracy of the real shadow as a preset predicts it, on photographs without a truth: the shadow
//! is withheld, the physical pose is rendered like any other, and the photograph itself is the
//! truth.

use std::sync::Arc;

use app_core::core::Core;
use app_core::frame::FrameInput;
use app_core::preset::{Preset, Settings};
use app_core::scene::Image;
use app_core::session::{Capture, Session};
use app_pipeline::core::inspect::Inspect;
use app_pipeline::geometry::rect::PixelRect;
use app_pipeline::readback::{FloatMap, Map};
use glam::Vec4;

use desk::alignment::Alignments;
use desk::false_color::srgb_from_linear;
use desk::lens::through_lens;
use desk::replay::ReplayError;

use super::table::aligned;

/// One photograph, rendered by one preset.
#[derive(Clone, Debug)]
pub struct Rebuilt {
    /// Name of the session.
    pub session: String,
    /// The preset.
    pub preset: Preset,
    /// The first frame with this photograph.
    pub frame: usize,
    /// Error over all pixels of receivers in the real shadow.
    pub all: Errors,
    /// Error over those pixels far from the toy, where none of its colour bleeds into the
    /// photograph.
    pub clear: Errors,
    /// The rendered picture, with the session's distortion. Errors are measured without distortion.
    pub picture: Image,
}

/// Renders every photograph of a session from the shadow of the first one, which alone is read,
/// also by alignment. `paper` and `flat` do not support this.
///
/// # Errors
/// When a frame cannot be read or made.
pub fn rebuild(
    session: &Capture,
    core: &mut Core,
    presets: &[Preset],
    is_aligned: bool,
) -> Result<Vec<Rebuilt>, ReplayError> {
    let alignments = if is_aligned {
        Alignments::find_without_shadows(session)?
    } else {
        Alignments::none()
    };
    let mut rebuilt = Vec::new();
    for &preset in presets {
        if matches!(preset.settings(), Settings::Model(_)) {
            rebuilt.extend(rebuild_with(session, &alignments, core, preset)?);
        }
    }
    Ok(rebuilt)
}

fn rebuild_with(
    session: &Capture,
    alignments: &Alignments,
    core: &mut Core,
    preset: Preset,
) -> Result<Vec<Rebuilt>, ReplayError> {
    let scene = session.scene();
    core.set_scene(alignments.scene(scene), preset)?;
    core.withhold_shadow()?;
    let mut first: Option<FrameInput> = None;
    let mut latest: Option<Arc<Image>> = None;
    let mut rebuilt = Vec::new();
    for frame in 0..session.n_frames() {
        let failed = |reason| ReplayError::Frame { index: frame, reason };
        if let Some(changed) = alignments.changed_scene(scene, frame) {
            core.set_scene(changed, preset)?;
            core.withhold_shadow()?;
            // The new scene knows nothing yet of the first photograph's shadow.
            if let Some(first) = &first {
                core.frame(first).map_err(failed)?;
            }
        }
        let input = alignments
            .input(frame, &session.frame(frame)?, preset)
            .with_shown_pose(scene.physical_pose.clone());
        if latest
            .as_ref()
            .is_some_and(|image| image.rgba8 == input.image.rgba().rgba8)
        {
            continue;
        }
        first.get_or_insert_with(|| input.clone());
        let region = core.frame(&input).map_err(failed)?.region;
        let picture = core.read_picture().map_err(failed)?;
        let (mut all, mut clear) = Default::default();
        if let Some(region) = region {
            let read = |map| core.read_map(map).map_err(failed);
            let (validity, plate) = (read(Map::Validity)?, read(Map::Plate)?);
            let gain = core.read_fit().map_err(failed)?.map(|fit| Vec4::from(fit.gain));
            if let (Some(validity), Some(plate), Some(gain)) = (validity, plate, gain) {
                let withheld = Withheld {
                    region,
                    validity,
                    plate,
                    gain,
                };
                all = withheld.errors(&picture, input.image.rgba(), |alpha| alpha < 1.0);
                clear = withheld.errors(&picture, input.image.rgba(), |alpha| alpha == 0.0);
            }
        }
        rebuilt.push(Rebuilt {
            session: scene.name.clone(),
            preset,
            frame,
            all,
            clear,
            picture: through_lens(session, frame, picture)?,
        });
        latest = Some(Arc::clone(input.image.rgba()));
    }
    Ok(rebuilt)
}

struct Withheld {
    region: PixelRect,
    validity: FloatMap,
    plate: FloatMap,
    gain: Vec4,
}

/// Differences from the photograph.
#[derive(Clone, Copy, Debug, Default)]
pub struct Errors {
    /// Sum of squares over pixels and channels of the rendered picture.
    made: f64,
    /// The same without any shadow.
    unshadowed: f64,
    n_pixels: usize,
}

impl Withheld {
    /// Errors over the pixels with such an alpha.
    fn errors(&self, picture: &Image, photograph: &Image, is_counted: impl Fn(f32) -> bool) -> Errors {
        let mut errors = Errors::default();
        for (index, marks) in self.validity.texels.iter().enumerate() {
            if !is_counted(marks[3]) {
                continue;
            }
            let width = self.validity.width as usize;
            let [left, top] = self.region.origin_px.to_array().map(|px| px as usize);
            let first = 4 * ((top + index / width) * photograph.width_px as usize + left + index % width);
            let lit = Vec4::from(self.plate.texels[index]) * self.gain;
            let lit_codes = lit
                .to_array()
                .map(|linear| 255.0 * srgb_from_linear(linear.clamp(0.0, 1.0)));
            for (channel, lit) in lit_codes.into_iter().take(3).enumerate() {
                let shown = f64::from(photograph.rgba8[first + channel]);
                errors.made += (f64::from(picture.rgba8[first + channel]) - shown).powi(2);
                errors.unshadowed += (f64::from(lit) - shown).powi(2);
            }
            errors.n_pixels += 1;
        }
        errors
    }
}

impl Errors {
    /// RMSE of the rendered picture, in 8-bit codes, that without shadow, and the number of pixels.
    fn cells(&self) -> [String; 3] {
        let n = 3.0 * self.n_pixels as f64;
        let rmse = |sum: f64| {
            if n > 0.0 {
                format!("{:.2}", (sum / n).sqrt())
            } else {
                "-".to_owned()
            }
        };
        [rmse(self.made), rmse(self.unshadowed), self.n_pixels.to_string()]
    }
}

/// The results, in columns.
#[must_use]
pub fn rebuilt_table(rebuilt: &[Rebuilt]) -> String {
    let heads = [
        "session",
        "preset",
        "frame",
        "clear of the toy",
        "no shadow",
        "pixels",
        "all",
        "no shadow",
        "pixels",
    ];
    let mut cells = vec![heads.map(str::to_owned).to_vec()];
    cells.extend(rebuilt.iter().map(|one| {
        let mut line = vec![one.session.clone(), one.preset.to_string(), one.frame.to_string()];
        line.extend(one.clear.cells());
        line.extend(one.all.cells());
        line
    }));
    aligned(&cells)
        + "RMSE in 8-bit codes against the photograph, over the real shadow: rebuilt from the shadow of the first photograph \
           alone, and left out.\n"
}
