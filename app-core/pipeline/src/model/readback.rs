//! Readback of the model's maps, for reports and tests.

use glam::{DMat4, DVec2, DVec3, Mat4, UVec2, Vec2, Vec3, Vec4};

use crate::gpu::context::{Gpu, GpuError};
use crate::gpu::shader::{Mirrors, mirrors};
use crate::gpu::texture::Texture;
use crate::model::Model;
use crate::model::capture::appearance::source_texel;
use crate::model::capture::validity::FAR_MARKS;
use crate::model::diagnostics::evidence::linear_colors;
use crate::model::frame::coverage::{COVERED_CODES, N_POSITIONS};
use crate::model::state::solution::Fit;
use crate::passes::globals::{Globals, ReceiverPlane};
use crate::readback::{FloatMap, Map, read_texture};
use app_scene::geometry::opaque::{
    LEAST_SKY, SHARPEST_M, STANDS, UNLIT_FACE, darkness_of_faces, hidden_light, hidden_sky, is_top,
};
use app_scene::scene::{Image, MAX_RECEIVERS};

/// What the tops of things hide, as shaders have it.
pub(crate) const PLATE_LIGHT: Mirrors = mirrors!(
    "common/plate_light",
    constants: [LEAST_SKY, SHARPEST_M, STANDS, UNLIT_FACE]
);

impl Model {
    /// Waits for the device and returns a map.
    pub(crate) fn read_map(
        &self,
        gpu: &Gpu,
        frame: Option<&Image>,
        map: Map,
    ) -> Result<Option<FloatMap>, GpuError> {
        let (captured, drawn) = (&self.captured, &self.drawn);
        let physical = self.region.plan.physical_box.origin_px;
        let map = match map {
            Map::Validity => self.read_box(gpu, (&captured.by_pass.validity.marks, physical), FAR_MARKS),
            Map::GbufferBase => self.read_box(gpu, (&captured.by_pass.gbuffer.base, physical), [0.0; 4]),
            Map::GbufferReceived => {
                self.read_box(gpu, (&captured.by_pass.gbuffer.received, physical), [0.0; 4])
            }
            Map::Appearance => self.read_appearance(gpu, frame),
            Map::PhysicalVisibility => read_texture(gpu, captured.light.visibility.lights.raw()),
            Map::PhysicalAmbient => read_texture(gpu, captured.light.visibility.ambient.raw()),
            Map::Visibility => read_texture(gpu, drawn.light.visibility.lights.raw()),
            Map::Ambient => read_texture(gpu, drawn.light.visibility.ambient.raw()),
            Map::Coverage => self.read_coverage(gpu),
            Map::Plate => read_texture(gpu, captured.plate.raw()),
            Map::Residual => self.read_residual(gpu, 0),
            Map::DirectFraction => self.read_direct_fraction(gpu),
            Map::Masks | Map::Eligible | Map::Warp | Map::Terms | Map::FilteredTerms | Map::SearchTaps => {
                return Ok(None);
            }
        };
        map.map(Some)
    }

    /// A target of the toy box or of the physical box, placed into the region; pixels outside the
    /// box are `beyond`.
    fn read_box(
        &self,
        gpu: &Gpu,
        (target, origin): (&Texture, UVec2),
        beyond: [f32; 4],
    ) -> Result<FloatMap, GpuError> {
        let size = self.region.plan.region.size_px;
        let map = read_texture(gpu, target.raw())?;
        let mut texels = vec![beyond; (size.x * size.y) as usize];
        for (y, row) in (origin.y..).zip(map.texels.chunks_exact(map.width as usize)) {
            let first = (y * size.x + origin.x) as usize;
            texels[first..first + row.len()].copy_from_slice(row);
        }
        Ok(FloatMap {
            width: size.x,
            height: size.y,
            texels,
        })
    }

