//! Presets: named settings of cost and accuracy.

use std::fmt;
use std::str::FromStr;

use thiserror::Error;

/// A named balance of speed and accuracy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Preset {
    /// A shadow of constant strength, as AR products draw it.
    Flat,
    /// The published method: warp, ring search, box filter, PCSS.
    Paper,
    /// Like `balanced`, with half the points of a wide light, half the positions of the outline,
    /// one sample per pixel within it, and a hard shadow of the toy on itself: for devices too slow
    /// for `balanced`.
    Fast,
    /// The default.
    #[default]
    Balanced,
    /// Like `balanced`, with a finer picture of the toy and less noise in the shadow: for pictures
    /// rather than for a live view.
    Best,
}

impl Preset {
    /// All presets.
    pub const ALL: &[Self] = &[Self::Flat, Self::Paper, Self::Fast, Self::Balanced, Self::Best];

    /// The name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Flat => "flat",
            Self::Paper => "paper",
            Self::Fast => "fast",
            Self::Balanced => "balanced",
            Self::Best => "best",
        }
    }

    /// Method and settings of the preset.
    #[must_use]
    pub fn settings(self) -> Settings {
        match self {
            Self::Flat => Settings::Baseline(BaselineSettings {
                constant_ratio: Some(0.40),
                ..BASELINE
            }),
            Self::Paper => Settings::Baseline(BASELINE),
            Self::Fast => Settings::Model(FAST),
            Self::Balanced => Settings::Model(BALANCED),
            Self::Best => Settings::Model(BEST),
        }
    }
}

/// Settings of `balanced`.
///
/// Mean errors over four frames of six sessions with exact input, in 8-bit codes:
///
/// - 64, 32, 16 points over each light: shadow 1.53, 1.60, 1.77, up to half as much again under a
///   wide light; 64 if a
///   penumbra is wider than 32 pixels or at most 4 wide, else 32: 1.55, and half of the triangles
///   of four sessions' shadows;
/// - 16, 8, 4 points for the toy's shadow on itself: toy 3.91, 3.93, 3.93, edge 4.54, 4.57, 4.57;
/// - own shapes and simplified ones: shadow 1.53 and 1.53, toy 3.91 and 3.91, edge 4.56 and 4.54.
pub const BALANCED: ModelSettings = ModelSettings {
    n_light_points: 64,
    n_narrow_light_points: 32,
    n_ambient_directions: 64,
    ambient_divisor: 4,
    n_toy_draws: 1,
    n_toy_samples: 4,
    n_coverage_positions: 32,
    n_self_shadow_points: 4,
    self_shadow_tile_px: 256,
    caster_px: Some(1),
    is_noise_removed: false,
    is_plate_fine: false,
    is_shadow_withheld: false,
};

/// Settings of `fast`.
///
/// Mean errors of the same frames, shadow, toy and edge, and triangles of a new pose of the stag
/// (3,667 of its own):
///
/// | points | directions | ambient divisor | errors | triangles |
/// | --- | --- | --- | --- | --- |
/// | 64 | 64 | 4 | 1.53, 3.93, 4.57 (`balanced`) | 430,166 |
/// | 32 | 64 | 4 | 1.60, 3.93, 4.57 | 312,822 |
/// | 32 | 32 | 8 | 1.66, 3.93, 4.63 | 284,758 |
/// | 16 | 32 | 8 | 1.83, 3.97, 4.63 | 226,086 |
/// | 16 | 16 | 8 | 1.92, 3.98, 4.70 | 212,054 |
///
/// Of these, 32, 32 and 8 are used. Two frames of each session, with 32 positions of the outline
/// and 4 points for the toy's shadow on itself: 1.66, 3.73, 4.57, and 283,249 triangles; with 16
/// and 1, which are used: 1.66, 3.84, 5.02, and 216,840. With casters within 3 pixels rather than 1
/// as well: the same errors, and 180,472. With one sample per pixel rather than four: 1.66, 4.62,
/// 5.33, and 5.22 with 16 positions that are a lattice of their own; the toy's flicker is 5.8
/// rather than 4.6, and the toy's draw takes half of the time on a processor. Casters within 4
/// pixels: the bundled session's shadow 1.2 in place of 1.0.
///
/// Of 16 points too few fall into each quarter of a pixel to be a sample of the light, and soft
/// shadows have steps.
pub const FAST: ModelSettings = ModelSettings {
    n_light_points: 32,
    n_ambient_directions: 32,
    ambient_divisor: 8,
    n_coverage_positions: 16,
    n_self_shadow_points: 1,
    n_toy_samples: 1,
    caster_px: Some(3),
    ..BALANCED
};

