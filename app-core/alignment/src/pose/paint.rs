//! Predicts the toy's colours beside its outline: its model's own colours, in the light on it in
//! the photograph.
//!
//! Beside the outline a toy's colour changes within a few pixels, as it turns away from the light
//! or another paint begins. The ratio of the photograph to a shaded model changes far less, so that
//! ratio is extrapolated across the outline, like the ratio to the plate on the other side.

use std::sync::Arc;

use glam::{DMat4, DVec2, DVec3, IVec2};
use nalgebra::{SMatrix, SVector};

use super::placement::Placement;
use super::texels::{mean_texel, texture_size};
use crate::picture::{Color, Level, index_in, noise_deviation};
use crate::raster::{Coverage, centres, project};
use crate::rigid_motion::RigidMotion;
use app_scene::geometry::color::linear_of_codes;
use app_scene::scene::{Intrinsics, Scene};
use app_scene::toy::{PosedMesh, Toy, ToyError, Wrap};

/// Number of spherical harmonics of the first three orders, which describe the irradiance of a matt
/// surface.
///
/// Source: Ramamoorthi and Hanrahan 2001.
const N_BASIS: usize = 9;
/// Weight of the prior on each order beyond the first, over that of the pixels: the visible side of
/// a toy does not constrain all.
const PRIOR: f64 = 1e-3;
/// Rounds of reweighting, and the scale of Cauchy's weights, relative to the light: the error of
/// shading by facets and contact.
const N_ROUNDS: usize = 4;
const ROBUST: f64 = 0.15;
/// Lower bound of a surface's irradiance, over the mean: darker pixels are in shadow, which the
/// model does not have.
const DARKEST: f32 = 0.15;
/// Number of pixels that an estimate needs, and the number above which more add nothing.
const LEAST_PIXELS: usize = 100;
const MOST_PIXELS: usize = 2000;
/// Distance of the light's pixels from the outline, in pixels.
const WITHIN_PX: i32 = 2;
/// Lower bound of paints, since light is divided by them.
const DARKEST_PAINT: f32 = 0.01;

type Basis = SVector<f64, N_BASIS>;

/// The toy's surface in its given place in camera space, with its paints.
#[derive(Clone, Debug)]
pub(crate) struct Paint {
    positions: Vec<DVec3>,
    normals: Vec<DVec3>,
    faces: Vec<Face>,
    toy: Arc<Toy>,
    /// Linear light of each code.
    linear: [f32; 256],
}

#[derive(Clone, Debug)]
struct Face {
    corners: [u32; 3],
    material: usize,
    color: Color,
    texture: Option<(usize, [Wrap; 2])>,
}

impl Paint {
    /// The paint of a toy in a scene's physical pose.
    pub(crate) fn new(scene: &Scene, camera_from_object: &DMat4) -> Result<Self, ToyError> {
        let toy = &scene.toy;
        let mut posed = PosedMesh::default();
        toy.pose(&scene.physical_pose, camera_from_object, &mut posed)?;
        Ok(Self {
            faces: faces(toy),
            toy: Arc::clone(toy),
            linear: linear_of_codes(),
            positions: posed.points().collect(),
            normals: posed.normals.iter().map(|normal| normal.as_dvec3()).collect(),
        })
    }

    /// The predicted colours of the toy in its given place, at each pixel of its coverage, in the
    /// light of `level`; `None` if too little of it is visible.
    pub(crate) fn shown(&self, level: &Level, coverage: &Coverage) -> Option<Vec<Option<Color>>> {
        let placement = Placement::of(RigidMotion::none(DVec3::ZERO, 1.0));
        let shaded = self.lit(&placement, level, coverage)?;
        Some(coverage.pixels().map(|at| shaded.at(at)).collect())
    }