    /// The toy's own colours: those of the frame at the source pixels.
    fn read_appearance(&self, gpu: &Gpu, frame: Option<&Image>) -> Result<FloatMap, GpuError> {
        let physical_box = self.region.plan.physical_box;
        let source = &self.captured.by_pass.appearance.source;
        let source = self.read_box(gpu, (source, physical_box.origin_px), [1.0; 4])?;
        let frame = frame.map_or_else(Vec::new, |frame| linear_colors(frame, &self.region.rect()));
        let [first, end] = [
            physical_box.origin_px,
            physical_box.origin_px + physical_box.size_px,
        ]
        .map(|corner| corner.as_ivec2());
        let width = source.width.max(1);
        let color = |(index, number): (u32, &[f32; 4])| {
            let from = source_texel(UVec2::new(index % width, index / width).as_ivec2(), number[0])?;
            let from = from.clamp(first, end - 1).as_uvec2();
            let [r, g, b] = *frame.get((from.y * width + from.x) as usize)?;
            Some([r, g, b, 1.0])
        };
        let texels = (0..).zip(&source.texels);
        Ok(FloatMap {
            texels: texels.map(|texel| color(texel).unwrap_or_default()).collect(),
            ..source
        })
    }

    /// Covered fractions of pixels, from the counts of `coverage`.
    fn read_coverage(&self, gpu: &Gpu) -> Result<FloatMap, GpuError> {
        let covered = &self.drawn.by_pass.coverage.covered;
        let origin_px = self.region.plan.toy_box.origin_px;
        let mut map = self.read_box(gpu, (covered, origin_px), [0.0, 0.0, 0.0, 1.0])?;
        let all = (COVERED_CODES * N_POSITIONS) as f32 / 255.0;
        map.texels.iter_mut().for_each(|texel| texel[0] /= all);
        Ok(map)
    }

    /// The lights' direct fraction, computed here from the fit, since no pass has it as a texture.
    fn read_direct_fraction(&self, gpu: &Gpu) -> Result<FloatMap, GpuError> {
        let fit: Fit = bytemuck::pod_read_unaligned(&gpu.read_buffer(&self.state.solution)?);
        let plan = &self.region.plan;
        let size = plan.ambient_px;
        let scale = plan.region.size_px.as_vec2() / size.as_vec2();
        let texel = |y: u32, x: u32| {
            let region_px = (UVec2::new(x, y).as_vec2() + 0.5) * scale;
            let direct_fraction = direct_fraction_at(&self.region.uniform, &fit, region_px);
            direct_fraction.extend(1.0).to_array()
        };
        let texels = (0..size.y).flat_map(|y| (0..size.x).map(move |x| (y, x)));
        let texels = texels.map(|(y, x)| texel(y, x)).collect();
        Ok(FloatMap {
            width: size.x,
            height: size.y,
            texels,
        })
    }

    /// Whether a receiver's front is visible at a position in the picture.
    pub(crate) fn shows_receiver(&self, image_px: Vec2) -> bool {
        let region_px = image_px - self.region.rect().origin_px.as_vec2();
        receiver_point(&self.region.uniform, region_px).is_some()
    }