/// Settings of `best`.
pub const BEST: ModelSettings = ModelSettings {
    n_narrow_light_points: 64,
    ambient_divisor: 2,
    n_toy_draws: 4,
    n_self_shadow_points: 16,
    self_shadow_tile_px: 512,
    caster_px: None,
    is_noise_removed: true,
    is_plate_fine: true,
    ..BALANCED
};

/// The constants that the papers leave open, tuned for the lowest mean shadow RMSE over four
/// sessions of the bundled toy (`tests/make/session.py`: the bundled one, `bulb-uniform`,
/// `area-wood` and `bulb-tiles`), one after the other:
///
/// - box radius 4, 20, 40 px: 2.66, 2.30, 2.30, with a margin of 3 px and a seam of 4 px;
/// - margin 1, 3, 6 px: 2.35, 2.30, 2.32, with a box of 20 px;
/// - seam 8, 4, 1 px: 2.43, 2.32, 2.26, with a margin of 6 px; a margin of 4 px then gave 2.24;
/// - box radius 30 px: 2.23; 32 directions instead of 16: the same; twice the blocker taps or four
///   times the filter
///   taps: the same within 0.01;
/// - kernel of PCSS round on the receiver, slanted with the light, slanted except for the search
///   for blockers: 2.47,
///   2.35, 2.27 on `area-wood`; blockers searched no farther than 0.6 of the widest penumbra there:
///   2.54;
/// - `flat`, ratio 0.35, 0.40, 0.50: 5.50, 4.38, 9.18.
pub const BASELINE: BaselineSettings = BaselineSettings {
    constant_ratio: None,
    eligible_margin_px: 4,
    ring_step_px: 2.0,
    n_ring_directions: 32,
    n_rings: 200,
    box_radius_px: 30,
    seam_px: 1,
    n_blocker_taps: 32,
    n_filter_taps: 64,
};

/// Settings of one of the two methods.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Settings {
    /// The additive model of the receiver: see the architecture.
    Model(ModelSettings),
    /// The published method as a baseline, or its simplest variant.
    Baseline(BaselineSettings),
}

/// Settings of the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ModelSettings {
    /// Points over each light: 16, 32 or 64.
    pub n_light_points: usize,
    /// The same for a light whose penumbra is at most this wide in pixels, but not a hard edge.
    pub n_narrow_light_points: usize,
    /// Directions of ambient light: 16, 32 or 64.
    pub n_ambient_directions: usize,
    /// Region pixels per texel of the ambient map, along each side.
    pub ambient_divisor: u32,
    /// Draws of the shown toy, 1 or 4.
    ///
    /// The outline has its samples from `coverage`: more draws smooth the edges within the toy.
    pub n_toy_draws: u32,
    /// Samples per pixel of each draw: 4, or 1 for a single draw.
    pub n_toy_samples: u32,
    /// Number of positions within a pixel at which the shown toy's coverage is sampled, 32 or 16.
    pub n_coverage_positions: u32,
    /// Number of a light's points, among those for the receiver, from which the toy's shadow on
    /// itself is drawn; up to 16.
    pub n_self_shadow_points: usize,
    /// Texels along each side of one such depth map.
    pub self_shadow_tile_px: u32,
    /// Largest distance of a shadow caster's shape from the toy's shape, in pixels at the toy; a
    /// shadow is farther from the camera. Without it the toy's own shape casts all shadows, that of
    /// the ambient light too.
    pub caster_px: Option<u32>,
    /// Whether the real shadow is denoised, so that it is no noisier than the new one beside it.
    pub is_noise_removed: bool,
    /// Whether the plate always has more precision than codes, not only where it was estimated or
    /// converted to another exposure.
    pub is_plate_fine: bool,
    /// Whether the real shadow is withheld from all but the first fits, and the physical pose drawn
    /// like any other: see
    /// [`Inspect::withhold_shadow`](crate::core::inspect::Inspect::withhold_shadow). No preset does
    /// so.
    pub is_shadow_withheld: bool,
}

/// The constants that the papers leave open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaselineSettings {
    /// Ratio of the shadow to the plate in full shadow, for shadows of constant strength, the same
    /// for each light; without it the real shadow is sampled.
    pub constant_ratio: Option<f32>,
    /// Distance from the edges of the eligible shadow.
    pub eligible_margin_px: i32,
    /// Distance between rings.
    pub ring_step_px: f32,
    /// Number of candidates per ring.
    pub n_ring_directions: u32,
    /// Number of rings after which the search ends, if it has not left the region before.
    pub n_rings: u32,
    /// Half the side of the box filter, without its centre.
    pub box_radius_px: i32,
    /// Width of the linear interpolation around the cropped masks.
    pub seam_px: i32,
    /// Taps of the blocker search.
    pub n_blocker_taps: u32,
    /// Taps of the filter.
    pub n_filter_taps: u32,
}

