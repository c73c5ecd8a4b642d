//! Options that ask for an estimate of a number that the session states.

/// The source of a number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Source {
    /// The session.
    #[default]
    Given,
    /// An estimate from the pictures, within 3 % of the session's number.
    Found,
}

/// The number to estimate from the pictures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Ratio {
    /// No number: all are the session's.
    #[default]
    Given,
    /// The focal length.
    FocalLength,
    /// The scale of the world.
    WorldScale,
}

/// Options that ask for an estimate of a number.
#[derive(Clone, Copy, Debug, clap::Args)]
pub struct RatioArgs {
    /// Estimate the focal length, too, which takes several times as long as all else
    #[arg(long, value_enum, default_value_t)]
    focal_length: Source,
    /// Estimate the scale of the world instead, for a tracker whose scale is wrong: the toy's model
    /// has the right size
    #[arg(long, value_enum, default_value_t, conflicts_with = "focal_length")]
    world_scale: Source,
    /// Estimate two radial terms of the lens's distortion, in place of the session's
    #[arg(long, value_enum, default_value_t)]
    lens: Source,
}

impl RatioArgs {
    /// The source of the lens.
    #[must_use]
    pub fn lens(&self) -> Source {
        self.lens
    }

    /// The number to estimate.
    #[must_use]
    pub fn asked(&self) -> Ratio {
        match (self.focal_length, self.world_scale) {
            (Source::Given, Source::Given) => Ratio::Given,
            (Source::Found, _) => Ratio::FocalLength,
            (Source::Given, Source::Found) => Ratio::WorldScale,
        }
    }
}
