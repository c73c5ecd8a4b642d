//! Visibility of the lights in a pose: points over the lights, the passes that draw from them, and the resulting
//! maps.

use glam::{UVec2, Vec4};

use crate::geometry::shadow_atlas::ShadowAtlas;
use crate::geometry::tiles::Tiles;
use crate::gpu::context::Gpu;
use crate::gpu::recorder::Recorder;
use crate::gpu::texture::{Texture, TextureView};
use crate::model::lighting::occlusion::{Light, LightPointsBuffer, PartOfMap};
use crate::model::plan::{Casters, Plan};
use crate::passes::globals::GlobalsOnDevice;
use crate::passes::list::passes;
use crate::passes::toy_mesh::{CasterLod, PoseBuffers, Side, ToyMesh};
use crate::readback::FloatMap;
use crate::readback::inject::upload;
use app_scene::geometry::disc::ambient_directions;

passes!(occlusion, self_shadow);

/// Pixels along each side of the tiles in which shadows and the toy are located.
pub(crate) const TILE_PX: u32 = 16;
/// Margin in pixels around a shadow's triangles for rounding errors.
const AROUND_SHADOW_PX: f32 = 1.0;

/// Visibility and self-shadow maps of one pose.
pub(crate) struct LightMaps {
    pub(crate) visibility: occlusion::Targets,
    pub(crate) self_shadow: self_shadow::Targets,
    /// Replaces the visibility of the lights that the passes compute.
    pub(crate) injected: Option<InjectedLights>,
    /// Points from which the shadow on receivers is drawn, if these are not the lights' own. They stay
    /// for the next such shadow, since a bind group with a new buffer would be kept for each.
    softened: Vec<LightPointsBuffer>,
    is_softened: bool,
}

/// Visibility of the lights, as given by the caller.
pub(crate) struct InjectedLights {
    visibility: Texture,
    /// Tiles in which any light is hidden.
    shadowed: Tiles,
}

impl InjectedLights {
    /// The values of a map of the first `n_lights`, for a texture of the size and format of `like`.
    pub(crate) fn new(gpu: &Gpu, map: &FloatMap, n_lights: usize, like: &Texture) -> Self {
        let size_px = UVec2::new(map.width, map.height);
        let mut shadowed = Tiles::over(size_px, TILE_PX);
        let rows = (0..map.height).flat_map(|y| (0..map.width).map(move |x| UVec2::new(x, y)));
        for (at, visibilities) in rows.zip(&map.texels) {
            if visibilities
                .iter()
                .take(n_lights)
                .any(|visibility| *visibility < 1.0)
            {
                shadowed.mark_box([at.as_vec2(), (at + 1).as_vec2()]);
            }
        }
        Self {
            visibility: upload(gpu, map, like),
            shadowed,
        }
    }
}

impl LightMaps {
    /// Sets the points of each light, receiver by receiver, from which the shadow on receivers is
    /// drawn; `None` selects the lights' own.
    pub(crate) fn soften(&mut self, gpu: &Gpu, plan: &Plan, points: Option<Vec<Vec<Vec4>>>) {
        self.is_softened = points.is_some();
        let Some(points) = points else { return };
        let n_receivers = plan.n_receivers;
        if points.len() == self.softened.len() {
            for (light, points) in self.softened.iter_mut().zip(points) {
                light.write(gpu, points, n_receivers);
            }
            return;
        }
        self.softened = points
            .into_iter()
            .enumerate()
            .map(|(light, points)| {
                LightPointsBuffer::new(gpu, points, n_receivers, PartOfMap::of_light(plan, light))
            })
            .collect();
    }

    /// Points from which the shadow on receivers is drawn, of lights whose own are given.
    fn points<'a>(&'a self, own: &'a [LightPointsBuffer]) -> &'a [LightPointsBuffer] {
        if self.is_softened { &self.softened } else { own }
    }

    pub(crate) fn new(gpu: &Gpu, plan: &Plan) -> Self {
        Self {
            visibility: occlusion::Targets::new(gpu, plan),
            self_shadow: self_shadow::Targets::new(gpu, plan),
            injected: None,
            softened: Vec::new(),
            is_softened: false,
        }
    }
}

/// Points over the lights, directions of the ambient light, and their drawing order.
pub(crate) struct Lighting {
    /// Points of each light, followed by those of the eyes behind a reflecting receiver.
    lights: Vec<LightPointsBuffer>,
    ambient: LightPointsBuffer,
    n_lights: usize,
    n_receivers: u32,
    casters: Casters,
    atlas: ShadowAtlas,
    orders: occlusion::Orders,
}

/// A posed toy in a view.
#[derive(Clone, Copy)]
pub(crate) struct Posed<'a> {
    pub(crate) globals: GlobalsOnDevice<'a>,
    pub(crate) toy: &'a ToyMesh,
    pub(crate) pose: &'a PoseBuffers,
}

impl Lighting {
    /// Uploads `points`: those of each light, receiver by receiver.
    pub(crate) fn new(gpu: &Gpu, plan: &Plan, points: Vec<Vec<Vec4>>) -> Self {
        let n_receivers = plan.n_receivers;
        let on_device = |points, part| LightPointsBuffer::new(gpu, points, n_receivers, part);
        // Each receiver has its own hemisphere.
        let directions = ambient_directions(plan.n_ambient_directions).repeat(n_receivers as usize);
        Self {
            lights: points
                .into_iter()
                .enumerate()
                .map(|(light, points)| on_device(points, PartOfMap::of_light(plan, light)))
                .collect(),
            ambient: on_device(directions, PartOfMap::of_ambient(plan)),
            orders: occlusion::Orders::new(gpu, plan),
            casters: plan.casters,
            atlas: plan.self_shadow.clone(),
            n_lights: plan.n_lights,
            n_receivers,
        }
    }