    /// The predicted colours of the toy in its estimated place, in the light of `level`; `None` if too
    /// little of it is visible.
    pub(super) fn lit(
        &self,
        placement: &Placement,
        level: &Level,
        coverage: &Coverage,
    ) -> Option<Shaded<'_>> {
        let seen = self.seen(placement, &level.intrinsics, coverage);
        let light = Light::fitted(&seen, level, coverage)?;
        Some(Shaded { seen, light })
    }

    /// Pixels of the toy at its given place, at most `most` of them.
    pub(crate) fn surfels(&self, level: &Level, coverage: &Coverage, most: usize) -> Vec<Surfel> {
        let placement = Placement::of(RigidMotion::none(DVec3::ZERO, 1.0));
        let seen = self.seen(&placement, &level.intrinsics, coverage);
        let within = within(coverage);
        let stride = within.len().div_ceil(most).max(1);
        let surfels = within.into_iter().step_by(stride).filter_map(|at| {
            let (surface, shown) = (seen.at(at)?, level.frame.get(at)?);
            let hit = seen.nearest[index_in(seen.size_px, at - seen.origin_px)?];
            let k = &level.intrinsics;
            let depth_m = hit.inverse_depth.recip();
            let on_plane =
                (at.as_dvec2() + 0.5 - DVec2::new(k.cx_px, k.cy_px)) / DVec2::new(k.fx_px, k.fy_px);
            Some(Surfel {
                shown,
                base: surface.color,
                normal: surface.normal,
                point: depth_m * DVec3::new(on_plane.x, -on_plane.y, -1.0),
                material: self.faces[hit.face as usize].material,
            })
        });
        surfels.collect()
    }

    /// The light on the toy, from `level` and the toy's estimated place; `None` if too little of it
    /// is visible.
    pub(super) fn light(&self, placement: &Placement, level: &Level, coverage: &Coverage) -> Option<Light> {
        Light::fitted(
            &self.seen(placement, &level.intrinsics, coverage),
            level,
            coverage,
        )
    }

    /// The face at the centre of each pixel of the coverage.
    fn seen(&self, placement: &Placement, k: &Intrinsics, coverage: &Coverage) -> Seen<'_> {
        let moved = self.positions.iter().map(|point| placement.apply(*point));
        let corners = project(moved, k);
        let size_px = coverage.size_px;
        let n_pixels = (size_px.x * size_px.y) as usize;
        let mut nearest: Vec<Hit> = vec![Hit::NONE; n_pixels];
        let origin = coverage.origin_px.as_dvec2().extend(0.0);
        for (index, face) in (0..).zip(&self.faces) {
            let corners = face.corners.map(|corner| corners[corner as usize] - origin);
            if corners.iter().all(|corner| corner.z > 0.0) {
                draw(corners, size_px, |place, inverse_depth, weights| {
                    if inverse_depth > nearest[place].inverse_depth {
                        nearest[place] = Hit {
                            inverse_depth,
                            face: index,
                            weights,
                        };
                    }
                });
            }
        }
        Seen {
            paint: self,
            motion: placement.motion,
            origin_px: coverage.origin_px,
            size_px,
            corners,
            nearest,
        }
    }

    /// Side of the square of a texture in one pixel, in texels; at least one.
    fn texels_of(&self, face: &Face, corners: &[DVec3]) -> f64 {
        let Some((texture, _)) = face.texture else {
            return 1.0;
        };
        let area = |[a, b, c]: [DVec2; 3]| (b - a).perp_dot(c - a).abs();
        let pixels = area(face.corners.map(|corner| corners[corner as usize].truncate()));
        let size = texture_size(&self.toy.textures()[texture]);
        let texels = area(face.corners.map(|corner| self.uv(corner as usize) * size));
        let side = (texels / pixels).sqrt();
        if side.is_finite() { side.max(1.0) } else { 1.0 }
    }

    fn uv(&self, vertex: usize) -> DVec2 {
        let [u, v] = self.toy.uvs()[vertex];
        DVec2::new(f64::from(u), f64::from(v))
    }

    fn at(&self, face: &Face, weights: [f64; 3], motion: &RigidMotion, texels: f64) -> Surface {
        let mixed = |of: &dyn Fn(usize) -> DVec3| {
            let corners = face.corners.into_iter().zip(weights);
            corners
                .map(|(corner, weight)| weight * of(corner as usize))
                .sum::<DVec3>()
        };
        let normal = motion
            .turn_of(mixed(&|corner| self.normals[corner]))
            .normalize_or_zero();
        let mut color = face.color;
        if let Some(colors) = self.toy.colors_linear() {
            let of_vertices = mixed(&|corner| {
                let [r, g, b, _] = colors[corner].map(f64::from);
                DVec3::new(r, g, b)
            });
            color = scaled(color, of_vertices.as_vec3().to_array());
        }
        if let Some((texture, wraps)) = face.texture {
            let uv = mixed(&|corner| self.uv(corner).extend(0.0)).truncate();
            let texture = &self.toy.textures()[texture];
            color = scaled(color, mean_texel(texture, &self.linear, (uv, wraps), texels));
        }
        Surface { color, normal }
    }
}

fn faces(toy: &Toy) -> Vec<Face> {
    let parts = toy.parts().iter().flat_map(|part| {
        let material = &toy.materials()[part.material];
        let [r, g, b, _] = material.base_color_linear;
        let texture = material.base_color_texture.as_ref();
        let texture = texture.map(|texture| (texture.texture, [texture.wrap_u, texture.wrap_v]));
        let corners = toy.indices()[part.indices.start as usize..part.indices.end as usize].chunks_exact(3);
        corners.map(move |corners| Face {
            corners: [corners[0], corners[1], corners[2]],
            material: part.material,
            color: [r, g, b],
            texture,
        })
    });
    parts.collect()
}

