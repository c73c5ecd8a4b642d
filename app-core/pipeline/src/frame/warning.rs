//! Degraded modes and known defects of the pictures, as sentences.

use std::fmt;

use serde::{Serialize, Serializer};

use app_scene::words::Listed;

/// A degraded mode: the picture is the best that is possible, for a stated reason. JSON has the
/// displayed sentence.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Warning {
    /// No light is listed and none was found: the toy moves, and its shadow is made without a
    /// light.
    NoLight {
        /// Whether the preset uses the shadow of ambient light in the real picture; otherwise it
        /// draws no shadow.
        has_ambient: bool,
    },
    /// No light is known, so the new shadow is that of ambient light alone.
    AmbientAlone {
        /// Its strength relative to ambient light alone, from 0 to 1, as measured in the real
        /// picture; 0 if it is not measurable.
        strength: f32,
    },
    /// There is no plate, and the preset needs one: the camera frame passes through.
    NoPlate,
    /// There is no plate: the scene without the toy is estimated from the frame.
    PlateEstimated,
    /// The plates show only a part of the work region. The rest is estimated from the frame, or
    /// stays unchanged if the preset needs a plate.
    PlatePartial {
        /// The visible share, from 0 to 1.
        fraction: f64,
    },
    /// The scene has more receivers than this version supports.
    ReceiversLeftOut {
        /// Receivers whose shadow stays as photographed.
        names: Vec<String>,
    },
    /// The scene has more lights than this version supports.
    LightsLeftOut {
        /// Number of shadows that stay as photographed.
        n_lights: usize,
    },
    /// Lights that are not above any receiver cast no shadow there.
    LightsBelowReceivers {
        /// Indices of the lights in the list of the frame or of the scene.
        lights: Vec<usize>,
    },
    /// Lights are inside the real toy, which blocks them completely.
    LightsInsideToy {
        /// Indices of the lights in the list of the frame or of the scene.
        lights: Vec<usize>,
    },
    /// Too little of the real shadow is visible to measure the strength of the new one.
    FaintShadow {
        /// Assumed share of that strength, from 0 to 1: 1 less the sum of the lights' conditioning.
        assumed: f64,
    },
    /// The real shadow is visible on very few pixels, and no earlier view showed it.
    SmallShadow {
        /// Number of pixels that show it, each weighted by its occlusion from a light.
        n_pixels: f64,
    },
    /// The estimated bounce light of the toy exceeds the physical limits in two channels or more:
    /// the picture's levels are not linear light, or something nearby that is not in the scene
    /// changes it.
    BounceAtLimit {
        /// Whether the estimate is below zero; otherwise it is above full reflection.
        is_black: bool,
    },
    /// The pictures do not agree with the scene.
    Mismatch(Mismatch),
    /// The intensities of some lights are under-constrained, and a prior decides: their shadow
    /// coincides with that of others, or is hidden from the camera.
    LightsUnderConstrained {
        /// Indices of the lights in the list of the frame or of the scene.
        lights: Vec<usize>,
    },
    /// No umbra of the real shadow is visible: preset `paper` has nothing to sample, and draws no
    /// shadow.
    NothingToSample,
    /// New shadows fall or overlap in a way that no visible real ones do: preset `paper` samples
    /// the most similar lights.
    ShadowsUnseen {
        /// Combinations that would have to be visible.
        unseen: Vec<UnseenShadow>,
    },
    /// The scene exceeds the cost budget with the preset's own settings: some are turned down.
    QualityReduced {
        /// Descriptions of these settings.
        what: Vec<&'static str>,
        /// Triangles of a new view without the reductions.
        triangles: u64,
        /// Pixels that these triangles would cover, counted once for each triangle.
        covered_px: f64,
    },
    /// The scene exceeds the cost budget with all reductions: the camera frame passes through.
    TooCostly {
        /// Triangles of a new view.
        triangles: u64,
        /// Pixels that these triangles would cover, counted once for each triangle.
        covered_px: f64,
    },
    /// The toy is so glossy that it mirrors its surroundings, and not only the listed lights and an
    /// even sky. No model here describes that.
    TooGlossy {
        /// Measured roughness of the surface.
        roughness: f32,
        /// Strength of the glossiest material, relative to plastic.
        strength: f32,
    },
    /// The receiver below the toy is too smooth, since its surroundings that it reflects are
    /// unknown.
    MirrorLike {
        /// Width of the lobe, as Beckmann's alpha.
        roughness: f64,
    },
    /// The camera picture contains something that the model cannot explain.
    Outlier(Outlier),
    /// Something beside the toy is in the pictures.
    Thing(Thing),
    /// The toy and its shadow are out of the picture.
    OutOfPicture,
    /// The real toy is out of the picture, but the drawn one is not.
    ToyOutOfPicture,
    /// The camera's centre is not above the receiver.
    CameraBelowReceiver,
}

