//! Shadows in the picture: the toy projected onto each receiver from points over a light. A blurred
//! picture's shadow is the mean over shifts in the picture as well: each point of the light has its
//! own shift. Planes of things and reflections are compared with sharp ones.

use glam::{DMat4, DVec2, DVec3, DVec4, IVec2};

use super::behind::Behind;
use super::lamp::{Lamp, disc};
use super::receiver_pixels::ReceiverPixel;
use crate::raster::{Coverage, Rasterizer, project};
use crate::receivers::SeenReceiver;
use crate::shape::Shape;
use app_scene::scene::Intrinsics;

/// Sine of the lowest elevation of ambient light: lower directions have unbounded shadows.
const LOWEST: f64 = 0.1;

/// Components of ambient light: uniform, and linear along each axis of a receiver.
pub(super) const N_AMBIENT: usize = 3;

/// The fraction of each component that the toy blocks.
pub(super) type Ambient = [f32; N_AMBIENT];

/// A toy that casts shadows, and its picture.
pub(super) struct Caster<'a> {
    pub(super) shape: &'a Shape,
    pub(super) receivers: &'a [SeenReceiver],
    /// The shape's points in the plane space of each receiver.
    in_planes: Vec<Vec<DVec3>>,
    intrinsics: Intrinsics,
    size_px: IVec2,
    /// Standard deviation of the picture's blur, in its pixels.
    pub(super) softness_px: f64,
}

impl<'a> Caster<'a> {
    /// In a sharp picture.
    pub(super) fn new(
        shape: &'a Shape,
        receivers: &'a [SeenReceiver],
        intrinsics: Intrinsics,
        size_px: IVec2,
    ) -> Self {
        Self {
            shape,
            receivers,
            in_planes: in_planes(shape, receivers),
            intrinsics,
            size_px,
            softness_px: 0.0,
        }
    }

    /// In a picture that is blurred by a Gaussian, with its standard deviation in pixels.
    pub(super) fn softened(self, softness_px: f64) -> Self {
        Self { softness_px, ..self }
    }

