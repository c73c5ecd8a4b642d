//! What alignment found, and what it did with it. In JSON a number that is not finite is null, and an outcome or a reason is a sentence.

use std::fmt;

use glam::DVec3;
use serde::{Serialize, Serializer};

use crate::no_light::NoLight;
use crate::probe::ProbeReport;
use app_scene::lens::Distortion;
use app_scene::scene::Light;

/// What was aligned in a frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[non_exhaustive]
pub struct AlignmentReport {
    /// The focal length; none where nobody asked for it.
    pub focal_length: Option<RatioAlignment>,
    /// The scale of the world; none where nobody asked for it.
    pub world_scale: Option<RatioAlignment>,
    /// The camera; none where there is no plate or what it shows has too little texture.
    pub camera: Option<CameraAlignment>,
    /// The toy's pose; none where too little of its outline is seen.
    pub pose: Option<PoseAlignment>,
    /// The toy's model, adapted to its outline; none where it is as given.
    pub model: Option<ModelAlignment>,
    /// The lights, in the order of the list; empty where they were not found: none or more than four are listed, there is no plate,
    /// the toy's pose is not known well enough, or the picture shows too little of their shadows.
    pub lights: Vec<LightAlignment>,
    /// Error of the shadows that the given lights predict, and of those that were found: mean squares over receivers, in units of
    /// what noise and the model of light are expected to leave. None where lights were not looked at.
    pub light_errors: Option<[f64; 2]>,
    /// What the scene's probe tells, where no light is listed: a first guess of those that were discovered.
    pub probe: Option<ProbeReport>,
    /// The lights that were looked for where none are listed, or far from a list that does not explain the shadow, strongest first; empty
    /// where a list stands, or none was found.
    pub discovered: Vec<DiscoveredLight>,
    /// Why none was found by a shadow; none where lights are listed or were found. Those that a probe tells are then taken as they
    /// are.
    pub no_light: Option<NoLight>,
    /// One wide light that is assumed where none is listed, told or found: a coarse guess, and none where light from all around explains
    /// the picture about as well.
    pub assumed: Option<AssumedLight>,
    /// Whether the one light is long, and shown as a line of round ones.
    pub is_long: bool,
    /// The part of the shadows in the picture that the lights in use leave unexplained; none where too little of them is seen, and
    /// where there are no lights.
    pub unexplained: Option<f64>,
    /// Whether plates are in another light than they were taken in, since lights were moved or switched on.
    pub is_relit: bool,
}

/// The camera, by what the receivers look like in the plates.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CameraAlignment {
    /// Whether the camera was moved: only where that explains the picture better by more than noise does.
    pub is_applied: bool,
    /// Root mean square that points of the receivers moved in the picture, in pixels.
    pub moved_px: f64,
    /// How far the camera was found from where it was given, in metres.
    pub moved_m: f64,
    /// How far it was found turned, in radians.
    pub turned_rad: f64,
    /// Part of the points that the given camera does not explain, by brightness, and that the found one does not.
    pub errors: [f64; 2],
}

/// The toy's pose, by its outline, and by its texture if its model has one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PoseAlignment {
    /// Whether the toy is shown elsewhere than it was given: where it was found, which brings the outline nearer by more than noise
    /// explains, or where it was found before.
    pub is_applied: bool,
    /// Whether it is shown where it was before: this view tells nothing better.
    pub is_held: bool,
    /// How far the middle of the toy was found from where it was given, in metres.
    pub moved_m: f64,
    /// How far it was found turned, in radians.
    pub turned_rad: f64,
    /// Root mean square distance from the outline, as given or as held, to that in the picture, in pixels; a piece that is far off
    /// counts as two pixels.
    pub given_outline_px: f64,
    /// The same for the pose that was found. Where the model was adapted in this view, both are by the adapted one.
    pub outline_px: f64,
    /// One deviation of what was found: by how much parts of the outline pull against one another, and by how much they misfit.
    pub deviation: PoseDeviation,
    /// Size of the toy as found over that given; 1 unless the toy stands on a receiver and only another size explains its outline there.
    pub size_ratio: f64,
    /// What the outline of the toy's model is off by along some centimetres of it where it was found, in pixels: the root mean square.
    pub model_px: f64,
    /// Whether that is what the pictures of cameras let it be off by: else the model, before it was adapted, is not quite this toy.
    pub is_of_model: bool,
    /// Correlation of the texture of the toy's model with the picture's, between -1 and 1, where the toy was found; none if the toy has no
    /// texture, or another one than its model, and the pose is by the outline alone.
    pub texture_correlation: Option<f64>,
    /// Standard deviation of the spread that lens and focus give the outline, in pixels; 0 where it is sharp.
    pub spread_px: f64,
    /// How the toy, where it is shown, is on the receiver that it was given on; none where it is given above all of them.
    pub stand: Option<Stand>,
}

