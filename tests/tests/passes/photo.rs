//! Plate and frame of a stand, made with the model itself: the fit has a known answer.

use std::sync::Arc;

use app_core::gloss::Gloss;
use app_core::scene::Image;
use app_core::toy::PosedMesh;
use glam::{DVec2, DVec3, DVec4, UVec2};
use reference::fit::toy_radiance;
use reference::gloss::{Glossy, SeenPoint, reflected};
use reference::model::{ReceiverPoint, ReceiverSolution, Region, Solution, centre_px};
use reference::raster::Raster;
use reference::self_shadow::received;
use reference::visibility::visibility_map;

use crate::stand::Stand;
use crate::toy;

const N_POINTS: usize = 64;

/// The solution with which the pictures are made.
pub(crate) fn truth(n_lights: usize) -> Solution {
    // Fractions on the table, then on the wall, which has the second light behind it, and on others.
    let of_wall = [DVec3::new(0.7, 0.66, 0.58), DVec3::ZERO];
    let direct_fractions = [
        [DVec3::new(0.34, 0.38, 0.44), DVec3::new(0.24, 0.2, 0.14)],
        of_wall,
        of_wall,
        of_wall,
    ];
    let of_others = DVec3::new(0.1, 0.18, 0.22);
    let bounces = [DVec3::new(0.25, 0.15, 0.08), of_others, of_others, of_others];
    let receivers = bounces
        .iter()
        .zip(direct_fractions)
        .map(|(bounce, direct_fractions)| ReceiverSolution {
            bounce: *bounce,
            direct_fractions: direct_fractions[..n_lights].to_vec(),
            clipped: DVec3::ZERO,
        });
    let light = [DVec3::new(0.55, 0.5, 0.48), DVec3::new(0.35, 0.36, 0.4)];
    Solution {
        gain: DVec3::new(1.04, 1.0, 0.96),
        intensities: vec![DVec3::ONE; n_lights],
        receivers: receivers.collect(),
        toy: [DVec3::splat(0.55), DVec3::splat(0.25)]
            .into_iter()
            .chain(light)
            .take(2 + n_lights)
            .collect(),
    }
}

/// A point of a receiver, or of the endless table if the pixel shows none.
fn point_seen(region: &Region, texel: UVec2) -> ReceiverPoint {
    let at = centre_px(texel);
    let beyond = || ReceiverPoint {
        receiver: 0,
        in_plane: region.receivers[0].plane_point(at).unwrap_or_default(),
    };
    region.receiver_point(at).unwrap_or_else(beyond)
}

/// Plate and frame of wood under the true light, with a small part that no model explains.
pub(crate) fn photograph(stand: &Stand) -> [Arc<Image>; 2] {
    let photo = Photo {
        solution: truth(stand.setup.lights.len()),
        albedo: wood,
        unmodelled: faint_light,
        paint: |_| DVec3::ONE,
        gloss: None,
    };
    [photo.plate(stand), photo.frame(stand, &stand.physical)]
}

/// Parameters of a stand's pictures.
#[derive(Clone, Debug)]
pub(crate) struct Photo {
    pub(crate) solution: Solution,
    pub(crate) albedo: fn(ReceiverPoint) -> DVec3,
    /// Light that is added to the frame alone, in plates.
    pub(crate) unmodelled: fn(ReceiverPoint) -> DVec3,
    /// Factor on the base colour of a triangle of the toy.
    pub(crate) paint: fn(usize) -> DVec3,
    /// Gloss of the toy, if there is any.
    pub(crate) gloss: Option<Gloss>,
}

impl Photo {
    /// A smooth table under the true light alone.
    pub(crate) fn plain(n_lights: usize) -> Self {
        Self {
            solution: truth(n_lights),
            albedo: smooth,
            unmodelled: |_| DVec3::ZERO,
            paint: |_| DVec3::ONE,
            gloss: None,
        }
    }

    /// The place without the toy, linear.
    pub(crate) fn plate_at(&self, region: &Region, point: ReceiverPoint) -> DVec3 {
        (self.albedo)(point) * self.solution.plate_falloff(region, point)
    }

    pub(crate) fn plate(&self, stand: &Stand) -> Arc<Image> {
        self.exposed_plate(stand, DVec3::ONE)
    }

    /// The plate at another exposure and white balance.
    pub(crate) fn exposed_plate(&self, stand: &Stand, gain: DVec3) -> Arc<Image> {
        let region = stand.region(&stand.whole_image());
        let plate = Raster::from_fn(region.size_px, |texel| {
            gain * self.plate_at(&region, point_seen(&region, texel))
        });
        Arc::new(image(&plate))
    }

    /// The toy in a pose, with its shadows.
    pub(crate) fn frame(&self, stand: &Stand, posed: &PosedMesh) -> Arc<Image> {
        self.frame_casting(stand, posed, |_| posed)
    }

