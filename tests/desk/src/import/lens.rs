//! Lenses of other programs: OpenCV's two models, of which those of COLMAP, nerfstudio and instant-ngp are parts.
//!
//! Source: OpenCV, «Camera Calibration and 3D Reconstruction» and «Fisheye camera model»; COLMAP, `models.h`; nerfstudio,
//! `camera_utils.py`, whose k3 and k4 go on with r^6 and r^8.

use app_core::lens::{Distortion, Lens as SessionLens, resampled};
use app_core::scene::{FieldError, Image, Intrinsics};
use glam::{DMat2, DVec2};

/// Number of sampled places per side of the picture.
const N_PLACES: u32 = 33;
/// Step of a difference quotient, as a fraction of the focal length.
const STEP: f64 = 1e-6;

/// The map from a pinhole's image point, `(x, y) = ((u - cx) / fx, (v - cy) / fy)`, to the
/// photograph's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lens {
    /// `(x, y) (1 + k1 r2 + k2 r2^2 + ...) / (1 + d1 r2 + ...)`, and a tangential part.
    Brown {
        /// Coefficients of r2, r2^2, r2^3 and r2^4.
        radial: [f64; 4],
        /// Coefficients of the divisor: OpenCV's k4, k5 and k6.
        divisor: [f64; 3],
        /// OpenCV's p1 and p2.
        tangential: [f64; 2],
    },
    /// The angle times `1 + k1 angle^2 + ...` in place of the angle's tangent.
    Fisheye([f64; 4]),
}

impl Lens {
    /// A pinhole.
    pub const NONE: Self = Self::radial([0.0; 4]);

    /// A lens with a radial polynomial alone.
    #[must_use]
    pub const fn radial(radial: [f64; 4]) -> Self {
        Self::Brown {
            radial,
            divisor: [0.0; 3],
            tangential: [0.0; 2],
        }
    }

    /// The lens as a session states it; `None` if it has more terms.
    #[must_use]
    pub fn as_session(&self) -> Option<Distortion> {
        match *self {
            Self::Brown {
                radial: [k1, k2, k3, k4],
                divisor,
                tangential,
            } if [k3, k4] == [0.0; 2] && divisor == [0.0; 3] && tangential == [0.0; 2] => {
                Some(Distortion { k1, k2 })
            }
            _ => None,
        }
    }

    /// Whether a session with that lens can be opened.
    pub(super) fn fits_session(&self, intrinsics: &Intrinsics, size_px: [u32; 2]) -> bool {
        self.as_session()
            .is_some_and(|lens| SessionLens::new(lens, intrinsics, size_px).is_ok())
    }

    /// The photograph's image of the pinhole's point `place`.
    #[must_use]
    pub fn distorted(&self, place: DVec2) -> DVec2 {
        let r2 = place.length_squared();
        match *self {
            Self::Brown {
                radial: [k1, k2, k3, k4],
                divisor: [d1, d2, d3],
                tangential: [p1, p2],
            } => {
                let above = 1.0 + r2 * (k1 + r2 * (k2 + r2 * (k3 + r2 * k4)));
                let below = 1.0 + r2 * (d1 + r2 * (d2 + r2 * d3));
                let both = 2.0 * place.x * place.y;
                let squares = DVec2::splat(r2) + 2.0 * place * place;
                place * (above / below) + DVec2::new(p1 * both + p2 * squares.x, p1 * squares.y + p2 * both)
            }
            Self::Fisheye([k1, k2, k3, k4]) => {
                let r = r2.sqrt();
                if r == 0.0 {
                    return place;
                }
                let angle = r.atan();
                let a2 = angle * angle;
                let bent = angle * (1.0 + a2 * (k1 + a2 * (k2 + a2 * (k3 + a2 * k4))));
                place * (bent / r)
            }
        }
    }

    /// Refuses a lens that maps two points of a pinhole's picture to one, or any point nowhere.
    pub(super) fn check(&self, intrinsics: &Intrinsics, size_px: [u32; 2]) -> Result<(), FieldError> {
        let size = DVec2::from_array(size_px.map(f64::from));
        let [centre, focal] = centre_and_focal(intrinsics);
        let places = (0..N_PLACES).flat_map(|y| (0..N_PLACES).map(move |x| DVec2::new(x.into(), y.into())));
        let unfolds = |place: DVec2| {
            let at = (place / f64::from(N_PLACES - 1) * size - centre) / focal;
            let [right, down] = [DVec2::X, DVec2::Y].map(|axis| {
                (self.distorted(at + STEP * axis) - self.distorted(at - STEP * axis)) / (2.0 * STEP)
            });
            let determinant = DMat2::from_cols(right, down).determinant();
            determinant > 0.0 && determinant.is_finite()
        };
        if places.into_iter().all(unfolds) {
            Ok(())
        } else {
            Err(FieldError::Folds)
        }
    }

    /// Converts a photograph to the picture of a pinhole of the same size and intrinsics.
    #[must_use]
    pub fn to_pinhole(&self, intrinsics: &Intrinsics, photograph: &Image) -> Image {
        let [centre, focal] = centre_and_focal(intrinsics);
        resampled(photograph, |at_px| {
            centre + focal * self.distorted((at_px - centre) / focal)
        })
    }

    /// Its coefficients that are not zero, by OpenCV's names.
    pub(super) fn named(&self) -> String {
        let (kind, named) = match *self {
            Self::Brown {
                radial,
                divisor,
                tangential,
            } => {
                let names = ["k1", "k2", "k3", "k of r^8", "k4", "k5", "k6", "p1", "p2"];
                let values = radial.into_iter().chain(divisor).chain(tangential);
                ("", names.into_iter().zip(values).collect::<Vec<_>>())
            }
            Self::Fisheye(k) => (
                "a fisheye ",
                ["k1", "k2", "k3", "k4"].into_iter().zip(k).collect(),
            ),
        };
        let said = named.into_iter().filter(|(_, value)| *value != 0.0);
        let said: Vec<_> = said.map(|(name, value)| format!("{name} {value}")).collect();
        format!("{kind}{}", said.join(", ")).trim_end().to_owned()
    }
}

fn centre_and_focal(intrinsics: &Intrinsics) -> [DVec2; 2] {
    [
        DVec2::new(intrinsics.cx_px, intrinsics.cy_px),
        DVec2::new(intrinsics.fx_px, intrinsics.fy_px),
    ]
}