/// The toy's model in another shape: a smooth displacement along its normals, by which its outline is that of the toy.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ModelAlignment {
    /// Root mean square of the displacements, in metres: of the points that are displaced at all.
    pub displaced_m: f64,
    /// The largest of them.
    pub most_displaced_m: f64,
    /// Pieces of the outline that tell it, each about a pixel long.
    pub n_pieces: usize,
    /// Root mean square distance of the outline with the model as given, and as adapted, in pixels; a piece that is far off counts as
    /// half a pixel.
    pub outlines_px: [f64; 2],
    /// Logarithm of how much likelier the picture is with it.
    pub evidence: f64,
}

/// How a toy is on a plane that it may stand on.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Stand {
    /// Of the foot that is farthest from the plane, in metres: above it, or, below 0, beneath it.
    pub height_m: f64,
    /// Between the plane and that of the feet, in radians.
    pub lean_rad: f64,
}

impl PoseAlignment {
    /// How the toy is off the receiver that it was given on, by more than a millimetre or a degree and by more than twice what its pose may
    /// be off by; none if it stands there, or floats.
    #[must_use]
    pub fn off_receiver(&self) -> Option<Stand> {
        const MOST_HEIGHT_M: f64 = 1e-3;
        const MOST_LEAN_RAD: f64 = 0.017;
        let height_m = MOST_HEIGHT_M.max(2.0 * self.deviation.depth_m);
        let lean_rad = MOST_LEAN_RAD.max(2.0 * self.deviation.rotation_rad);
        self.stand
            .filter(|stand| stand.height_m.abs() > height_m || stand.lean_rad > lean_rad)
    }

    /// The outline's distance as the toy is shown, in pixels.
    #[must_use]
    pub fn shown_px(&self) -> f64 {
        if self.is_applied && !self.is_held {
            self.outline_px
        } else {
            self.given_outline_px
        }
    }
}

/// A model whose outline is off by more, along some centimetres of it, is not the toy, in pixels: the softer a picture, the more it may be.
///
/// Right models came to .19 in compressed and sharpened pictures, and to .28 where they were spread by 2 px.
pub(crate) fn most_model_px(spread_px: f64) -> f64 {
    0.2 + 0.06 * spread_px
}

/// One deviation of a pose.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PoseDeviation {
    /// Across the camera's axis, in metres.
    pub lateral_m: f64,
    /// Along it, in metres.
    pub depth_m: f64,
    /// About all axes, in radians. Large where a toy can be turned unseen.
    pub rotation_rad: f64,
}

/// A light, by its shadow.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LightAlignment {
    /// Whether the lights were moved, all or none.
    pub is_applied: bool,
    /// Whether this one was found elsewhere by enough to show.
    pub is_moved: bool,
    /// Angle at the toy between the direction given and that found, in radians. Given is here, and below, where it was before, of a
    /// light that was moved.
    pub turned_rad: f64,
    /// Found distance over the given; 1 for a directional light.
    pub distance_ratio: f64,
    /// Tangent of the angular radius as found, over that as given; none for a point light.
    pub size_ratio: Option<f64>,
    /// One deviation of the direction, in radians, by noise alone.
    pub deviation_rad: f64,
}

