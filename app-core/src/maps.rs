//! The maps between input and picture, read back for reports and tests.

use glam::{UVec2, Vec2, Vec3, Vec4};
use wgpu::TextureFormat;

use crate::gpu::layout::{COVERED_CODES, Fit, Globals, N_POSITIONS, TintGrid};
use crate::gpu::{Gpu, GpuError};
use crate::published::Published;
use crate::work::Model;

/// A map that the pipeline makes on its way to a picture, all of the work region.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Map {
    /// r is 1 where the frame shows the receiver alone, g where it shows one surface of the toy, b where it shows the
    /// receiver well clear of the toy.
    Evidence,
    /// Base colour of the physical toy, linear; alpha is its coverage.
    ObjectBase,
    /// Cosine to each light times its visibility, on the physical toy, light 0 in r.
    ObjectReceived,
    /// The toy's own colours, linear, carried past its outline; alpha is 1 where there is one.
    Appearance,
    /// Visibility of each light with the physical toy, light 0 in r.
    PhysicalVisibility,
    /// Visibility of the ambient light with the physical toy, in r, at a fraction of the region's size.
    PhysicalAmbient,
    /// Visibility of each light with the shown toy, light 0 in r.
    Visibility,
    /// Visibility of the ambient light with the shown toy, in r, at a fraction of the region's size.
    Ambient,
    /// How much of each pixel the shown toy covers, in r.
    Coverage,
    /// The plate as this camera would have taken it, linear; alpha is 1 where it was photographed, 0 where it is unknown.
    Plate,
    /// The filled grid of residuals on the first receiver in rgb, in plates; alpha is 1.
    Residual,
    /// Share f of the plate's radiance that all lights give together, in rgb, at the ambient maps' size; 0 beside the
    /// receiver.
    Share,
    /// The paper's mask 3a, the physical toy, in r.
    Masks,
    /// The paper's masks: r labels the shadow to sample from (3c), g is 1 in the real shadow (3b). A label is 16 times the
    /// receiver plus the set of lights that do not reach it, bit i for light i; 0 where there is nothing to sample.
    Eligible,
    /// The paper's warp: where in the region's pixels to sample, the occluder's height in metres; alpha is coverage. The
    /// maps of several lights lie below each other.
    Warp,
    /// Shadow terms as they were sampled; alpha is the label of what they stand for, 0 where there is none.
    Terms,
    /// Sums of shadow terms over the box; alpha is their number. The maps of several sets of lights, from the set 1 on, lie
    /// below each other.
    FilteredTerms,
    /// Candidates that the ring search looked at, in r; 0 where it was not needed.
    SearchTaps,
}

impl Map {
    /// Every map there is.
    pub const ALL: &[Self] = &[
        Self::Evidence,
        Self::ObjectBase,
        Self::ObjectReceived,
        Self::Appearance,
        Self::PhysicalVisibility,
        Self::PhysicalAmbient,
        Self::Visibility,
        Self::Ambient,
        Self::Coverage,
        Self::Plate,
        Self::Residual,
        Self::Share,
        Self::Masks,
        Self::Eligible,
        Self::Warp,
        Self::Terms,
        Self::FilteredTerms,
        Self::SearchTaps,
    ];
}

/// Numbers over a rectangle, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct FloatMap {
    /// Texels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `width * height` texels; channels that the map does not have are 0, alpha 1.
    pub texels: Vec<[f32; 4]>,
}

/// How the real toy's paint differs from its model's.
#[derive(Clone, Debug, PartialEq)]
pub struct TintMap {
    /// Where the cells lie.
    pub grid: TintGrid,
    /// For each material that has a grid, the tint of its cells, x fastest, then y; alpha is 1.
    pub materials: Vec<Vec<[f32; 4]>>,
}

