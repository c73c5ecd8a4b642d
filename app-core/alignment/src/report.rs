//! The results of alignment, and their use. In JSON a number that is not finite is null, and an
//! outcome or a reason is a sentence.

use std::fmt;

use glam::DVec3;
use serde::{Serialize, Serializer};

use crate::no_light::NoLight;
use crate::probe::ProbeReport;
use app_scene::lens::Distortion;
use app_scene::scene::Light;

/// The alignment of a frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[non_exhaustive]
pub struct AlignmentReport {
    /// The focal length; `None` if not requested.
    pub focal_length: Option<RatioAlignment>,
    /// The scale of the world; `None` if not requested.
    pub world_scale: Option<RatioAlignment>,
    /// The camera; `None` without a plate or with too little texture.
    pub camera: Option<CameraAlignment>,
    /// The toy's pose; `None` if too little of its outline is visible.
    pub pose: Option<PoseAlignment>,
    /// The toy's model, adapted to its outline; `None` if it is unchanged.
    pub model: Option<ModelAlignment>,
    /// The lights, in the order of the list, without those that are not used: beyond the fourth, or
    /// below all receivers. Empty if they were not estimated: none is listed, there is no plate, the
    /// toy's pose is too uncertain, or the picture shows too little of their shadows.
    pub lights: Vec<LightAlignment>,
    /// Error of the predicted shadows with the given and with the estimated lights: mean squares
    /// over receivers, in units of the expected error by noise and light model. `None` if lights
    /// were not estimated.
    pub light_errors: Option<[f64; 2]>,
    /// Estimates from the scene's probe, if no light is listed: initial guesses of the discovered
    /// ones.
    pub probe: Option<ProbeReport>,
    /// Lights that were found without a list, or far from a list that does not explain the shadow,
    /// strongest first; empty if a list stays, or none was found.
    pub discovered: Vec<EstimatedLight>,
    /// The reason why no light was found by a shadow; `None` if lights are listed or were found. A
    /// probe's estimates are then used directly.
    pub no_light: Option<NoLight>,
    /// One wide light that is assumed if none is listed, estimated from a probe or found: a coarse
    /// guess; `None` if ambient light explains the picture about as well.
    pub assumed: Option<AssumedLight>,
    /// Whether the one light is long, and shown as a line of round ones.
    pub is_long: bool,
    /// The fraction of the shadows in the picture that the present lights leave unexplained; `None`
    /// if too little of them is visible, and without lights.
    pub unexplained: Option<f64>,
    /// Whether plates were relit, since lights were moved or switched on.
    pub is_relit: bool,
    /// Planes of things on the receivers that were found by the toy's shadow on them: the scene has them as receivers.
    pub planes: Vec<PlaneAlignment>,
}

/// A plane of a thing that stands on a receiver, by the toy's shadow on it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PlaneAlignment {
    /// Height of its centre above that receiver, in metres.
    pub height_m: f64,
    /// Between both, in radians.
    pub tilt_rad: f64,
    /// Half the sides of its rectangle, in metres.
    pub half_extent_m: [f64; 2],
    /// Mean squared difference from what the thing shows, in plates: of that receiver, and of this
    /// plane; 0 if the toy hides it.
    pub losses: [f64; 2],
}

impl PlaneAlignment {
    /// Whether it is a side of a thing, and not its top.
    #[must_use]
    pub fn is_upright(&self) -> bool {
        self.tilt_rad >= std::f64::consts::FRAC_PI_2
    }
}

impl fmt::Display for PlaneAlignment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, z] = self.half_extent_m.map(|half_m| 2e2 * half_m);
        if self.is_upright() {
            return write!(f, "an upright plane of a thing, {x:.0} x {z:.0} cm");
        }
        write!(f, "a plane {:.0} mm above the receiver", 1e3 * self.height_m)?;
        if self.tilt_rad > 0.0 {
            write!(
                f,
                " in its middle, tilted by {:.0} degrees",
                self.tilt_rad.to_degrees()
            )?;
        }
        write!(f, ", {x:.0} x {z:.0} cm")
    }
}

/// The camera, estimated from the receivers in the plates.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CameraAlignment {
    /// Whether the camera was corrected: only if that explains the picture better by more than
    /// noise.
    pub is_applied: bool,
    /// Root mean square shift of the receivers' points in the picture, in pixels.
    pub moved_px: f64,
    /// Distance between the given and the estimated camera, in metres.
    pub moved_m: f64,
    /// Rotation between them, in radians.
    pub turned_rad: f64,
    /// Fraction of the points, by brightness, that the given camera does not explain, and that the
    /// estimated one does not.
    pub errors: [f64; 2],
}

