//! A plain shaded picture of a toy, rendered on the processor.

use app_core::scene::Pose;
use app_core::toy::{Material, PosedMesh, Toy, ToyError, Wrap};
use app_scene::geometry::color::{code_of_linear, linear_of_codes};
use glam::{DMat4, DVec3, Vec2, Vec3};
use image::{Rgb, RgbImage};

use crate::small::shrunk;

/// Samples per pixel along each side.
const N_SAMPLES: u32 = 3;
/// Turn of the view from the front, and its elevation.
const YAW_DEG: f64 = -35.0;
const PITCH_DEG: f64 = 20.0;
/// Empty share at each border.
const MARGIN: f64 = 0.06;
/// Code of the background.
const BACKGROUND: u8 = 96;
/// Ambient light.
const AMBIENT: f32 = 0.35;

/// The view volume that several pictures of a toy share.
pub struct Stand {
    view_from_object: DMat4,
    /// Corners of the volume in view space: +X right, +Y up, towards the viewer +Z.
    min: DVec3,
    max: DVec3,
    linear: [f32; 256],
}

impl Stand {
    /// A volume around the toy in all of `poses`.
    ///
    /// # Errors
    ///
    /// Fails if a pose does not fit the toy.
    pub fn new(toy: &Toy, poses: &[Pose]) -> Result<Self, ToyError> {
        let view_from_object =
            DMat4::from_rotation_x(PITCH_DEG.to_radians()) * DMat4::from_rotation_y(YAW_DEG.to_radians());
        let mut posed = PosedMesh::default();
        let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for pose in poses {
            toy.pose(pose, &view_from_object, &mut posed)?;
            for point in posed.points() {
                min = min.min(point);
                max = max.max(point);
            }
        }
        Ok(Self {
            view_from_object,
            min,
            max,
            linear: linear_of_codes(),
        })
    }

    /// Draws a pose, as large as fits a square.
    ///
    /// # Errors
    ///
    /// Fails if the pose does not fit the toy.
    pub fn draw(&self, toy: &Toy, pose: &Pose, side_px: u32) -> Result<RgbImage, ToyError> {
        let mut posed = PosedMesh::default();
        toy.pose(pose, &self.view_from_object, &mut posed)?;
        let side = f64::from(side_px * N_SAMPLES);
        let extent = (self.max - self.min).truncate().max_element();
        let scale = if extent > 0.0 {
            (1.0 - 2.0 * MARGIN) * side / extent
        } else {
            0.0
        };
        let centre = 0.5 * (self.min + self.max);
        let on_picture = |point: DVec3| {
            let at = (point - centre) * scale;
            DVec3::new(0.5 * side + at.x, 0.5 * side - at.y, at.z).as_vec3()
        };
        let points: Vec<Vec3> = posed.points().map(on_picture).collect();
        let mut canvas = Canvas::new(side_px * N_SAMPLES);
        for part in toy.parts() {
            let Some(material) = toy.materials().get(part.material) else {
                continue;
            };
            let indices = &toy.indices()[part.indices.start as usize..part.indices.end as usize];
            for corners in indices.chunks_exact(3) {
                let corners = [0, 1, 2].map(|k| corners[k] as usize);
                canvas.triangle(corners.map(|corner| points[corner]), |weights| {
                    self.shade(toy, material, &posed, (corners, weights))
                });
            }
        }
        Ok(shrunk(&canvas.picture, side_px))
    }