    /// Sets the shapes that cast shadows in another view.
    pub(crate) fn cast_by(&mut self, casters: Casters) {
        self.casters = casters;
    }

    /// Moves the lights, whose number stays the same, or replaces their points.
    pub(crate) fn relocate(&mut self, gpu: &Gpu, points: Vec<Vec<Vec4>>) {
        for (light, points) in self.lights.iter_mut().zip(points) {
            light.write(gpu, points, self.n_receivers);
        }
    }

    /// Marks the tiles of the region, of `TILE_PX`, in which a toy in a pose may hide any part of any light.
    pub(crate) fn mark_shadows(&self, tiles: &mut Tiles, posed: Posed<'_>, maps: &LightMaps) {
        if let Some(injected) = &maps.injected {
            tiles.join(&injected.shadowed);
        }
        for light in maps.points(&self.lights) {
            for (receiver, points) in light.by_receiver().enumerate() {
                // A light behind a receiver casts no shadow on it.
                if points.iter().all(|point| point.y <= 0.0) {
                    continue;
                }
                let Some(onto) = posed.globals.uniform.onto_receiver(receiver, points) else {
                    return tiles.mark_all();
                };
                let around_px = AROUND_SHADOW_PX + posed.globals.uniform.soft_reach_px;
                posed
                    .toy
                    .mark_seen(tiles, posed.pose, self.casters.light, &onto, around_px);
            }
        }
    }

    /// Draws the visibility of the lights, if there are any, and of the ambient light.
    pub(crate) fn encode_visibility(
        &self,
        recorder: &mut Recorder<'_>,
        passes: &Passes,
        posed: Posed<'_>,
        maps: &LightMaps,
    ) {
        self.encode_light_visibility(recorder, passes, posed, maps);
        let ambient = [Light {
            points: &self.ambient,
            side: None,
        }];
        let inputs = occlusion::Inputs {
            shadows: self.seen_from_upright(posed, maps),
            ..self.occlusion_inputs(posed, self.casters.ambient)
        };
        let (map, order) = (&maps.visibility.ambient, &self.orders.ambient);
        passes.occlusion.encode(recorder, &inputs, &ambient, map, order);
    }

    /// Draws the visibilities that are as sharp as the picture: those of the lights, and the ambient
    /// light's if an upright receiver sees the lights' shadows.
    pub(crate) fn encode_sharp_visibility(
        &self,
        recorder: &mut Recorder<'_>,
        passes: &Passes,
        posed: Posed<'_>,
        maps: &LightMaps,
    ) {
        if self.seen_from_upright(posed, maps).is_some() {
            self.encode_visibility(recorder, passes, posed, maps);
        } else {
            self.encode_light_visibility(recorder, passes, posed, maps);
        }
    }

    /// Draws the visibility of the lights, if there are any.
    fn encode_light_visibility(
        &self,
        recorder: &mut Recorder<'_>,
        passes: &Passes,
        posed: Posed<'_>,
        maps: &LightMaps,
    ) {
        if self.lights.is_empty() {
            return;
        }
        let lights: Vec<_> = maps
            .points(&self.lights)
            .iter()
            .enumerate()
            .map(|(index, points)| Light {
                points,
                // Eyes behind a receiver see the opposite side of the faces that the camera sees in
                // the image.
                side: (index < self.n_lights).then_some(Side::Light(index)),
            })
            .collect();
        let inputs = self.occlusion_inputs(posed, self.casters.light);
        let (map, order) = (&maps.visibility.lights, &self.orders.lights);
        passes.occlusion.encode(recorder, &inputs, &lights, map, order);
        if let Some(injected) = &maps.injected {
            recorder.copy(&injected.visibility, &maps.visibility.lights);
        }
    }

    /// Visibilities of the lights, if an upright receiver sees the shadows on others.
    fn seen_from_upright<'a>(&self, posed: Posed<'_>, maps: &'a LightMaps) -> Option<&'a TextureView> {
        let mut receivers = 0..self.n_receivers as usize;
        let is_any = self.n_lights > 0 && receivers.any(|k| posed.globals.uniform.is_upright(k));
        is_any.then_some(&maps.visibility.lights.view)
    }

    fn occlusion_inputs<'a>(&self, posed: Posed<'a>, caster: CasterLod) -> occlusion::Inputs<'a> {
        occlusion::Inputs {
            globals: posed.globals,
            n_receivers: self.n_receivers,
            toy: posed.toy,
            pose: posed.pose,
            caster,
            shadows: None,
        }
    }

    /// Draws the toy's shadow on itself, if there are any lights.
    pub(crate) fn encode_self_shadow(
        &self,
        recorder: &mut Recorder<'_>,
        passes: &Passes,
        posed: Posed<'_>,
        maps: &LightMaps,
    ) {
        if self.n_lights == 0 {
            return;
        }
        let lights = self.lights.iter().take(self.n_lights);
        let light_points: Vec<&[Vec4]> = lights.map(LightPointsBuffer::in_anchor).collect();
        let inputs = self_shadow::Inputs {
            toy: posed.toy,
            pose: posed.pose,
            light_points: &light_points,
            atlas: &self.atlas,
            caster: self.casters.self_shadow,
        };
        passes.self_shadow.encode(recorder, &inputs, &maps.self_shadow);
    }
}