impl Warning {
    /// Sentence of a warning that contains no number.
    fn words(&self) -> Option<&'static str> {
        Some(match self {
            Self::NoLight { has_ambient: true } => {
                "no light is known: the new shadow is that of ambient light, as strong as in the picture; list a light, photograph a lens, or show more of the real shadow"
            }
            Self::NoLight { has_ambient: false } => {
                "no light is known: no new shadow is drawn; list a light, photograph a lens, or show more of the real shadow"
            }
            Self::NoPlate => "there is no plate, which this preset needs: the camera frame passes through",
            Self::PlateEstimated => {
                "there is no plate: the place behind toy and shadow is estimated from the frame"
            }
            Self::CameraBelowReceiver => {
                "the camera is not above the receiver: the camera frame passes through"
            }
            Self::NothingToSample => {
                "no umbra of the real shadow is visible: no new shadow is drawn, since there is nothing to sample; show more of the real shadow"
            }
            Self::OutOfPicture => "the toy and its shadow are out of the picture",
            Self::ToyOutOfPicture => {
                "the real toy is out of the picture: surfaces that no picture has shown have the colours of its model; turn the camera to it, or check its pose"
            }
            _ => return None,
        })
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(words) = self.words() {
            return f.write_str(words);
        }
        match self {
            Self::PlatePartial { fraction } => write!(
                f,
                "the plates show {:.0} % of the work region: the rest is estimated, or stays unchanged if the preset needs a plate",
                // Rounded down, since 100 % must mean that nothing is missing.
                (100.0 * fraction).floor()
            ),
            Self::ReceiversLeftOut { names } => write!(
                f,
                "the shadow on {} stays as photographed: the preset handles fewer receivers",
                listed(names, ", ")
            ),
            Self::LightsLeftOut { n_lights } => {
                write!(
                    f,
                    "the shadows of the last {n_lights} lights stay as photographed: the preset handles fewer"
                )
            }
            Self::LightsBelowReceivers { lights } => write!(
                f,
                "lights that are not above any receiver are ignored: {}",
                lights_in_words(lights)
            ),
            Self::LightsInsideToy { lights } => write!(
                f,
                "{} would be inside the real toy, which blocks all light: check the places of lights and toy",
                lights_in_words(lights)
            ),
            Self::TooGlossy { roughness, strength } => too_glossy(f, (*roughness, *strength)),
            Self::AmbientAlone { strength } => ambient_alone(f, *strength),
            Self::FaintShadow { assumed } => write!(
                f,
                "little of the real shadow is visible: {:.0} % of the strength of the new one is assumed; show more of it, from higher up or from a shorter distance",
                100.0 * assumed
            ),
            Self::SmallShadow { n_pixels } => write!(
                f,
                "the real shadow is visible on only {n_pixels:.0} pixels: the strength of the new one is uncertain; show more of it, from higher up or from a shorter distance"
            ),
            Self::BounceAtLimit { is_black } => f.write_str(bounce_at_limit(*is_black)),
            Self::LightsUnderConstrained { lights } => write!(
                f,
                "the real shadow does not constrain the strength of {} separately: the lights are assumed to be equal",
                lights_in_words(lights)
            ),
            Self::ShadowsUnseen { unseen } => shadows_unseen(f, unseen),
            Self::MirrorLike { roughness } => mirror_like(f, *roughness),
            Self::Mismatch(mismatch) => mismatch.fmt(f),
            Self::Outlier(unknown) => unknown.fmt(f),
            Self::Thing(thing) => thing.fmt(f),
            Self::QualityReduced {
                what,
                triangles,
                covered_px,
            } => too_much(
                f,
                (*triangles, *covered_px),
                format_args!(": {}", listed(what, ", ")),
            ),
            Self::TooCostly {
                triangles,
                covered_px,
            } => {
                let what =
                    " with every setting turned down: the camera frame passes through; take a simpler toy";
                too_much(f, (*triangles, *covered_px), format_args!("{what}"))
            }
            // [`Self::words`] has these.
            Self::NoLight { .. }
            | Self::NoPlate
            | Self::PlateEstimated
            | Self::CameraBelowReceiver
            | Self::NothingToSample
            | Self::OutOfPicture
            | Self::ToyOutOfPicture => Ok(()),
        }
    }
}