impl Model {
    /// Waits for the device and returns a map.
    pub(crate) fn read_map(&self, gpu: &Gpu, map: Map) -> Result<Option<FloatMap>, GpuError> {
        let capture = &self.capture;
        let map = match map {
            Map::Evidence => read_texture(gpu, &capture.evidence().raw),
            Map::ObjectBase => read_texture(gpu, &capture.object_base.raw),
            Map::ObjectReceived => read_texture(gpu, &capture.object_received.raw),
            Map::Appearance => read_texture(gpu, &capture.appearance.raw),
            Map::PhysicalVisibility => read_texture(gpu, &capture.physical.lights.raw),
            Map::PhysicalAmbient => read_texture(gpu, &capture.physical.ambient.raw),
            Map::Visibility => read_texture(gpu, &capture.shown.lights.raw),
            Map::Ambient => read_texture(gpu, &capture.shown.ambient.raw),
            Map::Coverage => self.read_coverage(gpu),
            Map::Plate => read_texture(gpu, &capture.plate().raw),
            Map::Residual => self.read_residual(gpu, 0),
            Map::Share => self.read_share(gpu),
            Map::Masks | Map::Eligible | Map::Warp | Map::Terms | Map::FilteredTerms | Map::SearchTaps => {
                return Ok(None);
            }
        };
        map.map(Some)
    }

    /// Parts of pixels, from the count that `coverage` made.
    fn read_coverage(&self, gpu: &Gpu) -> Result<FloatMap, GpuError> {
        let mut map = read_texture(gpu, &self.capture.coverage.count.raw)?;
        #[allow(clippy::cast_precision_loss, reason = "fewer than 256 codes")]
        let all = (COVERED_CODES * N_POSITIONS) as f32 / 255.0;
        map.texels.iter_mut().for_each(|texel| texel[0] /= all);
        Ok(map)
    }

    /// The lights' share, worked out here from what was fitted: no pass has it as a texture.
    fn read_share(&self, gpu: &Gpu) -> Result<FloatMap, GpuError> {
        let fit: Fit = bytemuck::pod_read_unaligned(&gpu.read_buffer(&self.knowledge.solution)?);
        let plan = &self.capture.plan;
        let size = plan.ambient_px;
        let scale = plan.region.size_px.as_vec2() / size.as_vec2();
        let texel = |y: u32, x: u32| {
            let region_px = (UVec2::new(x, y).as_vec2() + 0.5) * scale;
            let share = share_at(&self.capture.known, &fit, region_px);
            share.extend(1.0).to_array()
        };
        let texels = (0..size.y).flat_map(|y| (0..size.x).map(move |x| (y, x)));
        let texels = texels.map(|(y, x)| texel(y, x)).collect();
        Ok(FloatMap {
            width: size.x,
            height: size.y,
            texels,
        })
    }

    /// Waits for the device and returns the filled residuals on a receiver; empty for one there is none of.
    pub(crate) fn read_residual(&self, gpu: &Gpu, receiver: usize) -> Result<FloatMap, GpuError> {
        let grid = self.knowledge.layout.grids[receiver];
        let cells = gpu.read_buffer(&self.knowledge.residual.cells)?;
        let cells: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(&cells);
        let [width, height] = grid.size;
        // The coarser levels of the pyramid follow the finest.
        let finest = cells.into_iter().skip(grid.first_cell as usize);
        Ok(FloatMap {
            width,
            height,
            texels: finest.take((width * height) as usize).collect(),
        })
    }
}

/// Sum over lights of share falloff / (1 - sum share + sum share falloff), with the falloff cos / d^2 against the
/// reference point, as the shaders' model has it; 0 beside the receivers.
fn share_at(known: &Globals, fit: &Fit, region_px: Vec2) -> Vec3 {
    let Some((index, in_plane)) = receiver_point(known, region_px) else {
        return Vec3::ZERO;
    };
    let (receiver, fit) = (&known.receivers[index], &fit.receivers[index]);
    let (mut direct, mut total) = (Vec3::ZERO, Vec3::ONE);
    let lights = receiver.lights.iter().zip(&fit.share);
    for (light, share) in lights.take(known.n_lights as usize) {
        let light = Vec4::from_array(*light);
        let distance = |p: Vec2| light.truncate().distance(Vec3::new(p.x, 0.0, p.y));
        let reference = Vec2::from_array(receiver.reference_in_plane);
        let falloff = if light.y <= 0.0 {
            0.0
        } else if light.w == 0.0 {
            1.0
        } else {
            (distance(reference) / distance(in_plane)).powi(3)
        };
        let share = Vec4::from_array(*share).truncate();
        direct += share * falloff;
        total += share * (falloff - 1.0);
    }
    direct / total
}