    /// Light that the toy reflects at a point, relative to the gain.
    fn reflected(&self, stand: &Stand, region: &Region, point: &SeenPoint) -> DVec3 {
        let Some(gloss) = &self.gloss else {
            return DVec3::ZERO;
        };
        let glossy = Glossy {
            roughness: f64::from(gloss.roughness),
            strengths: gloss.strengths.map(f64::from).to_vec(),
            angular_radii_rad: stand.angular_radii_rad(),
        };
        reflected(&self.solution, &glossy.columns(region, point))
            .into_iter()
            .sum()
    }

    /// The toy in a pose, with each light's shadow of another pose.
    pub(crate) fn frame_casting<'a>(
        &self,
        stand: &Stand,
        posed: &PosedMesh,
        caster_of: impl Fn(usize) -> &'a PosedMesh,
    ) -> Arc<Image> {
        let region = stand.region(&stand.whole_image());
        let size = region.size_px;
        let light = |i| stand.light_casters(caster_of(i), i, N_POINTS);
        let lights: Vec<Raster<f64>> = (0..region.lights.len())
            .map(|i| visibility_map(&light(i), &region, size))
            .collect();
        let ambient = visibility_map(&stand.ambient_casters(posed, N_POINTS), &region, size);
        let occluder = stand.occluder(posed);
        let light_points: Vec<_> = (0..region.lights.len())
            .map(|i| stand.light_points(i, N_POINTS))
            .collect();
        let frame = Raster::from_fn(size, |texel| {
            let (origin, direction) = stand.camera_ray(centre_px(texel));
            if let Some(hit) = occluder.nearest(origin, direction) {
                let normal = posed.normals[stand.toy.indices()[3 * hit.triangle] as usize].as_dvec3();
                let at = origin + hit.distance * direction;
                let received = received(&region, &occluder, &light_points, at, normal);
                let light = toy_radiance(&self.solution, normal, received);
                let point = SeenPoint {
                    in_anchor: at,
                    normal,
                    camera_in_anchor: origin,
                    material: toy::material(hit.triangle),
                    received,
                };
                let base = (self.paint)(hit.triangle) * toy::base_color(hit.triangle);
                return self.solution.gain * (base * light + self.reflected(stand, &region, &point));
            }
            let at = point_seen(&region, texel);
            let mut visibility = DVec4::ZERO;
            lights
                .iter()
                .enumerate()
                .for_each(|(i, light)| visibility[i] = light.at(texel));
            let model = self
                .solution
                .receiver_model(&region, at, ambient.at(texel), visibility);
            self.solution.gain * self.plate_at(&region, at) * (model + (self.unmodelled)(at))
        });
        Arc::new(image(&frame))
    }
}

/// A pattern that changes slowly, so that its edges do not disturb comparisons.
fn smooth(point: ReceiverPoint) -> DVec3 {
    let at = point.in_plane;
    let colors = [DVec3::new(0.42, 0.36, 0.3), DVec3::new(0.3, 0.34, 0.4)];
    colors[point.receiver.min(1)] * (1.0 + 0.2 * (25.0 * at.x).sin() * (21.0 * at.y).cos())
}

/// A pattern similar to wood: grain, knots and speckle.
fn wood(point: ReceiverPoint) -> DVec3 {
    let at = point.in_plane;
    let grain = (170.0 * at.x + 2.0 * (31.0 * at.y).sin()).sin();
    let speckle = (9000.0 * at.x).sin() * (8000.0 * at.y).sin();
    let colors = [DVec3::new(0.55, 0.42, 0.3), DVec3::new(0.35, 0.4, 0.45)];
    colors[point.receiver.min(1)] * (1.0 + 0.22 * grain + 0.08 * speckle)
}

/// A faint light that is not listed.
fn faint_light(point: ReceiverPoint) -> DVec3 {
    let middles = [DVec2::new(0.08, 0.03), DVec2::new(-0.03, 0.01)];
    let from_middle = point.in_plane - middles[point.receiver.min(1)];
    0.012 * (-from_middle.length_squared() / 0.002).exp() * DVec3::new(1.0, 0.4, -0.5)
}

fn image(linear: &Raster<DVec3>) -> Image {
    let code = |color: DVec3| [code(color.x), code(color.y), code(color.z), 255];
    let rgba8 = linear.texels().iter().flat_map(|color| code(*color)).collect();
    Image {
        width_px: linear.size().x,
        height_px: linear.size().y,
        rgba8,
    }
}

/// The 8-bit code of a linear value.
pub(crate) fn code(linear: f64) -> u8 {
    #[allow(clippy::cast_possible_truncation, reason = "from 0 to 255")]
    let code = unrounded_code(linear).round() as u8;
    code
}

/// The code before rounding. Source: IEC 61966-2-1.
pub(crate) fn unrounded_code(linear: f64) -> f64 {
    let linear = linear.clamp(0.0, 1.0);
    255.0
        * if linear <= 0.003_130_8 {
            12.92 * linear
        } else {
            1.055 * linear.powf(1.0 / 2.4) - 0.055
        }
}