impl Serialize for Warning {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

fn shadows_unseen(f: &mut fmt::Formatter<'_>, unseen: &[UnseenShadow]) -> fmt::Result {
    write!(
        f,
        "no real shadow of {} is visible: the new one there has the shade of the others",
        listed(unseen, ", ")
    )
}

fn bounce_at_limit(is_black: bool) -> &'static str {
    if is_black {
        "the table beside the toy is darker than beside a black one: possible causes are a tone curve or HDR of the camera, a light that is not listed, or the shadow of something else; the new shadow may be too dark"
    } else {
        "the table beside the toy is brighter than beside a white one: possible causes are a bright thing nearby, or gloss; the new shadow may be too light"
    }
}

fn too_glossy(f: &mut fmt::Formatter<'_>, (roughness, strength): (f32, f32)) -> fmt::Result {
    write!(
        f,
        "the toy is as glossy as a mirror or metal (roughness {roughness:.3}, {strength:.1} times as reflective as plastic): its reflection of the room moves like paint; a matt spray or softer light would help"
    )
}

fn mirror_like(f: &mut fmt::Formatter<'_>, roughness: f64) -> fmt::Result {
    write!(
        f,
        "the table is nearly a mirror (roughness {roughness:.2}): the toy's reflection in it has one colour; lay something duller under the toy"
    )
}

fn ambient_alone(f: &mut fmt::Formatter<'_>, strength: f32) -> fmt::Result {
    if strength <= 0.0 {
        return f.write_str(
            "no light is known, and the real picture shows no shadow of ambient light: no new shadow is drawn",
        );
    }
    write!(
        f,
        "no light is known: the new shadow is that of ambient light, which is {:.0} % of the light according to the real shadow",
        100.0 * strength
    )
}

fn too_much(
    f: &mut fmt::Formatter<'_>,
    (triangles, covered_px): (u64, f64),
    and: fmt::Arguments<'_>,
) -> fmt::Result {
    write!(
        f,
        "a new view would draw {triangles} triangles over {covered_px:.2e} pixels, which exceeds the budget{and}"
    )
}

fn listed<'a, T>(items: &'a [T], between: &'static str) -> Listed<'a, T> {
    Listed { items, between }
}

fn lights_in_words(lights: &[usize]) -> String {
    let names: Vec<String> = lights.iter().map(|light| format!("light {light}")).collect();
    listed(&names, ", ").to_string()
}

/// A place on a receiver that exactly these lights do not reach.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnseenShadow {
    /// Index of the receiver in the scene's list.
    pub receiver: usize,
    /// Indices of the lights in the list of the frame or of the scene.
    pub lights: Vec<usize>,
}