    /// Waits for the device and returns the filled residuals on a receiver; empty if it has none.
    pub(crate) fn read_residual(&self, gpu: &Gpu, receiver: usize) -> Result<FloatMap, GpuError> {
        let grid = self.state.layout.grids[receiver];
        let cells = gpu.read_buffer(&self.state.residual.cells)?;
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

/// Sum over lights of fraction falloff / ((1 - sum fraction) sky + sum fraction falloff), with the
/// falloff cos / d^2 relative to the reference point, and the part of the sky that no other receiver
/// hides, as in the shaders' model; 0 outside the receivers.
fn direct_fraction_at(globals: &Globals, fit: &Fit, region_px: Vec2) -> Vec3 {
    let Some((index, in_plane)) = receiver_point(globals, region_px) else {
        return Vec3::ZERO;
    };
    let (receiver, fit) = (&globals.receivers[index], &fit.receivers[index]);
    let sky = open_sky(globals, (index, in_plane));
    let (mut direct, mut total) = (Vec3::ZERO, Vec3::splat(sky));
    let lights = receiver.lights.iter().zip(&fit.direct_fraction);
    for (i, (light, direct_fraction)) in lights.take(globals.n_lights as usize).enumerate() {
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
        let falloff = falloff * unhidden(globals, i, (index, in_plane));
        let direct_fraction = Vec4::from_array(*direct_fraction).truncate();
        direct += direct_fraction * falloff;
        total += direct_fraction * (falloff - sky);
    }
    direct / total
}

/// Part of a light that the other receivers leave at a point of one.
fn unhidden(globals: &Globals, light: usize, (own, in_plane): (usize, Vec2)) -> f32 {
    let from = Vec3::new(in_plane.x, 0.0, in_plane.y).as_dvec3();
    let hidden = hidden_by_all(globals, own, |own_from_top, top| {
        let top_from_own = own_from_top.inverse();
        let here = top_from_own.transform_point3(from);
        let up = top_from_own.transform_vector3(DVec3::Y);
        let centre = Vec4::from_array(top.lights[light]).as_dvec4();
        hidden_light(here, up, centre, f64::from(globals.light_radii[light]), ends(top))
    });
    (1.0 - hidden).max(0.0)
}

/// Part of the sky that the other receivers leave at a point of one.
fn open_sky(globals: &Globals, (own, in_plane): (usize, Vec2)) -> f32 {
    let hidden = hidden_by_all(globals, own, |own_from_top, top| {
        let lights = top.lights.map(|light| Vec4::from_array(light).as_dvec4());
        let darkness = darkness_of_faces(ends(top), &lights[..globals.n_lights as usize]);
        hidden_sky(in_plane.as_dvec2(), own_from_top, ends(top), darkness)
    });
    (1.0 - hidden).max(LEAST_SKY)
}

/// What the tops of things on a receiver hide together: each adds what those below it do not hide.
/// `hidden` is the part of one, from the matrix from its space to the receiver's.
fn hidden_by_all(globals: &Globals, own: usize, hidden: impl Fn(&DMat4, &ReceiverPlane) -> f64) -> f32 {
    let own_from_anchor = plane_from_anchor(&globals.receivers[own]);
    let mut parts = [0.0; MAX_RECEIVERS];
    let receivers = globals.receivers.iter().take(globals.n_receivers as usize);
    for (index, (part, other)) in parts.iter_mut().zip(receivers).enumerate() {
        let own_from_other = own_from_anchor * plane_from_anchor(other).inverse();
        if index != own && is_top(&own_from_other) {
            *part = hidden(&own_from_other, other);
        }
    }
    let added = parts.iter().zip(&globals.receivers).map(|(part, receiver)| {
        let below = parts.iter().zip(receiver.stands_on);
        let most = below
            .map(|(part, below)| part * f64::from(below))
            .fold(0.0, f64::max);
        (part - most).max(0.0)
    });
    #[allow(clippy::cast_possible_truncation, reason = "a part, to 7 digits")]
    let all = added.sum::<f64>() as f32;
    all
}

fn plane_from_anchor(receiver: &ReceiverPlane) -> DMat4 {
    Mat4::from_cols_array_2d(&receiver.plane_from_anchor).as_dmat4()
}

/// The smallest and the largest (x, z) of a receiver.
fn ends(receiver: &ReceiverPlane) -> [DVec2; 2] {
    let [x_min, z_min, x_max, z_max] = receiver.rect.map(f64::from);
    [DVec2::new(x_min, z_min), DVec2::new(x_max, z_max)]
}

/// The nearest receiver visible at a pixel, and its point there; `None` if the pixel shows its
/// back.
fn receiver_point(globals: &Globals, region_px: Vec2) -> Option<(usize, Vec2)> {
    let receivers = globals.receivers.iter().take(globals.n_receivers as usize);
    let hits = receivers.enumerate().filter_map(|(index, receiver)| {
        let [x, y, z] = receiver.plane_from_region_px.map(Vec4::from_array);
        let at = (x * region_px.x + y * region_px.y + z).truncate();
        let in_plane = Vec2::new(at.x, at.y) / at.z;
        let [x_min, z_min, x_max, z_max] = receiver.rect;
        let is_on = at.z > 0.0
            && in_plane.cmpge(Vec2::new(x_min, z_min)).all()
            && in_plane.cmple(Vec2::new(x_max, z_max)).all();
        is_on.then_some((at.z, index, in_plane))
    });
    hits.max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, index, in_plane)| (index, in_plane))
        .filter(|(index, _)| globals.seen_from_behind >> index & 1 == 0)
}