/// The toy's pose, estimated from its outline, and from its texture if its model has one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PoseAlignment {
    /// Whether the toy is shown in another place than given: at the estimate, which improves the
    /// outline by more than noise, or at an earlier estimate.
    pub is_applied: bool,
    /// Whether it is shown at an earlier estimate: this view gives nothing better.
    pub is_held: bool,
    /// Distance of the toy's centre between the given and the estimated pose, in metres.
    pub moved_m: f64,
    /// Rotation between them, in radians.
    pub turned_rad: f64,
    /// Root mean square distance from the outline, as given or as kept, to that in the picture, in
    /// pixels; a distant piece counts as two pixels.
    pub given_outline_px: f64,
    /// The same for the estimated pose. If the model was adapted in this view, both refer to the
    /// adapted one.
    pub outline_px: f64,
    /// Standard deviation of the estimate: from the scatter between parts of the outline, and from
    /// the misfit.
    pub deviation: PoseDeviation,
    /// Estimated size of the toy over the given one; 1 unless the toy stands on a receiver and only
    /// another size explains its outline there.
    pub size_ratio: f64,
    /// Distance of the model's outline along some centimetres in the estimated pose, in pixels: the
    /// root mean square.
    pub model_px: f64,
    /// Whether that is within the usual error of camera pictures: if not, the model, before it was
    /// adapted, differs from this toy.
    pub is_of_model: bool,
    /// Correlation of the model's texture with the picture's at the estimated pose, up to 1;
    /// `None` without a texture or if the picture shows another one: the pose is then estimated
    /// from the outline alone.
    pub texture_correlation: Option<f64>,
    /// Standard deviation of the spread that lens and focus give the outline, in pixels; 0 if it is
    /// sharp.
    pub spread_px: f64,
    /// The shown toy's position on the receiver that it was given on; `None` if it is given above
    /// all of them.
    pub stand: Option<Stand>,
}

/// The toy's model in another shape: a smooth displacement along its normals that gives it the
/// toy's outline.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ModelAlignment {
    /// Root mean square of the non-zero displacements, in metres.
    pub displaced_m: f64,
    /// The largest of them.
    pub most_displaced_m: f64,
    /// Number of the outline's pieces that constrain it, each about a pixel long.
    pub n_pieces: usize,
    /// Root mean square distance of the outline with the given and with the adapted model, in
    /// pixels; a distant piece counts as half a pixel.
    pub outlines_px: [f64; 2],
    /// Logarithm of the likelihood ratio in favour of it.
    pub evidence: f64,
}

/// The position of a toy on a plane that it may stand on.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Stand {
    /// Height of the foot farthest from the plane, in metres; negative if it is below.
    pub height_m: f64,
    /// Angle between the plane and that of the feet, in radians.
    pub lean_rad: f64,
}

impl PoseAlignment {
    /// The toy's deviation from the receiver that it was given on, if a foot is more than a millimetre and more
    /// than twice the pose's deviation from it; `None` if it stands there, or floats. A lean alone counts for
    /// nothing: the toes of an exact heron, of which none is a millimetre high, lie on a plane that leans by 3.4
    /// degrees.
    #[must_use]
    pub fn off_receiver(&self) -> Option<Stand> {
        const MOST_HEIGHT_M: f64 = 1e-3;
        let height_m = MOST_HEIGHT_M.max(2.0 * self.deviation.depth_m);
        self.stand.filter(|stand| stand.height_m.abs() > height_m)
    }

    /// The outline's distance of the shown toy, in pixels.
    #[must_use]
    pub fn shown_px(&self) -> f64 {
        if self.is_applied && !self.is_held {
            self.outline_px
        } else {
            self.given_outline_px
        }
    }
}

/// Largest distance of a model's outline along some centimetres of it for the model to be the
/// toy's, in pixels; it grows with blur.
///
/// Correct models came to .19 in compressed and sharpened pictures, and to .28 at a blur of 2 px.
pub(crate) fn most_model_px(spread_px: f64) -> f64 {
    0.2 + 0.06 * spread_px
}

/// Standard deviation of a pose.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PoseDeviation {
    /// Across the camera's axis, in metres.
    pub lateral_m: f64,
    /// Along it, in metres.
    pub depth_m: f64,
    /// About all axes, in radians. Large if a toy can be turned without a visible change.
    pub rotation_rad: f64,
}

/// A light, estimated from its shadow.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LightAlignment {
    /// Whether the lights were corrected, all or none.
    pub is_applied: bool,
    /// Whether the estimate of this one differs visibly.
    pub is_moved: bool,
    /// Angle at the toy between the given and the estimated direction, in radians. For a light that
    /// was moved, "given" is here and below its earlier estimate.
    pub turned_rad: f64,
    /// Estimated distance over the given one; 1 for a directional light.
    pub distance_ratio: f64,
    /// Tangent of the estimated angular radius over that of the given one; `None` for a point
    /// light.
    pub size_ratio: Option<f64>,
    /// Whether the two sizes differ visibly.
    pub is_resized: bool,
    /// Standard deviation of the direction, in radians, by noise alone.
    pub deviation_rad: f64,
}