impl fmt::Display for UnseenShadow {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let lights: Vec<_> = self.lights.iter().map(ToString::to_string).collect();
        write!(
            f,
            "light {} alone on receiver {}",
            lights.join(" + "),
            self.receiver
        )
    }
}

/// Something unexplained that stays as photographed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outlier {
    /// An object with a colour of its own, such as a hand.
    Object,
    /// A region that looks like the shadow of a light that is not listed.
    Shadow,
}

impl fmt::Display for Outlier {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Object => {
                "something that the plate does not show lies on the receiver: it stays as photographed"
            }
            Self::Shadow => "a shadow is visible that no listed light casts: it stays as photographed",
        })
    }
}

/// Something in the pictures beside the toy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Thing {
    /// It stands where the toy's shadow falls.
    OnReceiver,
    /// It hides a part of the real toy, or would hide one that is moved there.
    BeforeToy,
    /// The plate shows it, but the picture does not.
    InPlateAlone,
}

impl fmt::Display for Thing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::OnReceiver => {
                "a thing stands in the shadow's place: it stays as photographed, without a new shadow; move it away, or list its top as a receiver if it is flat"
            }
            Self::BeforeToy => {
                "a thing stands before the toy: the toy is drawn behind it; its hidden parts have the colours of the model"
            }
            Self::InPlateAlone => {
                "the plate shows something that the picture does not, such as the toy in another place or the shadow of a hand: that part of the plate is estimated; take the plate again"
            }
        })
    }
}

/// A contradiction between the pictures of the latest view and the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Mismatch {
    /// The picture is as bright as the plate in the place of the real shadow.
    NoShadow {
        /// Share of the lights in the plate's radiance, from 0 to 1.
        direct_fraction: f32,
    },
    /// The picture is as bright as the plate in the place of the real shadow, in one channel alone.
    NoShadowInColor {
        /// Name of the channel.
        color: &'static str,
    },
    /// The real shadow is too dark or too bright in the picture to be measured.
    ShadowUnreadable {
        /// Share of the shadow, from 0 to 1.
        fraction: f64,
    },
    /// The plate is too dark or too bright for a comparison.
    PlateUnreadable {
        /// Share of the receivers' pixels, from 0 to 1.
        fraction: f64,
    },
    /// The picture shows the same as the plate in the place of the real toy.
    ToyNotSeen {
        /// Share of the toy's pixels, from 0 to 1.
        fraction: f64,
    },
    /// Red and blue are swapped between the picture and the plate.
    RedAndBlueSwapped {
        /// Factor by which the colours agree better after swapping.
        times: f64,
    },
}

impl fmt::Display for Mismatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoShadow { direct_fraction } => write!(
                f,
                "the picture shows no real shadow at its expected place: it is as bright as the plate there ({:.1} % of that is from the lights); check lights and toy, and whether a light is on",
                100.0 * direct_fraction
            ),
            Self::NoShadowInColor { color } => write!(
                f,
                "the real shadow takes no {color} light away: unless the lamp has none, something of another colour stands in the shadow, or picture and plate differ in their white balance; the new shadow has that colour, too"
            ),
            Self::ShadowUnreadable { fraction } => write!(
                f,
                "{:.0} % of the real shadow is too dark or too bright in the picture to be measured: the strength of the new one is partly assumed; take it at another exposure",
                100.0 * fraction
            ),
            Self::PlateUnreadable { fraction } => write!(
                f,
                "{:.0} % of the plate is too dark or too bright to compare the picture with: take it again at another exposure",
                100.0 * fraction
            ),
            Self::ToyNotSeen { fraction } => write!(
                f,
                "the picture shows the plate at the place of the real toy ({:.0} % of it): check whether the toy is there, and its pose",
                100.0 * fraction
            ),
            Self::RedAndBlueSwapped { times } => write!(
                f,
                "picture and plate agree {times:.1} times better with red and blue swapped: check the order of channels in both"
            ),
        }
    }
}