/// Calls `pixel` with the index, one over the depth and the corners' weights of each pixel whose centre a projected triangle covers.
fn draw([a, b, c]: [DVec3; 3], size_px: IVec2, mut pixel: impl FnMut(usize, f64, [f64; 3])) {
    let [pa, pb, pc] = [a, b, c].map(DVec3::truncate);
    let area = (pb - pa).perp_dot(pc - pa);
    if area == 0.0 || !area.is_finite() {
        return;
    }
    for (row, columns) in centres([a, b, c], size_px) {
        for column in columns {
            let at = DVec2::new(column as f64 + 0.5, row as f64 + 0.5);
            let weights = [
                (pb - at).perp_dot(pc - at) / area,
                (pc - at).perp_dot(pa - at) / area,
                (pa - at).perp_dot(pb - at) / area,
            ];
            // Weights over depth are affine over the picture.
            let over_depth = [weights[0] / a.z, weights[1] / b.z, weights[2] / c.z];
            let inverse_depth: f64 = over_depth.iter().sum();
            pixel(
                row * size_px.x as usize + column,
                inverse_depth,
                over_depth.map(|weight| weight / inverse_depth),
            );
        }
    }
}

fn scaled(a: Color, b: Color) -> Color {
    [0, 1, 2].map(|channel| a[channel] * b[channel])
}

/// The toy's surface at a pixel's centre.
#[derive(Clone, Copy)]
struct Hit {
    /// In 1/m; 0 for none.
    inverse_depth: f64,
    face: u32,
    /// Weights of the face's corners.
    weights: [f64; 3],
}

impl Hit {
    const NONE: Self = Self {
        inverse_depth: 0.0,
        face: 0,
        weights: [0.0; 3],
    };
}

/// The toy in its estimated place, over a rectangle of the picture.
struct Seen<'a> {
    paint: &'a Paint,
    motion: RigidMotion,
    origin_px: IVec2,
    size_px: IVec2,
    /// Projected corners.
    corners: Vec<DVec3>,
    nearest: Vec<Hit>,
}

impl Seen<'_> {
    /// `None` if the toy does not cover the pixel's centre.
    fn at(&self, at: IVec2) -> Option<Surface> {
        let hit = self.nearest[index_in(self.size_px, at - self.origin_px)?];
        (hit.inverse_depth > 0.0).then(|| {
            let face = &self.paint.faces[hit.face as usize];
            let texels = self.paint.texels_of(face, &self.corners);
            let surface = self.paint.at(face, hit.weights, &self.motion, texels);
            // Rows go down: triangles whose outer side is visible turn to the left. For others, the
            // inner side receives light.
            let [a, b, c] = face
                .corners
                .map(|corner| self.corners[corner as usize].truncate());
            let is_inner = (b - a).perp_dot(c - a) > 0.0;
            Surface {
                normal: if is_inner { -surface.normal } else { surface.normal },
                ..surface
            }
        })
    }
}

/// Pixels well within the outline.
fn within(coverage: &Coverage) -> Vec<IVec2> {
    let reach = [IVec2::X, IVec2::NEG_X, IVec2::Y, IVec2::NEG_Y].map(|step| WITHIN_PX * step);
    let is_within = |at: &IVec2| reach.iter().all(|step| coverage.at(*at + *step) >= 1.0);
    coverage.pixels().filter(is_within).collect()
}

/// A visible pixel of the toy.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surfel {
    /// By the photograph.
    pub(crate) shown: Color,
    /// Colour of the model's paint.
    pub(crate) base: Color,
    /// Unit vector in camera space, as is the place.
    pub(crate) normal: DVec3,
    pub(crate) point: DVec3,
    /// Index of the material.
    pub(crate) material: usize,
}

/// The toy's surface at a pixel.
#[derive(Clone, Copy, Debug)]
struct Surface {
    color: Color,
    normal: DVec3,
}

impl Surface {
    fn basis(&self) -> Basis {
        let DVec3 { x, y, z } = self.normal;
        Basis::from([
            1.0,
            x,
            y,
            z,
            x * y,
            y * z,
            x * z,
            3.0 * z * z - 1.0,
            x * x - y * y,
        ])
    }
}

/// The light on the toy: coefficients of each harmonic, for each channel.
#[derive(Clone, Debug)]
pub(super) struct Light {
    factors: [Basis; 3],
    least: Color,
}