/// An unlisted light, found by its shadow.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct EstimatedLight {
    /// The light as a scene lists it.
    pub light: Light,
    /// Unit vector from the centre of the toy's box.
    pub direction_in_world: DVec3,
    /// Distance from there, in metres; `None` if unconstrained.
    pub distance_m: Option<f64>,
    /// Angular radius as seen from there, in radians.
    pub angular_radius_rad: f64,
    /// Its share of the light on the receiver nearest to the toy, at the toy's foot: 0 to 1.
    pub share: f64,
    /// Its uncertainty.
    pub deviation: LightDeviation,
}

/// A wide light that is assumed, since it explains the picture better than ambient light alone.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct AssumedLight {
    /// The light as a scene lists it.
    pub light: Light,
    /// Its share of the light on the receiver nearest to the toy, at the toy's foot: 0 to 1.
    pub share: f64,
    /// The fraction of ambient light's residual that it explains, in squares.
    pub explained: f64,
}

/// Standard deviation of an estimated light: from the residuals, the pose's deviation, and a
/// receiver that is not flat.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LightDeviation {
    /// Standard deviation of the direction, in radians.
    pub direction_rad: f64,
    /// Standard deviation of the inverse distance, in 1/m, which unlike that of the distance is
    /// also defined for far lights.
    pub nearness_per_m: f64,
    /// Standard deviation of the angular radius, in radians.
    pub angular_radius_rad: f64,
}

/// A focal length, or the scale of a world, estimated from toy and shadow together.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RatioAlignment {
    /// The use of the estimate.
    pub outcome: RatioOutcome,
    /// The estimated focal length over the given one; or the lengths of the world, as its camera
    /// and receivers give them, over those by the size of the toy's model. 1 without an estimate.
    pub ratio: f64,
    /// Change of the ratio at which the error of the shadows has risen by the model's error;
    /// infinite without an estimate.
    pub deviation: f64,
    /// Error of the shadows with the given and with the estimated value, each with the best pose
    /// and lights: mean squares as for lights. `None` without an estimate.
    pub errors: Option<[f64; 2]>,
}

impl RatioAlignment {
    /// Whether frames and plates have the estimated focal length, or poses the scale.
    #[must_use]
    pub fn is_applied(&self) -> bool {
        self.outcome == RatioOutcome::Corrected
    }

    /// Whether toy and shadows were visible enough for an estimate.
    #[must_use]
    pub fn is_seen(&self) -> bool {
        self.outcome != RatioOutcome::Unseen
    }
}

/// The distortion of a lens, estimated from toy and shadow together.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LensAlignment {
    /// The use of the estimate.
    pub outcome: RatioOutcome,
    /// The estimate; no distortion if there is none.
    pub distortion: Distortion,
    /// Change of the distortion at the picture's farthest corner, as a fraction of the corner's
    /// distance from the principal point, at which the error of the shadows has risen by the
    /// model's error; infinite without an estimate.
    pub deviation: f64,
    /// Error of the shadows without a lens and with the estimate, as in a [`RatioAlignment`].
    pub errors: Option<[f64; 2]>,
}

impl LensAlignment {
    /// Whether it is to be removed from photographs.
    #[must_use]
    pub fn is_applied(&self) -> bool {
        self.outcome == RatioOutcome::Corrected
    }
}

/// The use of an estimate of a focal length, of the scale of a world, or of a lens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RatioOutcome {
    /// It is applied, in this frame and in all others.
    Corrected,
    /// The given value explains the picture as well, within noise.
    AsGiven,
    /// Other values explain the shadows as well, or no value near the given one does.
    Unconstrained,
    /// The shadows fit another value better, with which the outline of the toy fits worse:
    /// something else is wrong, for example the size of the toy or the height of a receiver.
    OutlineDisagrees,
    /// There is no plate, or toy or shadows are not visible enough for an estimate.
    Unseen,
}

impl fmt::Display for RatioOutcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Corrected => "corrected",
            Self::AsGiven => "the given value explains the shadows as well",
            Self::Unconstrained => "the shadows do not constrain it",
            Self::OutlineDisagrees => {
                "another would explain the shadows, but not the outline: toy or receivers may be of another size or height"
            }
            Self::Unseen => "there is no plate, or too little of toy and shadows is visible",
        })
    }
}

impl Serialize for RatioOutcome {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}