/// A setting with an impossible value.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("settings, {field}: {value} is not {needed}")]
pub struct SettingsError {
    /// The field.
    pub field: &'static str,
    /// Its value.
    pub value: f64,
    /// The permitted values, in words.
    pub needed: &'static str,
}

impl SettingsError {
    fn unless(is_allowed: bool, field: &'static str, value: f64, needed: &'static str) -> Result<(), Self> {
        let error = Self { field, value, needed };
        if is_allowed { Ok(()) } else { Err(error) }
    }
}

impl From<Preset> for Settings {
    fn from(preset: Preset) -> Self {
        preset.settings()
    }
}

impl Settings {
    /// Checks the limits of shaders and their uniforms.
    ///
    /// # Errors
    /// If a setting is out of its range.
    pub fn check(&self) -> Result<(), SettingsError> {
        match self {
            Self::Model(settings) => settings.check(),
            Self::Baseline(settings) => settings.check(),
        }
    }
}

impl ModelSettings {
    fn check(&self) -> Result<(), SettingsError> {
        let points = [
            ("n_light_points", self.n_light_points),
            ("n_narrow_light_points", self.n_narrow_light_points),
            ("n_ambient_directions", self.n_ambient_directions),
        ];
        for (field, n) in points {
            SettingsError::unless([16, 32, 64].contains(&n), field, n as f64, "16, 32 or 64")?;
        }
        let sides = [
            ("ambient_divisor", self.ambient_divisor, 1..=16, "from 1 to 16"),
            (
                "self_shadow_tile_px",
                self.self_shadow_tile_px,
                16..=1024,
                "from 16 to 1024",
            ),
        ];
        for (field, n, range, needed) in sides {
            SettingsError::unless(range.contains(&n), field, f64::from(n), needed)?;
        }
        let counts = [
            ("n_toy_draws", self.n_toy_draws, [1, 4], "1 or 4"),
            ("n_toy_samples", self.n_toy_samples, [1, 4], "1 or 4"),
            (
                "n_coverage_positions",
                self.n_coverage_positions,
                [16, 32],
                "16 or 32",
            ),
        ];
        for (field, n, allowed, needed) in counts {
            SettingsError::unless(allowed.contains(&n), field, f64::from(n), needed)?;
        }
        let n = self.n_toy_draws;
        let are_sampled = n == 1 || self.n_toy_samples == 4;
        SettingsError::unless(are_sampled, "n_toy_draws", n.into(), "1 with one sample a pixel")?;
        let n = self.n_self_shadow_points;
        let is_allowed = (1..=16).contains(&n);
        SettingsError::unless(is_allowed, "n_self_shadow_points", n as f64, "from 1 to 16")
    }
}

impl BaselineSettings {
    fn check(&self) -> Result<(), SettingsError> {
        let ratio = self.constant_ratio.unwrap_or(0.0);
        SettingsError::unless(
            (0.0..=1.0).contains(&ratio),
            "constant_ratio",
            ratio.into(),
            "from 0 to 1",
        )?;
        let step_px = self.ring_step_px;
        SettingsError::unless(
            (0.25..=64.0).contains(&step_px),
            "ring_step_px",
            step_px.into(),
            "from 0.25 to 64",
        )?;
        let widths_px = [
            ("eligible_margin_px", self.eligible_margin_px),
            ("box_radius_px", self.box_radius_px),
            ("seam_px", self.seam_px),
        ];
        for (field, width_px) in widths_px {
            let is_allowed = (0..=256).contains(&width_px);
            SettingsError::unless(is_allowed, field, width_px.into(), "from 0 to 256")?;
        }
        let counts = [
            ("n_ring_directions", self.n_ring_directions),
            ("n_rings", self.n_rings),
            ("n_blocker_taps", self.n_blocker_taps),
            ("n_filter_taps", self.n_filter_taps),
        ];
        for (field, n) in counts {
            SettingsError::unless((1..=1024).contains(&n), field, n.into(), "from 1 to 1024")?;
        }
        Ok(())
    }
}

/// A preset name that does not exist.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("preset \"{asked}\" does not exist; choose one of {known}")]
pub struct UnknownPreset {
    /// The requested name.
    pub asked: String,
    /// The existing names.
    pub known: String,
}

impl FromStr for Preset {
    type Err = UnknownPreset;

    fn from_str(name: &str) -> Result<Self, UnknownPreset> {
        Self::ALL
            .iter()
            .copied()
            .find(|preset| preset.name() == name)
            .ok_or_else(|| UnknownPreset {
                asked: name.to_owned(),
                known: Self::ALL
                    .iter()
                    .map(|preset| preset.name())
                    .collect::<Vec<_>>()
                    .join(", "),
            })
    }
}

impl fmt::Display for Preset {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