    /// With another toy.
    pub(super) fn of_shape<'b>(&self, shape: &'b Shape) -> Caster<'b>
    where
        'a: 'b,
    {
        Caster {
            shape,
            receivers: self.receivers,
            in_planes: in_planes(shape, self.receivers),
            intrinsics: self.intrinsics,
            size_px: self.size_px,
            softness_px: self.softness_px,
        }
    }

    /// The fraction of a lamp's light that the toy blocks at each pixel.
    pub(super) fn lamp(
        &self,
        raster: &mut Rasterizer,
        pixels: &[ReceiverPixel],
        lamp: &Lamp,
        disc: &[DVec2],
    ) -> Vec<f32> {
        let mut taken = vec![[0.0]; pixels.len()];
        let shifts_px = shifts(disc.len(), self.softness_px);
        for (index, receiver) in self.receivers.iter().enumerate() {
            let plane_from_camera = &receiver.plane_from_camera;
            let foot = plane_from_camera.transform_point3(self.shape.centre) * DVec3::new(1.0, 0.0, 1.0);
            let points = lamp.points(plane_from_camera, self.shape.centre, disc);
            let weighted = points.into_iter().zip(&shifts_px).map(|(at, shift_px)| Point {
                at,
                shift_px: *shift_px,
                weights: [irradiance(at, foot)],
            });
            self.add(raster, pixels, index, weighted.collect(), &mut taken);
        }
        taken.into_iter().map(|[taken]| taken).collect()
    }

    /// The part of a lobe that the toy hides from each pixel of the first receiver; of eyes behind it in its space, homogeneous.
    pub(super) fn image(
        &self,
        raster: &mut Rasterizer,
        pixels: &[ReceiverPixel],
        eyes: &[DVec4],
    ) -> Vec<f32> {
        let mut hidden = vec![[0.0]; pixels.len()];
        if !self.receivers.is_empty() {
            let eyes = eyes.iter().map(|eye| Point::sharp(*eye, [1.0]));
            self.add(raster, pixels, 0, eyes.collect(), &mut hidden);
        }
        hidden.into_iter().map(|[hidden]| hidden).collect()
    }

    /// Irradiance of each pixel's receiver from a lamp, relative to the foot of the toy there: no shadow
    /// falls where the top of a thing hides the lamp.
    pub(super) fn lit(&self, pixels: &[ReceiverPixel], lamp: &Lamp) -> Vec<f32> {
        let seen = self.receivers.iter().map(|receiver| {
            let plane_from_camera = receiver.plane_from_camera;
            let foot = plane_from_camera.transform_point3(self.shape.centre) * DVec3::new(1.0, 0.0, 1.0);
            let middle = lamp.middle(&plane_from_camera, self.shape.centre);
            (plane_from_camera, middle, irradiance(middle, foot))
        });
        let seen: Vec<_> = seen.collect();
        let middles = seen.iter().map(|(_, middle, _)| *middle).collect();
        let behind = Behind::new(self.receivers, lamp, middles);
        let lit = pixels.iter().map(|pixel| {
            let (plane_from_camera, middle, at_foot) = seen[pixel.receiver];
            let open = if lamp.is_far() || at_foot <= 0.0 {
                1.0
            } else {
                let at = plane_from_camera.transform_point3(pixel.point);
                irradiance(middle, at) / at_foot
            };
            #[allow(clippy::cast_possible_truncation, reason = "a ratio, to 7 digits")]
            let lit = (behind.seen(pixel) * open) as f32;
            lit
        });
        lit.collect()
    }

    /// Bounding rectangles in pixels of the hard shadows from each point of a lamp, as the first
    /// and the last.
    pub(super) fn rects(&self, raster: &mut Rasterizer, lamp: &Lamp, disc: &[DVec2]) -> Vec<[IVec2; 2]> {
        let mut rects = Vec::new();
        for (index, receiver) in self.receivers.iter().enumerate() {
            for point in lamp.points(&receiver.plane_from_camera, self.shape.centre, disc) {
                let coverage = self.hard(raster, index, (point, DVec2::ZERO));
                if coverage.size_px != IVec2::ZERO {
                    let first = coverage.origin_px;
                    rects.push([first, first + coverage.size_px - 1]);
                }
            }
        }
        rects
    }

    /// The fractions of the ambient light that the toy blocks at each pixel: of a uniform one, and
    /// of linear ones along each axis of the receiver.
    pub(super) fn ambient(
        &self,
        raster: &mut Rasterizer,
        pixels: &[ReceiverPixel],
        n_directions: usize,
    ) -> Vec<Ambient> {
        // Malley's method: points on a disc lifted to the hemisphere are cosine-weighted.
        let lifted = |at: DVec2| {
            let sine = (1.0 - at.length_squared()).max(0.0).sqrt().max(LOWEST);
            Point::sharp(DVec4::new(at.x, sine, at.y, 0.0), [1.0, at.x, at.y])
        };
        let mut taken = vec![[0.0; N_AMBIENT]; pixels.len()];
        for index in 0..self.receivers.len() {
            let directions = disc(n_directions).into_iter().map(lifted);
            self.add(raster, pixels, index, directions.collect(), &mut taken);
        }
        taken
    }

    /// Adds the shadow from each point.
    fn add<const N: usize>(
        &self,
        raster: &mut Rasterizer,
        pixels: &[ReceiverPixel],
        receiver: usize,
        points: Vec<Point<N>>,
        taken: &mut [[f32; N]],
    ) {
        let total: f64 = points.iter().map(|point| point.weights[0]).sum();
        for point in points.into_iter().filter(|point| point.weights[0] > 0.0) {
            let coverage = self.hard(raster, receiver, (point.at, point.shift_px));
            #[allow(clippy::cast_possible_truncation, reason = "a fraction of one")]
            let weights = point.weights.map(|weight| (weight / total) as f32);
            let mut first = pixels.partition_point(|pixel| pixel.at.y < coverage.origin_px.y);
            for (at, end) in coverage.rows() {
                // At most two rows further.
                let next = &pixels[first..pixels.len().min(first + 2 * self.size_px.x as usize)];
                first += next.partition_point(|pixel| (pixel.at.y, pixel.at.x) < (at.y, at.x));
                let row = taken[first..].iter_mut().zip(&pixels[first..]);
                let row = row.take_while(|(_, pixel)| pixel.at.y == at.y && pixel.at.x < end);
                for (taken, pixel) in row.filter(|(_, pixel)| pixel.receiver == receiver) {
                    let covered = coverage.at(pixel.at);
                    for (taken, weight) in taken.iter_mut().zip(weights) {
                        *taken += weight * covered;
                    }
                }
            }
        }
    }

    /// The hard shadow from one point, shifted in the picture by some pixels.
    fn hard(&self, raster: &mut Rasterizer, receiver: usize, (light, shift_px): (DVec4, DVec2)) -> Coverage {
        let camera_from_plane = self.receivers[receiver].plane_from_camera.inverse();
        let in_plane = self.in_planes[receiver].iter();
        let flat = in_plane.map(|point| on_plane(*point, light, &camera_from_plane));
        let mut corners = project(flat, &self.intrinsics);
        for corner in &mut corners {
            *corner += shift_px.extend(0.0);
        }
        raster.coverage(&corners, &self.shape.faces, self.size_px)
    }
}

