//! Adapts the toy's model to the outline in the picture: a smooth field of displacements in the
//! estimated pose.
//!
//! Each round measures the outline of the displaced model from the codes beside it, and estimates
//! the field anew. The camera's edge response is estimated anew as well: a wrong model looks like a
//! soft lens.

use glam::DVec3;

use super::blur;
use super::contour_segments::{ContourSegment, cell_px};
use super::decide::COMPARED_PX;
use super::edge::{self, Optics};
use super::field::{Camera, Field, Skin};
use super::motion::Measured;
use super::paint::{Light, Lit, Paint};
use super::placement::Placement;
use super::settle::{LEAST_EVIDENCE, Misfit};
use super::{Search, enough};
use crate::picture::Pyramid;
use crate::report::{PoseAlignment, most_model_px};
use crate::rigid_motion::RigidMotion;
use crate::shape::Shape;
use app_scene::scene::PoseUncertainty;
use app_scene::toy::ToyError;

/// Number of rounds; each reduces the remaining distance.
const N_ROUNDS: usize = 4;
/// Typical displacement of correct models' outlines by a camera, over its maximum.
const AS_A_RULE: f64 = 0.5;
/// Displacement by the camera per pixel of blur: correct models came to .1 to .3 px at a blur of 2
/// px.
const OF_SPREAD: f64 = 0.1;

/// An adapted shape of a toy's model.
pub(crate) struct Adapted {
    /// Displacement of each point, in camera space.
    pub(crate) displacements_m: Vec<DVec3>,
    /// Root mean square distance of the outline with the given and with the adapted model, in
    /// pixels.
    pub(crate) outlines_px: [f64; 2],
    /// Number of measured pieces of the outline.
    pub(crate) n_pieces: usize,
    /// Logarithm of the likelihood ratio in favour of it.
    pub(crate) evidence: f64,
}

/// The toy's surface in its pose, with its colours.
pub(crate) type Surface = (Shape, Paint);

/// Whether the outline deviates over some centimetres by more than camera pictures usually do, so
/// that another shape is tried. `picture_px` are the picture's pixels per pixel of the largest
/// level.
pub(crate) fn is_doubtful(pose: &PoseAlignment, picture_px: f64) -> bool {
    let [model_px, spread_px] = [pose.model_px, pose.spread_px].map(|px| px / picture_px);
    model_px > AS_A_RULE * most_model_px(spread_px)
}

/// The model with the picture's outline; `None` if the picture does not support another one than
/// the given. `displaced` is the surface with its points displaced in camera space.
pub(crate) fn adapt(
    (given, normals): (&Surface, &[DVec3]),
    pyramid: &Pyramid,
    displaced: impl Fn(&[DVec3]) -> Result<Surface, ToyError>,
) -> Result<Option<Adapted>, ToyError> {
    let skin = Skin {
        shape: &given.0,
        normals,
    };
    let as_given = vec![DVec3::ZERO; skin.shape.points.len()];
    let mut displacements_m = as_given.clone();
    let mut now = displaced(&as_given)?;
    for round in 0..N_ROUNDS {
        let viewpoint = match round {
            0 => Viewpoint::sharp(&now, pyramid),
            _ => Viewpoint::new(&now, pyramid),
        };
        let measured = viewpoint.measured(&now);
        let field = measured.and_then(|measured| viewpoint.field(skin, (&now, &displacements_m), &measured));
        let Some(field) = field else {
            return Ok(None);
        };
        if round > 0 && field.evidence < 0.0 {
            return Ok(None);
        }
        displacements_m = field.displacements_m;
        now = displaced(&displacements_m)?;
    }
    // The camera's edge response is known best at a matching outline.
    let viewpoint = Viewpoint::new(&now, pyramid);
    let [Some(before), Some(after)] = [given, &now].map(|surface| viewpoint.measured(surface)) else {
        return Ok(None);
    };
    let Some(field) = viewpoint.field(skin, (given, &as_given), &before) else {
        return Ok(None);
    };
    let misfits = [&before, &after].map(|measured| Misfit::of(measured, Misfit::ROBUST_PX));
    let evidence = field.evidence.min(misfits[1].likelier_than(&misfits[0]));
    Ok((evidence >= LEAST_EVIDENCE).then(|| Adapted {
        displacements_m,
        outlines_px: misfits.map(|misfit| misfit.loss_px2.sqrt()),
        n_pieces: after.len(),
        evidence,
    }))
}

/// The observer of an outline.
struct Viewpoint<'a> {
    pyramid: &'a Pyramid,
    optics: Optics,
    light: Option<Light>,
}

impl<'a> Viewpoint<'a> {
    /// With the optics and the light that explain a surface best.
    fn new(surface: &Surface, pyramid: &'a Pyramid) -> Self {
        let sharp = Self::sharp(surface, pyramid);
        let posed = sharp.posed(surface, |posed| {
            blur::optics(&posed.beside(pyramid.level(0)), &posed.elements)
        });
        let (optics, _) = posed;
        Self { optics, ..sharp }
    }

    fn sharp((shape, paint): &Surface, pyramid: &'a Pyramid) -> Self {
        let mut search = Search::new(shape, pyramid, &PoseUncertainty::default());
        Self {
            pyramid,
            optics: Optics::default(),
            light: search.light(paint, &in_place(shape)),
        }
    }

    fn posed<T>(&self, (shape, paint): &Surface, of: impl FnOnce(&super::Posed<'_>) -> T) -> T {
        let mut search = Search::new(shape, self.pyramid, &PoseUncertainty::default());
        let light = self.light.as_ref();
        of(&search.posed(&in_place(shape), light.map(|light| Lit { paint, light })))
    }

    /// Measured pieces of the outline of a surface; `None` if there are too few.
    fn measured(&self, surface: &Surface) -> Option<Vec<Measured>> {
        let half_px = COMPARED_PX + self.optics.half_px();
        self.posed(surface, |posed| {
            let beside = posed.beside(self.pyramid.level(0));
            let measured = edge::measure_explained(&beside, &posed.elements, self.optics, half_px);
            enough(measured, &posed.elements).map(|(measured, _)| measured)
        })
    }

    /// The field of a surface with the given present displacements, and of its measured outline.
    fn field(
        &self,
        skin: Skin<'_>,
        (surface, displacements_m): (&Surface, &[DVec3]),
        measured: &[Measured],
    ) -> Option<Field> {
        let k = &self.pyramid.level(0).intrinsics;
        let segments = ContourSegment::all(measured, (&surface.0, displacements_m), k);
        let camera = Camera {
            alike_px: AS_A_RULE * most_model_px(0.0) + OF_SPREAD * self.optics.spread_px,
            cell_px: cell_px(measured.len()),
            pixel_m: skin.shape.centre.length() / k.fx_px,
        };
        Field::found(skin, &segments, camera)
    }
}

/// A shape in its place.
fn in_place(shape: &Shape) -> Placement {
    Placement::of(RigidMotion::none(shape.centre, shape.radius_m))
}