    /// The codes of a point of a triangle.
    fn shade(
        &self,
        toy: &Toy,
        material: &Material,
        posed: &PosedMesh,
        (corners, weights): ([usize; 3], [f32; 3]),
    ) -> Rgb<u8> {
        let mut normal = Vec3::ZERO;
        let mut uv = Vec2::ZERO;
        let mut color = Vec3::ZERO;
        for (corner, weight) in corners.into_iter().zip(weights) {
            normal += weight * posed.normals[corner];
            uv += weight
                * toy
                    .uvs()
                    .get(corner)
                    .map_or(Vec2::ZERO, |uv| Vec2::from_array(*uv));
            color += weight
                * toy.colors_linear().map_or(Vec3::ONE, |colors| {
                    Vec3::new(colors[corner][0], colors[corner][1], colors[corner][2])
                });
        }
        let [r, g, b, _] = material.base_color_linear;
        let albedo = color * Vec3::new(r, g, b) * self.texel(toy, material, uv);
        // Light from the viewer's upper left.
        let towards_light = Vec3::new(-0.4, 0.7, 0.6).normalize();
        let direct = normal.normalize_or_zero().dot(towards_light).max(0.0);
        let light = albedo * (AMBIENT + (1.0 - AMBIENT) * direct);
        Rgb(light.to_array().map(code_of_linear))
    }

    fn texel(&self, toy: &Toy, material: &Material, uv: Vec2) -> Vec3 {
        let Some(used) = &material.base_color_texture else {
            return Vec3::ONE;
        };
        let Some(texture) = toy.textures().get(used.texture) else {
            return Vec3::ONE;
        };
        let x = texel_index(uv.x, used.wrap_u, texture.width_px);
        let y = texel_index(uv.y, used.wrap_v, texture.height_px);
        let at = 4 * (y * texture.width_px as usize + x);
        texture.rgba8_srgb.get(at..at + 3).map_or(Vec3::ONE, |codes| {
            Vec3::new(
                self.linear[usize::from(codes[0])],
                self.linear[usize::from(codes[1])],
                self.linear[usize::from(codes[2])],
            )
        })
    }
}

fn texel_index(coordinate: f32, wrap: Wrap, side_px: u32) -> usize {
    let share = match wrap {
        Wrap::Repeat => coordinate.rem_euclid(1.0),
        Wrap::MirroredRepeat => 1.0 - (coordinate.rem_euclid(2.0) - 1.0).abs(),
        Wrap::ClampToEdge => coordinate.clamp(0.0, 1.0),
    };
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to the texture"
    )]
    {
        ((share * side_px as f32) as usize).min(side_px.saturating_sub(1) as usize)
    }
}

/// A picture with its depth buffer.
struct Canvas {
    picture: RgbImage,
    nearness: Vec<f32>,
}

impl Canvas {
    fn new(side_px: u32) -> Self {
        Self {
            picture: RgbImage::from_pixel(side_px, side_px, Rgb([BACKGROUND; 3])),
            nearness: vec![f32::NEG_INFINITY; (side_px * side_px) as usize],
        }
    }

    /// Draws a triangle with a depth test: +X right, +Y down, towards the viewer +Z, in pixels.
    fn triangle(&mut self, [a, b, c]: [Vec3; 3], shade: impl Fn([f32; 3]) -> Rgb<u8>) {
        let cross = |u: Vec3, v: Vec3| u.x * v.y - u.y * v.x;
        let area = cross(b - a, c - a);
        if area == 0.0 || !area.is_finite() {
            return;
        }
        let side_px = self.picture.width();
        let pixels = |low: f32, high: f32| {
            #[allow(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "clamped to the picture"
            )]
            let [low, high] = [low, high].map(|at| at.clamp(0.0, side_px as f32) as u32);
            low..(high + 1).min(side_px)
        };
        let (min, max) = (a.min(b).min(c), a.max(b).max(c));
        for y in pixels(min.y, max.y) {
            for x in pixels(min.x, max.x) {
                let p = Vec3::new(x as f32 + 0.5, y as f32 + 0.5, 0.0);
                let weights = [cross(b - p, c - p), cross(c - p, a - p), cross(a - p, b - p)];
                let weights = weights.map(|weight| weight / area);
                if weights.iter().any(|weight| *weight < 0.0) {
                    continue;
                }
                let near = weights[0] * a.z + weights[1] * b.z + weights[2] * c.z;
                let nearest = &mut self.nearness[(y * side_px + x) as usize];
                if near > *nearest {
                    *nearest = near;
                    self.picture.put_pixel(x, y, shade(weights));
                }
            }
        }
    }
}