impl Light {
    /// Fits the light to the visible surface in a photograph, by iteratively reweighted least
    /// squares; `None` if too little of it is visible.
    fn fitted(seen: &Seen<'_>, level: &Level, coverage: &Coverage) -> Option<Self> {
        let within = within(coverage);
        let stride = within.len().div_ceil(MOST_PIXELS).max(1);
        let pixels = within.into_iter().step_by(stride);
        let pixels: Vec<(Surface, Color)> = pixels
            .filter_map(|at| Some((seen.at(at)?, level.frame.get(at)?)))
            .collect();
        if pixels.len() < LEAST_PIXELS {
            return None;
        }
        let factors = [0, 1, 2].map(|channel| fitted(&pixels, channel));
        let mut mean = [0.0_f64; 3];
        for (surface, _) in &pixels {
            for channel in 0..3 {
                mean[channel] += surface.basis().dot(&factors[channel]).max(0.0);
            }
        }
        #[allow(clippy::cast_possible_truncation, reason = "light, to 7 digits")]
        let least = mean.map(|sum| DARKEST * (sum / pixels.len() as f64) as f32);
        Some(Self { factors, least })
    }

    fn shade(&self, surface: &Surface) -> Color {
        let basis = surface.basis();
        [0, 1, 2].map(|channel| {
            #[allow(clippy::cast_possible_truncation, reason = "light, to 7 digits")]
            let light = basis.dot(&self.factors[channel]) as f32;
            surface.color[channel].max(DARKEST_PAINT) * light.max(self.least[channel])
        })
    }
}

fn fitted(pixels: &[(Surface, Color)], channel: usize) -> Basis {
    let mut factors: Option<Basis> = None;
    for _ in 0..N_ROUNDS {
        let mut normal = SMatrix::<f64, N_BASIS, N_BASIS>::zeros();
        let mut side = Basis::zeros();
        for (surface, shown) in pixels {
            let paint = f64::from(surface.color[channel].max(DARKEST_PAINT));
            let shown = f64::from(shown[channel]);
            let row = paint * surface.basis();
            // Errors of the model are proportional to the light, those of the picture are noise.
            #[allow(clippy::cast_possible_truncation, reason = "light, to 7 digits")]
            let noise = f64::from(noise_deviation(shown as f32));
            let scale = noise.hypot(ROBUST * shown);
            let excess = factors.map_or(0.0, |factors| (shown - row.dot(&factors)) / scale);
            let weight = 1.0 / (scale * scale * (1.0 + excess * excess));
            normal += weight * row * row.transpose();
            side += weight * shown * row;
        }
        let prior = PRIOR * normal[(0, 0)];
        for order in 1..N_BASIS {
            normal[(order, order)] += prior;
        }
        let Some(factor) = normal.cholesky() else { break };
        factors = Some(factor.solve(&side));
    }
    factors.unwrap_or_else(Basis::zeros)
}

/// The light of a toy.
#[derive(Clone, Copy)]
pub(super) struct Lit<'a> {
    pub(super) paint: &'a Paint,
    pub(super) light: &'a Light,
}

impl<'a> Lit<'a> {
    /// The predicted colours of the toy in its estimated place.
    pub(super) fn shaded(self, placement: &Placement, level: &Level, coverage: &Coverage) -> Shaded<'a> {
        Shaded {
            seen: self.paint.seen(placement, &level.intrinsics, coverage),
            light: self.light.clone(),
        }
    }
}

/// Predicted colours of the toy, over a rectangle of the picture.
pub(super) struct Shaded<'a> {
    seen: Seen<'a>,
    light: Light,
}

impl Shaded<'_> {
    pub(super) fn light(&self) -> &Light {
        &self.light
    }

    /// `None` if the toy does not cover the pixel's centre.
    pub(super) fn at(&self, at: IVec2) -> Option<Color> {
        self.seen.at(at).map(|surface| self.light.shade(&surface))
    }

    /// The toy's own colour there, whatever the light.
    pub(super) fn color(&self, at: IVec2) -> Option<Color> {
        self.seen
            .at(at)
            .map(|surface| surface.color.map(|channel| channel.max(DARKEST_PAINT)))
    }

    /// The point of the toy that a pixel's centre shows, where the toy was given, in camera space.
    pub(super) fn given(&self, at: IVec2) -> Option<DVec3> {
        let seen = &self.seen;
        let hit = seen.nearest[index_in(seen.size_px, at - seen.origin_px)?];
        (hit.inverse_depth > 0.0).then(|| {
            let corners = seen.paint.faces[hit.face as usize].corners.into_iter();
            let corners = corners.zip(hit.weights);
            corners
                .map(|(corner, weight)| weight * seen.paint.positions[corner as usize])
                .sum()
        })
    }
}