/// A light that nobody listed, by its shadow.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DiscoveredLight {
    /// As a scene lists it.
    pub light: Light,
    /// Unit vector from the middle of the toy's box.
    pub direction_in_world: DVec3,
    /// From there, in metres; none where it is too far away to be told.
    pub distance_m: Option<f64>,
    /// Half the angle that it fills as seen from there, in radians.
    pub angular_radius_rad: f64,
    /// Its part of the light on the receiver that is nearest to the toy, at the toy's foot: 0 to 1.
    pub share: f64,
    /// How well it is known.
    pub deviation: LightDeviation,
}

/// A wide light that is assumed, since it explains the picture better than light from all around alone.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct AssumedLight {
    /// As a scene lists it.
    pub light: Light,
    /// Its part of the light on the receiver that is nearest to the toy, at the toy's foot: 0 to 1.
    pub share: f64,
    /// The part that it explains of what light from all around leaves of the picture, in squares.
    pub explained: f64,
}

/// One deviation of a light that was found: what residuals and the pose's deviation leave open, and a receiver that is not flat.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LightDeviation {
    /// Of the direction, in radians.
    pub direction_rad: f64,
    /// Of one over the distance, in 1/m, which unlike that of the distance has a meaning for far lights too.
    pub nearness_per_m: f64,
    /// Of half the angle that it fills, in radians.
    pub angular_radius_rad: f64,
}

/// A focal length, or the scale of a world, by toy and shadow together.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RatioAlignment {
    /// What was done with it.
    pub outcome: RatioOutcome,
    /// The focal length that was found, over that given; or the lengths of the world, which are those of its camera and its receivers, over
    /// what they are by the size of the toy's model. 1 where none was found.
    pub ratio: f64,
    /// How far the ratio may be off before the error of the shadows has risen by what errors of the model are taken for; infinite where
    /// none was found.
    pub deviation: f64,
    /// Error of the shadows with what was given, and with what was found, each with the pose and the lights that fit it best: mean
    /// squares as those of the lights. None where none was found.
    pub errors: Option<[f64; 2]>,
}

impl RatioAlignment {
    /// Whether frames and plates have the focal length that was found, or poses the scale.
    #[must_use]
    pub fn is_applied(&self) -> bool {
        self.outcome == RatioOutcome::Corrected
    }

    /// Whether toy and shadows were seen well enough to look for it.
    #[must_use]
    pub fn is_seen(&self) -> bool {
        self.outcome != RatioOutcome::Unseen
    }
}

/// The distortion of a lens, by toy and shadow together.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LensAlignment {
    /// What was done with it.
    pub outcome: RatioOutcome,
    /// As found; none where none was.
    pub distortion: Distortion,
    /// How far what the lens adds at the picture's farthest corner may be off, in parts of the corner's distance from the principal
    /// point, before the error of the shadows has risen by what errors of the model are taken for; infinite where none was found.
    pub deviation: f64,
    /// Error of the shadows without a lens and with what was found: as those of a [`RatioAlignment`].
    pub errors: Option<[f64; 2]>,
}

impl LensAlignment {
    /// Whether photographs are to be freed of it.
    #[must_use]
    pub fn is_applied(&self) -> bool {
        self.outcome == RatioOutcome::Corrected
    }
}

/// What was done with a focal length, the scale of a world, or a lens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RatioOutcome {
    /// It is corrected, in this frame and in all others.
    Corrected,
    /// That given explains the picture as well, but for noise.
    AsGiven,
    /// Others explain the shadows as well, or none near that given does.
    NotTold,
    /// The shadows ask for another one, with which the outline of the toy fits worse: something else is off, such as the size of the toy
    /// or the height of a receiver.
    OutlineDisagrees,
    /// There is no plate, or toy or shadows are not seen well enough to look for it.
    Unseen,
}

impl fmt::Display for RatioOutcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Corrected => "corrected",
            Self::AsGiven => "that given explains the shadows as well",
            Self::NotTold => "the shadows do not tell it",
            Self::OutlineDisagrees => {
                "another would explain the shadows, but not the outline: toy or receivers may be of another size or height"
            }
            Self::Unseen => "there is no plate, or too little of toy and shadows is seen",
        })
    }
}

impl Serialize for RatioOutcome {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}