/// A point of a light.
struct Point<const N: usize> {
    /// In plane space, homogeneous.
    at: DVec4,
    /// Shift of its shadow in the picture.
    shift_px: DVec2,
    /// Weight for each component; the first is its light's.
    weights: [f64; N],
}

impl<const N: usize> Point<N> {
    fn sharp(at: DVec4, weights: [f64; N]) -> Self {
        Self {
            at,
            shift_px: DVec2::ZERO,
            weights,
        }
    }
}

/// Shifts with a Gaussian distribution, in pixels, each independent of its point's place on a disc.
///
/// Source: the sequence R2 of Roberts 2018, and the transform of Box and Muller 1958.
fn shifts(n: usize, deviation_px: f64) -> Vec<DVec2> {
    if deviation_px == 0.0 {
        return vec![DVec2::ZERO; n];
    }
    /// Inverse powers of the plastic number.
    const STEPS: DVec2 = DVec2::new(0.754_877_666_246_693, 0.569_840_290_998_053);
    let shift = |index: usize| {
        let [u, v] = (0.5 + (index + 1) as f64 * STEPS).fract().to_array();
        (-2.0 * u.max(f64::MIN_POSITIVE).ln()).sqrt() * DVec2::from_angle(std::f64::consts::TAU * v)
    };
    let mut shifts: Vec<DVec2> = (0..n).map(shift).collect();
    // With the distribution's own mean and variance, from which few points deviate slightly.
    let mean_of = |values: &dyn Fn(&DVec2) -> DVec2, shifts: &[DVec2]| {
        shifts.iter().map(values).sum::<DVec2>() / n.max(1) as f64
    };
    let mean = mean_of(&|shift| *shift, &shifts);
    let variance = mean_of(&|shift| (*shift - mean) * (*shift - mean), &shifts);
    for shift in &mut shifts {
        *shift = deviation_px * (*shift - mean) / variance.max(DVec2::splat(f64::EPSILON)).map(f64::sqrt);
    }
    shifts
}

fn in_planes(shape: &Shape, receivers: &[SeenReceiver]) -> Vec<Vec<DVec3>> {
    let receivers = receivers.iter();
    receivers
        .map(|receiver| in_plane(shape, &receiver.plane_from_camera))
        .collect()
}

fn in_plane(shape: &Shape, plane_from_camera: &DMat4) -> Vec<DVec3> {
    let points = shape.points.iter();
    points
        .map(|point| plane_from_camera.transform_point3(*point))
        .collect()
}

/// A shape's points projected on a receiver from a point of a light, homogeneous in plane space;
/// the result is in camera space.
pub(super) fn flattened(shape: &Shape, plane_from_camera: &DMat4, light: DVec4) -> Vec<DVec3> {
    let camera_from_plane = plane_from_camera.inverse();
    let in_plane = in_plane(shape, plane_from_camera);
    in_plane
        .into_iter()
        .map(|point| on_plane(point, light, &camera_from_plane))
        .collect()
}

/// The intersection of the ray from a light through a point with the plane, in camera space; behind
/// the camera if there is none.
fn on_plane(point: DVec3, light: DVec4, camera_from_plane: &DMat4) -> DVec3 {
    const BEHIND: DVec3 = DVec3::Z;
    let to_light = light.truncate() - light.w * point;
    if to_light.y > 0.0 {
        camera_from_plane.transform_point3(point - to_light * (point.y / to_light.y))
    } else {
        BEHIND
    }
}

/// Irradiance of the plane from a point of a light, up to a factor.
pub(super) fn irradiance(point: DVec4, at: DVec3) -> f64 {
    let to = point.truncate() - point.w * at;
    let falloff = if point.w == 0.0 {
        to.length()
    } else {
        to.length().powi(3)
    };
    if to.y > 0.0 { to.y / falloff } else { 0.0 }
}