/// The nearest receiver seen at a pixel, and the point of it; none where that is its back.
fn receiver_point(known: &Globals, region_px: Vec2) -> Option<(usize, Vec2)> {
    let receivers = known.receivers.iter().take(known.n_receivers as usize);
    let hits = receivers.enumerate().filter_map(|(index, receiver)| {
        let [x, y, z] = receiver.plane_from_region_px.map(Vec4::from_array);
        let at = (x * region_px.x + y * region_px.y + z).truncate();
        let in_plane = Vec2::new(at.x, at.y) / at.z;
        let is_on = at.z > 0.0
            && in_plane
                .abs()
                .cmple(Vec2::from_array(receiver.half_extent_m))
                .all();
        is_on.then_some((at.z, index, in_plane))
    });
    hits.max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, index, in_plane)| (index, in_plane))
        .filter(|(index, _)| known.seen_from_behind >> index & 1 == 0)
}

impl Published {
    /// Waits for the device and returns a map, if the published method makes it.
    pub(crate) fn read_map(&self, gpu: &Gpu, map: Map) -> Result<Option<FloatMap>, GpuError> {
        let texture = match map {
            Map::Plate => &self.plate.raw,
            Map::Masks => &self.masks.raw,
            Map::Eligible => &self.eligible.raw,
            Map::Warp => &self.warp.raw,
            Map::Terms => &self.terms.raw,
            Map::FilteredTerms => &self.filtered_terms.raw,
            Map::SearchTaps => &self.taps.raw,
            Map::Visibility => &self.visibility.raw,
            _ => return Ok(None),
        };
        read_texture(gpu, texture).map(Some)
    }
}

fn read_texture(gpu: &Gpu, texture: &wgpu::Texture) -> Result<FloatMap, GpuError> {
    let bytes = gpu.read_texture(texture)?;
    let format = texture.format();
    let n_channels = usize::from(format.components());
    let values: Vec<f32> = match format {
        TextureFormat::R16Float | TextureFormat::Rg16Float | TextureFormat::Rgba16Float => bytes
            .chunks_exact(2)
            .map(|b| f32_from_f16(u16::from_le_bytes([b[0], b[1]])))
            .collect(),
        TextureFormat::Rgba32Float => bytes
            .chunks_exact(4)
            .map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
            .collect(),
        TextureFormat::Rgba8UnormSrgb => bytes
            .iter()
            .enumerate()
            .map(|(i, code)| {
                let encoded = f32::from(*code) / 255.0;
                if i % 4 == 3 {
                    encoded
                } else {
                    linear_from_srgb(encoded)
                }
            })
            .collect(),
        TextureFormat::Rg8Uint => bytes.iter().map(|number| f32::from(*number)).collect(),
        _ => bytes.iter().map(|code| f32::from(*code) / 255.0).collect(),
    };
    let texels = values
        .chunks_exact(n_channels)
        .map(|channels| {
            let mut texel = [0.0, 0.0, 0.0, 1.0];
            texel[..n_channels].copy_from_slice(channels);
            texel
        })
        .collect();
    Ok(FloatMap {
        width: texture.width(),
        height: texture.height() * texture.depth_or_array_layers(),
        texels,
    })
}

/// Decodes an sRGB value in [0, 1]. Source: IEC 61966-2-1.
#[must_use]
pub fn linear_from_srgb(encoded: f32) -> f32 {
    if encoded <= 0.040_45 {
        encoded / 12.92
    } else {
        ((encoded + 0.055) / 1.055).powf(2.4)
    }
}

/// Widens an IEEE 754 half.
fn f32_from_f16(bits: u16) -> f32 {
    let sign = if bits & 0x8000 == 0 { 1.0 } else { -1.0 };
    let exponent = i32::from((bits >> 10) & 0x1f);
    let fraction = f32::from(bits & 0x3ff) / 1024.0;
    sign * match exponent {
        0 => fraction * 2f32.powi(-14),
        31 if fraction == 0.0 => f32::INFINITY,
        31 => f32::NAN,
        _ => (1.0 + fraction) * 2f32.powi(exponent - 15),
    }
}
